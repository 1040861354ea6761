/** Handles at the corners of the speed curve: dragging one changes the ramp and the top speed. The number fields do the same by keys. */
import { element } from "../../dom.js";
import { createLiveEdit } from "../../form/live_edit.js";
import { convert } from "../../form/values.js";
import { cornerOf, movedCorner } from "../../state/corners.js";
import { get } from "../../state/paths.js";
import { blockedBy, derivedAxis } from "../../state/queries.js";
import { shown } from "../../state/time_window.js";
import { valueAt } from "../../time/gestures.js";
import { pixelOf } from "../../time/timeline.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").Plot} Plot */
/** @typedef {{min: number, max: number}} Range */
/** @typedef {{path: string, move: any, rates: import("../../state/corners.js").Rates, corner: import("../../state/corners.js").Corner,
 *   start_s: number, end_s: number, sign: number, isLast: boolean}} Place  `isLast`: at the end of the plateau. */

/** Axes with more moves have no handles. */
const MAX_MOVES = 6;

/** A value with the digits that a drag can mean. @param {number} value */
const rounded = (value) => Number(value.toPrecision(3));

/**
 * @param {HTMLCanvasElement} canvas  Of the speed.
 * @param {() => number} scale  Length of a step in the visible unit.
 * @param {import("../../state/types.js").Page} page
 */
export function createCornerHandles(canvas, scale, { dispatch, now }) {
  const layer = element("div", { class: "corners", "aria-hidden": "true" });
  canvas.after(layer);
  const live = createLiveEdit(dispatch);
  /** @type {HTMLElement[]} */
  const nodes = [];
  /** @type {Place[]} */
  let places = [];
  /** @type {Plot | null} */
  let plot = null;
  /** @type {Range} */
  let range = { min: 0, max: 1 };
  /** The dragged handle, and the range of the chart at its start, which stays. @type {{index: number, range: Range, place: Place} | null} */
  let drag = null;

  /** @param {number} index */
  function createNode(index) {
    const node = element("div", { class: "corner", title: "Drag to change the ramp and the top speed" });
    node.addEventListener("pointerdown", (event) => {
      if (event.button !== 0 || !places[index]) return;
      // The time axis below must not move.
      event.stopPropagation();
      event.preventDefault();
      node.setPointerCapture(event.pointerId);
      drag = { index, range, place: places[index] };
    });
    node.addEventListener("pointermove", (event) => {
      if (!drag) return;
      event.stopPropagation();
      follow(event);
    });
    for (const end of ["pointerup", "pointercancel"])
      node.addEventListener(end, (event) => {
        event.stopPropagation();
        drag = null;
        live.end();
        render(now(), plot, range);
      });
    layer.append(node);
    return node;
  }

  /** @param {PointerEvent} event */
  function follow({ clientX, clientY }) {
    if (!drag || !plot) return;
    const box = canvas.getBoundingClientRect();
    const state = now();
    const clock = state.result?.summary.clock_hz ?? 1;
    const { place, range: fixed } = drag;
    const at = valueAt(shown(state), plot, clientX - box.left) / clock;
    const height = (clientY - box.top - plot.top) / (plot.bottom - plot.top);
    const top = ((fixed.max - height * (fixed.max - fixed.min)) / scale()) * place.sign;
    const ramp_s = place.isLast ? place.end_s - at : at - place.start_s;
    const fields = movedCorner(place.move, place.rates, { ramp_s, top });
    if (!fields) return;
    const value = changed(place, fields, state);
    live.edit(() => dispatch({ type: "edit", path: place.path, value, joins: true }));
    put(nodes[drag.index], clientX - box.left, clientY - box.top);
  }

  /** @param {HTMLElement} node @param {number} x @param {number} y */
  function put(node, x, y) {
    node.style.left = `${x.toFixed(1)}px`;
    node.style.top = `${(canvas.offsetTop + y).toFixed(1)}px`;
  }

  /** @param {State} state @param {Plot | null} area @param {Range} values  Of the vertical axis. */
  function render(state, area, values) {
    [plot, range] = [area, values];
    // Until the form is valid again the handles stay at the visible curve.
    if (blockedBy(state) === null) places = placesOf(state);
    const clock = state.result?.summary.clock_hz ?? 1;
    while (nodes.length < places.length) nodes.push(createNode(nodes.length));
    for (const [index, node] of nodes.entries()) {
      const place = places[index];
      if (drag?.index === index) continue;
      node.hidden = true;
      if (!place || !plot) continue;
      const { corner, start_s, end_s, sign, isLast } = place;
      const x = pixelOf(state, plot, (isLast ? end_s - corner.ramp_s : start_s + corner.ramp_s) * clock);
      const share = (range.max - sign * corner.top * scale()) / (range.max - range.min);
      node.hidden = x < plot.left - 1 || x > plot.right + 1;
      put(node, x, plot.top + share * (plot.bottom - plot.top));
    }
  }
  return {
    render,
    /** The range of the chart while a handle is dragged; otherwise null. */
    range: () => drag?.range ?? null,
  };
}

