/** Text of the comparison with the run of the sender of a link. */
import { count, time } from "../state/number.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").TraceLocation} TraceLocation */
/** @typedef {import("../state/types.js").SenderComparison} SenderComparison */

/** Minimum margin of a location, in cycles. */
const MIN_MARGIN_CYCLES = 200;

/** The result as text, with the location of the difference. @param {SenderComparison} comparison @param {State} state @returns {{text: string, location: TraceLocation | null}} */
export function comparisonText(comparison, { result }) {
  if (!result) return { text: "", location: null };
  const { controllers, clock_hz, end_cycle } = result.summary;
  if (comparison.error) {
    // The core writes it as a sentence.
    return { text: `${comparison.error[0].toUpperCase()}${comparison.error.slice(1)}.`, location: null };
  }
  const { after, until, version, controller, shorter } = comparison;
  if (comparison.same || !after || !until) {
    const which = controllers.length > 1 ? `all ${controllers.length} controllers, ` : "";
    const made = version ? ` It was sent by version ${version}; this is ${comparison.own_version}.` : "";
    return {
      text: `Reproduced bit-exactly: ${which}${count(comparison.edges)} edges, digest ${controllers[result.controller].digest}.${made}`,
      location: null,
    };
  }
  const at = (/** @type {import("../state/types.js").Mark} */ mark) =>
    `edge ${count(mark.edge)} (${time(mark.cycle / clock_hz)})`;
  const which = controllers.length > 1 ? ` on controller ${controller + 1}` : "";
  const ends =
    shorter === "this" ? " This run ends there." : shorter === "other" ? " The sender's run ends there." : "";
  const made = version
    ? ` The link was made with version ${version}, this is ${comparison.own_version}. That may be the cause.`
    : "";
  const text = `The run differs from the sender's: the first difference${which} is between ${at(after)} and ${at(until)}.${ends}${made}`;
  return { text, location: locationAround(after.cycle, until.cycle, end_cycle, controller) };
}

/** A window around some cycles, with a margin. @param {number} from @param {number} to @param {number} last @param {number} controller @returns {TraceLocation} */
export function locationAround(from, to, last, controller) {
  const margin = Math.max(MIN_MARGIN_CYCLES, Math.round((to - from) / 20));
  return { start: Math.max(0, from - margin), end: Math.min(last, to + margin), controller, cycle: from };
}
