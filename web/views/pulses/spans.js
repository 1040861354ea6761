/** Decoded rows of the logic view: bits, bytes, fields, packets, ticks and violations. */
import { unlessDropped } from "../../engine/engine.js";
import { ruleName } from "../../form/schema.js";
import { si } from "../../state/number.js";
import { selected } from "../../state/queries.js";
import { shown } from "../../state/time_window.js";
import { required } from "../required.js";
import { hasLine } from "./rows.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").PacketRow} PacketRow */
/** @typedef {import("../../state/types.js").TickRow} TickRow */
/** @typedef {import("../../state/types.js").Timing} Timing */
/** @typedef {import("../../state/types.js").Decoded} Decoded */
/** @typedef {import("./rows.js").SpanRow | import("./rows.js").LineRow} DecodedRow */
/** @typedef {{start: number, end: number, texts: string[], marked: boolean, ink: string | null, packet: number | null, sample?: number | null}} Span  In cycles. `texts` are alternatives, from the longest to the shortest. */

/** Maximum spans that are drawn; more would be too narrow to distinguish. */
const MAX_SPANS = 250;
/** Minimum width of a drawn bit, in CSS pixels. */
const BIT_PX = 6;
/** @type {Decoded} */
const EMPTY = { rx: { bits: [], bytes: [], fields: [] }, tx: { bits: [], bytes: [], fields: [] }, more: false };

/** Colors of special outcomes. @type {{[mark: string]: string}} */
const INKS = { bad: "--error", repeated: "--warning", foreign: "--quiet" };

/** @param {{engine: import("../../engine/engine.js").Engine}} page */
export function createSpans({ engine }) {
  /** @type {{rows: PacketRow[], more: boolean}} */
  let packets = { rows: [], more: false };
  /** @type {{rows: TickRow[], more: boolean}} */
  let ticks = { rows: [], more: false };
  /** @type {Timing | null} */
  let timing = null;
  /** The result of `timing`. @type {State["result"]} */
  let timedResult = null;

  let decoded = EMPTY;

  /** Requests the spans of the visible time and calls `onReply` after each reply. Returns false if a newer request replaced it. @param {State} state @param {number} width  CSS pixels. @param {() => void} onReply @returns {Promise<boolean>} */
  async function fetch(state, width, onReply) {
    const { start, end } = shown(state);
    const margin = (end - start) / 4;
    const [from, to] = [Math.max(0, start - margin), end + margin];
    const isLineUsed = hasLine(state);
    const isTimingKnown = timedResult === state.result;
    /** @template T @param {Promise<T> | T} request @param {(reply: T) => void} store */
    const receive = async (request, store) => {
      const reply = await Promise.resolve(request).catch(unlessDropped);
      if (reply === undefined || reply === null) return false;
      store(/** @type {T} */ (reply));
      onReply();
      return true;
    };
    const replies = await Promise.all([
      receive(
        isLineUsed ? engine.latest("spans", "packets_in", from, to, MAX_SPANS) : { rows: [], more: false },
        (reply) => {
          packets = reply;
        },
      ),
      receive(engine.latest("ticks", "ticks_in", from, to, MAX_SPANS), (reply) => {
        ticks = reply;
      }),
      receive(
        isLineUsed ? engine.latest("decoded", "decoded", from, to, MAX_SPANS, Math.floor(width / (7 * BIT_PX))) : EMPTY,
        (reply) => {
          decoded = reply;
        },
      ),
      isTimingKnown ||
        receive(
          selected(state)?.violations
            ? engine.latest("violations", "timing")
            : { driver: null, total: 0, rules: [], violations: [] },
          (reply) => {
            timing = reply;
          },
        ),
    ]);
    if (replies[3]) timedResult = state.result;
    return replies.every(Boolean);
  }

  /** Whether a row has too many spans in the visible time to draw them. @param {DecodedRow} row */
  function isDense(row) {
    if (row.kind === "ticks") return ticks.more;
    if (!("wire" in row)) return row.kind !== "violations" && packets.more;
    return (
      decoded.more || (row.kind === "bits" && decoded[row.wire].bits.length === 0 && decoded[row.wire].bytes.length > 0)
    );
  }

  /** @param {State} state @param {DecodedRow} row @returns {Span[]} */
  function spansOf(state, row) {
    if (row.kind === "violations") return violations(state);
    const { start, end } = shown(state);
    if (isDense(row)) {
      const noun = row.kind === "packets" && state.result?.summary.framed ? "frames" : row.kind;
      return [
        {
          start,
          end,
          texts: [`zoom in to see the ${noun}`, "zoom in"],
          marked: false,
          ink: null,
          packet: null,
        },
      ];
    }
    if ("wire" in row) {
      return decoded[row.wire][row.kind].map((span) => ({
        ...span,
        marked: span.packet !== null && span.packet === state.packet,
        ink: span.bad ? "--error" : null,
      }));
    }
    if (row.kind === "ticks") return ticks.rows.map((tick) => tickSpan(state, tick));
    return packets.rows
      .filter((each) => (row.kind === "replies") === isOnReplyRow(each))
      .map((each) => packetSpan(state, each));
  }

  /** Violations in the visible time, each as long as its measured time. @param {State} state @returns {Span[]} */
  function violations(state) {
    const { start, end } = shown(state);
    const clock = state.result?.summary.clock_hz ?? 1;
    const found = (timing?.violations ?? []).filter(
      ({ cycle, measured_cycles }) => cycle >= start && cycle - measured_cycles <= end,
    );
    if (found.length > MAX_SPANS)
      return [
        {
          start,
          end,
          texts: [`${found.length} violations: zoom in to see them`, "zoom in"],
          marked: false,
          ink: "--error",
          packet: null,
        },
      ];
    return found.map(({ cycle, channel, rule, measured_cycles }) => ({
      start: cycle - measured_cycles,
      end: cycle,
      marked: false,
      ink: "--error",
      packet: null,
      texts: [
        `ch ${channel}: ${ruleName(rule)} ${si(measured_cycles / clock, "s")}, ${required(timing, rule)} required`,
        ruleName(rule),
        "!",
      ],
    }));
  }

  return { fetch, spansOf, isDense };
}

