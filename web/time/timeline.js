/** The time axis that motion and pulses share: gestures, cursors and keys. */
import { registerCommands } from "../shell/commands.js";
import { endOf, shown } from "../state/time_window.js";
import { gestures, moved, valueAt, zoomed } from "./gestures.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Span} Span */
/** @typedef {import("../state/types.js").Page} Page */
/** @typedef {(event: PointerEvent, cycle: number) => boolean | Promise<number>} Click  Returns true if it used the click, or the cycle for the cursor. */

const DIGITS = [..."0123456789"];

/** Zooms the shown time around a cycle, or its middle. @param {Page} page @param {number} factor @param {number} [at] @param {string} [joins] */
export function zoom({ dispatch, now }, factor, at, joins) {
  dispatch({ type: "window", joins, window: zoomed(shown(now()), factor, at) });
}

/** Moves the visible time by a fraction of its length. @param {Page} page @param {number} fraction @param {string} [joins] */
export function pan({ dispatch, now }, fraction, joins) {
  dispatch({ type: "window", joins, window: moved(shown(now()), fraction) });
}

/** Shows the time between the cursors with a margin. @param {Page} page */
function zoomToCursors({ dispatch, now }) {
  const { a, b } = now().cursors;
  if (a === null || b === null || a === b) return;
  const margin = Math.abs(b - a) * 0.05;
  dispatch({ type: "window", window: { start: Math.min(a, b) - margin, end: Math.max(a, b) + margin } });
}

/** Brings a cycle into view, with the same zoom. @param {Page} page @param {number} cycle */
export function reveal({ dispatch, now }, cycle) {
  const { start, end } = shown(now());
  if (cycle >= start && cycle <= end) return;
  const half = (end - start) / 2;
  dispatch({ type: "window", window: { start: cycle - half, end: cycle + half } });
}

/** Centers a marker, with the same zoom; returns false if it is not set. @param {Page} page @param {number} digit */
export function goToMarker({ dispatch, now }, digit) {
  const cycle = now().markers[digit];
  if (cycle === null) return false;
  const { start, end } = shown(now());
  const half = (end - start) / 2;
  dispatch({ type: "window", window: { start: cycle - half, end: cycle + half } });
  return true;
}

/** Cycle under a pixel of the plotting area. @param {State} state @param {{left: number, right: number}} plot @param {number} x */
export function cycleAt(state, plot, x) {
  return inRun(state, valueAt(shown(state), plot, x));
}

/** The nearest whole cycle within the run. @param {State} state @param {number} cycle */
function inRun(state, cycle) {
  return Math.min(endOf(state), Math.max(0, Math.round(cycle)));
}

/** Pixel of a cycle. @param {State} state @param {{left: number, right: number}} plot @param {number} cycle */
export function pixelOf(state, plot, cycle) {
  const { start, end } = shown(state);
  return plot.left + ((cycle - start) / (end - start)) * (plot.right - plot.left);
}

/**
 * Adds the time axis to an element.
 * @param {HTMLElement} target
 * @param {() => {left: number, right: number}} plot  Plotting area in the element's CSS pixels.
 * @param {Page & {click?: Click}} page
 */
export function onTimeAxis(target, plot, page) {
  const { dispatch, now } = page;
  gestures(target, plot, {
    shown: () => shown(now()),
    show: (window, joins) => dispatch({ type: "window", joins, window }),
    boxing: () => now().box,
    picked: () => now().picked,
    pick: (span) => {
      const cycle = (/** @type {number} */ at) => inRun(now(), at);
      dispatch({ type: "pick", picked: span && { start: cycle(span.start), end: cycle(span.end) } });
    },
    hover: (at) => dispatch({ type: "hover", cycle: at === null ? null : inRun(now(), at) }),
    click: async (event, at) => {
      const cycle = inRun(now(), at);
      const used = page.click?.(event, cycle) ?? false;
      const { left, right } = plot();
      const x = event.clientX - target.getBoundingClientRect().left;
      if (used === true || x < left || x > right) return;
      setCursor(page, event, used === false ? cycle : await used);
    },
  });
  registerCommands(target, "Time axis (motion and pulses)", keys(page, plot));
}

/** Sets the cursor of a click. @param {Page} page @param {PointerEvent} event @param {number} cycle */
export function setCursor({ dispatch, now }, { shiftKey, pointerType }, cycle) {
  const which = shiftKey ? "b" : pointerType === "touch" ? tapped(now(), cycle) : "a";
  dispatch({ type: "cursor", which, cycle });
}

