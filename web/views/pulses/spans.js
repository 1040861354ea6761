/** The decoded rows of the logic view: packets and frames, replies, ticks, and what breaks the driver's timing. */
import { unlessDropped } from "../../engine/engine.js";
import { si } from "../../state/number.js";
import { ruleName } from "../rules.js";
import { lookedAt, shown } from "../../state/state.js";
import { asked } from "../timing.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").PacketRow} PacketRow */
/** @typedef {import("../../state/types.js").TickRow} TickRow */
/** @typedef {import("../../state/types.js").Timing} Timing */
/** @typedef {import("./rows.js").SpanRow["kind"]} Kind */
/** @typedef {{start: number, end: number, texts: string[], marked: boolean, ink: string | null, packet: number | null}} Span  Cycles; the texts from the longest to the shortest. */

/** Spans that are drawn one by one; more than that are too narrow to be told apart. */
const MOST = 400;

/** Colours of what is not as usual. @type {{[mark: string]: string}} */
const INKS = { bad: "--error", repeated: "--warning", foreign: "--quiet" };

/** @param {{engine: import("../../engine/engine.js").Engine}} page */
export function createSpans({ engine }) {
  /** @type {{rows: PacketRow[], more: boolean}} */
  let packets = { rows: [], more: false };
  /** @type {{rows: TickRow[], more: boolean}} */
  let ticks = { rows: [], more: false };
  /** @type {Timing | null} */
  let timing = null;
  /** @type {State["result"]} What `timing` is about. */
  let checked = null;

  /** Asks for what lies in the shown time; false where a newer question took its place. @param {State} state @returns {Promise<boolean>} */
  async function fetch(state) {
    const { start, end } = shown(state);
    const known = checked === state.result;
    const answers = await Promise.all([
      engine.latest("spans", "packets_in", start, end, MOST),
      engine.latest("ticks", "ticks_in", start, end, MOST),
      known ? timing : lookedAt(state)?.violations ? engine.latest("violations", "timing") : null,
    ]).catch(unlessDropped);
    if (!answers?.[0]) return false;
    [packets, ticks, timing] = answers;
    checked = state.result;
    return true;
  }

  /** @param {State} state @param {Kind} kind @returns {Span[]} */
  function spansOf(state, kind) {
    const { start, end } = shown(state);
    const { more } = kind === "ticks" ? ticks : packets;
    const list = kind === "ticks" ? ticks.rows.map((tick) => ofTick(state, tick))
      : kind === "violations" ? violations(state)
        : packets.rows.filter((row) => (kind === "replies") === onReplies(row)).map((row) => ofPacket(state, row));
    if (kind === "violations" || !more) return list;
    const what = kind === "ticks" ? "ticks" : state.result?.summary.framed ? "frames" : "packets";
    return [{ start, end, texts: [`more than ${MOST} ${what}: zoom in to see each`, "zoom in"], marked: false, ink: null, packet: null }];
  }

  /** Violations in the shown time, each as long as what was measured. @param {State} state @returns {Span[]} */
  function violations(state) {
    const { start, end } = shown(state);
    const clock = state.result?.summary.clock_hz ?? 1;
    const found = (timing?.violations ?? []).filter(({ cycle, measured_cycles }) => cycle >= start && cycle - measured_cycles <= end);
    if (found.length > MOST) return [{ start, end, texts: [`${found.length} violations: zoom in to see each`, "zoom in"], marked: false, ink: "--error", packet: null }];
    return found.map(({ cycle, channel, rule, measured_cycles }) => ({
      start: cycle - measured_cycles, end: cycle, marked: false, ink: "--error", packet: null,
      texts: [`ch ${channel}: ${ruleName(rule)} ${si(measured_cycles / clock, "s")}, ${asked(timing, rule)} asked for`, ruleName(rule), "!"],
    }));
  }

  return { fetch, spansOf };
}

/** What the controller itself sends, on TX. @param {PacketRow} row */
function onReplies({ kind, mark }) {
  return kind === "collision" || (kind === "reply" && mark !== "foreign");
}

/** @param {State} state @param {PacketRow} row @returns {Span} */
function ofPacket(state, { index, kind, start_cycle, end_cycle, hex, fields, outcome, mark }) {
  const said = mark === "good" ? "" : outcome;
  const [short] = fields.split(/, |: (?=[A-Z]+,)/);
  const texts = kind === "packet" ? [[hex, fields, said], [hex]] : [[fields, said], [short], [fields ? "" : said]];
  const ink = INKS[mark] ?? null;
  return { start: start_cycle, end: end_cycle, marked: index === state.packet, ink, packet: index,
    texts: [...texts.map((parts) => parts.filter(Boolean).join(" · ")), `#${index}`].filter(Boolean) };
}

/** @param {State} state @param {TickRow} tick @returns {Span} */
function ofTick(state, { start_cycle, end_cycle, row, fields }) {
  const texts = [row === null ? fields : `#${row} · ${fields}`, fields, ...(row === null ? [] : [`#${row}`, `${row}`])];
  return { start: start_cycle, end: end_cycle, texts, marked: row !== null && row === state.packet, ink: null, packet: row };
}
