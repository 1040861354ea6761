/** The packet table. */
import { byId, element, fill, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count } from "../../state/number.js";
import { ROW_PX, virtualRows } from "../virtual_rows.js";
import { COLUMNS, columnWidths, isHighlighted, meaningOf } from "./columns.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").PacketRow} PacketRow */
/** @typedef {import("../../state/types.js").PacketPage} PacketPage */
/** @typedef {import("./columns.js").Widths} Widths */

const ruler = /** @type {CanvasRenderingContext2D} */ (document.createElement("canvas").getContext("2d"));

/**
 * @param {import("./packets.js").Page} page
 * @param {{inspect: (row: PacketRow) => void, choose: (row: PacketRow, go?: boolean) => void, counted: (page: PacketPage) => void}} told
 */
export function createTable({ engine, dispatch, now }, { inspect, choose, counted }) {
  const scroller = byId("packets-scroll");
  const space = byId("packets-space");
  const table = byId("packets");
  const body = /** @type {HTMLTableSectionElement} */ (table.querySelector("tbody"));
  /** @type {PacketPage} */
  let reply = { total: 0, shown: 0, matches: 0, unit: "ms", rows: [] };
  /** Position of the current row among those visible. */
  let current = 0;
  /** Widest texts of the columns so far, in CSS pixels: columns do not jump while the table scrolls. @type {{[column: string]: number}} */
  let widest = {};
  let cellAir = 0;

  scroller.addEventListener("scroll", reload);
  new ResizeObserver(reload).observe(scroller);
  const rowAt = (/** @type {Event} */ event) => {
    const row = /** @type {HTMLElement} */ (event.target).closest("tr");
    return row ? reply.rows.find(({ index }) => index === Number(row.dataset.index)) : undefined;
  };
  body.addEventListener("click", (event) => {
    const row = rowAt(event);
    if (!row) return;
    current = row.position;
    choose(row);
  });
  body.addEventListener("pointerover", (event) => {
    const row = rowAt(event);
    if (row)
      dispatch({
        type: "highlight",
        highlighted: { start: row.start_cycle, end: row.line_end_cycle, from: "packets", packet: row.index, bit: null },
      });
  });
  body.addEventListener("pointerleave", () => dispatch({ type: "highlight", highlighted: null }));

  const { first, visible, scrollTo, resize } = virtualRows(scroller, space, () => reply.shown);

  /** Makes another row the current one. @param {number} position */
  function moveTo(position) {
    current = Math.min(Math.max(0, reply.shown - 1), Math.max(0, position));
    scrollTo(current);
    return reload();
  }

  /** The current row, also where the table has not drawn it yet. @returns {Promise<PacketRow | null>} */
  async function currentRow() {
    const page = await engine.request("packets", current, 1).catch(unlessDropped);
    return page?.rows[0] ?? null;
  }

  /** Requests the visible rows. */
  async function reload() {
    const { result, bare } = now();
    // Out of sight nothing is drawn; whether there is anything to show has to be known all the same.
    const unseen = scroller.clientHeight < ROW_PX;
    if (!result || (unseen && !bare.includes("packets"))) return;
    const from = unseen ? 0 : first();
    const page = await engine.latest("packets", "packets", from, unseen ? 1 : visible() + 2).catch(unlessDropped);
    if (!page) return;
    if (unseen) return counted(page);
    const others = page.shown !== reply.shown || page.total !== reply.total;
    reply = page;
    if (others) {
      current = Math.min(current, Math.max(0, reply.shown - 1));
      table.setAttribute("aria-rowcount", String(reply.shown + 1));
      resize();
      // Fewer rows may have moved the scroll bar.
      if (first() !== from) return reload();
    }
    counted(reply);
    paint(now());
  }

  /** @param {State} state */
  function paint(state) {
    const { rows, unit } = reply;
    say(byId("packets-time"), `start, ${unit}`);
    say(byId("packets-gap"), `gap, ${unit}`);
    say(byId("packets-meaning"), state.result?.summary.framed ? "meaning" : "steps");
    // A row that stays keeps its element: a click that began on it ends on it.
    const nodes = new Map([...body.rows].map((node) => [node.id, node]));
    fill(
      body,
      ...rows.map((row) => {
        const id = `packet-${row.index}`;
        const node =
          nodes.get(id) ?? element("tr", { id, "data-index": String(row.index) }, ...COLUMNS.map(() => element("td")));
        node.setAttribute("aria-rowindex", String(row.position + 2));
        node.setAttribute("aria-selected", String(row.index === state.packet));
        node.className = [
          row.position === current ? "current" : "",
          row.rank === null ? "" : "found",
          row.kind,
          row.mark,
        ]
          .join(" ")
          .trim();
        for (const [place, column] of COLUMNS.entries()) {
          const [text, title = text] = column(row);
          say(node.cells[place], text);
          node.cells[place].title = title;
        }
        return node;
      }),
    );
    const row = rows.find(({ position }) => position === current);
    if (row) table.setAttribute("aria-activedescendant", `packet-${row.index}`);
    else table.removeAttribute("aria-activedescendant");
    light(state);
    widen();
    if (row) inspect(row);
  }

  /** Marks the rows that another view, or this one, points at. @param {State} state */
  function light({ highlighted }) {
    for (const [place, node] of [...body.rows].entries()) {
      const row = reply.rows[place];
      node.classList.toggle("highlighted", row !== undefined && isHighlighted(row, highlighted));
    }
  }

  /**
   * Columns as wide as their texts; the meaning takes what is left. Where there is little room the gap goes first, which
   * the inspector tells, then the bytes and the meaning become narrow, and last the outcome.
   */
  function widen() {
    // Air at both sides of a cell's text.
    const air = 1 + 2 * Number.parseFloat(getComputedStyle(table.querySelector("th") ?? table).paddingLeft);
    if (air !== cellAir) [cellAir, widest] = [air, {}];
    const fontOf = (/** @type {string} */ cell) => {
      const { fontWeight, fontSize, fontFamily } = getComputedStyle(table.querySelector(cell) ?? table);
      return `${fontWeight} ${fontSize} ${fontFamily}`;
    };
    const measure = (/** @type {string} */ column, /** @type {string} */ font, /** @type {string[]} */ ...texts) => {
      ruler.font = font;
      widest[column] = Math.max(
        widest[column] ?? 0,
        ...texts.map((text) => Math.ceil(ruler.measureText(text).width) + air),
      );
    };
    const { rows, unit } = reply;
    const [head, plain, hex] = [fontOf("th"), fontOf("td"), fontOf("td:nth-child(3)")];
    measure("index", plain, count(Math.max(0, reply.total - 1)), "00");
    measure("time", plain, ...rows.map(({ start }) => start));
    measure("time", head, `start, ${unit}`);
    measure("gap", plain, ...rows.map(({ gap }) => gap));
    measure("gap", head, `gap, ${unit}`);
    measure("outcome", plain, ...rows.map(({ short }) => short));
    measure("outcome", head, "outcome");
    measure("bytes", hex, ...rows.map((row) => row.hex));
    measure("bytes", head, "bytes (hex)");
    measure("meaning", plain, ...rows.map(meaningOf));
    const isFramed = Boolean(now().result?.summary.framed);
    const { tight, bytes, outcome } = columnWidths(/** @type {Widths} */ (widest), table.clientWidth, isFramed);
    table.classList.toggle("tight", tight);
    for (const [column, width] of Object.entries({ ...widest, outcome, bytes }))
      table.style.setProperty(`--${column}-px`, `${width}px`);
  }

  return {
    reload,
    moveTo,
    light,
    current: currentRow,
    /** @param {number} by  Rows. */
    move: (by) => {
      moveTo(current + by);
    },
    page: () => Math.max(1, visible() - 1),
    place: () => ({ position: current, row: reply.rows.find(({ position }) => position === current) ?? null }),
    /** Another run. */
    reset: () => {
      current = 0;
      widest = {};
      scroller.scrollTop = 0;
    },
  };
}
