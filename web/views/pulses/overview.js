/** The strip over the pulses: how busy the whole run is, which part of it is shown; pressing in it goes there. */
import { byId } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { paintOverview } from "./paint.js";
import { GUTTER, MARGIN, color, fit, ratio, watch } from "../../time/plot.js";
import { endOf, shown } from "../../state/state.js";
import { zoom } from "../../time/timeline.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").PulseColumns} PulseColumns */

/** @param {{engine: import("../../engine/engine.js").Engine} & import("../../time/timeline.js").Page} page */
export function createOverview({ engine, dispatch, now }) {
  const canvas = /** @type {HTMLCanvasElement} */ (byId("overview"));
  /** @type {PulseColumns | null} */
  let whole = null;

  watch(canvas, () => refresh(now()));
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    go(event);
  });
  canvas.addEventListener("pointermove", (event) => { if (canvas.hasPointerCapture(event.pointerId)) go(event); });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom({ dispatch, now }, Math.exp(event.deltaY * 0.002));
  }, { passive: false });

  /** Brings the time under the pointer into the middle. @param {PointerEvent} event */
  function go(event) {
    const box = canvas.getBoundingClientRect();
    const part = (event.clientX - box.left - GUTTER) / Math.max(1, box.width - GUTTER - MARGIN);
    const { start, end } = shown(now());
    const half = (end - start) / 2;
    const middle = part * endOf(now());
    dispatch({ type: "window", joins: "overview", window: { start: middle - half, end: middle + half } });
  }

  /** @param {State} state */
  async function refresh(state) {
    if (!state.result || canvas.clientWidth < 60) return;
    const wanted = Math.max(16, Math.round((canvas.clientWidth - GUTTER - MARGIN) * ratio()));
    const answer = await engine.latest("overview", "pulses", 0, endOf(state), wanted).catch(unlessDropped);
    if (!answer) return;
    whole = answer;
    paint(now());
  }

  /** @param {State} state */
  function paint(state) {
    const { width, height, ratio: scale } = fit(canvas);
    const context = canvas.getContext("2d");
    if (!context || !whole) return;
    const left = Math.round(GUTTER * scale);
    const right = (width - MARGIN) * scale;
    paintOverview(context, whole, { left, height: height * scale });
    context.fillStyle = color("--quiet");
    context.font = `${11 * scale}px ${getComputedStyle(document.body).fontFamily}`;
    context.textAlign = "right";
    context.textBaseline = "middle";
    context.fillText("whole run", left - 8 * scale, (height / 2) * scale);
    const { start, end } = shown(state);
    const x = (/** @type {number} */ cycle) => left + (cycle / endOf(state)) * (right - left);
    const [a, b] = [x(start), Math.max(x(end), x(start) + 3 * scale)];
    context.fillStyle = color("--ground");
    context.globalAlpha = 0.6;
    context.fillRect(left, 0, a - left, height * scale);
    context.fillRect(b, 0, right - b, height * scale);
    context.globalAlpha = 1;
    context.strokeStyle = color("--accent");
    context.lineWidth = 2 * scale;
    context.strokeRect(a, scale, b - a, height * scale - 2 * scale);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (before?.window === state.window && before?.result === state.result) return undefined;
    paint(state);
    return before?.result !== state.result ? refresh(state) : undefined;
  }
  return { render };
}
