/** Gestures on a time or frequency axis: wheel and pinch zoom, dragging moves or draws a zoom box, double-click shows all. */

/** @typedef {import("../state/types.js").Span} Span */
/**
 * @typedef {object} Axis  What the gestures move.
 * @property {() => Span} shown
 * @property {(window: Span | null, joins?: string) => void} show  Another part, null for all; what one gesture shows joins one step back.
 * @property {() => boolean} boxing  Dragging draws a box.
 * @property {() => Span | null} picked  What the box spans so far.
 * @property {(span: Span | null) => void} pick
 * @property {(at: number | null) => void} hover  The place under the pointer; null where it is beside the plotting area.
 * @property {(event: PointerEvent, at: number) => void} click
 */

/** Wheel events within this time are one gesture, in ms. */
const WHEEL_MS = 600;
/** A press that moves less than this many CSS pixels is a click. */
const CLICK_PX = 4;

/** @param {Span} window @param {number} factor @param {number} [at]  Place that stays; the middle without it. @returns {Span} */
export function zoomed({ start, end }, factor, at = (start + end) / 2) {
  return { start: at - (at - start) * factor, end: at + (end - at) * factor };
}

/** Moved by a part of itself. @param {Span} window @param {number} part @returns {Span} */
export function moved({ start, end }, part) {
  const by = (end - start) * part;
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
  let gestures = 0;
  let turned = -Infinity;
  /** The last press was a box. */
  let boxed = false;
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
    // Also a press that leaves the element before it is a drag ends here.
    target.setPointerCapture(event.pointerId);
    if (drag && pointers.size === 1)
      drag.box = (axis.boxing() || event.shiftKey || event.button === 2) && xOf(event) >= plot().left;
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
    boxed = drag?.box === true && picked !== null;
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
