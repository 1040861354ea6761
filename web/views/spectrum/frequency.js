/** The visible frequencies on a linear or logarithmic axis. Positions are Hz or their logarithms. */
import { DEPTH } from "../../state/history.js";

/** @typedef {import("../../state/types.js").Span} Span */

/** Margin below the fundamental and above the highest line of a logarithmic axis, as a ratio. */
const MARGIN = 1.25;
/** Minimum visible range: a number of lines, or a ratio on a logarithmic axis. */
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
  /** Sets the lines. Different lines reset the visible range. @param {number} hz @param {number} lines */
  setLines(hz, lines) {
    if (hz === fundamental_hz && lines === order) return;
    [fundamental_hz, order] = [hz, lines];
    [window, before] = [null, []];
  },

  isLog: () => log,

  /** Switches to a logarithmic or linear axis with the same visible frequencies. @param {boolean} on */
  setLog(on) {
    if (on === log) return;
    const { start, end } = hertz();
    log = on;
    if (window) window = clamp({ start: toPosition(Math.max(start, minFrequency())), end: toPosition(end) });
    before = [];
  },

  toPosition,
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
    frequency.show({ start: toPosition(Math.max(from, log ? minFrequency() : 0)), end: toPosition(to) });
  },

  back() {
    window = before.pop() ?? null;
    gesture = null;
  },

  canGoBack: () => before.length > 0,
};

/** The minimum of a logarithmic axis, which has no 0. */
function minFrequency() {
  return fundamental_hz / MARGIN;
}

/** Position of a frequency on the axis. @param {number} hz */
function toPosition(hz) {
  return log ? Math.log10(hz) : hz;
}

/** The whole axis. @returns {Span} */
function wholeRange() {
  return log
    ? { start: Math.log10(minFrequency()), end: Math.log10(fundamental_hz * Math.max(order, 2) * MARGIN) }
    : { start: 0, end: fundamental_hz * (order + 1) };
}

/** @returns {Span} */
function shown() {
  return window ?? wholeRange();
}

/** The visible range in Hz. @returns {Span} */
function hertz() {
  const { start, end } = shown();
  return log ? { start: 10 ** start, end: 10 ** end } : { start, end };
}

/** A range within the axis that is not too short. @param {Span} wanted @returns {Span} */
function clamp({ start, end }) {
  const whole = wholeRange();
  const maxLength = whole.end - whole.start;
  const minLength = Math.min(maxLength, log ? Math.log10(MIN_RATIO) : MIN_LINES * fundamental_hz);
  const length = Math.min(maxLength, Math.max(minLength, end - start));
  const from = Math.max(whole.start, Math.min(whole.end - length, (start + end - length) / 2));
  return { start: from, end: from + length };
}
