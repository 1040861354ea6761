/** Exact values at the pointer or a cursor. */
import { byId, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count, exactTime, short } from "../../state/number.js";
import { readingCycle } from "../../state/time_window.js";
import { baselineAxis, QUANTITIES, unitFor, unitOf } from "./bands.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").Between} Between */
/** @typedef {import("../../state/types.js").Readings} Readings */

/** Rest after a cursor moved by keys before its values are spoken, in ms. */
const SPEAK_MS = 500;

/** Of counts every digit. @param {number} value */
function exact(value) {
  return Number.isInteger(value) ? String(value).replace("-", "−") : short(value, 6);
}

/** A quantity at the cycle; none where the speed jumps and has no acceleration. @param {Readings | null | undefined} readings @param {number} index */
function readingOf(readings, index) {
  return readings?.mean[index] === undefined ? undefined : readings.at_a[index];
}

/** @param {{engine: import("../../engine/engine.js").Engine, now: () => State}} page */
export function createReading({ engine, now }) {
  let speaking = 0;

  /** What is known of one cycle, of this run and of the baseline. @param {State} state @param {number} cycle @param {string} slot @returns {Promise<(Between | null | undefined)[]>} */
  function readingsAt({ axis, baseline, result }, cycle, slot) {
    const at = (cycle / (result?.summary.clock_hz ?? 1)) * (baseline?.summary.clock_hz ?? 1);
    const of = baselineAxis(now()).index;
    return Promise.all([
      engine.latest(slot, "between", axis, cycle, cycle).catch(unlessDropped),
      baseline &&
        engine.latest(`${slot} baseline`, "baseline_between", baseline.controller, of, at, at).catch(unlessDropped),
    ]);
  }

  /** The values there. @param {State} state */
  async function render(state) {
    const { a, b } = state.cursors;
    const cycle = readingCycle(state);
    const result = state.result;
    if (cycle === null || !result) return write("", []);
    const [own, other] = await readingsAt(state, cycle, "reading");
    // What has gone on meanwhile has asked anew, or has nothing to say.
    if (!own || now().result !== result || readingCycle(now()) === null) return undefined;
    const name = cycle === a ? "A " : cycle === b ? "B " : "";
    const { scale, baseline } = unitOf(state);
    const seconds = cycle / result.summary.clock_hz;
    const apart = state.difference && other && state.baseline;
    return write(
      `${name}${exactTime(cycle, result.summary.clock_hz)} · cycle ${count(cycle)}`,
      QUANTITIES.map((quantity, index) => {
        const of = (/** @type {Readings | null | undefined} */ readings, /** @type {number} */ step) =>
          (readingOf(readings, index) ?? Number.NaN) * step;
        const far = of(own.actual, scale) - of(other?.actual, baseline);
        const texts = (
          apart && quantity === "position"
            ? [["difference", seconds <= apart.summary.end_s ? far : Number.NaN]]
            : [
                ["from pulses", of(own.actual, scale)],
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
    say(byId("motion-time"), at);
    for (const [index, quantity] of QUANTITIES.entries()) say(byId(`read-${quantity}`), texts[index] ?? "");
  }

  /** Says a cursor's values once it stands, where keys moved it. @param {State} state @param {"a" | "b"} which */
  function speak(state, which) {
    clearTimeout(speaking);
    const cycle = state.cursors[which];
    speaking = window.setTimeout(async () => {
      if (cycle === null) return say(byId("motion-spoken"), `Cursor ${which.toUpperCase()} is removed.`);
      const [reply] = await readingsAt({ ...state, baseline: null }, cycle, "spoken");
      if (!reply) return;
      const { scale } = unitOf(state);
      const texts = QUANTITIES.flatMap((quantity, index) => {
        const values = [
          ["ideal", readingOf(reply.ideal, index)],
          ["from pulses", readingOf(reply.actual, index)],
        ].flatMap(([name, value]) => (Number.isFinite(value) ? [`${name} ${exact(Number(value) * scale)}`] : []));
        return values.length ? [`${quantity}: ${values.join(", ")} ${unitFor(state, quantity)}.`] : [];
      });
      say(
        byId("motion-spoken"),
        `Cursor ${which.toUpperCase()} at ${exactTime(cycle, state.result?.summary.clock_hz ?? 1)}. ${texts.join(" ")}`,
      );
    }, SPEAK_MS);
  }
  return { render, speak };
}
