/** Gestures on a time or frequency axis: wheel and pinch zoom, dragging moves or draws a zoom box, double-click shows all. */

/** @typedef {import("../state/types.js").Span} Span */
/**
 * @typedef {object} Axis  The axis that the gestures move.
 * @property {() => Span} shown
 * @property {(window: Span | null, joins?: string) => void} show  Shows a part of the axis, null for all. Calls with the same `joins` are one step back.
 * @property {() => boolean} boxing  Whether dragging draws a zoom box.
 * @property {() => Span | null} picked  The current zoom box.
 * @property {(span: Span | null) => void} pick
 * @property {(at: number | null) => void} hover  The position under the pointer; null outside of the plotting area.
 * @property {(event: PointerEvent, at: number) => void} click
 */

/** Wheel events within this time are one gesture, in ms. */
const WHEEL_MS = 600;
/** A press that moves less than this many CSS pixels is a click. */
const CLICK_PX = 4;

/** @param {Span} window @param {number} factor @param {number} [at]  Position that stays; default: the middle. @returns {Span} */
export function zoomed({ start, end }, factor, at = (start + end) / 2) {
  return { start: at - (at - start) * factor, end: at + (end - at) * factor };
}

/** A window moved by a fraction of its length. @param {Span} window @param {number} fraction @returns {Span} */
export function moved({ start, end }, fraction) {
  const by = (end - start) * fraction;
  return { start: start + by, end: end + by };
}

/** Position at a pixel of the plotting area. @param {Span} window @param {{left: number, right: number}} plot @param {number} x */
export function valueAt({ start, end }, plot, x) {
  return start + ((x - plot.left) / Math.max(1, plot.right - plot.left)) * (end - start);
}

/**
 * @param {HTMLElement} target
 * @param {() => {left: number, right: number}} plot  Plotting area in the element's CSS pixels.
 * @param {Axis} axis
 */
export function gestures(target, plot, axis) {
  /** @type {Map<number, {x: number, y: number}>} */
  const pointers = new Map();
  /** @type {{window: Span, x: number, spread: number, moved: boolean, box: boolean, gesture: string} | null} */
  let drag = null;
  let gestureCount = 0;
  /** Time of the last wheel event. */
  let lastWheel = -Infinity;
  /** Whether the last press drew a box. */
  let hasDrawnBox = false;
  const at = (/** @type {number} */ x) => valueAt(axis.shown(), plot(), x);
  const xOf = (/** @type {{clientX: number}} */ event) => event.clientX - target.getBoundingClientRect().left;

  function begin() {
    const points = [...pointers.values()];
    const x = points.reduce((sum, point) => sum + point.x, 0) / points.length;
    drag = {
      window: axis.shown(),
      x,
      spread: Math.abs(points[0].x - (points[1]?.x ?? 0)),
      moved: drag?.moved ?? false,
      box: false,
      gesture: drag?.gesture ?? `${target.id} ${++gestureCount}`,
    };
  }

  target.addEventListener(
    "wheel",
    (event) => {
      if (event.ctrlKey && event.deltaMode !== 0) return;
      // Left of the plotting area the wheel scrolls the rows.
      if (xOf(event) < plot().left && !event.ctrlKey) return;
      event.preventDefault();
      const sideways = event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY);
      const delta = (event.deltaX || event.deltaY) * (event.deltaMode === 1 ? 20 : 1);
      if (event.timeStamp - lastWheel > WHEEL_MS) gestureCount += 1;
      lastWheel = event.timeStamp;
      const joins = `${target.id} wheel ${gestureCount}`;
      const factor = Math.exp(Math.max(-1, Math.min(1, event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.002))));
      const window = axis.shown();
      axis.show(sideways ? moved(window, delta / 800) : zoomed(window, factor, at(xOf(event))), joins);
    },
    { passive: false },
  );

  target.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 && event.button !== 2) return;
    pointers.set(event.pointerId, { x: xOf(event), y: event.clientY });
    if (pointers.size === 1) drag = null;
    if (pointers.size > 1 && axis.picked()) axis.pick(null);
    begin();
    // So that the release is reported even outside of the element.
    target.setPointerCapture(event.pointerId);
    if (drag && pointers.size === 1)
      drag.box = (axis.boxing() || event.shiftKey || event.button === 2) && xOf(event) >= plot().left;
  });
  // Dragging with the right button draws a box; a click still opens the menu of the browser.
  target.addEventListener("contextmenu", (event) => {
    if (drag?.moved || hasDrawnBox) event.preventDefault();
  });

  target.addEventListener("pointermove", (event) => {
    const x = xOf(event);
    const area = plot();
    if (!pointers.has(event.pointerId)) {
      const inside = x >= area.left && x <= area.right;
      return axis.hover(inside ? at(x) : null);
    }
    pointers.set(event.pointerId, { x, y: event.clientY });
    if (!drag) return;
    const points = [...pointers.values()];
    const middle = points.reduce((sum, point) => sum + point.x, 0) / points.length;
    if (!drag.moved && Math.abs(middle - drag.x) < CLICK_PX && points.length === 1) return;
    drag.moved = true;
    if (drag.box && points.length === 1) {
      const [start, end] = [drag.x, x]
        .sort((a, b) => a - b)
        .map((px) => at(Math.min(area.right, Math.max(area.left, px))));
      return axis.pick({ start, end });
    }
    const width = Math.max(1, area.right - area.left);
    const { start, end } = drag.window;
    const spread = points.length > 1 ? Math.max(10, Math.abs(points[0].x - points[1].x)) : drag.spread;
    const factor = points.length > 1 ? Math.max(10, drag.spread) / spread : 1;
    const anchor = start + ((drag.x - area.left) / width) * (end - start);
    const span = (end - start) * factor;
    const from = anchor - ((middle - area.left) / width) * span;
    axis.show({ start: from, end: from + span }, drag.gesture);
  });

  /** @param {PointerEvent} event */
  function lift(event) {
    if (!pointers.delete(event.pointerId)) return;
    const picked = axis.picked();
    hasDrawnBox = drag?.box === true && picked !== null;
    if (drag?.box && picked) {
      axis.pick(null);
      if (event.type === "pointerup" && picked.end > picked.start) axis.show(picked);
    }
    if (event.type === "pointerup" && event.button === 0 && drag && !drag.moved && pointers.size === 0)
      axis.click(event, at(xOf(event)));
    if (pointers.size > 0) begin();
    else drag = null;
  }
  target.addEventListener("pointerup", lift);
  target.addEventListener("pointercancel", lift);
  target.addEventListener("pointerleave", () => axis.hover(null));

  target.addEventListener("dblclick", (event) => {
    if (xOf(event) >= plot().left) axis.show(null);
  });
}
