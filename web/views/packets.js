/**
 * The packets view: one row a packet. Only the rows on show are in the document; the scroll bar stands for
 * all of them. Enter or a click shows the packet in the pulses.
 */
import { byId, element, fill, say } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";
import { count, time } from "../state/number.js";
import { shown } from "../state/state.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").PacketRow} PacketRow */

const ROW_PX = 23;
/** Browsers refuse boxes taller than some ten million pixels; a longer list scrolls in larger steps. */
const MOST_PX = 6_000_000;
/** Air at both sides of a cell's text. */
const CELL_PX = 18;
/** Most of the columns whose texts a frame makes long. */
const FRAMED_PX = { bytes: 104, outcome: 124 };
const ruler = /** @type {CanvasRenderingContext2D} */ (document.createElement("canvas").getContext("2d"));

/** @param {{engine: import("../engine/engine.js").Engine} & import("../time/timeline.js").Page} page */
export function createPackets({ engine, dispatch, now }) {
  const scroller = byId("packets-scroll");
  const space = byId("packets-space");
  const table = byId("packets");
  const body = /** @type {HTMLTableSectionElement} */ (table.querySelector("tbody"));
  let total = 0;
  let current = 0;
  /** @type {PacketRow[]} */
  let rows = [];
  /** Widest texts of the columns so far, in CSS pixels: columns do not jump while the table scrolls. @type {{[column: string]: number}} */
  let widest = {};

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
      widest = {};
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
    const { unit, print } = clockOf(state);
    say(byId("packets-time"), `start, ${unit}`);
    say(byId("packets-tick"), `tick, ${unit}`);
    say(byId("packets-meaning"), state.result?.summary.framed ? "meaning" : "steps");
    fill(body, ...rows.map((row) => {
      const tick = row.tick_start_cycle === null ? "–" : print(row.tick_start_cycle);
      const cells = [count(row.index), print(row.start_cycle), row.hex, worded(row), row.outcome, tick];
      const line = element("tr", {
        id: `packet-${row.index}`, "data-index": String(row.index), "aria-rowindex": String(row.index + 2),
        "aria-selected": String(row.index === state.packet),
        class: [row.index === current ? "current" : "", row.kind, row.mark].join(" ").trim(),
      }, ...cells.map((text) => element("td", { title: text }, text)));
      return line;
    }));
    const there = rows.some(({ index }) => index === current);
    if (there) table.setAttribute("aria-activedescendant", `packet-${current}`);
    else table.removeAttribute("aria-activedescendant");
    widen(print(state.result?.summary.end_cycle ?? 0), unit);
    detail(rows.find(({ index }) => index === current), state);
  }

  /** Columns as wide as their texts; the steps take what is left. @param {string} time @param {string} unit */
  function widen(time, unit) {
    const fontOf = (/** @type {string} */ cell) => {
      const { fontWeight, fontSize, fontFamily } = getComputedStyle(table.querySelector(cell) ?? table);
      return `${fontWeight} ${fontSize} ${fontFamily}`;
    };
    const measure = (/** @type {string} */ column, /** @type {string} */ font, /** @type {string[]} */ ...texts) => {
      ruler.font = font;
      widest[column] = Math.max(widest[column] ?? 0, ...texts.map((text) => Math.ceil(ruler.measureText(text).width) + CELL_PX));
    };
    const [head, plain, hex] = [fontOf("th"), fontOf("td"), fontOf("td:nth-child(3)")];
    measure("index", plain, count(total), "00");
    measure("time", plain, time);
    measure("time", head, `start, ${unit}`);
    measure("outcome", plain, ...rows.map(({ outcome }) => outcome));
    measure("outcome", head, "outcome");
    measure("bytes", hex, ...rows.map((row) => row.hex));
    measure("bytes", head, "bytes (hex)");
    // Of a frame the bytes say less than the words.
    const { framed } = now().result?.summary ?? {};
    const outcome = Math.min(widest.outcome, framed ? FRAMED_PX.outcome : Infinity);
    const spare = table.clientWidth - widest.index - 2 * widest.time - outcome;
    const bytes = Math.min(widest.bytes, framed ? Math.min(FRAMED_PX.bytes, Math.max(spare / 3, 60)) : Math.max(spare / 2, 96));
    for (const [column, width] of Object.entries({ ...widest, outcome, bytes })) {
      table.style.setProperty(`--${column}-px`, `${width}px`);
    }
  }

  /** All of the current packet, for what its row has no room for. @param {PacketRow | undefined} row @param {State} state */
  function detail(row, state) {
    // What stands while other rows are looked at is still true.
    if (!row) return total === 0 ? say(byId("packet-detail"), "") : undefined;
    const clock = state.result?.summary.clock_hz ?? 1;
    const at = (/** @type {number} */ cycle) => time(cycle / clock);
    const tick = row.tick_start_cycle === null ? "no tick"
      : `tick ${at(row.tick_start_cycle)}${row.tick_end_cycle === null ? ", not ended" : ` to ${at(row.tick_end_cycle)}`}`;
    say(byId("packet-detail"), [`#${count(row.index)}`, worded(row), row.hex, row.outcome, `on the line ${at(row.start_cycle)} to ${at(row.end_cycle)}`, tick]
      .filter(Boolean).join(" · "));
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

/** What a row says, and which way it went. @param {PacketRow} row */
function worded({ kind, fields }) {
  if (kind === "packet") return fields;
  const arrow = { frame: "→", reply: "←", collision: "↯" }[kind];
  return `${arrow} ${fields || kind}`;
}

/**
 * One unit and one number of digits for a whole column, so that times can be compared at a glance.
 * @param {State} state
 */
function clockOf(state) {
  const { end_s = 0, clock_hz = 1 } = state.result?.summary ?? {};
  const { unit, per_s, digits } = end_s >= 10 ? { unit: "s", per_s: 1, digits: 5 }
    : end_s >= 0.01 ? { unit: "ms", per_s: 1e3, digits: 3 } : { unit: "µs", per_s: 1e6, digits: 2 };
  return { unit, print: (/** @type {number} */ cycle) => ((cycle * per_s) / clock_hz).toFixed(digits) };
}
