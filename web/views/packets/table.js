/** The packet table. */
import { byId, element, fill, setText } from "../../dom.js";
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
 * @param {{inspect: (row: PacketRow) => void, select: (row: PacketRow) => void, onPage: (page: PacketPage) => void}} callbacks
 */
export function createTable({ engine, dispatch, now }, { inspect, select, onPage }) {
  const scroller = byId("packets-scroll");
  const space = byId("packets-space");
  const table = byId("packets");
  const body = /** @type {HTMLTableSectionElement} */ (table.querySelector("tbody"));
  /** @type {PacketPage} */
  let reply = { total: 0, shown: 0, matches: 0, unit: "ms", rows: [] };
  /** Position of the current row among those visible. */
  let current = 0;
  /** Width of the widest text of each column so far, in CSS pixels, so that columns do not jump while the table scrolls. @type {{[column: string]: number}} */
  let widest = {};
  let cellPadding = 0;

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
    select(row);
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

  /** Sets the current row. @param {number} position */
  function moveTo(position) {
    current = Math.min(Math.max(0, reply.shown - 1), Math.max(0, position));
    scrollTo(current);
    return reload();
  }

  /** The current row, even if it is not drawn. @returns {Promise<PacketRow | null>} */
  async function currentRow() {
    const page = await engine.request("packets", current, 1).catch(unlessDropped);
    return page?.rows[0] ?? null;
  }

  /** Requests the visible rows. */
  async function reload() {
    const { result, emptyViews } = now();
    // A hidden table draws nothing, but has to find out whether it is empty.
    const isHidden = scroller.clientHeight < ROW_PX;
    if (!result || (isHidden && !emptyViews.includes("packets"))) return;
    const from = isHidden ? 0 : first();
    const page = await engine.latest("packets", "packets", from, isHidden ? 1 : visible() + 2).catch(unlessDropped);
    if (!page) return;
    if (isHidden) return onPage(page);
    const isOtherList = page.shown !== reply.shown || page.total !== reply.total;
    reply = page;
    if (isOtherList) {
      current = Math.min(current, Math.max(0, reply.shown - 1));
      table.setAttribute("aria-rowcount", String(reply.shown + 1));
      resize();
      // Fewer rows may have moved the scroll bar.
      if (first() !== from) return reload();
    }
    onPage(reply);
    paint(now());
  }

  /** @param {State} state */
  function paint(state) {
    const { rows, unit } = reply;
    setText(byId("packets-time"), `start, ${unit}`);
    setText(byId("packets-gap"), `gap, ${unit}`);
    setText(byId("packets-meaning"), state.result?.summary.framed ? "meaning" : "steps");
    // Rows that stay keep their elements, so that a click begins and ends on the same element.
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
        for (const [index, column] of COLUMNS.entries()) {
          const [text, title = text] = column(row);
          setText(node.cells[index], text);
          node.cells[index].title = title;
        }
        return node;
      }),
    );
    const row = rows.find(({ position }) => position === current);
    if (row) table.setAttribute("aria-activedescendant", `packet-${row.index}`);
    else table.removeAttribute("aria-activedescendant");
    highlight(state);
    updateWidths();
    if (row) inspect(row);
  }

  /** Updates the highlighted rows. @param {State} state */
  function highlight({ highlighted }) {
    for (const [index, node] of [...body.rows].entries()) {
      const row = reply.rows[index];
      node.classList.toggle("highlighted", row !== undefined && isHighlighted(row, highlighted));
    }
  }

  /** Measures the texts and sets the widths of the columns (`columnWidths`). */
  function updateWidths() {
    const padding = 1 + 2 * Number.parseFloat(getComputedStyle(table.querySelector("th") ?? table).paddingLeft);
    if (padding !== cellPadding) [cellPadding, widest] = [padding, {}];
    const fontOf = (/** @type {string} */ cell) => {
      const { fontWeight, fontSize, fontFamily } = getComputedStyle(table.querySelector(cell) ?? table);
      return `${fontWeight} ${fontSize} ${fontFamily}`;
    };
    const measure = (/** @type {string} */ column, /** @type {string} */ font, /** @type {string[]} */ ...texts) => {
      ruler.font = font;
      widest[column] = Math.max(
        widest[column] ?? 0,
        ...texts.map((text) => Math.ceil(ruler.measureText(text).width) + padding),
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
    const { isTight, bytes, outcome } = columnWidths(/** @type {Widths} */ (widest), table.clientWidth, isFramed);
    table.classList.toggle("tight", isTight);
    for (const [column, width] of Object.entries({ ...widest, outcome, bytes }))
      table.style.setProperty(`--${column}-px`, `${width}px`);
  }

  return {
    reload,
    moveTo,
    highlight,
    current: currentRow,
    /** Moves by rows. @param {number} by */
    move: (by) => {
      moveTo(current + by);
    },
    page: () => Math.max(1, visible() - 1),
    currentPosition: () => ({
      position: current,
      row: reply.rows.find(({ position }) => position === current) ?? null,
    }),
    /** Resets the table for another run. */
    reset: () => {
      current = 0;
      widest = {};
      scroller.scrollTop = 0;
    },
  };
}
