/** The rows of a panel over time, with draggable script entries. */
import { element } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { registerCommands } from "../../shell/commands.js";
import { shown } from "../../state/time_window.js";
import { drawCursors } from "../../time/cursors.js";
import { createHandles } from "../../time/handles.js";
import { cleared, fit, font, GUTTER, MARGIN, watch } from "../../time/plot.js";
import { cycleAt, onTimeAxis, reveal } from "../../time/timeline.js";
import { xOf } from "./paint.js";
import { entryAfter, entryAt, entryBelow, heights, ROW_PX, rowsOf, TIME_PX } from "./strip_layout.js";
import { paintStrip } from "./strip_picture.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./script.js").Entry} Entry */
/** @typedef {import("./script.js").Placed} Placed */
/**
 * @typedef {object} Script  The script of the panel.
 * @property {() => Placed[]} entries  All entries for this panel, in the order of time.
 * @property {(placed: Placed, cycle: number, joins: boolean) => Placed | null} move  Returns the moved entry; null if it could not be moved.
 * @property {(placed: Placed) => void} remove
 */

/** Columns of pixels of a fast movement. */
const FAST = 10;

/** @param {HTMLElement} root @param {Script & import("./pane.js").Page & {selected: (placed: Placed | null) => void, print: (steps: number) => string, availableHeight: () => number, channel: () => number}} page  `print` prints a position. */
export function createStrip(root, page) {
  const { engine, dispatch, now } = page;
  const canvas = element("canvas", {
    tabindex: "0",
    role: "application",
    "aria-roledescription": "rows of the panel",
    "aria-describedby": "panel-keys time-keys",
  });
  const overlay = element("canvas", { class: "overlay", "aria-hidden": "true" });
  const strip = element("div", { class: "handles" });
  const stack = element("div", { class: "panel-rows" }, canvas, overlay);
  root.append(strip, stack);
  let plot = { left: GUTTER, right: GUTTER + 1 };
  const handles = createHandles(strip, () => plot, { dispatch, now });
  /** @type {import("./story.js").Story | null} */
  let story = null;
  /** @type {import("./paint.js").Curve | null} */
  let curve = null;
  /** @type {string[]} */
  let rows = [];
  /** Height of the position curve. */
  let curvePx = 0;
  /** @type {Placed | null} */
  let selected = null;
  /** The dragged entry, and its distance from the pointer in CSS pixels. @type {{placed: Placed, by: number, moved: boolean} | null} */
  let drag = null;

  onTimeAxis(stack, () => plot, { dispatch, now });
  watch(/** @type {Element} */ (root.closest(".panel-body")), () => {
    paint();
    void loadCurve(now());
  });

  const xIn = (/** @type {MouseEvent} */ event) => event.clientX - canvas.getBoundingClientRect().left;

  /** @param {Placed | null} placed */
  function choose(placed) {
    // Moves of another input are a new step of undo.
    if (placed?.entry.input !== selected?.entry.input || placed === null) dispatch({ type: "committed" });
    selected = placed;
    page.selected(placed);
    paint();
  }

  /** @param {MouseEvent} event */
  function entryUnder(event) {
    const ground = groundOf(now());
    if (!ground) return null;
    const row = Math.floor((event.clientY - canvas.getBoundingClientRect().top - curvePx) / ROW_PX);
    const distance = (/** @type {number} */ cycle) => Math.abs(xOf(ground, cycle) - xIn(event));
    return entryAt(page.entries(), rows, row, distance) ?? null;
  }

  canvas.addEventListener("pointerdown", (event) => {
    const placed = event.button === 0 ? entryUnder(event) : null;
    if (!placed) return;
    // The time axis must not be dragged, too.
    event.stopPropagation();
    event.preventDefault();
    canvas.focus();
    canvas.setPointerCapture(event.pointerId);
    const ground = groundOf(now());
    drag = { placed, by: ground ? xIn(event) - xOf(ground, placed.entry.cycle) : 0, moved: false };
    choose(placed);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!drag) {
      canvas.classList.toggle("over", entryUnder(event) !== null);
      return;
    }
    event.stopPropagation();
    const cycle = cycleAt(now(), plot, Math.min(plot.right, Math.max(plot.left, xIn(event) - drag.by)));
    const to = page.move(drag.placed, cycle, true);
    if (!to) return;
    drag = { ...drag, placed: to, moved: true };
    choose(to);
  });
  for (const end of ["pointerup", "pointercancel"])
    canvas.addEventListener(end, (event) => {
      if (!drag) return;
      event.stopPropagation();
      drag = null;
      dispatch({ type: "committed" });
    });

  /** Selects the next or the previous entry. @param {number} by */
  function step(by) {
    const to = entryAfter(page.entries(), selected, by);
    if (!to) return;
    choose(to);
    reveal(page, to.entry.cycle);
  }

  /** Selects an entry of the row below or above. @param {number} by */
  function stepRow(by) {
    const to = entryBelow(page.entries(), rows, selected, by);
    if (to) choose(to);
  }

  /** @param {number} columns */
  function nudge(columns) {
    if (!selected) return;
    const { start, end } = shown(now());
    const column = Math.max(1, Math.round((end - start) / Math.max(1, plot.right - plot.left)));
    const to = page.move(selected, selected.entry.cycle + columns * column, true);
    if (to) choose(to);
  }

  registerCommands(canvas, "Rows of the panel", [
    { keys: ["n"], text: "next input", run: () => step(1) },
    { keys: ["p"], text: "previous input", run: () => step(-1) },
    { keys: ["ArrowDown"], text: "input of the row below", run: () => stepRow(1) },
    { keys: ["ArrowUp"], text: "input of the row above", run: () => stepRow(-1) },
    { keys: [","], text: "move the selected input earlier", run: () => nudge(-1) },
    { keys: ["."], text: "move the selected input later", run: () => nudge(1) },
    { keys: ["<"], text: "move it much earlier", run: () => nudge(-FAST) },
    { keys: [">"], text: "move it much later", run: () => nudge(FAST) },
    {
      keys: ["Enter"],
      text: "move cursor A to the selected input",
      run: () => (selected ? dispatch({ type: "cursor", which: "a", cycle: selected.entry.cycle }) : false),
    },
    { keys: ["Delete"], text: "remove the selected input", run: () => (selected ? page.remove(selected) : false) },
  ]);

  /** @param {State} state @returns {import("./paint.js").Ground | null} */
  function groundOf(state) {
    const context = canvas.getContext("2d");
    if (!context || !state.result) return null;
    return { context, plot, ...shown(state), last: state.result.summary.end_cycle };
  }

  function paint() {
    const state = now();
    if (!story || stack.clientWidth < 60) return;
    plot = { left: GUTTER, right: Math.max(GUTTER + 1, stack.clientWidth - MARGIN) };
    rows = rowsOf(story.inputs.keys(), page.entries());
    const { curve: curveHeight, all: tall } = heights(page.availableHeight(), rows);
    curvePx = curveHeight;
    stack.style.height = `${tall + TIME_PX}px`;
    const { ratio } = fit(canvas);
    const ground = groundOf(state);
    if (!ground) return;
    const { context } = ground;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.textBaseline = "middle";
    context.font = `11px ${font()}`;
    const clock = state.result?.summary.clock_hz ?? 1;
    const { print } = page;
    const entries = page.entries();
    paintStrip(ground, { story, curve, rows, entries, selected, clock, curvePx, height: tall, print });
    fit(overlay);
    paintCursor(state);
  }

  /** Requests the position during the visible time. @param {State} state */
  async function loadCurve(state) {
    const { result } = state;
    if (!result || stack.clientWidth < 60) return;
    const { start, end } = shown(state);
    const clock = result.summary.clock_hz;
    const columns = Math.max(16, stack.clientWidth - GUTTER - MARGIN);
    const reply = await engine
      .latest("panel curve", "motion", page.channel(), start / clock, end / clock, columns)
      .catch(unlessDropped);
    if (!reply || now().result !== result) return;
    curve = { start, end, min: reply.actual_position_min, max: reply.actual_position_max };
    paint();
  }

  /** @param {State} state */
  function paintCursor(state) {
    const layer = cleared(overlay);
    if (!layer) return;
    drawCursors(layer.context, state, plot, layer.height - TIME_PX);
    handles.render(state);
  }

  return {
    paint,
    paintCursor,
    /** Selects an entry. @param {Placed | null} placed */
    choose,
    /** @param {import("./story.js").Story} next @param {string} about */
    show(next, about) {
      story = next;
      canvas.setAttribute("aria-label", about);
      paint();
      return loadCurve(now());
    },
    /** Redraws after a change of the visible time. */
    updateWindow() {
      paint();
      return loadCurve(now());
    },
  };
}
