/** Names of panel numbers (CONTROLLER.md G2, G8): inputs, states, alarms, display and LED. */

/** Inputs in the order of the core. */
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
/** Inputs of the first controller that all controllers share. */
export const SHARED = ["power", "estop", "clear"];
/** Inputs that keep their level. */
export const SWITCHES = INPUTS.slice(23);

/** Labels of inputs whose name is not their label. @type {{[input: string]: string}} */
const INPUT_LABELS = {
  estop: "emergency stop",
  jog_plus: "jog right",
  jog_minus: "jog left",
  limit_min: "left limit switch",
  limit_max: "right limit switch",
};

/** The label of an input. @param {string} input */
export const inputLabel = (input) => INPUT_LABELS[input] ?? input.replace("in_", "input ").replace("_", " ");

/** The label of an input where space is short. @param {string} input */
export const shortInputLabel = (input) =>
  inputLabel(input).replace("emergency stop", "e-stop").replace("limit switch", "limit");

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
/** Labels of the levels of trust in the position. @type {{[trust: string]: string}} */
export const POSITION = { LOST: "lost", HELD: "restored", SURE: "confirmed" };
/** The numbers of the state EDIT, followed by five numbers per move (`MOVE_NUMBERS`). */
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
const MOVE_NUMBERS = ["length", "speed", "direction", "level", "delay"];

/** @typedef {{state: string, alarm: string, trust: string, outputs: number, group: number, loop: number}} Word */

/** The fields of a panel word of 48 bits; an unknown code is shown as its number. @param {number} word @returns {Word} */
export function read(word) {
  const [low, high] = [word % 2 ** 32, Math.floor(word / 2 ** 32)];
  return {
    state: named(STATES, low & 15),
    alarm: named(ALARMS, (low >>> 4) & 15),
    trust: named(TRUST, (low >>> 8) & 3),
    outputs: (low >>> 12) & 15,
    group: (low >>> 16) & 0x1ff,
    loop: high,
  };
}

/** @param {string[]} names @param {number} code */
const named = (names, code) => names[code] ?? `unknown (${code})`;

/** A number on the display: six digits, or dashes if it does not fit. @param {number} display @param {number} decimals */
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

/** The name of a number in the state EDIT. @param {number} number */
export function numberName(number) {
  if (number < NUMBERS.length) return NUMBERS[number];
  const at = number - NUMBERS.length;
  return `${MOVE_NUMBERS[at % MOVE_NUMBERS.length]} of move ${Math.floor(at / MOVE_NUMBERS.length) + 1}`;
}

/** Advice for each alarm and each unconfirmed position; `@` stands for how to set the position. @type {{[of: string]: string}} */
const ADVICE = {
  ESTOP: "Release the emergency stop, then press clear.",
  LIMIT: "Press clear, then jog off the switch.",
  SOFT_LIMIT: "The move would exceed the soft limits. Press clear.",
  HOMING: "Homing did not find the switch. Press clear.",
  TRUST: "The position is lost. Press clear, then @.",
  TIMEOUT: "The wait for the input timed out. Press clear.",
  MEMORY: "The memory is invalid. Press clear, then @.",
  LOST: "The position is lost. To set it, @.",
  HELD: "The position is restored, but not confirmed. To set zero here, press debug, then ok.",
};

/** The next action for the user; empty if there is none. @param {Word} word @param {boolean} hasHome  Whether homing is set up. */
export function advice({ state, alarm, trust }, hasHome) {
  const howToSet = `${hasHome ? "press home, or " : ""}jog to a known position and press debug, then ok`;
  return state === "OFF" ? "" : (ADVICE[alarm] ?? ADVICE[trust] ?? "").replace("@", howToSet);
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
