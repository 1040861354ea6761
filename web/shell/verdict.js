/** Text of the comparison with the run of the sender of a link. */
import { count, time } from "../state/number.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Place} Place */
/** @typedef {import("../state/types.js").Verdict} Verdict */

/** What a verdict says, and the place that is meant. @param {Verdict} verdict @param {State} state @returns {{text: string, place: Place | null}} */
export function verdictText(verdict, { result }) {
  if (!result) return { text: "", place: null };
  const { controllers, clock_hz, end_cycle } = result.summary;
  if (verdict.error) {
    // A sentence of the core's.
    return { text: `${verdict.error[0].toUpperCase()}${verdict.error.slice(1)}.`, place: null };
  }
  const { after, until, version, controller, shorter } = verdict;
  if (verdict.same || !after || !until) {
    const which = controllers.length > 1 ? `all ${controllers.length} controllers, ` : "";
    const made = version ? ` It was sent by version ${version}; this is ${verdict.own_version}.` : "";
    return {
      text: `Reproduced bit-exactly: ${which}${count(verdict.edges)} edges, digest ${controllers[result.controller].digest}.${made}`,
      place: null,
    };
  }
  const at = (/** @type {import("../state/types.js").Mark} */ mark) =>
    `edge ${count(mark.edge)} (${time(mark.cycle / clock_hz)})`;
  const which = controllers.length > 1 ? ` on controller ${controller + 1}` : "";
  const ends =
    shorter === "this" ? " This run ends there." : shorter === "other" ? " The sender's run ends there." : "";
  const made = version
    ? ` The link was made with version ${version}, this is ${verdict.own_version}. That may be the cause.`
    : "";
  const text = `The run differs from the sender's: the first difference${which} is between ${at(after)} and ${at(until)}.${ends}${made}`;
  return { text, place: around(after.cycle, until.cycle, end_cycle, controller) };
}

/** A stretch with some air around it. @param {number} from @param {number} to @param {number} last @param {number} controller @returns {Place} */
export function around(from, to, last, controller) {
  const air = Math.max(200, Math.round((to - from) / 20));
  return { start: Math.max(0, from - air), end: Math.min(last, to + air), controller, cycle: from };
}
