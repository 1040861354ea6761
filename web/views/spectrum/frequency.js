/** The visible frequencies on a linear or logarithmic axis. Positions are Hz or their logarithms. */
import { DEPTH } from "../../state/history.js";

/** @typedef {import("../../state/types.js").Span} Span */

/** Beyond the fundamental and the highest line, as ratios on a logarithmic axis. */
const AIR = 1.25;
/** Least part of the whole axis that is shown is so many lines, or this ratio. */
const [MIN_LINES, MIN_RATIO] = [2, 1.05];

let fundamental_hz = 1;
let order = 1;
let log = false;
/** @type {Span | null} */
let window = null;
/** @type {(Span | null)[]} */
let before = [];
/** The gesture that moves the window. @type {string | null} */
let gesture = null;

export const frequency = {
  /** Takes the lines that there are; others than before are shown as a whole. @param {number} hz @param {number} lines */
  of(hz, lines) {
    if (hz === fundamental_hz && lines === order) return;
    [fundamental_hz, order] = [hz, lines];
    [window, before] = [null, []];
  },

  isLog: () => log,

  /** Turns to the other kind of axis, with the same visible frequencies. @param {boolean} on */
  setLog(on) {
    if (on === log) return;
    const { start, end } = hertz();
    log = on;
    if (window) window = clamp({ start: place(Math.max(start, least())), end: place(end) });
    before = [];
  },

  place,
  shown,
  hertz,

  /** @param {Span | null} wanted @param {string} [joins]  What one gesture shows joins one step back. */
  show(wanted, joins) {
    const next = wanted && clamp(wanted);
    if (next?.start === window?.start && next?.end === window?.end) return;
    if (joins === undefined || joins !== gesture) before = [...before, window].slice(-DEPTH);
    gesture = joins ?? null;
    window = next;
  },

  /** Shows these frequencies, in Hz. @param {number} from @param {number} to */
  showHertz(from, to) {
    frequency.show({ start: place(Math.max(from, log ? least() : 0)), end: place(to) });
  },

  back() {
    window = before.pop() ?? null;
    gesture = null;
  },

  canGoBack: () => before.length > 0,
};

/** The least frequency of a logarithmic axis, which has no 0. */
function least() {
  return fundamental_hz / AIR;
}

/** Place of a frequency. @param {number} hz */
function place(hz) {
  return log ? Math.log10(hz) : hz;
}

/** @returns {Span} */
function all() {
  return log
    ? { start: Math.log10(least()), end: Math.log10(fundamental_hz * Math.max(order, 2) * AIR) }
    : { start: 0, end: fundamental_hz * (order + 1) };
}

/** @returns {Span} */
function shown() {
  return window ?? all();
}

/** The same in Hz. @returns {Span} */
function hertz() {
  const { start, end } = shown();
  return log ? { start: 10 ** start, end: 10 ** end } : { start, end };
}

/** A part of the axis, neither too short nor beyond its ends. @param {Span} wanted @returns {Span} */
function clamp({ start, end }) {
  const whole = all();
  const most = whole.end - whole.start;
  const few = Math.min(most, log ? Math.log10(MIN_RATIO) : MIN_LINES * fundamental_hz);
  const length = Math.min(most, Math.max(few, end - start));
  const from = Math.max(whole.start, Math.min(whole.end - length, (start + end - length) / 2));
  return { start: from, end: from + length };
}