/** Whether a packet is in the row of replies: what the controller sends on TX. @param {PacketRow} row */
function isOnReplyRow({ kind, mark }) {
  return kind === "collision" || (kind === "reply" && mark !== "foreign");
}

/** @param {State} state @param {PacketRow} row @returns {Span} */
function packetSpan(state, { index, kind, start_cycle, end_cycle, hex, fields, outcome, why, mark }) {
  const shownOutcome = mark === "good" ? "" : outcome;
  const [short] = fields.split(/, |: (?=[A-Z]+,)/);
  const whole = why ? [[fields, `${shownOutcome}: ${why}`]] : [];
  const texts =
    kind === "packet"
      ? [...whole, [hex, fields, shownOutcome], [hex]]
      : [...whole, [fields, shownOutcome], [short], [fields ? "" : shownOutcome]];
  const ink = INKS[mark] ?? null;
  return {
    start: start_cycle,
    end: end_cycle,
    marked: index === state.packet,
    ink,
    packet: index,
    texts: [...texts.map((parts) => parts.filter(Boolean).join(" · ")), `#${index}`].filter(Boolean),
  };
}

/** @param {State} state @param {TickRow} tick @returns {Span} */
function tickSpan(state, { start_cycle, end_cycle, row, fields }) {
  const texts = [row === null ? fields : `#${row} · ${fields}`, fields, ...(row === null ? [] : [`#${row}`, `${row}`])];
  return {
    start: start_cycle,
    end: end_cycle,
    texts,
    marked: row !== null && row === state.packet,
    ink: null,
    packet: row,
  };
}
