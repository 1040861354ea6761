/**
 * The packets view: one row a packet. Only the rows on show are in the document; the scroll bar stands for
 * all of them. Enter or a click shows the packet in the pulses.
 */
import { byId, element, fill, say } from "./dom.js";
import { unlessDropped } from "./engine.js";
import { count } from "./number.js";
import { shown } from "./state.js";

/** @typedef {import("./types.js").State} State */
/** @typedef {import("./types.js").PacketRow} PacketRow */

const ROW_PX = 23;
/** Browsers refuse boxes taller than some ten million pixels; a longer list scrolls in larger steps. */
const MOST_PX = 6_000_000;

/** @param {{engine: import("./engine.js").Engine} & import("./timeline.js").Page} page */
export function createPackets({ engine, dispatch, now }) {
  const scroller = byId("packets-scroll");
  const space = byId("packets-space");
  const table = byId("packets");
  const body = /** @type {HTMLTableSectionElement} */ (table.querySelector("tbody"));
  let total = 0;
  let current = 0;
  /** @type {PacketRow[]} */
  let rows = [];

  scroller.addEventListener("scroll", () => fetchRows(now()));
  new ResizeObserver(() => fetchRows(now())).observe(scroller);
  body.addEventListener("click", (event) => {
    const row = /** @type {HTMLElement} */ (event.target).closest("tr");
    if (row) choose(Number(row.dataset.index));
  });
  table.addEventListener("keydown", (event) => {
    const page = Math.max(1, visible() - 1);
    const steps = { ArrowUp: -1, ArrowDown: 1, PageUp: -page, PageDown: page, Home: -total, End: total };
    if (event.key === "Enter" || event.key === " ") choose(current);
    else if (event.key in steps) move(steps[/** @type {keyof typeof steps} */ (event.key)]);
    else return;
    event.preventDefault();
  });

  const visible = () => Math.max(1, Math.floor((scroller.clientHeight - ROW_PX) / ROW_PX));
  const height = () => Math.min(MOST_PX, (total + 1) * ROW_PX + 2);

  function first() {
    const path = space.offsetHeight - scroller.clientHeight;
    if (path <= 0) return 0;
    const last = Math.max(0, total - visible());
    return Math.min(last, Math.round((scroller.scrollTop / path) * last));
  }

  /** @param {number} by */
  function move(by) {
    current = Math.min(Math.max(0, total - 1), Math.max(0, current + by));
    scrollTo(current);
    paint(now());
  }

  /** @param {number} index */
  function scrollTo(index) {
    const from = first();
    if (index >= from && index < from + visible()) return;
    const target = index < from ? index : index - visible() + 1;
    const last = Math.max(1, total - visible());
    scroller.scrollTop = (target / last) * (space.offsetHeight - scroller.clientHeight);
  }

  /** Marks a packet and brings its time into the pulses, in a window that shows it and its tick. @param {number} index */
  async function choose(index) {
    current = index;
    dispatch({ type: "packet", packet: index });
    const page = await engine.ask("packets", index, 1).catch(unlessDropped);
    const row = /** @type {PacketRow | undefined} */ (page?.rows[0]);
    if (row) show(row);
  }

  /** @param {PacketRow} row */
  function show(row) {
    const begin = row.start_cycle;
    const end = Math.max(row.end_cycle, row.tick_end_cycle ?? 0);
    const { start: from, end: to } = shown(now());
    const length = end - begin;
    const apart = begin < from || end > to;
    if (!apart && length > (to - from) / 12) return;
    dispatch({ type: "window", window: { start: begin - length * 0.15, end: end + length * 0.15 } });
  }

  /** @param {State} state */
  async function fetchRows(state) {
    if (!state.result || scroller.clientHeight < ROW_PX) return;
    const answer = await engine.latest("packets", "packets", first(), visible() + 2).catch(unlessDropped);
    if (!answer) return;
    if (answer.total !== total) {
      total = answer.total;
      current = Math.min(current, Math.max(0, total - 1));
      say(byId("packets-count"), `${count(total)} on the line`);
      table.setAttribute("aria-rowcount", String(total + 1));
    }
    space.style.height = `${height()}px`;
    rows = answer.rows;
    paint(now());
  }

  /** @param {State} state */
  function paint(state) {
    // One unit and one number of digits for the whole column, so that times can be compared at a glance.
    const seconds = (state.result?.summary.end_s ?? 0) >= 10;
    const clock = (state.result?.summary.clock_hz ?? 1) / (seconds ? 1 : 1000);
    const column = (/** @type {number} */ cycle) => (cycle / clock).toFixed(seconds ? 6 : 4);
    say(byId("packets-time"), seconds ? "start, s" : "start, ms");
    say(byId("packets-tick"), seconds ? "tick at, s" : "tick at, ms");
    fill(body, ...rows.map((row) => {
      const tick = row.tick_start_cycle === null ? "–" : column(row.tick_start_cycle);
      const cells = [count(row.index), column(row.start_cycle), row.hex, row.fields, row.outcome, tick];
      const line = element("tr", {
        id: `packet-${row.index}`, "data-index": String(row.index), "aria-rowindex": String(row.index + 2),
        "aria-selected": String(row.index === state.packet),
        class: [row.index === current ? "current" : "", row.outcome === "queued" ? "" : "bad"].join(" ").trim(),
      }, ...cells.map((text) => element("td", { title: text }, text)));
      return line;
    }));
    const there = rows.some(({ index }) => index === current);
    if (there) table.setAttribute("aria-activedescendant", `packet-${current}`);
    else table.removeAttribute("aria-activedescendant");
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (before?.result !== state.result) {
      current = 0;
      scroller.scrollTop = 0;
      return fetchRows(state);
    }
    if (before?.packet !== state.packet) {
      if (state.packet !== null) {
        current = state.packet;
        scrollTo(current);
      }
      return fetchRows(state);
    }
    return undefined;
  }
  return { render };
}
