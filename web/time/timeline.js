/**
 * The time axis that motion and pulses share: wheel and pinch zoom at the pointer, dragging moves, a click
 * sets a cursor, keys do all of it. It knows pixels and cycles, nothing of what is drawn.
 */
import { listen } from "../shell/commands.js";
import { endOf, shown } from "../state/state.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Span} Span */
/** @typedef {import("../state/types.js").Page} Page */
/** @typedef {(event: PointerEvent, cycle: number) => boolean | Promise<number>} Click  Whether it used the click, or the cycle to take instead. */

/** Notches of the wheel that come within this time, in ms, are one gesture. */
const WHEEL_MS = 600;
/** A press that moves less than this many CSS pixels is a click. */
const CLICK_PX = 4;
const DIGITS = [..."0123456789"];

/** @param {Span} window @param {number} factor @param {number} at  Cycle that keeps its place. @returns {Span} */
export function zoomed({ start, end }, factor, at) {
  return { start: at - (at - start) * factor, end: at + (end - at) * factor };
}

/** Zooms the shown time around a cycle, or its middle. @param {Page} page @param {number} factor @param {number} [at] @param {string} [joins] */
export function zoom({ dispatch, now }, factor, at, joins) {
  const window = shown(now());
  dispatch({ type: "window", joins, window: zoomed(window, factor, at ?? (window.start + window.end) / 2) });
}

/** Moves the shown time by a part of itself. @param {Page} page @param {number} part @param {string} [joins] */
export function pan({ dispatch, now }, part, joins) {
  const { start, end } = shown(now());
  const by = (end - start) * part;
  dispatch({ type: "window", joins, window: { start: start + by, end: end + by } });
}

/** Shows what lies between the cursors, with a little around it. @param {Page} page */
function zoomToCursors({ dispatch, now }) {
  const { a, b } = now().cursors;
  if (a === null || b === null || a === b) return;
  const air = Math.abs(b - a) * 0.05;
  dispatch({ type: "window", window: { start: Math.min(a, b) - air, end: Math.max(a, b) + air } });
}

/** Brings a cycle into view, with the same zoom. @param {Page} page @param {number} cycle */
export function reveal({ dispatch, now }, cycle) {
  const { start, end } = shown(now());
  if (cycle >= start && cycle <= end) return;
  const half = (end - start) / 2;
  dispatch({ type: "window", window: { start: cycle - half, end: cycle + half } });
}

/** Brings a marker into the middle, with the same zoom; false where it is not set. @param {Page} page @param {number} digit */
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
  const { start, end } = shown(state);
  const part = (x - plot.left) / Math.max(1, plot.right - plot.left);
  return Math.min(endOf(state), Math.max(0, Math.round(start + part * (end - start))));
}

/** Pixel of a cycle. @param {State} state @param {{left: number, right: number}} plot @param {number} cycle */
export function pixelOf(state, plot, cycle) {
  const { start, end } = shown(state);
  return plot.left + ((cycle - start) / (end - start)) * (plot.right - plot.left);
}

/**
 * Makes an element a part of the time axis.
 * @param {HTMLElement} target
 * @param {() => {left: number, right: number}} plot  Plotting area in the element's CSS pixels.
 * @param {Page & {click?: Click}} page
 */
