/** The readings below the pulses: pointer, pulse or span, and cursors. */
import { byId, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count, exactTime, short, si, time } from "../../state/number.js";
import { nameOf } from "./rows.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").Pulse} Pulse */

/** Delay before a sentence is spoken, in ms, so that a held key speaks only once. */
const SPEAK_MS = 250;
const coarse = () => matchMedia("(pointer: coarse)").matches;

/** @param {{engine: import("../../engine/engine.js").Engine, now: () => State}} page */
export function createReading({ engine, now }) {
  /** The text about the signal or span under the pointer. */
  let pointed = "";
  /** The last announced sentence, shown until the pointer moves. */
  let announced = "";
  let timer = 0;
  /** Number of announced sentences; a reply that arrives after a newer sentence is dropped. */
  let sentenceCount = 0;

  /** @param {State} state */
  function cursors(state) {
    const clock = state.result?.summary.clock_hz ?? 1;
    const { a, b } = state.cursors;
    const texts = [];
    if (a !== null) texts.push(`A ${exactTime(a, clock)}`);
    if (b !== null) texts.push(`B ${exactTime(b, clock)}`);
    if (a !== null && b !== null)
      texts.push(
        `B−A ${exactTime(b - a, clock)}, ${count(Math.abs(b - a))} cycles${a === b ? "" : ` = ${si(clock / Math.abs(b - a), "Hz", 6)}`}`,
      );
    else
      texts.push(
        a === null ? (coarse() ? "a tap sets A" : "click sets cursor A") : coarse() ? "drag B" : "shift-click sets B",
      );
    setText(byId("cursor-readings"), texts.join(" · "));
  }

  /** Width, period, frequency and duty cycle of the pulse under the pointer. @param {number} bit @returns {Promise<Pulse | undefined>} */
  async function signal(bit) {
    const { hover } = now();
    if (hover === null) return span("");
    const reply = await engine.latest("pulse", "pulse_at", bit, hover).catch(unlessDropped);
    if (reply) span(pulseText(now(), bit, reply));
    return reply ?? undefined;
  }

  /** Shows the text of the span under the pointer; empty if there is none. @param {string} text @returns {undefined} */
  function span(text) {
    pointed = text;
    announced = "";
    foot(now());
  }

  /** @param {State} state */
  function foot(state) {
    const clock = state.result?.summary.clock_hz ?? 1;
    const atPointer =
      state.hover === null ? [] : [`${time(state.hover / clock)} · cycle ${count(state.hover)}`, pointed];
    const text = announced || atPointer.filter(Boolean).join(" · ");
    setText(
      byId("hover-reading"),
      text ||
        (coarse()
          ? "two fingers zoom, dragging moves, double-tap shows the whole run"
          : "wheel zooms, dragging moves, double-click shows the whole run"),
    );
    byId("hover-reading").classList.toggle("said", announced !== "");
  }

  /** Shows a sentence at once, and speaks it after a delay. @param {string} text */
  function speak(text) {
    announced = text;
    sentenceCount++;
    foot(now());
    clearTimeout(timer);
    timer = window.setTimeout(() => setText(byId("pulses-sentence"), text), SPEAK_MS);
  }

  /** Speaks the level of the selected row at cursor A. */
  async function speakCursor() {
    const {
      row,
      cursors: { a },
    } = now();
    if (a === null) return;
    const own = sentenceCount;
    const reply = await engine.latest("spoken", "pulse_at", row, a).catch(unlessDropped);
    if (own !== sentenceCount) return;
    const state = now();
    const clock = state.result?.summary.clock_hz ?? 1;
    if (reply) speak(`${time(a / clock)}, cycle ${a}: ${pulseText(state, row, reply)}.`);
  }

  /** The result of `announced`. @type {State["result"]} */
  let about = null;

  /** @param {State} state */
  function render(state) {
    if (about !== state.result) announced = "";
    about = state.result;
    foot(state);
    cursors(state);
  }
  return { signal, span, speak, speakCursor, render };
}

/** A pulse as text: its level, width, period and duty cycle. @param {State} state @param {number} bit @param {Pulse} pulse */
function pulseText(state, bit, { high, begin, end, next }) {
  const clock = state.result?.summary.clock_hz ?? 1;
  const level = `${nameOf(state, bit)} ${high ? "high" : "low"}`;
  if (begin === null) return end === null ? `${level}, no edges` : `${level}, first edge at ${time(end / clock)}`;
  if (end === null) return `${level} from ${time(begin / clock)} to the end`;
  const width = `${level} for ${time((end - begin) / clock)} (${count(end - begin)} cycles)`;
  if (next === null) return width;
  const duty = (100 * (high ? end - begin : next - end)) / (next - begin);
  return `${width} · period ${time((next - begin) / clock)} = ${si(clock / (next - begin), "Hz", 5)} · duty ${short(duty, 3)} %`;
}
