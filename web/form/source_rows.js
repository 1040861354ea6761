/** Sources that are lists of equal rows, in the form: what a host sends, and segments that a controller runs by itself. */
import { fields } from "./schema.js";
import { sampleSegments } from "./source_kinds.js";

/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("./kit.js").Kit} Kit */
/** @typedef {import("../state/types.js").Scenario} Scenario */

/** @param {Kit} kit @param {Scenario} scenario @returns {Node[]} */
export function sendRows(kit, scenario) {
  return kit.rows(
    "source.line.sends",
    scenario.source.line.sends,
    fields("ScriptedSend"),
    "Send",
    (last) => (last ? { ...last, start_cycle: after(last, kit.now().scenario) } : structuredClone(kit.samples.send)),
    "Source.line",
  );
}

/** @param {Kit} kit @param {Scenario} scenario @returns {Node[]} */
export function segmentRows(kit, scenario) {
  return kit.rows(
    "source.segments.channels",
    scenario.source.segments.channels,
    segmentFields(),
    "List",
    (last) => structuredClone(last ?? sampleSegments()),
    "Source.segments",
  );
}

/** A channel's list of segments. @returns {Field[]} */
const segmentFields = () =>
  fields("ChannelSegments").map((each) => (each.kind === "segments" ? { ...each, rows: 5 } : each));

/** A start that lies behind a send: its bytes have passed. @param {any} send @param {Scenario} scenario */
function after({ start_cycle, bytes, frame }, scenario) {
  // A frame's check, COBS and end mark, and room for its reply.
  const length = String(frame ?? bytes).replace(/\s/g, "").length / 2 + (frame === null ? 1 : 30);
  return start_cycle + Math.ceil((10 * length * scenario.clock_hz) / Math.max(1, scenario.line.baud));
}
