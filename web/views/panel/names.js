/** The names of a panel's numbers (CONTROLLER.md G2, G8): inputs, states, alarms, trust; its display and its LED. */

/** Inputs in the core's order. */
export const INPUTS = [
  "power",
  "estop",
  "clear",
  "start",
  "pause",
  "jog_plus",
  "jog_minus",
  "zero",
  "home",
  "debug",
  "system",
  "ok",
  "back",
  ...Array.from({ length: 10 }, (_, digit) => `key_${digit}`),
  "limit_min",
  "limit_max",
  "home_switch",
  ...Array.from({ length: 4 }, (_, input) => `in_${input}`),
];
/** Those that are the first controller's for all. */
export const SHARED = ["power", "estop", "clear"];
/** Those that stay as they are put. */
export const SWITCHES = INPUTS.slice(23);

export const STATES = [
  "OFF",
  "SELF_TEST",
  "READY",
  "RUNNING",
  "DELAY",
  "WAIT",
  "PAUSING",
  "PAUSED",
  "JOG",
  "RETURNING",
  "HOMING",
  "DEBUG",
  "EDIT",
  "ALARM",
  "POWER_LOSS",
];
const ALARMS = ["", "ESTOP", "LIMIT", "SOFT_LIMIT", "HOMING", "TRUST", "TIMEOUT", "MEMORY"];
export const TRUST = ["LOST", "HELD", "SURE"];
/** What EDIT goes through; after these five of each move. */
const NUMBERS = [
  "pulses_per_unit",
  "decimals",
  "jog.speed_hz",
  "jog.fine_hz",
  "return.speed_hz",
  "return.level",
  "loops",
  "used groups",
];
const OF_MOVE = ["length", "speed_hz", "direction", "level", "delay_ms"];

/** @typedef {{state: string, alarm: string, trust: string, outputs: number, group: number, loop: number}} Word */

/** What stands in a panel's word; it has 48 bits. @param {number} word @returns {Word} */
export function read(word) {
  const [low, high] = [word % 2 ** 32, Math.floor(word / 2 ** 32)];
  return {
    state: STATES[low & 15],
    alarm: ALARMS[(low >>> 4) & 15],
    trust: TRUST[(low >>> 8) & 3],
    outputs: (low >>> 12) & 15,
    group: (low >>> 16) & 0x1ff,
    loop: high,
  };
}

/** Six digits. @param {number} display @param {number} decimals */
export function lcd(display, decimals) {
  if (display > 999_999 || display < -99_999) return "------";
  const digits = String(Math.abs(display)).padStart(decimals + 1, "0");
  const text = decimals ? `${digits.slice(0, -decimals)}.${digits.slice(-decimals)}` : digits;
  return `${display < 0 ? "-" : ""}${text}`.padStart(6);
}

/** @param {Word} word @returns {"quick" | "on" | "slow"} */
export function led({ state, trust }) {
  if (state === "ALARM") return "quick";
  return ["READY", "DEBUG", "EDIT", "PAUSED"].includes(state) && trust === "SURE" ? "on" : "slow";
}

/** The number that EDIT shows. @param {number} number */
export function numberName(number) {
  if (number < NUMBERS.length) return NUMBERS[number];
  const at = number - NUMBERS.length;
  return `${OF_MOVE[at % OF_MOVE.length]} of move ${Math.floor(at / OF_MOVE.length) + 1}`;
}

/** What each alarm asks for, and a trust that is not sure; @ is how the place becomes known. @type {{[of: string]: string}} */
const ADVICE = {
  ESTOP: "Release the emergency stop, then clear.",
  LIMIT: "Clear, then jog off the switch.",
  SOFT_LIMIT: "Clear; the move would have left the soft limits.",
  HOMING: "Clear; the switch was not found where homing looks.",
  TRUST: "Clear. The place is not known: @.",
  TIMEOUT: "Clear; the input did not come in time.",
  MEMORY: "Clear. Nothing is remembered: @.",
  LOST: "The place is not known: @.",
  HELD: "The place that was kept. Debug, ok makes where it stands the zero, and sure.",
};

/** What to do next, where something is to be done. @param {Word} word @param {boolean} hasHome  Whether homing is set up. */
export function advice({ state, alarm, trust }, hasHome) {
  const known = `${hasHome ? "home, or " : ""}jog to a known place, then debug, ok`;
  return state === "OFF" ? "" : (ADVICE[alarm] ?? ADVICE[trust] ?? "").replace("@", known);
}

/** What a panel says, in words. @param {Word} word @param {{groups: number, loops: number}} program  As its numbers rule it. */
export function sentence({ state, alarm, trust, group, loop }, { groups, loops }) {
  const where =
    state === "EDIT"
      ? `number ${group}: ${numberName(group)}`
      : group > 0
        ? `group ${group}/${groups}, loop ${loop}/${loops}`
        : "not running";
  return `${state}${alarm ? ` ${alarm}` : ""} · trust ${trust} · ${where}`;
}
