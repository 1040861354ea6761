/** Requests and texts of the tab Motor. */
import { hasNoLine } from "../../form/source_kinds.js";
import { readJson } from "../../state/json.js";
import { plain, short, si } from "../../state/number.js";
import { get, set } from "../../state/paths.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{rate: Float64Array, available: Float64Array, needed: Float64Array}} Torque */
/** @typedef {{rest_a: number, least_a: number, greatest_a: number, reached_cycles: number | null, settled_cycles: number | null, slot_cycles: number, x: Float64Array, y: Float64Array}} Settling */
/** @typedef {{x: Float64Array, min: Float64Array, max: Float64Array, above_a: number | null, below_a: number | null}} Supply */
/** @typedef {{json: string, controller: number, channel: number, channels: number}} Subject  Scenario as text, and the motor of a channel. */
/** @typedef {ReturnType<typeof noFindings>} Findings */

/** Rates of the resonance map in full steps/s, and the number of rates in one request. */
export const MAP = { from: 20, to: 400, rung: 4, piece: 8 };
/** Rates in the resonance map. */
export const MAP_RATES = Math.floor((MAP.to - MAP.from) / MAP.rung) + 1;
/** Ratio to the peak that counts as settled. */
const SETTLED_RATIO = 0.2;
/** Columns of the supply current. */
const COLUMNS = 1200;

export const noFindings = () => ({
  torque: /** @type {Torque | null} */ (null),
  start: /** @type {number | undefined} */ (undefined),
  pull: /** @type {number | undefined} */ (undefined),
  oscillation: new Float64Array(),
  loses: new Float64Array(),
  step: /** @type {Settling | null} */ (null),
  pair: /** @type {[Supply, Supply] | null} */ (null),
});

/** @param {number} controller */
const busPath = (controller) => (controller > 0 ? `controllers[${controller - 1}].bus` : "bus");

/** The motor of the selected axis; null if its controller was removed. @param {State} state @returns {Subject | null} */
export function subjectOf({ scenario, validation, result, axis }) {
  const controller = result?.controller ?? 0;
  const { bus } = [scenario, ...scenario.controllers][controller] ?? {};
  if (!bus || !validation) return null;
  const { channels } = bus;
  return { json: validation.scenario, controller, channel: Math.min(axis, channels - 1), channels };
}

/** @param {Subject} subject */
export const subjectText = ({ controller, channel }) =>
  `Motor of channel ${channel}${controller > 0 ? ` of controller ${controller + 1}` : ""} alone on its supply.`;

/** @param {Subject} subject @returns {any[][]} */
export function resonancePieces({ json, controller, channel }) {
  return Array.from({ length: Math.ceil(MAP_RATES / MAP.piece) }, (_, index) => {
    const at = index * MAP.piece;
    return [json, controller, channel, MAP.from + at * MAP.rung, MAP.rung, Math.min(MAP.piece, MAP_RATES - at)];
  });
}

/** @param {{oscillation: Float64Array, loses: Float64Array}[]} answers */
export function joinedMap(answers) {
  const joined = (/** @type {"oscillation" | "loses"} */ name) =>
    Float64Array.from(answers.flatMap((answer) => [...answer[name]]));
  return { oscillation: joined("oscillation"), loses: joined("loses") };
}

/** Current below which the supply counts as settled. @param {Settling} settling */
export const settledLimit = ({ rest_a, greatest_a, least_a }) =>
  rest_a + SETTLED_RATIO * Math.max(greatest_a - rest_a, rest_a - least_a);

/** Range of some values with space around them. @param {ArrayLike<number>[]} all */
export function extent(all) {
  let [low, high] = [Infinity, -Infinity];
  for (const values of all)
    for (const value of Array.from(values))
      if (!Number.isNaN(value)) [low, high] = [Math.min(low, value), Math.max(high, value)];
  if (low > high) [low, high] = [0, 1];
  const margin = 0.08 * (high - low) || 1;
  return { min: low - margin, max: high + margin };
}

