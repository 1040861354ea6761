/** The unfolded inspector: bytes, fields, CRC and times of a row. */
import { byId, element, fill, say } from "../../dom.js";
import { count, time } from "../../state/number.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").PacketDetail} PacketDetail */

/** Signal bits of the line (contract A3). */
const [RX, TX] = [33, 34];
/** Bytes whose bits are written out. */
const MAX_BITS = 4;

/** @param {import("./packets.js").Page} page @param {HTMLElement} bytes @param {HTMLElement} fields */
export function createUnfolded({ dispatch, now }, bytes, fields) {
  /** @type {PacketDetail | null} */
  let row = null;

  for (const list of [bytes, fields]) {
    list.addEventListener("pointerover", (event) => {
      const cell = /** @type {HTMLElement} */ (event.target).closest("[role=option]");
      if (cell) point(list, [...list.children].indexOf(cell));
    });
    list.addEventListener("pointerleave", () => point(list, -1));
    list.addEventListener("focus", () => {
      if (list.matches(":focus-visible")) point(list, at(list) ?? 0);
    });
    list.addEventListener("blur", () => point(list, -1));
  }

  /** Which cell of a list the keys are at. @param {HTMLElement} list */
  function at(list) {
    const cell = document.getElementById(list.getAttribute("aria-activedescendant") ?? "");
    return cell ? [...list.children].indexOf(cell) : null;
  }

  /** @param {HTMLElement} list @param {number} by */
  function step(list, by) {
    point(list, Math.min(list.children.length - 1, Math.max(0, (at(list) ?? 0) + by)));
  }

  /** Points at a cell, -1 at none. @param {HTMLElement} list @param {number} place */
  function point(list, place) {
    const cell = list.children[place];
    for (const each of list.children) each.setAttribute("aria-selected", String(each === cell));
    if (!row || !cell) {
      list.removeAttribute("aria-activedescendant");
      return dispatch({ type: "highlight", highlighted: null });
    }
    list.setAttribute("aria-activedescendant", cell.id);
    if (list.matches(":focus")) cell.scrollIntoView({ block: "nearest" });
    const { from, until } = list === bytes ? { from: place, until: place + 1 } : row.layout[place];
    const start = row.byte_cycles[from];
    const last = row.byte_cycles[until - 1];
    if (start === undefined || last === undefined) return undefined;
    const own = row.kind === "reply" && row.mark !== "foreign";
    dispatch({
      type: "highlight",
      highlighted: { start, end: last + row.byte_length, from: "packets", packet: row.index, bit: own ? TX : RX },
    });
  }

  /** Shows a row; none if there is none any more. @param {PacketDetail | null} shown */
  function show(shown) {
    row = shown;
    if (!row) return;
    paint(row, now());
    light(now());
  }

  /** @param {PacketDetail} row @param {State} state */
  function paint(row, state) {
    const clock = state.result?.summary.clock_hz ?? 1;
    const timeOf = (/** @type {number} */ cycles) => time(cycles / clock);
    fill(
      byId("packet-facts"),
      ...facts(row, timeOf).map(([name, value, bad]) =>
        element("div", bad ? { class: "bad" } : {}, element("dt", {}, name), element("dd", {}, value)),
      ),
    );
    const hex = row.hex === "" ? [] : row.hex.split(" ");
    const named = hex.map(
      (_, place) => row.layout.find(({ from, until }) => from <= place && place < until)?.name ?? "",
    );
    fill(
      bytes,
      ...hex.map((byte, place) =>
        element(
          "span",
          {
            role: "option",
            id: `byte-${place}`,
            "aria-selected": "false",
            "aria-label": `byte ${place}: ${byte}, ${named[place]}`,
            title: `byte ${place}: ${named[place]}`,
          },
          byte,
        ),
      ),
    );
    fill(
      fields,
      ...row.layout.map(({ name, value, from, until }, place) => {
        const range = until - from > 1 ? `${from}–${until - 1}` : String(from);
        return element(
          "span",
          {
            role: "option",
            id: `field-${place}`,
            "aria-selected": "false",
            title: until - from > 1 ? `bytes ${range}` : `byte ${range}`,
            class: name === "check" && row.check === "fails" ? "bad" : "",
          },
          element("b", {}, name),
          " ",
          value,
          " ",
          element("small", {}, `[${range}]`),
        );
      }),
    );
    bytes.hidden = fields.hidden = hex.length === 0;
  }

  /** Highlights the bytes and fields that something points at. @param {State} state */
  function light({ highlighted, result }) {
    const shown = row;
    const over =
      highlighted && shown && (highlighted.packet === null || highlighted.packet === shown.index)
        ? shown.byte_cycles.map((start) => start < highlighted.end && start + shown.byte_length > highlighted.start)
        : [];
    // All of a row is timeOf by the row itself.
    const some = over.includes(false) || over.length === 1 ? over : [];
    for (const [place, cell] of [...bytes.children].entries())
      cell.classList.toggle("highlighted", some[place] === true);
    for (const [place, cell] of [...fields.children].entries()) {
      const { from, until } = shown?.layout[place] ?? { from: 0, until: 0 };
      cell.classList.toggle("highlighted", some.slice(from, until).includes(true));
    }
    const [first, last] = [some.indexOf(true), some.lastIndexOf(true)];
    if (shown) say(byId("packet-reading"), reading(shown, first, last, result?.summary.clock_hz ?? 1));
  }

  return { show, light, step, point };
}

