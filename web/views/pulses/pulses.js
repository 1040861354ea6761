/** The pulses view: a logic analyzer of all signals, with decoded line and ticks. */
import { byId, setOptions, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { registerCommands } from "../../shell/commands.js";
import { time } from "../../state/number.js";
import { selected } from "../../state/queries.js";
import { rowPx } from "../../state/row_choices.js";
import { shown } from "../../state/time_window.js";
import { drawCursors, hasOverlayChanged } from "../../time/cursors.js";
import { createHandles } from "../../time/handles.js";
import { fit, GUTTER, MARGIN, ratio, watch } from "../../time/plot.js";
import { createRange } from "../../time/range.js";
import { reveal } from "../../time/timeline.js";
import { jumpText, rowAfter, searchStart } from "./edge_search.js";
import { createMarkers } from "./markers.js";
import { createOverview } from "./overview.js";
import { drawHighlights, paintRows } from "./picture.js";
import { createPointer } from "./pointer.js";
import { createReading } from "./reading.js";
import { createRowPanel } from "./row_panel.js";
import { allFolded, channelOf, idleSignals, isFolded, nameOf, rowsOf, shows, signalsOf } from "./rows.js";
import { createSpans } from "./spans.js";

/** @typedef {import("../../state/types.js").State} State */

/** @param {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} page */
export function createPulses({ engine, dispatch, now }) {
  const page = { dispatch, now };
  const canvas = /** @type {HTMLCanvasElement} */ (byId("pulses"));
  const overlay = /** @type {HTMLCanvasElement} */ (byId("pulses-cursor"));
  const stack = byId("pulses-stack");
  const rowSelect = /** @type {HTMLSelectElement} */ (byId("edge-row"));
  const kindSelect = /** @type {HTMLSelectElement} */ (byId("edge-kind"));
  const foldAll = byId("fold-channels");
  const allSignals = /** @type {HTMLInputElement} */ (byId("all-signals"));
  const range = createRange(page);
  const overview = createOverview({ engine, ...page });
  const reading = createReading({ engine, now });
  const spans = createSpans({ engine });
  const markers = createMarkers({ ...page, speak: reading.speak });
  /** The table of edges, loaded when it is first unfolded. @type {ReturnType<typeof import("./edges.js").createEdges> | null} */
  let edges = null;
  const rowPanel = createRowPanel({ ...page, canvas, speak: reading.speak });
  const handles = createHandles(byId("pulses-handles"), () => plot, {
    ...page,
    snap: (cycle) => pointer.snapped(now().row, cycle),
  });
  const px = () => rowPx(now().panes.pulses);
  /** @type {import("./picture.js").PulseReply | null} */
  let reply = null;
  let frame = 0;
  let plot = { left: GUTTER, right: GUTTER + 1 };

  const table = /** @type {HTMLDetailsElement} */ (byId("edge-panel"));
  table.addEventListener("toggle", async () => {
    if (!table.open) return;
    // Its buttons have no effect before it is loaded.
    const content = /** @type {HTMLElement} */ (table.lastElementChild);
    content.inert = edges === null;
    try {
      const { createEdges } = await import("./edges.js");
      edges ??= createEdges({ engine, now });
      content.inert = false;
      edges.showFromWindow();
    } catch {
      setText(byId("edges-count"), "The table could not be loaded. Check the network and unfold it again.");
    }
  });

  const pointer = createPointer(canvas, { engine, ...page, plot: () => plot, rowPx: px, reading, spans, fold });
  watch(stack, () => refresh(now()));
  byId("edge-next").addEventListener("click", () => jump(true));
  byId("edge-previous").addEventListener("click", () => jump(false));
  rowSelect.addEventListener("change", () => dispatch({ type: "row", row: Number(rowSelect.value) }));
  foldAll.addEventListener("click", () => dispatch({ type: "fold-all", folded: !allFolded(now()) }));
  allSignals.addEventListener("change", () => dispatch({ type: "all-signals", on: allSignals.checked }));
  registerCommands(canvas, "Pulses", [
    { keys: ["n"], text: "next edge of the selected row", run: () => void jump(true) },
    { keys: ["p"], text: "previous edge of the selected row", run: () => void jump(false) },
    { keys: ["ArrowUp"], text: "select the row above", run: () => step(-1) },
    { keys: ["ArrowDown"], text: "select the row below", run: () => step(1) },
    { keys: ["Enter"], text: "fold or unfold the channel of the selected row", run: () => fold(channelOf(now().row)) },
  ]);
  /** @param {number} by */
  function step(by) {
    const to = rowAfter(rowsOf(now()), now().row, by);
    if (to) dispatch({ type: "row", row: to.bit });
  }

  /** Folds a channel's two rows into one, or unfolds them. @param {number | null} channel */
  function fold(channel) {
    if (channel === null) return;
    const folded = !isFolded(now(), channel);
    dispatch({ type: "fold", channel, folded });
    reading.speak(
      `${channel < 16 ? `Channel ${channel}` : `Decoded bytes of ${nameOf(now(), channel)}`} ${folded ? "folded" : "unfolded"}.`,
    );
  }

  /** Sets cursor A to the next edge of the selected row and brings it into view. @param {boolean} forward */
  async function jump(forward) {
    const state = now();
    if (!state.result) return;
    const { value: kind } = kindSelect;
    const from = searchStart(state, forward);
    const edge = (await engine.request("next_edge", state.row, from, forward, kind).catch(unlessDropped)) ?? null;
    if (edge !== null) {
      dispatch({ type: "cursor", which: "a", cycle: edge });
      reveal(page, edge);
    }
    reading.speak(jumpText(nameOf(state, state.row), kind, forward, edge, state.result.summary.clock_hz));
  }

  /** Requests the columns and spans of the visible time. Until they arrive, the last picture is drawn shifted and stretched. @param {State} state */
  async function refresh(state) {
    plot = { left: GUTTER, right: Math.max(GUTTER + 1, stack.clientWidth - MARGIN) };
    if (!state.result || stack.clientWidth < 60) return;
    const { start, end } = shown(state);
    const wanted = Math.max(16, Math.round((plot.right - plot.left) * ratio()));
    const margin = Math.round(wanted / 4);
    if (reply) paintSoon();
    const request = engine
      .latest("pulses", "pulses", start, end, wanted, margin)
      .catch(unlessDropped)
      .then((columns) => {
        if (!columns) return false;
        reply = { columns, start, end, count: wanted, margin };
        paintSoon();
        return true;
      });
    const all = await Promise.all([request, spans.fetch(state, plot.right - plot.left, paintSoon)]);
    // Painted before the promise resolves, so that callers can wait for the drawing.
    if (all.every(Boolean)) paint(now());
  }

  /** Paints once in the next frame. */
  function paintSoon() {
    frame ||= requestAnimationFrame(() => paint(now()));
  }

  /** @param {State} state */
  function paint(state) {
    cancelAnimationFrame(frame);
    frame = 0;
    if (!reply || !state.result) return;
    paintRows(canvas, state, plot, reply, spans);
    describe(state);
    paintCursor(state);
  }

  /** @param {State} state */
  function paintCursor(state) {
    const { height, ratio: scale } = fit(overlay);
    const context = overlay.getContext("2d");
    if (!context || !state.result) return;
    context.scale(scale, scale);
    drawCursors(context, state, plot, height);
    drawHighlights(context, state, plot, spans);
    handles.render(state);
    reading.render(state);
  }

  /** @param {State} state */
  function describe(state) {
    const { start, end } = shown(state);
    const clock = state.result?.summary.clock_hz ?? 1;
    canvas.setAttribute(
      "aria-label",
      `Logic analyzer, ${rowsOf(state).length} rows, ${time(start / clock)} to ${time(end / clock)}, row ${nameOf(state, state.row)}`,
    );
  }

  /** Updates the controls of the header and the height of the rows. @param {State} state */
  function layout(state) {
    const channels = selected(state)?.channels ?? 1;
    setOptions(
      rowSelect,
      signalsOf(state).map(({ name, bit }) => [String(bit), name]),
      String(state.row),
    );
    const folded = allFolded(state);
    foldAll.hidden = channels === 1;
    setText(foldAll, folded ? "Unfold channels" : "Fold channels");
    allSignals.checked = state.allSignals;
    /** @type {HTMLElement} */ (allSignals.parentElement).hidden = idleSignals(state).length === 0;
    const height = rowsOf(state).length * px() + 6;
    stack.style.height = `${height}px`;
    // On a wide screen this view is as high as its rows, and the curves get the remaining height.
    byId("views").style.setProperty("--rows-px", `${height}px`);
  }

  /** Scrolls the selected row into view. @param {State} state */
  function follow(state) {
    const scroller = /** @type {HTMLElement} */ (stack.parentElement);
    const rowHeight = px();
    const top = rowsOf(state).findIndex((row) => shows(row, state.row)) * rowHeight;
    if (top < scroller.scrollTop) scroller.scrollTop = top;
    else if (top + rowHeight + 6 > scroller.scrollTop + scroller.clientHeight)
      scroller.scrollTop = top + rowHeight + 6 - scroller.clientHeight;
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    range.render(state, before);
    markers.render(state, before);
    edges?.render(state, before);
    const strip = overview.render(state, before);
    const isLayoutChanged =
      before?.result !== state.result ||
      before?.row !== state.row ||
      before?.folds !== state.folds ||
      before?.allSignals !== state.allSignals ||
      before?.panes.pulses !== state.panes.pulses;
    if (isLayoutChanged) layout(state);
    rowPanel.render(state, before);
    if (before && before.row !== state.row) follow(state);
    const isSelectionMoved = before && (before.cursors.a !== state.cursors.a || before.row !== state.row);
    if (isSelectionMoved && document.activeElement === canvas && before.result === state.result) reading.speakCursor();
    if (before?.window !== state.window || before?.result !== state.result) return Promise.all([refresh(state), strip]);
    if (isLayoutChanged || before?.packet !== state.packet) paint(state);
    else if (hasOverlayChanged(before, state)) paintCursor(state);
    return undefined;
  }
  return { render, speak: reading.speak };
}
