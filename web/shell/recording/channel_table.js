/**
 * The table of the channels of a recording with their signals. It can show and edit every channel map
 * (core/capture/src/channel_map.rs).
 */
import { element, fill } from "../../dom.js";

/** @typedef {{motors: number[], message?: undefined} | {motors?: undefined, message: string}} Motors */

/** Maximum motors of a bus. */
const MAX_MOTORS = 16;
/** From this number of channels on, channels with a signal are listed first. */
const MANY_CHANNELS = 17;
/** Signals by group, with their labels. @type {[string, [string, string][]][]} */
const SIGNALS = [
  [
    "Motor",
    [
      ["STEP", "STEP"],
      ["DIR", "DIR"],
      ["DEDGE", "STEP, both edges"],
      ["CW", "CW pulses"],
      ["CCW", "CCW pulses"],
    ],
  ],
  [
    "Encoder",
    [
      ["A", "Encoder A"],
      ["B", "Encoder B"],
    ],
  ],
  ["All motors", [["EN", "EN"]]],
  [
    "Serial line",
    [
      ["RX", "RX"],
      ["TX", "TX"],
      ["DE", "DE"],
    ],
  ],
];
/** Signals with a motor number. */
const MOTOR_SIGNALS = new Set(["STEP", "DIR", "DEDGE", "CW", "CCW", "A", "B"]);

/** @param {string[]} names  Of all channels. */
export function createChannelTable(names) {
  /** @type {ReturnType<typeof channelRow>[]} */
  const rows = names.map((name) => channelRow(name, freeMotor));
  const body = element("tbody", {}, ...rows.map(({ node }) => node));
  const head = ["Channel", "Signal", "Inverted"].map((text) => element("th", { scope: "col" }, text));
  const node = element(
    "div",
    { class: "channel-table" },
    element("table", { class: "channels" }, element("thead", {}, element("tr", {}, ...head)), body),
  );

  /** The first motor without such a signal on another channel. @param {HTMLSelectElement} field */
  function freeMotor(field) {
    const sameSignal = rows.filter((row) => row.field !== field && row.signal() === field.value);
    const used = new Set(sameSignal.flatMap((row) => row.motors()));
    return Array.from({ length: MAX_MOTORS }, (_, motor) => motor).find((motor) => !used.has(motor)) ?? 0;
  }

  return {
    node,
    /** The field to focus if no signal is selected. */
    first: rows[0]?.field,
    /** Shows a map. @param {string} map */
    setMap(map) {
      for (const [index, { signal, motors, isInverted }] of signalsOfMap(map, names))
        rows[index]?.set(signal, motors, isInverted);
      if (rows.length < MANY_CHANNELS) return;
      const isUsed = (/** @type {ReturnType<typeof channelRow>} */ row) => row.signal() !== "";
      fill(body, ...[...rows.filter(isUsed), ...rows.filter((row) => !isUsed(row))].map((row) => row.node));
    },
    /** The map as text, with channel numbers, because a name can contain any character. */
    map: () => rows.flatMap((row, index) => row.mapEntries(index)).join(","),
    isInvalid: () => rows.some((row) => row.isInvalid()),
    /** Whether a channel is one of these signals. @param {string[]} signals */
    has: (...signals) => rows.some((row) => signals.includes(row.signal())),
  };
}

/** The signals of a map by channel. @param {string} map @param {string[]} names */
function signalsOfMap(map, names) {
  /** @type {Map<number, {signal: string, motors: number[], isInverted: boolean}>} */
  const found = new Map();
  for (const pair of map.split(",")) {
    const [left, ...rest] = pair.split("=");
    const channel = rest.join("=");
    const name = channel.replace(/^!/, "");
    const index = /^#\d+$/.test(name) ? Number(name.slice(1)) : names.indexOf(name);
    const [, signal = "", motor = ""] = /^([A-Z]+)(\d*)$/.exec(left) ?? [];
    if (!signal || index < 0) continue;
    const entry = found.get(index) ?? { signal, motors: [], isInverted: channel.startsWith("!") };
    if (motor) entry.motors.push(Number(motor));
    found.set(index, entry);
  }
  return found;
}

/** @param {string} name @param {(field: HTMLSelectElement) => number} freeMotor */
function channelRow(name, freeMotor) {
  const field = element("select", { "aria-label": `Signal of ${name}` }, element("option", { value: "" }, "–"));
  for (const [label, signals] of SIGNALS)
    field.append(element("optgroup", { label }, ...signals.map(([value, text]) => element("option", { value }, text))));
  const error = element("span", { class: "error" });
  const number = element("input", { type: "text", size: "3", "aria-label": `Motor of ${name}` });
  const inverted = element("input", { type: "checkbox", "aria-label": `${name} is inverted` });
  const isOfMotor = () => MOTOR_SIGNALS.has(field.value);
  /** @returns {Motors} */
  const read = () => (isOfMotor() ? readMotors(number.value, field.value === "DIR") : { motors: [] });
  let lastSignal = "";

  function show() {
    number.hidden = !isOfMotor();
    number.title = field.value === "DIR" ? "Motor; several as 0, 1" : "Motor";
    const found = read();
    error.textContent = found.message ?? "";
    number.setAttribute("aria-invalid", String(found.message !== undefined));
  }
  field.addEventListener("input", () => {
    // The number stays when the signal of a motor changes.
    if (isOfMotor() && !MOTOR_SIGNALS.has(lastSignal)) number.value = String(freeMotor(field));
    lastSignal = field.value;
    show();
  });
  number.addEventListener("input", show);
  show();
  const cell = (/** @type {(Node | string)[]} */ ...children) => element("td", {}, ...children);
  return {
    node: element(
      "tr",
      {},
      cell(name),
      cell(field, " ", number, error),
      cell(element("label", { class: "check" }, inverted)),
    ),
    field,
    signal: () => field.value,
    motors: () => read().motors ?? [],
    isInvalid: () => read().message !== undefined,
    /** @param {string} signal @param {number[]} motors @param {boolean} isInverted */
    set(signal, motors, isInverted) {
      field.value = signal;
      lastSignal = field.value;
      number.value = motors.join(", ");
      inverted.checked = isInverted;
      show();
    },
    /** @param {number} index */
    mapEntries(index) {
      const channel = `${inverted.checked ? "!" : ""}#${index}`;
      const signals = isOfMotor() ? (read().motors ?? []).map((motor) => `${field.value}${motor}`) : [field.value];
      return signals.filter((signal) => signal !== "").map((signal) => `${signal}=${channel}`);
    },
  };
}

/** Reads motor numbers: `0`, or for a shared DIR `0, 1` or `0-3`. @param {string} text @param {boolean} isShared @returns {Motors} */
function readMotors(text, isShared) {
  const allowed = `use 0 to ${MAX_MOTORS - 1}${isShared ? ", several as 0, 1" : ""}`;
  const motors = new Set();
  for (const part of text.split(/[\s,;]+/).filter((each) => each !== "")) {
    const [, from, to = from] = /^(\d+)(?:[-–](\d+))?$/.exec(part) ?? [];
    if (from === undefined) return { message: `“${part}” is not a motor; ${allowed}.` };
    if (Number(to) >= MAX_MOTORS) return { message: `Motor ${to} is out of range; ${allowed}.` };
    for (let motor = Number(from); motor <= Number(to); motor++) motors.add(motor);
  }
  if (motors.size === 0) return { message: `The motor is missing; ${allowed}.` };
  if (motors.size > 1 && !isShared) return { message: "Only DIR can be shared by several motors; use one." };
  return { motors: [...motors] };
}