/** Rows of the table of limits. @param {Findings} findings @returns {string[][]} */
export function limitRows({ start, pull, oscillation, loses }) {
  const rate = (/** @type {number | undefined} */ value) =>
    value === undefined ? "below 500 steps/s" : plain(Math.floor(value), "steps/s");
  const rows = [
    ["Start-stop rate, for one turn", rate(start)],
    ["Pull-out rate with this ramp", rate(pull)],
  ];
  if (oscillation.length === 0) return rows;
  const peak = oscillation.reduce((best, value, at) => (value > oscillation[best] ? at : best), 0);
  const isAtEdge = peak === 0 || peak === oscillation.length - 1;
  return [
    ...rows,
    [
      isAtEdge ? "Maximum oscillation at the edge of the map" : "Maximum oscillation at",
      plain(MAP.from + peak * MAP.rung, "full steps/s"),
    ],
    ["peak to peak", `${short(oscillation[peak], 3)} full steps`],
    ["Rates that lose steps", `${loses.filter((value) => value > 0).length} of ${loses.length}`],
  ];
}

/** @param {Settling} settling @param {number} clock */
export function settlingText({ reached_cycles, settled_cycles, slot_cycles }, clock) {
  const time = (/** @type {number | null} */ cycles) =>
    cycles === null
      ? `not within ${si(slot_cycles / clock, "s")}`
      : `after ${si(cycles / clock, "s")} (${cycles} cycles)`;
  return `One step: the current falls to a fifth of its peak ${time(reached_cycles)} and stays below ${time(settled_cycles)}.`;
}

/** The edit that makes the measured time the bus' settling time; null if none was measured. @param {Findings} findings @param {number} controller */
export function settleEdit({ step }, controller) {
  const value = step?.reached_cycles ?? null;
  return value === null ? null : { path: `${busPath(controller)}.settle_cycles`, value };
}

/** Why simultaneous and staggered pulses are not compared; empty if they are. @param {State} state @param {number} channels */
export function whyNoPair({ validation, approved, revision, scenario }, channels) {
  if (channels < 2) return "Staggering needs more than one motor.";
  if (hasNoLine(scenario))
    return "Segments and stand-alone controllers have no ticks, so their pulses are not staggered.";
  if (validation?.cost?.over_budget && approved !== revision) return "The run takes long; start it to compare.";
  return "";
}

/** The arguments for the supply current of the run with simultaneous and with staggered pulses. @param {Subject} subject @param {number} settle_cycles  The measured time. */
export function pairPieces({ json, controller }, settle_cycles) {
  const path = busPath(controller);
  const scenario = readJson(json);
  const own = get(scenario, path);
  return ["simultaneous", "staggered"].map((kind) => {
    const bus = { ...own, pulse_phasing: kind };
    // If the scenario staggers pulses, its own settling time applies.
    if (kind === "staggered" && own.pulse_phasing !== kind) Object.assign(bus, { settle_cycles });
    return [JSON.stringify(set(scenario, path, bus)), controller, COLUMNS];
  });
}

/** How much less the current deviates from its rest with staggered pulses. @param {[Supply, Supply]} pair */
export function pairText([simultaneous, staggered]) {
  const worst = (/** @type {Supply} */ { above_a, below_a }) =>
    above_a === null ? null : Math.max(above_a, below_a ?? 0);
  const [before, after] = [worst(simultaneous), worst(staggered)];
  if (before === null || after === null) return "Each motor needs at least eight steps.";
  const range = (/** @type {Supply} */ { above_a, below_a }) =>
    `+${short(above_a ?? 0, 3)} A, −${short(below_a ?? 0, 3)} A`;
  return `Deviation of the supply current: ${range(simultaneous)} simultaneous, ${range(staggered)} staggered, ${short(before / after, 3)} times less.`;
}
