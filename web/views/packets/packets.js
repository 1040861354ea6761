/** The packets view: a table of packets, frames and replies with search, filters and inspector. */
import { byId, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { listen } from "../../shell/commands.js";
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
  const table = createTable(page, { inspect: (row) => inspector.show(row.index), choose, counted });
  const search = createSearch(page, { place: table.place, reload: table.reload, moveTo: table.moveTo });

  /** Marks a packet and brings its time into the pulses. @param {PacketRow} row @param {boolean} [go]  Also where the pulses are another tab. */
  function choose(row, go = false) {
    dispatch({ type: "packet", packet: row.index });
    say(
      byId("packet-sentence"),
      `Row ${row.index} is selected and shown in the pulses: ${row.kind}, ${row.fields}, ${row.outcome}.`,
    );
    reveal(row);
    if (go && byId("tab-pulses").checkVisibility()) dispatch({ type: "view", view: "pulses" });
  }

  /** A window that shows a row and its tick, where they are not to be seen well already. @param {PacketRow} row */
  function reveal(row) {
    const begin = row.start_cycle;
    const end = Math.max(row.end_cycle, row.tick_end_cycle ?? 0);
    const { start: from, end: to } = shown(now());
    const length = end - begin;
    const apart = begin < from || end > to;
    if (!apart && length > (to - from) / 12) return;
    dispatch({ type: "window", window: { start: begin - length * 0.15, end: end + length * 0.15 } });
  }

  /** @param {import("../../state/types.js").PacketPage} answer */
  function counted({ total, shown: rows }) {
    const state = now();
    say(
      byId("packets-count"),
      rows === total ? `${count(total)} on the line` : `${count(rows)} of ${count(total)} on the line`,
    );
    const why = total === 0 ? whyNone(state) : rows === 0 ? "No row matches." : "";
    say(/** @type {Element} */ (byId("packets-empty").firstElementChild), why);
    byId("packets-empty").hidden = why === "";
    byId("packets-unmatched").hidden = total === 0;
    byId("packet-inspector").hidden = total === 0 || (rows === 0 && state.packet === null);
    byId("packets-scroll").classList.toggle("none", rows === 0);
    dispatch({ type: "bare", view: "packets", bare: total === 0 });
    for (const id of ["packets-search", "packets-filters"]) {
      /** @type {HTMLButtonElement} */ (byId(id)).disabled = total === 0;
    }
  }

  byId("packet-show").addEventListener("click", () => {
    const row = inspector.row();
    if (row) choose(row, true);
  });
  byId("packet-copy").addEventListener("click", () => copyRow(inspector.row()));
  /** @param {(loaded: typeof import("./copy.js")) => any} work */
  const copy = (work) =>
    import("./copy.js").then(work, () =>
      say(byId("packets-note"), "This part of the page could not be loaded. Check the network and try again."),
    );
  byId("packets-copy-all").addEventListener("click", () => copy(({ copyAll }) => copyAll(engine)));
  /** @param {PacketRow | null} row */
  async function copyRow(row) {
    if (row) await copy(({ copyHex }) => copyHex(row.hex, `Row ${row.index}`));
  }

  listen(byId("packets"), "Packets", [
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
        table.current().then((row) => row && choose(row, true));
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
      table.light(state);
      inspector.light(state);
    }
    search.render(state, before);
    if (before?.result !== state.result) {
      table.reset();
      inspector.reset();
      return search.start(state);
    }
    if (before?.filter !== state.filter) return search.filter(state);
    if (before?.packet !== state.packet) {
      if (state.packet === null) return table.reload();
      const position = await engine.request("packet_position", state.packet).catch(unlessDropped);
      // A row that the filter leaves out is still told.
      if (typeof position === "number") return table.moveTo(position);
      await inspector.show(state.packet);
      return table.reload();
    }
    return undefined;
  }
  return { render };
}

/** Why nothing went over the line. @param {State} state */
function whyNone({ scenario: { source } }) {
  if ("segments" in source || source.motion?.engine === "segments")
    return "The controller runs segments: nothing is on the line.";
  if ("standalone" in source) return "A stand-alone controller has no line.";
  if ("line" in source) return "The line script sends nothing to this controller.";
  return "Nothing was sent: there are no ticks.";
}
