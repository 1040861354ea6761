/** Names of panel numbers (CONTROLLER.md G2, G8): inputs, states, alarms, display and LED. */

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
/** The same for a reader. @type {{[trust: string]: string}} */
const POSITION = { LOST: "lost", HELD: "restored", SURE: "confirmed" };
/** The numbers of EDIT, followed by five numbers per move. */
const NUMBERS = [
  "pulses per unit",
  "decimals",
  "jog speed",
  "fine jog speed",
  "return speed",
  "return level",
  "loops",
  "used groups",
];
const OF_MOVE = ["length", "speed", "direction", "level", "delay"];

/** @typedef {{state: string, alarm: string, trust: string, outputs: number, group: number, loop: number}} Word */

/** The fields of a panel word of 48 bits. @param {number} word @returns {Word} */
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

/** Advice for each alarm and each unconfirmed position; @ is how to set the position. @type {{[of: string]: string}} */
const ADVICE = {
  ESTOP: "Release the emergency stop, then clear.",
  LIMIT: "Clear, then jog off the switch.",
  SOFT_LIMIT: "Clear. The move would exceed the soft limits.",
  HOMING: "Clear. Homing did not find the switch.",
  TRUST: "Clear. The position is lost: @.",
  TIMEOUT: "Clear. The input timed out.",
  MEMORY: "Clear. The memory is invalid: @.",
  LOST: "The position is lost: @.",
  HELD: "The position is restored. Debug, ok sets zero here and confirms it.",
};

/** What to do next, if anything. @param {Word} word @param {boolean} hasHome  Whether homing is set up. */
export function advice({ state, alarm, trust }, hasHome) {
  const known = `${hasHome ? "home, or " : ""}jog to a known position, then debug, ok`;
  return state === "OFF" ? "" : (ADVICE[alarm] ?? ADVICE[trust] ?? "").replace("@", known);
}

/** The state of a panel as text. @param {Word} word @param {{groups: number, loops: number}} program */
export function sentence({ state, alarm, trust, group, loop }, { groups, loops }) {
  const where =
    state === "EDIT"
      ? `number ${group}: ${numberName(group)}`
      : group > 0
        ? `group ${group}/${groups}, loop ${loop}/${loops}`
        : "not running";
  return `${state}${alarm ? ` ${alarm}` : ""} · position ${POSITION[trust] ?? trust} · ${where}`;
}
