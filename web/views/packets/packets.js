/** The packets view: a table of packets, frames and replies with search, filters and inspector. */
import { byId, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { registerCommands } from "../../shell/commands.js";
import { count } from "../../state/number.js";
import { shown } from "../../state/time_window.js";
import { createInspector } from "./inspector.js";
import { createSearch } from "./search.js";
import { createTable } from "./table.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").PacketRow} PacketRow */
/** @typedef {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} Page */

/** @param {Page} page */
export function createPackets(page) {
  const { engine, dispatch, now } = page;
  const inspector = createInspector(page);
  const table = createTable(page, { inspect: (row) => inspector.show(row.index), select, onPage: showCounts });
  const search = createSearch(page, { current: table.currentPosition, reload: table.reload, moveTo: table.moveTo });

  /** Selects a packet and shows its time in the pulses. @param {PacketRow} row @param {boolean} [opensTab]  Whether to open the tab of the pulses. */
  function select(row, opensTab = false) {
    dispatch({ type: "packet", packet: row.index });
    setText(
      byId("packet-sentence"),
      `Row ${row.index} is selected and shown in the pulses: ${row.kind}, ${row.fields}, ${row.outcome}.`,
    );
    reveal(row);
    if (opensTab && byId("tab-pulses").checkVisibility()) dispatch({ type: "view", view: "pulses" });
  }

  /** Moves the window to a row and its tick, unless they are visible and large enough. @param {PacketRow} row */
  function reveal(row) {
    const begin = row.start_cycle;
    const end = Math.max(row.end_cycle, row.tick_end_cycle ?? 0);
    const { start: from, end: to } = shown(now());
    const length = end - begin;
    const isOutside = begin < from || end > to;
    if (!isOutside && length > (to - from) / 12) return;
    dispatch({ type: "window", window: { start: begin - length * 0.15, end: end + length * 0.15 } });
  }

  /** @param {import("../../state/types.js").PacketPage} page */
  function showCounts({ total, shown: rows }) {
    const state = now();
    setText(
      byId("packets-count"),
      rows === total ? `${count(total)} on the line` : `${count(rows)} of ${count(total)} on the line`,
    );
    const why = total === 0 ? whyNoPackets(state) : rows === 0 ? "No row matches." : "";
    setText(/** @type {Element} */ (byId("packets-empty").firstElementChild), why);
    byId("packets-empty").hidden = why === "";
    byId("packets-unmatched").hidden = total === 0;
    byId("packet-inspector").hidden = total === 0 || (rows === 0 && state.packet === null);
    byId("packets-scroll").classList.toggle("none", rows === 0);
    dispatch({ type: "empty", view: "packets", isEmpty: total === 0 });
    for (const id of ["packets-search", "packets-filters"]) {
      /** @type {HTMLButtonElement} */ (byId(id)).disabled = total === 0;
    }
  }

  byId("packet-show").addEventListener("click", () => {
    const row = inspector.row();
    if (row) select(row, true);
  });
  byId("packet-copy").addEventListener("click", () => copyRow(inspector.row()));
  /** Runs a function of copy.js, which is loaded on demand. @param {(module: typeof import("./copy.js")) => any} work */
  const copy = (work) =>
    import("./copy.js").then(work, () =>
      setText(byId("packets-note"), "This part of the page could not be loaded. Check the network and try again."),
    );
  byId("packets-copy-all").addEventListener("click", () => copy(({ copyAll }) => copyAll(engine)));
  /** @param {PacketRow | null} row */
  async function copyRow(row) {
    if (row) await copy(({ copyHex }) => copyHex(row.hex, `Row ${row.index}`));
  }

  registerCommands(byId("packets"), "Packets", [
    { keys: ["ArrowUp"], text: "previous row", run: () => table.move(-1) },
    { keys: ["ArrowDown"], text: "next row", run: () => table.move(1) },
    { keys: ["PageUp"], text: "page up", run: () => table.move(-table.page()) },
    { keys: ["PageDown"], text: "page down", run: () => table.move(table.page()) },
    { keys: ["Home"], text: "first row", run: () => table.move(-Infinity) },
    { keys: ["End"], text: "last row", run: () => table.move(Infinity) },
    {
      keys: ["Enter", "Space"],
      text: "select the row and show it in the pulses",
      run: () => {
        table.current().then((row) => row && select(row, true));
      },
    },
    {
      keys: ["c"],
      text: "copy the bytes of the row as hex",
      run: () => {
        table.current().then(copyRow);
      },
    },
    { keys: ["/"], text: "search", run: () => byId("packets-search").focus() },
    {
      keys: ["n"],
      text: "next match",
      run: () => {
        search.next(true);
      },
    },
    {
      keys: ["Shift+N"],
      text: "previous match",
      run: () => {
        search.next(false);
      },
    },
  ]);

  /** @param {State} state @param {State | undefined} before */
  async function render(state, before) {
    if (before?.highlighted !== state.highlighted) {
      table.highlight(state);
      inspector.highlight(state);
    }
    search.render(state, before);
    if (before?.result !== state.result) {
      table.reset();
      inspector.reset();
      return search.setRun(state);
    }
    if (before?.filter !== state.filter) return search.filter(state);
    if (before?.packet !== state.packet) {
      if (state.packet === null) return table.reload();
      const position = await engine.request("packet_position", state.packet).catch(unlessDropped);
      // The inspector also shows a row that the filter hides.
      if (typeof position === "number") return table.moveTo(position);
      await inspector.show(state.packet);
      return table.reload();
    }
    return undefined;
  }
  return { render };
}

/** Why there are no packets. @param {State} state */
function whyNoPackets({ scenario: { source } }) {
  if ("segments" in source || source.motion?.engine === "segments")
    return "The controller runs segments: nothing is on the line.";
  if ("standalone" in source) return "A stand-alone controller has no line.";
  if ("line" in source) return "The line script sends nothing to this controller.";
  return "Nothing was sent: there are no ticks.";
}
