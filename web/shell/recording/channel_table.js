/**
 * The table of a recording's channels, each with its signals: it shows and edits all that a channel map can say
 * (core/capture/src/channel_map.rs).
 */
import { element, fill } from "../../dom.js";

/** @typedef {{motors: number[], message?: undefined} | {motors?: undefined, message: string}} Motors */

/** Motors of one bus. */
const MOTORS = 16;
/** From this many channels on, those that have a signal come first. */
const MANY = 17;
/** Signals by kind, each with its name in the table. @type {[string, [string, string][]][]} */
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
/** Signals that each motor has of its own. */
const OF_A_MOTOR = new Set(["STEP", "DIR", "DEDGE", "CW", "CCW", "A", "B"]);

/** @param {string[]} names  Of all channels. */
export function createChannelTable(names) {
  /** @type {ReturnType<typeof channelRow>[]} */
  const rows = names.map((name) => channelRow(name, free));
  const body = element("tbody", {}, ...rows.map(({ node }) => node));
  const head = ["Channel", "Signal", "Inverted"].map((text) => element("th", { scope: "col" }, text));
  const node = element(
    "div",
    { class: "channel-table" },
    element("table", { class: "channels" }, element("thead", {}, element("tr", {}, ...head)), body),
  );

  /** The first motor without such a signal on another channel. @param {HTMLSelectElement} field */
  function free(field) {
    const others = rows.filter((row) => row.field !== field && row.signal() === field.value);
    const taken = new Set(others.flatMap((row) => row.motors()));
    return Array.from({ length: MOTORS }, (_, motor) => motor).find((motor) => !taken.has(motor)) ?? 0;
  }

  return {
    node,
    /** The field that comes first where nothing is selected. */
    first: rows[0]?.field,
    /** Shows a map. @param {string} map */
    put(map) {
      for (const [index, { signal, motors, isInverted }] of pairs(map, names))
        rows[index]?.put(signal, motors, isInverted);
      if (rows.length < MANY) return;
      const isUsed = (/** @type {ReturnType<typeof channelRow>} */ row) => row.signal() !== "";
      fill(body, ...[...rows.filter(isUsed), ...rows.filter((row) => !isUsed(row))].map((row) => row.node));
    },
    /** The map as text. Channels go by their numbers, since a name may contain anything. */
    map: () => rows.flatMap((row, index) => row.pairs(index)).join(","),
    isWrong: () => rows.some((row) => row.isWrong()),
    /** Whether a channel is one of these signals. @param {string[]} signals */
    has: (...signals) => rows.some((row) => signals.includes(row.signal())),
  };
}

/** The channels of a map's text, each with its signal. @param {string} map @param {string[]} names */
function pairs(map, names) {
  /** @type {Map<number, {signal: string, motors: number[], isInverted: boolean}>} */
  const found = new Map();
  for (const pair of map.split(",")) {
    const [left, ...rest] = pair.split("=");
    const channel = rest.join("=");
    const name = channel.replace(/^!/, "");
    const index = /^#\d+$/.test(name) ? Number(name.slice(1)) : names.indexOf(name);
    const [, signal = "", motor = ""] = /^([A-Z]+)(\d*)$/.exec(left) ?? [];
    if (!signal || index < 0) continue;
    const own = found.get(index) ?? { signal, motors: [], isInverted: channel.startsWith("!") };
    if (motor) own.motors.push(Number(motor));
    found.set(index, own);
  }
  return found;
}

/** @param {string} name @param {(field: HTMLSelectElement) => number} free */
function channelRow(name, free) {
  const field = element("select", { "aria-label": `Signal of ${name}` }, element("option", { value: "" }, "–"));
  for (const [label, signals] of SIGNALS)
    field.append(element("optgroup", { label }, ...signals.map(([value, text]) => element("option", { value }, text))));
  const error = element("span", { class: "error" });
  const number = element("input", { type: "text", size: "3", "aria-label": `Motor of ${name}` });
  const inverted = element("input", { type: "checkbox", "aria-label": `${name} is inverted` });
  const isOfMotor = () => OF_A_MOTOR.has(field.value);
  /** @returns {Motors} */
  const read = () => (isOfMotor() ? readMotors(number.value, field.value === "DIR") : { motors: [] });
  let last = "";

  function show() {
    number.hidden = !isOfMotor();
    number.title = field.value === "DIR" ? "Motor; several as 0, 1" : "Motor";
    const found = read();
    error.textContent = found.message ?? "";
    number.setAttribute("aria-invalid", String(found.message !== undefined));
  }
  field.addEventListener("input", () => {
    // From one signal of a motor to another the number stays.
    if (isOfMotor() && !OF_A_MOTOR.has(last)) number.value = String(free(field));
    last = field.value;
    show();
  });
  number.addEventListener("input", show);
  show();
  const cell = (/** @type {(Node | string)[]} */ ...what) => element("td", {}, ...what);
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
    isWrong: () => read().message !== undefined,
    /** @param {string} signal @param {number[]} motors @param {boolean} isInverted */
    put(signal, motors, isInverted) {
      field.value = signal;
      last = field.value;
      number.value = motors.join(", ");
      inverted.checked = isInverted;
      show();
    },
    /** @param {number} index */
    pairs(index) {
      const channel = `${inverted.checked ? "!" : ""}#${index}`;
      const signals = isOfMotor() ? (read().motors ?? []).map((motor) => `${field.value}${motor}`) : [field.value];
      return signals.filter((signal) => signal !== "").map((signal) => `${signal}=${channel}`);
    },
  };
}

/** Motors as they are typed: `0`, and of a shared DIR `0, 1` or `0-3`. @param {string} text @param {boolean} isShared @returns {Motors} */
function readMotors(text, isShared) {
  const allowed = `use 0 to ${MOTORS - 1}${isShared ? ", several as 0, 1" : ""}`;
  const motors = new Set();
  for (const part of text.split(/[\s,;]+/).filter((each) => each !== "")) {
    const [, from, to = from] = /^(\d+)(?:[-–](\d+))?$/.exec(part) ?? [];
    if (from === undefined) return { message: `“${part}” is not a motor; ${allowed}.` };
    if (Number(to) >= MOTORS) return { message: `Motor ${to} is out of range; ${allowed}.` };
    for (let motor = Number(from); motor <= Number(to); motor++) motors.add(motor);
  }
  if (motors.size === 0) return { message: `The motor is missing; ${allowed}.` };
  if (motors.size > 1 && !isShared) return { message: "Only DIR can be shared by several motors; use one." };
  return { motors: [...motors] };
}
