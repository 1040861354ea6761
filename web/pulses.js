/** The pulses view: a logic analyser over all signals of the bus, with the ticks and packets decoded between them. */
import { byId, options, say } from "./dom.js";
import { unlessDropped } from "./engine.js";
import { drawCursors, time } from "./motion.js";
import { count, parseNumber, si } from "./number.js";
import { ROW_PX, paintOverview, paintSignal, paintSpans, rowsOf } from "./paint.js";
import { GUTTER, MARGIN, color, fit, ratio, watch } from "./plot.js";
import { endOf, shown } from "./state.js";
import { cycleAt, gestures, pixelOf, reveal, zoom } from "./timeline.js";

/** @typedef {import("./types.js").State} State */
/** @typedef {import("./types.js").PulseColumns} PulseColumns */
/** @typedef {import("./types.js").PacketRow} PacketRow */

/** Packets that are drawn one by one; more than that are too narrow to be told apart. */
const MOST_SPANS = 400;

/** A cursor that is set this near to an edge is set on it, in CSS pixels. */
const SNAP_PX = 6;

/** @param {{engine: import("./engine.js").Engine} & import("./timeline.js").Page} page */
export function createPulses({ engine, dispatch, now }) {
  const page = { dispatch, now };
  const canvas = /** @type {HTMLCanvasElement} */ (byId("pulses"));
  const overlay = /** @type {HTMLCanvasElement} */ (byId("pulses-cursor"));
  const overview = /** @type {HTMLCanvasElement} */ (byId("overview"));
  const stack = byId("pulses-stack");
  const rowSelect = /** @type {HTMLSelectElement} */ (byId("edge-row"));
  const kindSelect = /** @type {HTMLSelectElement} */ (byId("edge-kind"));
  /** @type {{columns: PulseColumns, packets: {rows: PacketRow[], more: boolean}} | null} */
  let shownColumns = null;
  /** @type {PulseColumns | null} */
  let whole = null;
  let plot = { left: GUTTER, right: GUTTER + 1 };
  /** @type {{bit: number, begin?: number, end?: number, next?: number, cycle: number} | null} */
  let pulse = null;

  const rows = () => rowsOf(now().result?.summary.channels ?? 1);
  const signals = () => rows().flatMap((row) => (row.kind === "signal" ? [row] : []));

  gestures(canvas, () => plot, { ...page, click: pick });
  watch(stack, () => refresh(now()));
  watch(overview, () => refreshOverview(now()));
  byId("zoom-in").addEventListener("click", () => zoom(page, 0.5, now().cursors.a ?? undefined));
  byId("zoom-out").addEventListener("click", () => zoom(page, 2, now().cursors.a ?? undefined));
  byId("zoom-fit").addEventListener("click", () => dispatch({ type: "window", window: null }));
  byId("edge-next").addEventListener("click", () => jump(true));
  byId("edge-previous").addEventListener("click", () => jump(false));
  rowSelect.addEventListener("change", () => dispatch({ type: "row", row: Number(rowSelect.value) }));
  for (const id of ["window-start", "window-end"]) byId(id).addEventListener("change", typedWindow);
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const name = event.key.toLowerCase();
    if (name === "n" || name === "p") jump(name === "n");
    else if (event.key === "ArrowUp" || event.key === "ArrowDown") step(event.key === "ArrowUp" ? -1 : 1);
    else return;
    event.preventDefault();
  });
  canvas.addEventListener("pointermove", (event) => hover(event));
  canvas.addEventListener("pointerleave", () => { pulse = null; foot(now()); });
  dragOverview();

  /** @param {number} by */
  function step(by) {
    const all = signals();
    const at = all.findIndex(({ bit }) => bit === now().row);
    dispatch({ type: "row", row: all[Math.min(all.length - 1, Math.max(0, at + by))].bit });
  }

  /** The row under a pointer. @param {MouseEvent} event */
  function rowAt(event) {
    return rows()[Math.floor((event.clientY - canvas.getBoundingClientRect().top) / ROW_PX)];
  }

  /** The edge of a row within a few pixels of a cycle, else the cycle. @param {number} bit @param {number} cycle */
  async function snapped(bit, cycle) {
    const { start, end } = shown(now());
    const reach = (SNAP_PX * (end - start)) / (plot.right - plot.left);
    const edges = await Promise.all([true, false].map((forward) =>
      engine.ask("next_edge", bit, forward ? cycle - 1 : cycle + 1, forward, "any").catch(unlessDropped)));
    const near = edges.filter((edge) => typeof edge === "number" && Math.abs(edge - cycle) <= reach);
    return near.sort((a, b) => Math.abs(a - cycle) - Math.abs(b - cycle))[0] ?? cycle;
  }

  /** A click on a row chooses it and sets a cursor, on an edge if one is near; on a packet, chooses it. @param {PointerEvent} event @param {number} at */
  function pick(event, at) {
    const row = rowAt(event);
    if (!row) return false;
    const x = event.clientX - canvas.getBoundingClientRect().left;
    if (row.kind === "signal") dispatch({ type: "row", row: row.bit });
    if (x < plot.left) return true;
    if (row.kind === "signal") return snapped(row.bit, at);
    const cycle = cycleAt(now(), plot, x);
    const found = shownColumns?.packets.rows.find((packet) => row.kind === "packets"
      ? packet.start_cycle <= cycle && cycle < packet.end_cycle
      : packet.tick_start_cycle !== null && packet.tick_start_cycle <= cycle && cycle < (packet.tick_end_cycle ?? 0));
    if (found) dispatch({ type: "packet", packet: found.index });
    return Boolean(found);
  }

  /** Sets cursor A to the next edge of the chosen row and brings it into view. @param {boolean} forward */
  async function jump(forward) {
    const state = now();
    if (!state.result) return;
    const { start, end } = shown(state);
    const { a } = state.cursors;
    const from = a !== null && a >= start && a <= end ? a : forward ? start : end;
    const edge = await engine.ask("next_edge", state.row, from, forward, kindSelect.value).catch(unlessDropped);
    const name = signals().find(({ bit }) => bit === state.row)?.name ?? "";
    if (edge === undefined || edge === null) return say(byId("pulses-sentence"), `${name}: no ${forward ? "later" : "earlier"} edge.`);
    dispatch({ type: "cursor", which: "a", cycle: edge });
    reveal(page, edge);
    say(byId("pulses-sentence"), `${name}: edge at ${time(edge / state.result.summary.clock_hz)}, cycle ${edge}.`);
  }

  function typedWindow() {
    const state = now();
    const clockHz = state.result?.summary.clock_hz ?? 1;
    const [start, end] = ["window-start", "window-end"].map((id) => {
      const input = /** @type {HTMLInputElement} */ (byId(id));
      const read = parseNumber(input.value, "s");
      input.toggleAttribute("aria-invalid", "message" in read);
      return read;
    });
    const wrong = "message" in start ? start.message : "message" in end ? end.message : "";
    if (wrong || "message" in start || "message" in end) return say(byId("window-error"), wrong);
    if (end.value <= start.value) return say(byId("window-error"), "“to” lies before “from”.");
    say(byId("window-error"), "");
    dispatch({ type: "window", window: { start: start.value * clockHz, end: end.value * clockHz } });
    fields(now());
  }

  /** @param {State} state */
  async function refresh(state) {
    plot = { left: GUTTER, right: Math.max(GUTTER + 1, stack.clientWidth - MARGIN) };
    if (!state.result || stack.clientWidth < 60) return;
    const { start, end } = shown(state);
    const wanted = Math.max(16, Math.round((plot.right - plot.left) * ratio()));
    const [columns, packets] = await Promise.all([
      engine.latest("pulses", "pulses", start, end, wanted),
      engine.latest("spans", "packets_in", start, end, MOST_SPANS),
    ]).catch((error) => [unlessDropped(error), null]);
    if (!columns || !packets) return;
    shownColumns = { columns, packets };
    paint(now());
  }

  /** @param {State} state */
  function paint(state) {
    if (!shownColumns || !state.result) return;
    const { columns, packets } = shownColumns;
    const { width, ratio: scale } = fit(canvas);
    const context = canvas.getContext("2d");
    if (!context) return;
    const left = Math.round(plot.left * scale);
    const right = Math.round(plot.right * scale);
    context.font = `${11 * scale}px ${getComputedStyle(document.body).fontFamily}`;
    for (const [index, row] of rows().entries()) {
      const top = Math.round((index * ROW_PX + 4) * scale);
      const height = Math.round((ROW_PX - 6) * scale);
      const chosen = row.kind === "signal" && row.bit === state.row;
      if (chosen) {
        context.fillStyle = color("--chosen");
        context.fillRect(0, top - 3 * scale, width * scale, ROW_PX * scale);
      }
      context.fillStyle = color(chosen ? "--ink" : "--quiet");
      context.textAlign = "right";
      context.textBaseline = "middle";
      context.font = `${chosen ? "bold " : ""}${11 * scale}px ${getComputedStyle(document.body).fontFamily}`;
      context.fillText(row.name, left - 8 * scale, top + height / 2);
      const place = { left, right, top, height, ratio: scale, ink: color(row.ink) };
      if (row.kind === "signal") paintSignal(context, columns, row.bit, place);
      else paintSpans(context, spansOf(state, row.kind, packets), place);
    }
    describe(state);
    paintCursor(state);
  }

  /** @param {State} state @param {"packets" | "ticks"} kind @param {{rows: PacketRow[], more: boolean}} packets */
  function spansOf(state, kind, { rows: list, more }) {
    const x = (/** @type {number} */ cycle) => pixelOf(state, plot, cycle) * ratio();
    const spans = list.flatMap((packet) => {
      const [from, to] = kind === "packets" ? [packet.start_cycle, packet.end_cycle] : [packet.tick_start_cycle, packet.tick_end_cycle];
      if (from === null || to === null) return [];
      const said = [packet.hex, packet.fields, packet.outcome === "queued" ? "" : packet.outcome].filter(Boolean);
      const texts = kind === "packets" ? [said.join(" · "), said[0] ?? "", `#${packet.index}`] : [`tick ${packet.index} · ${packet.fields}`, packet.fields, `${packet.index}`];
      return [{ from: x(from), to: x(to), texts, marked: packet.index === state.packet, bad: kind === "packets" && packet.outcome !== "queued" }];
    });
    if (!more || list.length === 0) return spans;
    const text = `more than ${MOST_SPANS} ${kind}: zoom in to see each`;
    return [{ from: plot.left * ratio(), to: plot.right * ratio(), texts: [text, "zoom in"], marked: false, bad: false }];
  }

  /** @param {State} state */
  function paintCursor(state) {
    const { height, ratio: scale } = fit(overlay);
    const context = overlay.getContext("2d");
    if (!context || !state.result) return;
    context.scale(scale, scale);
    drawCursors(context, state, plot, height);
    foot(state);
    cursors(state);
  }

  /** @param {State} state */
  function cursors(state) {
    const clock = state.result?.summary.clock_hz ?? 1;
    const { a, b } = state.cursors;
    const texts = [];
    if (a !== null) texts.push(`A ${time(a / clock)}`);
    if (b !== null) texts.push(`B ${time(b / clock)}`);
    if (a !== null && b !== null) texts.push(`B−A ${time((b - a) / clock)}${a === b ? "" : ` = ${si(clock / Math.abs(b - a), "Hz", 6)}`}`);
    else texts.push(a === null ? "click sets cursor A" : "shift-click sets B");
    say(byId("cursor-readings"), texts.join(" · "));
  }

  /** Width and period of the pulse under the pointer. @param {PointerEvent} event */
  async function hover(event) {
    const row = rowAt(event);
    const state = now();
    if (!row || row.kind !== "signal" || !state.result || state.hover === null) {
      pulse = null;
      return foot(state);
    }
    const cycle = state.hover;
    const answer = await engine.latest("pulse", "pulse_at", row.bit, cycle).catch(unlessDropped);
    if (!answer) return;
    pulse = { ...answer, bit: row.bit, cycle };
    foot(now());
  }

  /** @param {State} state */
  function foot(state) {
    const clock = state.result?.summary.clock_hz ?? 1;
    const parts = [];
    if (state.hover !== null) parts.push(`${time(state.hover / clock)} · cycle ${count(state.hover)}`);
    const name = pulse && signals().find(({ bit }) => bit === pulse?.bit)?.name;
    if (pulse && name && state.hover !== null) {
      const { begin, end, next } = pulse;
      if (begin !== undefined && end !== undefined) {
        parts.push(`${name} stays ${time((end - begin) / clock)} (${count(end - begin)} cycles)`);
        if (next !== undefined) parts.push(`period ${time((next - begin) / clock)} = ${si(clock / (next - begin), "Hz", 5)}`);
      } else if (begin === undefined && end === undefined) parts.push(`${name} never changes`);
      else parts.push(`${name} ${end === undefined ? "stays so to the end" : `first changes at ${time(end / clock)}`}`);
    }
    say(byId("hover-reading"), parts.length ? parts.join(" · ") : "wheel zooms, dragging moves, double click shows the whole run");
  }

  /** @param {State} state */
  function describe(state) {
    const { start, end } = shown(state);
    const clock = state.result?.summary.clock_hz ?? 1;
    canvas.setAttribute("aria-label", `Logic analyser, ${rows().length} rows, ${time(start / clock)} to ${time(end / clock)}`);
  }

  /** @param {State} state */
  function fields(state) {
    const { start, end } = shown(state);
    const clock = state.result?.summary.clock_hz ?? 1;
    for (const [id, cycle] of /** @type {[string, number][]} */ ([["window-start", start], ["window-end", end]])) {
      const input = /** @type {HTMLInputElement} */ (byId(id));
      if (document.activeElement !== input) input.value = time(cycle / clock);
    }
  }

  /** @param {State} state */
  async function refreshOverview(state) {
    if (!state.result || overview.clientWidth < 60) return;
    const wanted = Math.max(16, Math.round((overview.clientWidth - GUTTER - MARGIN) * ratio()));
    const answer = await engine.latest("overview", "pulses", 0, endOf(state), wanted).catch(unlessDropped);
    if (!answer) return;
    whole = answer;
    paintStrip(now());
  }

  /** @param {State} state */
  function paintStrip(state) {
    const { width, height, ratio: scale } = fit(overview);
    const context = overview.getContext("2d");
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

  /** Pressing in the overview brings that time into the middle. */
  function dragOverview() {
    const go = (/** @type {PointerEvent} */ event) => {
      const box = overview.getBoundingClientRect();
      const part = (event.clientX - box.left - GUTTER) / Math.max(1, box.width - GUTTER - MARGIN);
      const { start, end } = shown(now());
      const half = (end - start) / 2;
      const middle = part * endOf(now());
      dispatch({ type: "window", window: { start: middle - half, end: middle + half } });
    };
    overview.addEventListener("pointerdown", (event) => {
      overview.setPointerCapture(event.pointerId);
      go(event);
    });
    overview.addEventListener("pointermove", (event) => { if (overview.hasPointerCapture(event.pointerId)) go(event); });
    overview.addEventListener("wheel", (event) => {
      event.preventDefault();
      zoom(page, Math.exp(event.deltaY * 0.002));
    }, { passive: false });
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (before?.result !== state.result || before?.row !== state.row) {
      options(rowSelect, signals().map(({ name, bit }) => [String(bit), name]), String(state.row));
    }
    const moved = before?.window !== state.window || before?.result !== state.result;
    if (before?.result !== state.result) {
      const tall = rows().length * ROW_PX + 6;
      stack.style.height = `${tall}px`;
      // On a wide screen this view takes what its rows need, and the curves the rest.
      byId("views").style.setProperty("--rows-px", `${tall}px`);
    }
    if (moved) {
      fields(state);
      say(byId("window-error"), "");
    }
    if (moved) {
      paintStrip(state);
      const strip = before?.result !== state.result ? refreshOverview(state) : undefined;
      return Promise.all([refresh(state), strip]);
    }
    if (before?.row !== state.row || before?.packet !== state.packet) paint(state);
    else if (before?.hover !== state.hover || before?.cursors !== state.cursors) paintCursor(state);
    return undefined;
  }
  return { render };
}
