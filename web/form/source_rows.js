/** The form of sources that are lists of rows: sends of a line script, and segments. */
import { fields } from "./schema.js";
import { sampleSegments } from "./source_kinds.js";

/** Additional bytes of a frame, with room for its reply. */
const FRAME_BYTES = 30;

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
    (last) =>
      last ? { ...last, start_cycle: cycleAfter(last, kit.now().scenario) } : structuredClone(kit.samples.send),
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

/** A cycle at which the bytes of a send have ended. @param {any} send @param {Scenario} scenario */
function cycleAfter({ start_cycle, bytes, frame }, scenario) {
  // A frame also has a CRC, COBS and delimiters, and needs time for its reply.
  const length = String(frame ?? bytes).replace(/\s/g, "").length / 2 + (frame === null ? 1 : FRAME_BYTES);
  return start_cycle + Math.ceil((10 * length * scenario.clock_hz) / Math.max(1, scenario.line.baud));
}