/** The cursor that a tap sets: the first one that is not set, else the nearest one. @param {State} state @param {number} cycle @returns {"a" | "b"} */
export function tapped({ cursors: { a, b } }, cycle) {
  if (a === null) return "a";
  return b === null || Math.abs(b - cycle) < Math.abs(a - cycle) ? "b" : "a";
}

/** The cycle in the middle of the visible time. @param {State} state */
function middleOf(state) {
  const { start, end } = shown(state);
  return Math.round((start + end) / 2);
}

/** Moves a cursor by columns of pixels, or from the middle if it is not set, and brings it into view. @param {Page} page @param {{left: number, right: number}} plot @param {"a" | "b"} which @param {number} columns */
export function nudge(page, { left, right }, which, columns) {
  const { dispatch, now } = page;
  const { start, end } = shown(now());
  const column = Math.max(1, Math.round((end - start) / Math.max(1, right - left)));
  const cycle = inRun(now(), (now().cursors[which] ?? middleOf(now())) + columns * column);
  dispatch({ type: "cursor", which, cycle });
  reveal(page, cycle);
}

/** The keys of the time axis. @param {Page} page @param {() => {left: number, right: number}} plot @returns {import("../shell/commands.js").Command[]} */
function keys(page, plot) {
  const { dispatch, now } = page;
  const at = () => now().cursors.a ?? undefined;
  /** @param {"a" | "b"} which @param {number} sign */
  const moveCursor = (which, sign) => () => nudge(page, plot(), which, sign);
  const clear = () => {
    const { box, picked, cursors } = now();
    if (box || picked) return dispatch({ type: "box", on: false });
    // Without cursors, Escape removes the focus from the view.
    if (cursors.a === null && cursors.b === null && document.activeElement instanceof HTMLElement)
      return document.activeElement.blur();
    dispatch({ type: "cursor", which: "a", cycle: null });
    dispatch({ type: "cursor", which: "b", cycle: null });
  };
  /** The digit of a key, with Shift or without. @param {KeyboardEvent} event */
  const digitOf = ({ code, key }) => Number(/^Digit(\d)$/.exec(code)?.[1] ?? key);
  const mark = (/** @type {KeyboardEvent} */ event) => {
    const { hover, cursors, markers } = now();
    const cycle = hover ?? cursors.a ?? middleOf(now());
    const digit = digitOf(event);
    dispatch({ type: "marker", digit, cycle: markers[digit] === cycle ? null : cycle });
  };
  return [
    { keys: DIGITS, text: "show marker 0 to 9", run: (event) => void goToMarker(page, digitOf(event)) },
    {
      keys: DIGITS.map((digit) => `Shift+${digit}`),
      text: "set or remove that marker at the pointer, or at cursor A",
      run: mark,
    },
    { keys: ["+", "="], text: "zoom in, around cursor A if set", run: () => zoom(page, 0.5, at()) },
    { keys: ["-", "−"], text: "zoom out", run: () => zoom(page, 2, at()) },
    { keys: ["Home"], text: "show the whole run", run: () => dispatch({ type: "window", window: null }) },
    { keys: ["ArrowLeft"], text: "show an earlier time", run: () => pan(page, -0.1) },
    { keys: ["ArrowRight"], text: "show a later time", run: () => pan(page, 0.1) },
    { keys: ["PageUp"], text: "one screen earlier", run: () => pan(page, -0.9) },
    { keys: ["PageDown"], text: "one screen later", run: () => pan(page, 0.9) },
    { keys: ["Shift+ArrowLeft"], text: "move cursor A to the left", run: moveCursor("a", -1) },
    { keys: ["Shift+ArrowRight"], text: "move cursor A to the right", run: moveCursor("a", 1) },
    { keys: ["Alt+ArrowLeft"], text: "move cursor B to the left", run: moveCursor("b", -1) },
    { keys: ["Alt+ArrowRight"], text: "move cursor B to the right", run: moveCursor("b", 1) },
    { keys: ["Backspace"], text: "back to the previous view", run: () => dispatch({ type: "back" }) },
    { keys: ["b"], text: "turn box zoom on or off", run: () => dispatch({ type: "box", on: !now().box }) },
    { keys: ["z"], text: "show the time between the cursors", run: () => zoomToCursors(page) },
    { keys: ["Escape"], text: "remove the cursors; then leave the view", run: clear },
  ];
}
