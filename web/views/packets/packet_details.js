/** The content of the inspector: bytes, fields, CRC and times of a row. */
import { byId, element, fill, setText } from "../../dom.js";
import { time } from "../../state/number.js";
import { bitsText, bitText, factsOf, rangeText } from "./packet_texts.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").PacketDetail} PacketDetail */

/** Maximum fields of a row that show the meaning of their bits. */
const MAX_EXPLAINED = 24;
/** Signal bits of the line (contract A3). */
const [RX, TX] = [33, 34];

/** @param {import("./packets.js").Page} page @param {HTMLElement} bytes @param {HTMLElement} fields */
export function createPacketDetails({ dispatch, now }, bytes, fields) {
  /** @type {PacketDetail | null} */
  let row = null;

  for (const list of [bytes, fields]) {
    list.addEventListener("pointerover", (event) => {
      const cell = /** @type {HTMLElement} */ (event.target).closest("[role=option]");
      if (cell) point(list, [...list.children].indexOf(cell));
    });
    list.addEventListener("pointerleave", () => point(list, -1));
    list.addEventListener("focus", () => {
      if (list.matches(":focus-visible")) point(list, activeIndex(list) ?? 0);
    });
    list.addEventListener("blur", () => point(list, -1));
  }

  /** Index of the active cell of a list; null if there is none. @param {HTMLElement} list */
  function activeIndex(list) {
    const cell = document.getElementById(list.getAttribute("aria-activedescendant") ?? "");
    return cell ? [...list.children].indexOf(cell) : null;
  }

  /** @param {HTMLElement} list @param {number} by */
  function step(list, by) {
    point(list, Math.min(list.children.length - 1, Math.max(0, (activeIndex(list) ?? 0) + by)));
  }

  /** Selects a cell; -1 selects none. @param {HTMLElement} list @param {number} index */
  function point(list, index) {
    const cell = list.children[index];
    for (const each of list.children) each.setAttribute("aria-selected", String(each === cell));
    if (!row || !cell) {
      list.removeAttribute("aria-activedescendant");
      return dispatch({ type: "highlight", highlighted: null });
    }
    list.setAttribute("aria-activedescendant", cell.id);
    if (list.matches(":focus")) cell.scrollIntoView({ block: "nearest" });
    const { from, until } = list === bytes ? { from: index, until: index + 1 } : row.layout[index];
    const start = row.byte_cycles[from];
    const last = row.byte_cycles[until - 1];
    if (start === undefined || last === undefined) return undefined;
    const isOwnReply = row.kind === "reply" && row.mark !== "foreign";
    dispatch({
      type: "highlight",
      highlighted: {
        start,
        end: last + row.byte_length,
        from: "packets",
        packet: row.index,
        bit: isOwnReply ? TX : RX,
      },
    });
  }

  /** Shows a row; null clears it. @param {PacketDetail | null} next */
  function show(next) {
    row = next;
    if (!row) return;
    paint(row, now());
    highlight(now());
  }

  /** @param {PacketDetail} row @param {State} state */
  function paint(row, state) {
    const clock = state.result?.summary.clock_hz ?? 1;
    const timeOf = (/** @type {number} */ cycles) => time(cycles / clock);
    fill(
      byId("packet-facts"),
      ...factsOf(row, timeOf).map(([name, value, bad]) =>
        element("div", bad ? { class: "bad" } : {}, element("dt", {}, name), element("dd", {}, value)),
      ),
    );
    const hex = row.hex === "" ? [] : row.hex.split(" ");
    const meanings = hex.map((_, index) => {
      const field = row.layout.find(({ from, until }) => from <= index && index < until);
      return field ? [field.name, bitsText(field)].filter(Boolean).join(", ") : "";
    });
    fill(
      bytes,
      ...hex.map((byte, index) =>
        element(
          "span",
          {
            role: "option",
            id: `byte-${index}`,
            "aria-selected": "false",
            "aria-label": `byte ${index}: ${byte}, ${meanings[index]}`,
            title: `byte ${index}: ${meanings[index]}`,
          },
          byte,
        ),
      ),
    );
    fill(
      fields,
      ...row.layout.map((field, index) => {
        const { name, value, from, until, bits } = field;
        const range = until - from > 1 ? `${from}–${until - 1}` : String(from);
        return element(
          "span",
          {
            role: "option",
            id: `field-${index}`,
            "aria-selected": "false",
            title: [until - from > 1 ? `bytes ${range}` : `byte ${range}`, bitsText(field)].filter(Boolean).join(": "),
            class: name === "CRC" && row.check === "fails" ? "bad" : "",
          },
          element("b", {}, name),
          " ",
          value,
          " ",
          element("small", {}, `[${range}]`),
          // Long frames explain their bits only at the pointer.
          ...(row.layout.length <= MAX_EXPLAINED
            ? bits.map((group) =>
                element(
                  "span",
                  { class: "bits", title: bitText(group) },
                  element("code", {}, group.levels),
                  ` ${group.name} ${group.value}`,
                ),
              )
            : []),
        );
      }),
    );
    bytes.hidden = fields.hidden = hex.length === 0;
  }

  /** Updates the highlighted bytes and fields. @param {State} state */
  function highlight({ highlighted, result }) {
    const shown = row;
    const isInHighlight =
      highlighted && shown && (highlighted.packet === null || highlighted.packet === shown.index)
        ? shown.byte_cycles.map((start) => start < highlighted.end && start + shown.byte_length > highlighted.start)
        : [];
    // If the whole row is highlighted, its bytes are not.
    const marked = isInHighlight.includes(false) || isInHighlight.length === 1 ? isInHighlight : [];
    for (const [index, cell] of [...bytes.children].entries())
      cell.classList.toggle("highlighted", marked[index] === true);
    for (const [index, cell] of [...fields.children].entries()) {
      const { from, until } = shown?.layout[index] ?? { from: 0, until: 0 };
      cell.classList.toggle("highlighted", marked.slice(from, until).includes(true));
    }
    const [first, last] = [marked.indexOf(true), marked.lastIndexOf(true)];
    if (shown) setText(byId("packet-reading"), rangeText(shown, first, last, result?.summary.clock_hz ?? 1));
  }

  return { show, highlight, step, point };
}