/** The corners of the visible axis. @param {State} state @returns {Place[]} */
function placesOf(state) {
  const index = state.result?.controller ?? 0;
  const base = `${index === 0 ? "source.motion" : `controllers[${index - 1}]`}.axes[${state.axis}]`;
  const moves = get(state.scenario, `${base}.moves`);
  const derived = derivedAxis(state, base);
  if (!state.scenario.source?.motion || !moves || !derived || moves.length > MAX_MOVES) return [];
  return moves.flatMap((/** @type {any} */ move, /** @type {number} */ at) => {
    const { start_s, duration_s, steps } = derived.moves[at] ?? {};
    const path = `${base}.moves[${at}]`;
    const [kind] = Object.keys(move);
    const inSteps = (/** @type {any} */ quantity) => quantity && Number(convert(quantity, "steps", path, state).steps);
    const rates = {
      steps: Math.abs(steps ?? 0),
      start: inSteps(move[kind].start_speed),
      max: inSteps(move[kind].max_speed),
      acceleration: inSteps(move[kind].max_acceleration),
      peak: moves.length === 1 ? derived.peak_speed_steps_s : undefined,
    };
    const { start_speed, end_speed, deceleration, max_deceleration } = move[kind];
    // The corners of a move between two speeds, or of one that is cut, are elsewhere.
    const hasStart = kind === "trapezoid" ? start_speed === null : start_speed;
    const isBetween = end_speed || deceleration || max_deceleration || hasStart;
    const corner = isBetween || moves[at + 1]?.retarget ? null : cornerOf(move, rates);
    if (!corner) return [];
    const place = { path, move, rates, corner, start_s, end_s: start_s + duration_s, sign: Math.sign(steps) };
    // Without a plateau the corners coincide.
    const isSingle = duration_s - 2 * corner.ramp_s < duration_s * 0.02;
    return (isSingle ? [false] : [false, true]).map((isLast) => ({ ...place, isLast }));
  });
}

/** The move with new fields, in the units of the old ones. @param {Place} place @param {any} fields @param {State} state */
function changed({ move, path }, fields, state) {
  const [kind] = Object.keys(move);
  if ("duration_s" in fields) {
    const duration_s = rounded(fields.duration_s);
    return { [kind]: { ...move[kind], duration_s, ramp_s: Math.min(rounded(fields.ramp_s), duration_s / 2) } };
  }
  const inUnit = (/** @type {any} */ before, /** @type {number} */ steps) => {
    const [unit] = Object.keys(before);
    return { [unit]: rounded(convert({ steps }, unit, path, state)[unit]) };
  };
  const { max_speed, max_acceleration } = move[kind];
  return {
    [kind]: {
      ...move[kind],
      max_speed: inUnit(max_speed, fields.max),
      max_acceleration: inUnit(max_acceleration, fields.acceleration),
    },
  };
}
