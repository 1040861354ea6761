/** The line under the pulses: the pointer's time, the pulse under it, the cursors and what lies between them. */
import { byId, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count, si, time } from "../../state/number.js";
import { signalsOf } from "./rows.js";

/** @typedef {import("../../state/types.js").State} State */

/** @param {{engine: import("../../engine/engine.js").Engine, now: () => State}} page */
export function createReading({ engine, now }) {
  /** @type {{bit: number, begin?: number, end?: number, next?: number, cycle: number} | null} */
  let pulse = null;

  /** @param {State} state */
  function cursors(state) {
    const clock = state.result?.summary.clock_hz ?? 1;
    const { a, b } = state.cursors;
    const texts = [];
    if (a !== null) texts.push(`A ${time(a / clock)}`);
    if (b !== null) texts.push(`B ${time(b / clock)}`);
    if (a !== null && b !== null) texts.push(`B−A ${time((b - a) / clock)}${a === b ? "" : ` = ${si(clock / Math.abs(b - a), "Hz", 6)}`}`);
    else texts.push(a === null ? "click sets cursor A" : "shift-click sets B");
    say(byId("cursor-readings"), texts.join(" · "));
  }

  /** Width and period of the pulse under the pointer. @param {import("./rows.js").Row | undefined} row */
  async function hover(row) {
    const state = now();
    if (!row || !("bit" in row) || !state.result || state.hover === null) {
      pulse = null;
      return foot(state);
    }
    const cycle = state.hover;
    const answer = await engine.latest("pulse", "pulse_at", row.bit, cycle).catch(unlessDropped);
    if (!answer) return;
    pulse = { ...answer, bit: row.bit, cycle };
    foot(now());
  }

  /** @param {State} state */
  function foot(state) {
    const clock = state.result?.summary.clock_hz ?? 1;
    const parts = [];
    if (state.hover !== null) parts.push(`${time(state.hover / clock)} · cycle ${count(state.hover)}`);
    const name = pulse && signalsOf(state).find(({ bit }) => bit === pulse?.bit)?.name;
    if (pulse && name && state.hover !== null) {
      const { begin, end, next } = pulse;
      if (begin !== undefined && end !== undefined) {
        parts.push(`${name} stays ${time((end - begin) / clock)} (${count(end - begin)} cycles)`);
        if (next !== undefined) parts.push(`period ${time((next - begin) / clock)} = ${si(clock / (next - begin), "Hz", 5)}`);
      } else if (begin === undefined && end === undefined) parts.push(`${name} never changes`);
      else parts.push(`${name} ${end === undefined ? "stays so to the end" : `first changes at ${time(end / clock)}`}`);
    }
    say(byId("hover-reading"), parts.length ? parts.join(" · ") : "wheel zooms, dragging moves, double click shows the whole run");
  }

  function leave() {
    pulse = null;
    foot(now());
  }

  /** @param {State} state */
  function render(state) {
    foot(state);
    cursors(state);
  }
  return { hover, leave, render };
}
