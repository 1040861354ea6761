/** Exact values at the pointer or a cursor. */
import { byId, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count, exactTime, short } from "../../state/number.js";
import { readingCycle } from "../../state/time_window.js";
import { baselineAxis, unitFor, unitOf } from "./axis_units.js";
import { QUANTITIES } from "./bands.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").Between} Between */
/** @typedef {import("../../state/types.js").Readings} Readings */

/** Delay after a cursor was moved with keys before its values are spoken, in ms. */
const SPEAK_MS = 500;

/** A value with all digits if it is whole, else six. @param {number} value */
function exact(value) {
  return Number.isInteger(value) ? String(value).replace("-", "−") : short(value, 6);
}

/** A quantity at the cycle; undefined if there is no acceleration. @param {Readings | null | undefined} readings @param {number} index */
function readingOf(readings, index) {
  return readings?.mean[index] === undefined ? undefined : readings.at_a[index];
}

/** @param {{engine: import("../../engine/engine.js").Engine, now: () => State}} page */
export function createReading({ engine, now }) {
  let speaking = 0;

  /** The readings of this run and of the baseline at a cycle. @param {State} state @param {number} cycle @param {string} slot @returns {Promise<(Between | null | undefined)[]>} */
  function readingsAt({ axis, baseline, result }, cycle, slot) {
    const at = (cycle / (result?.summary.clock_hz ?? 1)) * (baseline?.summary.clock_hz ?? 1);
    const of = baselineAxis(now()).index;
    return Promise.all([
      engine.latest(slot, "between", axis, cycle, cycle).catch(unlessDropped),
      baseline &&
        engine.latest(`${slot} baseline`, "baseline_between", baseline.controller, of, at, at).catch(unlessDropped),
    ]);
  }

  /** Shows the values at the pointer or a cursor. @param {State} state */
  async function render(state) {
    const { a, b } = state.cursors;
    const cycle = readingCycle(state);
    const result = state.result;
    if (cycle === null || !result) return write("", []);
    const [own, other] = await readingsAt(state, cycle, "reading");
    // A newer state has requested its own readings.
    if (!own || now().result !== result || readingCycle(now()) === null) return undefined;
    const name = cycle === a ? "A " : cycle === b ? "B " : "";
    const { scale, baseline } = unitOf(state);
    const seconds = cycle / result.summary.clock_hz;
    const comparedBaseline = state.difference && other && state.baseline;
    return write(
      `${name}${exactTime(cycle, result.summary.clock_hz)} · cycle ${count(cycle)}`,
      QUANTITIES.map((quantity, index) => {
        const of = (/** @type {Readings | null | undefined} */ readings, /** @type {number} */ step) =>
          (readingOf(readings, index) ?? Number.NaN) * step;
        const difference = of(own.actual, scale) - of(other?.actual, baseline);
        const texts = (
          comparedBaseline && quantity === "position"
            ? [["difference", seconds <= comparedBaseline.summary.end_s ? difference : Number.NaN]]
            : [
                ["actual", of(own.actual, scale)],
                ["ideal", of(own.ideal, scale)],
                ["baseline", of(other?.ideal ?? other?.actual, baseline)],
              ]
        )
          .filter(([, value]) => Number.isFinite(value))
          .map(([text, value]) => `${text} ${exact(Number(value))}`);
        return texts.length ? `${texts.join("  ·  ")} ${unitFor(state, quantity)}` : "";
      }),
    );
  }

  /** @param {string} at @param {string[]} texts */
  function write(at, texts) {
    setText(byId("motion-time"), at);
    for (const [index, quantity] of QUANTITIES.entries()) setText(byId(`read-${quantity}`), texts[index] ?? "");
  }

  /** Speaks the values of a cursor some time after it was moved with keys. @param {State} state @param {"a" | "b"} which */
  function speak(state, which) {
    clearTimeout(speaking);
    const cycle = state.cursors[which];
    speaking = window.setTimeout(async () => {
      if (cycle === null) return setText(byId("motion-spoken"), `Cursor ${which.toUpperCase()} is removed.`);
      const [reply] = await readingsAt({ ...state, baseline: null }, cycle, "spoken");
      if (!reply) return;
      const { scale } = unitOf(state);
      const texts = QUANTITIES.flatMap((quantity, index) => {
        const values = [
          ["ideal", readingOf(reply.ideal, index)],
          ["actual", readingOf(reply.actual, index)],
        ].flatMap(([name, value]) => (Number.isFinite(value) ? [`${name} ${exact(Number(value) * scale)}`] : []));
        return values.length ? [`${quantity}: ${values.join(", ")} ${unitFor(state, quantity)}.`] : [];
      });
      setText(
        byId("motion-spoken"),
        `Cursor ${which.toUpperCase()} at ${exactTime(cycle, state.result?.summary.clock_hz ?? 1)}. ${texts.join(" ")}`,
      );
    }, SPEAK_MS);
  }
  return { render, speak };
}
