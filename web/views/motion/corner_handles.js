/** Handles at the corners of the speed curve: dragging one changes the ramp and the top speed. For keys there are the number fields. */
import { element } from "../../dom.js";
import { createLiveEdit } from "../../form/live_edit.js";
import { movedCorner } from "../../state/corners.js";
import { isDrag } from "../../state/drag.js";
import { blockedBy } from "../../state/queries.js";
import { shown } from "../../state/time_window.js";
import { valueAt } from "../../time/gestures.js";
import { cycleAt, pixelOf, setCursor } from "../../time/timeline.js";
import { cornerPlaces, editOf, moved } from "./corner_places.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").Plot} Plot */
/** @typedef {import("./corner_places.js").Place} Place */
/** @typedef {{min: number, max: number}} Range */
/** @typedef {{x: number, y: number}} Point */
/** @typedef {{range: Range, window: import("../../state/types.js").Span}} Axes  Of the chart. */

/**
 * @param {HTMLCanvasElement} canvas  Of the speed.
 * @param {() => number} scale  Length of a step in the visible unit.
 * @param {import("../../state/types.js").Page} page
 * @param {() => void} onRelease  The axes of the chart follow again.
 */
export function createCornerHandles(canvas, scale, { dispatch, now }, onRelease) {
  const layer = element("div", { class: "corners", "aria-hidden": "true" });
  canvas.after(layer);
  const live = createLiveEdit(layer, { dispatch, now });
  /** @type {HTMLElement[]} */
  const nodes = [];
  /** @type {Place[]} */
  let places = [];
  /** @type {Plot | null} */
  let plot = null;
  /** @type {Range} */
  let range = { min: 0, max: 1 };
  /** The dragged handle, where it was pressed, and its center and the axes at that time: they stay even if the chart moves. @type {({node: HTMLElement, place: Place, press: PointerEvent, center: Point, area: Plot, isMoved: boolean} & Axes) | null} */
  let drag = null;

  /** @param {number} index */
  function createNode(index) {
    const node = element("div", { class: "corner", title: "Drag to change the ramp and the top speed" });
    node.addEventListener("pointerdown", (press) => {
      if (press.button !== 0 || !places[index] || !plot) return;
      // The time axis below must not move.
      press.stopPropagation();
      press.preventDefault();
      node.setPointerCapture(press.pointerId);
      const [place, center] = [places[index], centerOf(places[index])];
      drag = { node, place, press, center, area: plot, isMoved: false, range, window: shown(now()) };
    });
    node.addEventListener("pointermove", (event) => {
      if (!drag) return;
      event.stopPropagation();
      drag.isMoved ||= isDrag(drag.press, event);
      if (drag.isMoved) follow(event);
    });
    node.addEventListener("pointerup", (event) => {
      event.stopPropagation();
      // A click at a handle is a click at the chart.
      const x = event.clientX - canvas.getBoundingClientRect().left;
      if (drag && !drag.isMoved && plot) setCursor({ dispatch, now }, event, cycleAt(now(), plot, x));
    });
    node.addEventListener("pointercancel", live.cancel);
    node.addEventListener("lostpointercapture", () => {
      const hasMoved = drag?.isMoved;
      drag = null;
      live.end();
      if (hasMoved) onRelease();
    });
    layer.append(node);
    return node;
  }

  /** @param {PointerEvent} event */
  function follow({ clientX, clientY }) {
    if (!drag) return;
    const { place, center, press, area, window } = drag;
    const clock = now().result?.summary.clock_hz ?? 1;
    const at = valueAt(window, area, center.x + clientX - press.clientX) / clock;
    const height = (center.y + clientY - press.clientY - area.top) / (area.bottom - area.top);
    const top = ((drag.range.max - height * (drag.range.max - drag.range.min)) / scale()) * place.sign;
    const fields = movedCorner(place.move, place.rates, {
      ramp_s: place.isLast ? place.end_s - at : at - place.start_s,
      top,
    });
    if (!fields) return;
    live.edit(() => {
      const edit = editOf(place, fields, now());
      if (edit) dispatch({ type: "edit", joins: true, moved: [], ...edit });
    });
    put(drag.node, centerOf(moved(place, fields, top)));
  }

  /** Where the handle of a corner is. @param {Place} place @returns {Point} */
  function centerOf({ corner, start_s, end_s, sign, isLast }) {
    const { left, right, top, bottom } = /** @type {Plot} */ (plot);
    const state = now();
    const clock = state.result?.summary.clock_hz ?? 1;
    const { range: values, window } = drag ?? { range, window: shown(state) };
    const share = (values.max - sign * corner.top * scale()) / (values.max - values.min);
    const cycle = (isLast ? end_s - corner.ramp_s : start_s + corner.ramp_s) * clock;
    return { x: pixelOf({ ...state, window }, { left, right }, cycle), y: top + share * (bottom - top) };
  }

  /** @param {HTMLElement} node @param {Point} center */
  function put(node, { x, y }) {
    node.style.translate = `${x.toFixed(1)}px ${(canvas.offsetTop + y).toFixed(1)}px`;
    node.hidden = !plot || x < plot.left - 1 || x > plot.right + 1;
  }

  /** @param {State} state @param {Plot | null} [area] @param {Range} [values]  Of the vertical axis. */
  function render(state, area = plot, values = range) {
    [plot, range] = [area, values];
    // Until the form is valid again the handles stay at the visible curve.
    if (blockedBy(state) === null) places = cornerPlaces(state);
    while (nodes.length < places.length) nodes.push(createNode(nodes.length));
    // A text that is no number yet would not follow.
    const isVisible = plot && Object.keys(state.drafts).length === 0 && !state.hiddenAxes.includes(state.axis);
    for (const [index, node] of nodes.entries()) {
      const place = places[index];
      if (drag?.isMoved && drag.node === node) continue;
      if (isVisible && place?.axis === state.axis) put(node, centerOf(place));
      else node.hidden = true;
    }
  }
  return {
    render,
    /** The axes of the chart while a handle is dragged; otherwise null. @returns {Axes | null} */
    axes: () => (drag?.isMoved ? drag : null),
  };
}
