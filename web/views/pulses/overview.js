/** The overview strip above the pulses, with the visible part to drag. */
import { byId } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { registerCommands } from "../../shell/commands.js";
import { time } from "../../state/number.js";
import { endOf, shown } from "../../state/time_window.js";
import { color, fit, GUTTER, MARGIN, ratio, watch } from "../../time/plot.js";
import { pan, zoom } from "../../time/timeline.js";
import { paintOverview } from "./paint.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").PulseColumns} PulseColumns */

/** Maximum distance of the pointer from an edge of the visible part, in CSS pixels. */
const EDGE_PX = 6;

/** @param {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} page */
export function createOverview({ engine, dispatch, now }) {
  const page = { dispatch, now };
  const canvas = /** @type {HTMLCanvasElement} */ (byId("overview"));
  /** The strip without the visible part. */
  const strip = document.createElement("canvas");
  /** @type {PulseColumns | null} */
  let whole = null;
  /** What is dragged, and its distance from the pointer in cycles. @type {{target: "start" | "end" | "part", offset: number} | null} */
  let drag = null;

  watch(canvas, () => refresh(now()));
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    const { start, end } = shown(now());
    const target = targetAt(event);
    const cycle = cycleOf(event);
    if (target === "outside") move("part", cycle - (end - start) / 2);
    drag =
      target === "outside"
        ? { target: "part", offset: (end - start) / 2 }
        : { target, offset: cycle - (target === "end" ? end : start) };
  });
  canvas.addEventListener("pointermove", (event) => {
    if (drag && canvas.hasPointerCapture(event.pointerId)) move(drag.target, cycleOf(event) - drag.offset);
    else
      canvas.style.cursor = { start: "ew-resize", end: "ew-resize", part: "grab", outside: "pointer" }[targetAt(event)];
  });
  for (const kind of ["pointerup", "pointercancel"])
    canvas.addEventListener(kind, () => {
      drag = null;
    });
  canvas.addEventListener("dblclick", () => dispatch({ type: "window", window: null }));
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      zoom(page, Math.exp(event.deltaY * 0.002));
    },
    { passive: false },
  );
  /** @param {"start" | "end"} target @param {number} sign */
  const nudge = (target, sign) => () => {
    const part = shown(now());
    move(target, part[target] + (sign * (part.end - part.start)) / 10);
  };
  registerCommands(canvas, "Overview (strip above the pulses)", [
    { keys: ["ArrowLeft"], text: "move the visible part earlier", run: () => pan(page, -0.1) },
    { keys: ["ArrowRight"], text: "move the visible part later", run: () => pan(page, 0.1) },
    { keys: ["Shift+ArrowLeft"], text: "move its end earlier", run: nudge("end", -1) },
    { keys: ["Shift+ArrowRight"], text: "move its end later", run: nudge("end", 1) },
    { keys: ["Alt+ArrowLeft"], text: "move its start earlier", run: nudge("start", -1) },
    { keys: ["Alt+ArrowRight"], text: "move its start later", run: nudge("start", 1) },
    { keys: ["+", "="], text: "zoom in", run: () => zoom(page, 0.5) },
    { keys: ["-", "−"], text: "zoom out", run: () => zoom(page, 2) },
    { keys: ["Home"], text: "show the whole run", run: () => dispatch({ type: "window", window: null }) },
  ]);

  /** Cycle at the pointer, which may be outside of the run. @param {MouseEvent} event */
  function cycleOf(event) {
    const box = canvas.getBoundingClientRect();
    return ((event.clientX - box.left - GUTTER) / Math.max(1, box.width - GUTTER - MARGIN)) * endOf(now());
  }

  /** @param {MouseEvent} event @returns {"start" | "end" | "part" | "outside"} */
  function targetAt(event) {
    const { start, end } = shown(now());
    const reach = (EDGE_PX / Math.max(1, canvas.clientWidth - GUTTER - MARGIN)) * endOf(now());
    const cycle = cycleOf(event);
    // The edges of a narrow part reach less far inside, so that the part can still be dragged.
    const insideReach = Math.min(reach, (end - start) / 4);
    if (cycle >= start - reach && cycle < start + insideReach) return "start";
    if (cycle > end - insideReach && cycle <= end + reach) return "end";
    return cycle >= start && cycle <= end ? "part" : "outside";
  }

  /** @param {"start" | "end" | "part"} target @param {number} to  Cycle. */
  function move(target, to) {
    const { start, end } = shown(now());
    const last = endOf(now());
    const inside = Math.min(last, Math.max(0, to));
    const window =
      target === "part"
        ? { start: to, end: to + end - start }
        : target === "start"
          ? { start: Math.min(inside, end - 1), end }
          : { start, end: Math.max(inside, start + 1) };
    dispatch({ type: "window", joins: "overview", window });
  }

  /** @param {State} state */
  async function refresh(state) {
    if (!state.result) return;
    if (canvas.clientWidth < 60) {
      whole = null;
      return;
    }
    const wanted = Math.max(16, Math.round((canvas.clientWidth - GUTTER - MARGIN) * ratio()));
    const reply = await engine.latest("overview", "pulses", 0, endOf(state), wanted, 0).catch(unlessDropped);
    const height = Math.round(canvas.clientHeight * ratio());
    if (!reply) return;
    // If it was hidden meanwhile, it is requested again when it is visible.
    whole = height > 0 ? reply : null;
    if (!whole) return;
    const context = strip.getContext("2d");
    [strip.width, strip.height] = [wanted, height];
    if (context) paintOverview(context, reply, { left: 0, height });
    paint(now());
  }

  /** @param {State} state */
  function paint(state) {
    const { start, end } = shown(state);
    const clock = state.result?.summary.clock_hz ?? 1;
    canvas.setAttribute(
      "aria-label",
      `The whole run, ${time(endOf(state) / clock)}; visible: ${time(start / clock)} to ${time(end / clock)}`,
    );
    const { width, height, ratio: scale } = fit(canvas);
    const context = canvas.getContext("2d");
    if (!context || !whole) return;
    const left = Math.round(GUTTER * scale);
    const right = (width - MARGIN) * scale;
    context.drawImage(strip, left, 0);
    context.fillStyle = color("--quiet");
    context.font = `${11 * scale}px ${getComputedStyle(document.body).fontFamily}`;
    context.textAlign = "right";
    context.textBaseline = "middle";
    context.fillText("whole run", left - 8 * scale, (height / 2) * scale);
    const x = (/** @type {number} */ cycle) => left + (cycle / endOf(state)) * (right - left);
    const [visibleLeft, visibleRight] = [x(start), Math.max(x(end), x(start) + 3 * scale)];
    context.fillStyle = color("--ground");
    context.globalAlpha = 0.6;
    context.fillRect(left, 0, visibleLeft - left, height * scale);
    context.fillRect(visibleRight, 0, right - visibleRight, height * scale);
    context.globalAlpha = 1;
    context.strokeStyle = color("--accent");
    context.lineWidth = 2 * scale;
    context.strokeRect(visibleLeft, scale, visibleRight - visibleLeft, height * scale - 2 * scale);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (before?.result !== state.result) return refresh(state);
    if (before?.window !== state.window) paint(state);
    return undefined;
  }
  return { render };
}