export function gestures(target, plot, page) {
  const { dispatch, now } = page;
  /** @type {Map<number, {x: number, y: number}>} */
  const pointers = new Map();
  /** @type {{window: Span, x: number, spread: number, moved: boolean, box: boolean, gesture: string} | null} */
  let drag = null;
  let gestures = 0;
  let turned = -Infinity;
  /** The last press was a box. */
  let boxed = false;
  const xOf = (/** @type {{clientX: number}} */ event) => event.clientX - target.getBoundingClientRect().left;

  function begin() {
    const points = [...pointers.values()];
    const x = points.reduce((sum, point) => sum + point.x, 0) / points.length;
    drag = {
      window: shown(now()),
      x,
      spread: Math.abs(points[0].x - (points[1]?.x ?? 0)),
      moved: drag?.moved ?? false,
      box: false,
      gesture: drag?.gesture ?? `${target.id} ${++gestures}`,
    };
  }

  target.addEventListener(
    "wheel",
    (event) => {
      if (event.ctrlKey && event.deltaMode !== 0) return;
      // Beside the plotting area the wheel scrolls the rows.
      if (xOf(event) < plot().left && !event.ctrlKey) return;
      event.preventDefault();
      const sideways = event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY);
      const delta = (event.deltaX || event.deltaY) * (event.deltaMode === 1 ? 20 : 1);
      if (event.timeStamp - turned > WHEEL_MS) gestures += 1;
      turned = event.timeStamp;
      const joins = `${target.id} wheel ${gestures}`;
      if (sideways) pan(page, delta / 800, joins);
      else
        zoom(
          page,
          Math.exp(Math.max(-1, Math.min(1, event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.002)))),
          cycleAt(now(), plot(), xOf(event)),
          joins,
        );
    },
    { passive: false },
  );

  target.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 && event.button !== 2) return;
    pointers.set(event.pointerId, { x: xOf(event), y: event.clientY });
    if (pointers.size === 1) drag = null;
    if (pointers.size > 1 && now().picked) dispatch({ type: "pick", picked: null });
    begin();
    // Also a press that leaves the element before it is a drag ends here.
    target.setPointerCapture(event.pointerId);
    if (drag && pointers.size === 1)
      drag.box = (now().box || event.shiftKey || event.button === 2) && xOf(event) >= plot().left;
  });
  // The right button's drag is a box; a press of it alone is still the browser's menu.
  target.addEventListener("contextmenu", (event) => {
    if (drag?.moved || boxed) event.preventDefault();
  });

  target.addEventListener("pointermove", (event) => {
    const x = xOf(event);
    const area = plot();
    if (!pointers.has(event.pointerId)) {
      const inside = x >= area.left && x <= area.right;
      return dispatch({ type: "hover", cycle: inside ? cycleAt(now(), area, x) : null });
    }
    pointers.set(event.pointerId, { x, y: event.clientY });
    if (!drag) return;
    const points = [...pointers.values()];
    const middle = points.reduce((sum, point) => sum + point.x, 0) / points.length;
    if (!drag.moved && Math.abs(middle - drag.x) < CLICK_PX && points.length === 1) return;
    drag.moved = true;
    if (drag.box && points.length === 1) {
      const [from, to] = [drag.x, x]
        .sort((a, b) => a - b)
        .map((at) => cycleAt(now(), area, Math.min(area.right, Math.max(area.left, at))));
      return dispatch({ type: "pick", picked: { start: from, end: to } });
    }
    const width = Math.max(1, area.right - area.left);
    const { start, end } = drag.window;
    const spread = points.length > 1 ? Math.max(10, Math.abs(points[0].x - points[1].x)) : drag.spread;
    const factor = points.length > 1 ? Math.max(10, drag.spread) / spread : 1;
    const anchor = start + ((drag.x - area.left) / width) * (end - start);
    const span = (end - start) * factor;
    const from = anchor - ((middle - area.left) / width) * span;
    dispatch({ type: "window", joins: drag.gesture, window: { start: from, end: from + span } });
  });

  /** @param {PointerEvent} event */
  function lift(event) {
    if (!pointers.delete(event.pointerId)) return;
    const { picked } = now();
    boxed = drag?.box === true && picked !== null;
    if (drag?.box && picked) {
      dispatch({ type: "pick", picked: null });
      if (event.type === "pointerup" && picked.end > picked.start) dispatch({ type: "window", window: picked });
    }
    if (event.type === "pointerup" && event.button === 0 && drag && !drag.moved && pointers.size === 0) click(event);
    if (pointers.size > 0) begin();
    else drag = null;
  }
  target.addEventListener("pointerup", lift);
  target.addEventListener("pointercancel", lift);
  target.addEventListener("pointerleave", () => dispatch({ type: "hover", cycle: null }));

  /** @param {PointerEvent} event */
  async function click(event) {
    const area = plot();
    const x = xOf(event);
    const cycle = cycleAt(now(), area, x);
    const used = page.click?.(event, cycle) ?? false;
    if (used === true || x < area.left || x > area.right) return;
    dispatch({ type: "cursor", which: event.shiftKey ? "b" : "a", cycle: used === false ? cycle : await used });
  }

  target.addEventListener("dblclick", (event) => {
    const area = plot();
    if (xOf(event) >= area.left) dispatch({ type: "window", window: null });
  });
  listen(target, "Time axis (motion and pulses)", keys(page, plot));
}