/** The bytes that are pointed at: hex, bits, and when they are on the line; with none, when all of them are. @param {PacketDetail} row @param {number} first @param {number} last @param {number} clock */
function reading(row, first, last, clock) {
  if (first < 0) return `on the line ${time(row.start_cycle / clock)} to ${time(row.line_end_cycle / clock)}`;
  const hex = row.hex.split(" ").slice(first, last + 1);
  const bits = hex
    .map((byte) => Number.parseInt(byte, 16).toString(2).padStart(8, "0"))
    .map((eight) => `${eight.slice(0, 4)}\u2009${eight.slice(4)}`);
  const when = `${time(row.byte_cycles[first] / clock)} to ${time((row.byte_cycles[last] + row.byte_length) / clock)}`;
  return [
    first === last ? `byte ${first}` : `bytes ${first} to ${last}`,
    hex.length <= MAX_BITS ? hex.join(" ") : "",
    hex.length <= MAX_BITS ? `bits ${bits.join(" ")}` : "",
    when,
  ]
    .filter(Boolean)
    .join(" · ");
}

/** @param {PacketDetail} row @param {(cycles: number) => string} timeOf @returns {[string, string, boolean?][]} */
function facts(row, timeOf) {
  const { check, check_found: found, check_expected: expected } = row;
  const cobs = row.layout.filter(({ name }) => name === "COBS" || name === "end mark").length;
  const size = row.byte_cycles.length;
  /** @type {[string, string, boolean?]} */
  const checked =
    check === "holds"
      ? ["CRC-32/ISCSI", `${found} ✓`]
      : check === "fails"
        ? ["CRC-32/ISCSI", `✕ ${found}, expected ${expected}`, true]
        : check === "none"
          ? ["check", "none: raw packets have no CRC"]
          : ["check", "none: incomplete frame"];
  const tick =
    row.tick_start_cycle === null
      ? []
      : [
          [
            "tick",
            `${timeOf(row.tick_start_cycle)}${row.tick_end_cycle === null ? ", not ended" : ` to ${timeOf(row.tick_end_cycle)}`}`,
          ],
        ];
  const turnaround =
    row.turnaround_cycles === null
      ? []
      : [
          [
            "turnaround",
            `${timeOf(row.turnaround_cycles)} after the end of #${count(row.answers ?? 0)}${row.drive_cycles === null ? "" : `; DE rises after ${timeOf(row.drive_cycles)}`}`,
          ],
        ];
  const all = [
    ["gap before", row.gap_cycles === null ? "–" : timeOf(row.gap_cycles)],
    ...turnaround,
    ...tick,
    ...(row.kind === "collision"
      ? []
      : [["size", `${count(size)} ${size === 1 ? "byte" : "bytes"}${cobs ? `, ${cobs} of them COBS` : ""}`], checked]),
  ];
  return /** @type {[string, string, boolean?][]} */ (all);
}
