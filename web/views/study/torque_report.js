/** Texts and rows of the tab Torque. */
import { count, plain, short, si } from "../../state/number.js";

/** @typedef {{at_s: number, rate: number, needed_mn_m: number, available_mn_m: number}} Moment */
/** @typedef {{index: number, duration_s: number, longest_s: number | null, too_fast: boolean, room_s: number, enough_s: [number, number] | null,
 *   too_fast_s: [number, number] | null, without_ramps: boolean}} Ramps */
/**
 * @typedef {{standing_mn_m: number, load_mn_m: number, corner_rate: number | null, torque_rate: number | null, working_rate: number | null,
 *   over_working_rate: number | null, jump: number, least: Moment | null, total: number, window_s: number | null,
 *   shortages: {from_s: number, to_s: number, times: number, worst: Moment}[], ramps: Ramps[]}} Report
 * @typedef {{report: Report, rate: Float64Array, available: Float64Array, needed: Float64Array}} Torque
 */

/** @param {number} torque In mN·m. */
const torqueText = (torque) => `${short(torque, 4)} mN·m`;
/** @param {number} rate */
const rateText = (rate) => plain(rate, "steps/s");
/** @param {number | null} rate */
const upTo = (rate) => (rate === null ? "any rate" : rate === 0 ? "no rate" : rateText(Math.floor(rate)));
/** @param {number} seconds */
const rampText = (seconds) => `${seconds.toFixed(4)} s`;

/** Ramps with enough torque; if there are none, whether rate or torque is the limit. @param {Ramps} ramps */
function enoughText({ enough_s, too_fast_s, without_ramps }) {
  if (enough_s) return `${enough_s[0].toFixed(4)} to ${rampText(enough_s[1])}`;
  const all = too_fast_s ? "all above the working rate" : "none";
  return without_ramps ? `without ramps only; with ramps ${all}` : all;
}

/** @param {Report} report @returns {string[][]} */
export function motorRows({ standing_mn_m, load_mn_m, corner_rate, torque_rate, working_rate, least, jump }) {
  const standing =
    corner_rate === 0
      ? [
          ["Torque at standstill", torqueText(standing_mn_m)],
          ["full current up to", "no rate: the supply is too low"],
        ]
      : [
          ["Full torque", torqueText(standing_mn_m)],
          ["full torque up to", upTo(corner_rate)],
        ];
  return [
    ...standing,
    ["Load", torqueText(load_mn_m)],
    ["enough torque for the load up to", upTo(torque_rate)],
    ...(working_rate === null ? [] : [["Stated working rate", rateText(working_rate)]]),
    ...(least
      ? [
          ["Minimum margin", torqueText(least.available_mn_m - Math.abs(least.needed_mn_m))],
          ["at", `${si(least.at_s, "s")}, ${rateText(least.rate)}`],
        ]
      : []),
    ...(jump > 0 ? [["Maximum jump of speed", rateText(jump)]] : []),
  ];
}

/** Warnings about rate and torque; empty if the torque is enough. @param {Report} report */
export function shortageText({ over_working_rate, total }) {
  const tooFast =
    over_working_rate === null
      ? ""
      : `⚠ ${rateText(over_working_rate)} exceed the stated working rate: use more time or shorter ramps. `;
  const tooLittle =
    total === 0
      ? ""
      : `⚠ Too little torque in ${total === 1 ? "one interval" : `${count(total)} intervals`}: use more time, longer ramps, less load or a higher supply voltage.`;
  return tooFast + tooLittle;
}

/** @param {Report} report @returns {string[][]} */
export function shortageRows({ shortages }) {
  return shortages.map(({ from_s, to_s, times, worst: { at_s, rate, needed_mn_m, available_mn_m } }) => [
    si(from_s, "s"),
    si(to_s, "s"),
    torqueText(Math.abs(needed_mn_m) - available_mn_m),
    si(at_s, "s"),
    rateText(rate),
    torqueText(needed_mn_m),
    torqueText(available_mn_m),
    count(times),
  ]);
}

/** @param {Report} report @returns {string[][]} */
export function rampRows({ ramps }) {
  return ramps.map((ramp) => [
    `${ramp.index + 1}, ${si(ramp.duration_s, "s")}`,
    enoughText(ramp),
    ramp.longest_s === null ? (ramp.too_fast ? "too fast" : "any") : rampText(ramp.longest_s),
    rampText(ramp.room_s),
  ]);
}

/** The limits of the model. @param {Report} report */
export function modelNote({ window_s, ramps, jump }) {
  const window =
    window_s === null
      ? ""
      : `The acceleration of steps is averaged over the natural period of the rotor, ${si(window_s, "s")}. `;
  const ramp = ramps.length
    ? "Enough torque: ramps for which the torque suffices. Longest ramp for the rate limit: T − n/f_s, for ramps whose mean rate is half the peak rate; f_s is the maximum rate with the load. The longest possible ramp is T/2. "
    : "";
  const jumps =
    jump > 0 ? "A motor follows a jump of speed up to its start-stop rate, which is not part of these data. " : "";
  return `${window}${ramp}${jumps}The model includes only the fundamental wave: no saturation, no iron or friction losses, no resonance.`;
}

/** @param {number} channel @param {string} motor  Name of a motor of the list; empty for the channel's own. @param {Report} report */
export function stepsText(channel, motor, { least }) {
  if (!least) return `Channel ${channel} has no steps, so it needs no torque.`;
  const which = motor === "" ? "its motor" : "this motor (16 microsteps, 24 V, no load)";
  return `Channel ${channel}: torque of ${which} and torque needed by the steps; there is no plan.`;
}