/** What the keys do on the time axis. @param {Page} page @param {() => {left: number, right: number}} plot @returns {import("../shell/commands.js").Command[]} */
function keys(page, plot) {
  const { dispatch, now } = page;
  const at = () => now().cursors.a ?? undefined;
  /** @param {"a" | "b"} which @param {number} sign */
  const nudge = (which, sign) => {
    const { left, right } = plot();
    const { start, end } = shown(now());
    const column = Math.max(1, Math.round((end - start) / Math.max(1, right - left)));
    const from = now().cursors[which] ?? Math.round((start + end) / 2);
    const cycle = Math.min(endOf(now()), Math.max(0, from + sign * column));
    dispatch({ type: "cursor", which, cycle });
    reveal(page, cycle);
  };
  const clear = () => {
    const { box, picked, cursors } = now();
    if (box || picked) return dispatch({ type: "box", on: false });
    // Nothing is left to remove: the focus leaves the view.
    if (cursors.a === null && cursors.b === null && document.activeElement instanceof HTMLElement)
      return document.activeElement.blur();
    dispatch({ type: "cursor", which: "a", cycle: null });
    dispatch({ type: "cursor", which: "b", cycle: null });
  };
  /** The digit of a key, with Shift or without. @param {KeyboardEvent} event */
  const digitOf = ({ code, key }) => Number(/^Digit(\d)$/.exec(code)?.[1] ?? key);
  const mark = (/** @type {KeyboardEvent} */ event) => {
    const { hover, cursors, markers } = now();
    const { start, end } = shown(now());
    const cycle = hover ?? cursors.a ?? Math.round((start + end) / 2);
    const digit = digitOf(event);
    dispatch({ type: "marker", digit, cycle: markers[digit] === cycle ? null : cycle });
  };
  return [
    { keys: DIGITS, text: "show marker 0 to 9", run: (event) => void goToMarker(page, digitOf(event)) },
    {
      keys: DIGITS.map((digit) => `Shift+${digit}`),
      text: "set that marker at the pointer, else at cursor A; once more removes it",
      run: mark,
    },
    { keys: ["+", "="], text: "zoom in, around cursor A if it is set", run: () => zoom(page, 0.5, at()) },
    { keys: ["-", "−"], text: "zoom out", run: () => zoom(page, 2, at()) },
    { keys: ["Home"], text: "show the whole run", run: () => dispatch({ type: "window", window: null }) },
    { keys: ["ArrowLeft"], text: "earlier", run: () => pan(page, -0.1) },
    { keys: ["ArrowRight"], text: "later", run: () => pan(page, 0.1) },
    { keys: ["PageUp"], text: "a screen earlier", run: () => pan(page, -0.9) },
    { keys: ["PageDown"], text: "a screen later", run: () => pan(page, 0.9) },
    { keys: ["Shift+ArrowLeft"], text: "cursor A to the left", run: () => nudge("a", -1) },
    { keys: ["Shift+ArrowRight"], text: "cursor A to the right", run: () => nudge("a", 1) },
    { keys: ["Alt+ArrowLeft"], text: "cursor B to the left", run: () => nudge("b", -1) },
    { keys: ["Alt+ArrowRight"], text: "cursor B to the right", run: () => nudge("b", 1) },
    { keys: ["Backspace"], text: "back to what was shown before", run: () => dispatch({ type: "back" }) },
    { keys: ["b"], text: "drag a box to zoom, or no longer", run: () => dispatch({ type: "box", on: !now().box }) },
    { keys: ["z"], text: "show what lies between the cursors", run: () => zoomToCursors(page) },
    { keys: ["Escape"], text: "remove the cursors; then leave the view", run: clear },
  ];
}
