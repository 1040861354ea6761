/**
 * What the form asks for: one row a field, with its unit, its range in words, and how it is typed. Ranges
 * are judged by the core; the words here only help to give a number it accepts.
 */
import { RULES } from "../views/rules.js";

/**
 * @typedef {object} Field
 * @property {string} key     Name in the scenario.
 * @property {string} label
 * @property {string} hint    What it is, and its range.
 * @property {"number" | "integer" | "optional" | "cycles" | "optional-cycles" | "choice" | "quantity" | "text" | "hex" | "optional-hex" | "lines" | "segments"} kind
 *   `optional…` may be empty (null); `cycles` also takes a time; `lines` is one hex packet a line, `segments` one
 *   segment.
 * @property {string} [unit]
 * @property {{[value: string]: string}} [choices]
 * @property {{[unit: string]: string}} [units]  Of a quantity: JSON's name to the printed one.
 * @property {number} [rows]
 * @property {{key?: string, path?: string, is: string}} [when]  Only of use while a field beside it, or one at a path, has this value.
 */

/** @typedef {{label: string, fields: Field[]}} Kind */

const DISTANCE = { steps: "steps", mm: "mm", deg: "°" };
const SPEED = { steps_s: "steps/s", mm_s: "mm/s", deg_s: "°/s", rpm: "rpm" };
const ACCELERATION = { steps_s2: "steps/s²", mm_s2: "mm/s²", deg_s2: "°/s²" };

/** @param {string} key @param {string} label @param {string} unit @param {string} hint @returns {Field} */
const number = (key, label, unit, hint) => ({ key, label, unit, hint, kind: "number" });
/** @param {string} key @param {string} label @param {string} unit @param {string} hint @returns {Field} */
const integer = (key, label, unit, hint) => ({ key, label, unit, hint, kind: "integer" });
/** @param {string} key @param {string} label @param {string} hint @returns {Field} */
const cycles = (key, label, hint) => ({ key, label, unit: "cycles", hint: `${hint} A time such as 2.5 us is taken too.`, kind: "cycles" });
/** @param {string} key @param {string} label @param {{[unit: string]: string}} units @param {string} hint @returns {Field} */
const quantity = (key, label, units, hint) => ({ key, label, units, hint, kind: "quantity" });

const FULL_STEP = number("full_step_deg", "Full step", "°", "Angle of the motor's full step, above 0; 1.8° is 200 a turn.");
const MICROSTEPS = integer("microsteps", "Microsteps", "", "In a full step, 1 to 512.");

/** How an axis turns steps into millimetres and degrees. @type {{[kind: string]: Kind}} */
export const MECHANICS = {
  rotary: { label: "Rotary shaft", fields: [FULL_STEP, MICROSTEPS] },
  wheel: { label: "Wheel, pulley or gear", fields: [FULL_STEP, MICROSTEPS, number("radius_mm", "Radius", "mm", "Above 0; 2π × radius is the way of one turn.")] },
  screw: { label: "Lead screw", fields: [FULL_STEP, MICROSTEPS, number("lead_mm", "Lead", "mm", "Above 0; way of the nut in one turn.")] },
  direct: { label: "Length of a step", fields: [number("step_mm", "One step", "mm", "Above 0; measured or given length of one step.")] },
};

/** What a move can be. @type {{[kind: string]: Kind}} */
export const MOVES = {
  cosine: {
    label: "Cosine S-curve",
    fields: [
      quantity("distance", "Distance", DISTANCE, "Negative is left. Reached exactly."),
      number("duration_s", "Duration", "s", "Time of the whole move, above 0. Kept exactly."),
      number("ramp_s", "Ramp", "s", "Time of each ramp, at most half of the duration."),
    ],
  },
  trapezoid: {
    label: "Trapezoid",
    fields: [
      quantity("distance", "Distance", DISTANCE, "Negative is left."),
      quantity("start_speed", "Start speed", SPEED, "Speed of the first step, above 0."),
      quantity("top_speed", "Top speed", SPEED, "Speed of the plateau, at least the start speed; short moves do not reach it."),
      quantity("acceleration", "Acceleration", ACCELERATION, "Above 0; also of the slowing down."),
      { key: "method", label: "Step times", kind: "choice", choices: { table: "table and timer", exact: "exact" }, hint: "Whole rates from a table and a timer's whole reloads, as the document has them; or the ideal curve's own times." },
      { ...integer("timer_hz", "Timer clock", "Hz", "Counts the table's reloads."), when: { key: "method", is: "table" } },
    ],
  },
  staircase: {
    label: "Staircase of rates",
    fields: [
      quantity("distance", "Distance", DISTANCE, "Negative is left."),
      quantity("top_speed", "Top speed", SPEED, "Speed of the plateau; at or below the start speed that of the whole move."),
      integer("level", "Acceleration level", "", "1 to 5: 1000 to 5000 steps/s²."),
      { key: "short_move", label: "Short moves", kind: "choice", choices: { document: "at start speed", turn_round: "turn round" }, hint: "What becomes of a move that is too short for its top speed: the whole of it at the start speed, as in the document, or up as many rows as there is room for and down again." },
      quantity("start_speed", "Start speed", SPEED, "First rate of the table."),
      quantity("max_speed", "Table ends above", SPEED, "The table ends with the first rate above this; no top speed may be above it."),
    ],
  },
  sine_segments: {
    label: "Sine in segments",
    fields: [
      quantity("amplitude", "Amplitude", DISTANCE, "From the middle to an extreme, above 0."),
      number("period_s", "Period", "s", "Time of one period, above 0."),
      integer("periods", "Periods", "", "How many whole periods, from 1."),
      number("max_deviation", "Deviation d1", "× A", "Largest distance of a segment from the sine, d1; 0.002 to 0.015 in the document."),
    ],
  },
  constant: {
    label: "Constant rate",
    fields: [quantity("distance", "Distance", DISTANCE, "Negative is left."), quantity("speed", "Speed", SPEED, "From the first step to the last, above 0.")],
  },
  dwell: { label: "Dwell", fields: [number("duration_s", "Duration", "s", "Standing still, from 0.")] },
};

/** @type {Field} */
export const PACKET_LINES = { key: "packets", label: "Packets, one a line", kind: "lines", rows: 8, hint: "Hex, one byte a channel: bit 7 is the direction (1 right), bits 6 to 0 the steps. A raw line with addresses has the address first. One packet orders one tick." };

/** What runs a motion. @type {Field} */
export const ENGINE = { key: "engine", label: "Steps made by", kind: "choice", choices: { ticks: "ticks", segments: "segments" }, hint: "Ticks: the host sends the steps of each tick. Segments: nothing is sent; the peripheral makes each step in the cycle in which it falls due." };

/** A channel's list of segments. @type {Field[]} */
export const SEGMENTS = [
  cycles("start_cycle", "Start", "Cycle in which the list's time begins, from 1."),
  { key: "segments", label: "Segments, one a line", kind: "segments", rows: 5, hint: "Count, interval, growth of the interval, direction: 20 1048576000 -500 right; or dwell 65536000. Times in 1/65536 cycle." },
];

/** Only on a framed line. */
const FRAMED = { path: "line.protocol", is: "framed" };

/** @type {Field[]} */
export const SEND = [
  cycles("start_cycle", "Start", "Cycle in which the first start bit falls, from 1."),
  { key: "bytes", label: "Bytes", kind: "hex", hint: "Hex, sent back to back." },
  { key: "frame", label: "Or a frame", kind: "optional-hex", hint: "In place of bytes: address, kind and body in hex, such as ff 05 (STOP for all); check, COBS and end mark are added.", when: FRAMED },
];

/** @type {Field[]} */
export const GLITCH = [
  cycles("start_cycle", "Start", "First forced cycle, from 1."),
  cycles("length_cycles", "Length", "From 1."),
  { key: "level", label: "Level", kind: "choice", choices: { 0: "0 (low)", 1: "1 (high)" }, hint: "Forced on the line whatever is sent; the later entry wins." },
];

/** @type {Field} */
const RECEIVER_BAUD = { key: "receiver_baud", label: "Receiver's rate", unit: "baud", kind: "optional", hint: "Where the receiver's clock differs from the host's, 1 to 100 000 000; empty for the same." };

/** @type {Field[]} */
const LINE = [
  integer("baud", "Bit rate", "baud", "8N1; 1 to 100 000 000, at least 11 clock cycles a bit."),
  RECEIVER_BAUD,
  { key: "protocol", label: "Protocol", kind: "choice", choices: { raw: "raw", framed: "framed" }, hint: "Raw: bytes and pauses, as in RU 2704486, with no check and no answer. Framed: each frame has a check and a sequence number, is answered, and is repeated until it is." },
  { key: "address", label: "Address", unit: "", kind: "optional", hint: "0 to 254; empty for none: raw packets then begin with no address, and a framed controller has 0. 255 addresses all." },
];

/** How the host of a framed line behaves. @type {Field[]} */
const HOST = [
  integer("ticks_a_frame", "Ticks in a frame", "", "At most, 1 to 32; and at most half of the queue."),
  { key: "reply_timeout_cycles", label: "Reply time-out", unit: "cycles", kind: /** @type {const} */ ("optional-cycles"), hint: "How long a reply is waited for, from the end of the frame to the end of the reply, 1 to 2³² − 1; empty for 256 bit times. A time such as 3 ms is taken too." },
  integer("attempts", "Attempts", "", "How often one frame is sent before the host gives up, 1 to 255."),
].map((field) => ({ ...field, when: FRAMED }));

/** @param {string} key @param {string} label @param {string} hint */
const rate = (key, label, hint) => integer(`${key}_ppm`, label, "ppm", `${hint} In millionths, 0 to 1 000 000.`);
/** @type {Field[]} */
const NOISE = [
  integer("seed", "Seed", "", "0 to 2³² − 1. The same seed gives the same noise."),
  rate("flipped_bits", "Bits turned over", "Of all bits of all bytes, both ways."),
  rate("lost_bytes", "Bytes lost", "Of all bytes, both ways."),
  rate("doubled_bytes", "Bytes doubled", "Of all bytes, both ways."),
  rate("glitches", "Glitches", "Levels forced for up to two bit times, of all bytes of the host."),
  rate("lost_replies", "Replies lost", "Replies that the host does not hear, of all replies."),
  rate("deaths", "Deaths of the host", "Frames (raw: packets) within which the host dies, of all of them; it comes back and remembers nothing but its orders."),
];

/** The bus of a controller: what every user sets. @type {Field[]} */
const BUS_SIZE = [
  integer("channels", "Channels", "", "1 to 16; a packet has one byte for each."),
  integer("slots", "Slots in a tick", "", "1 to 127: the most steps a channel makes in one tick."),
  cycles("step_period_cycles", "Slot", "Length of a slot, 2 to 10⁹; a tick lasts slots × this."),
];

/** The rest of it. @type {Field[]} */
const BUS_PULSES = [
  cycles("pulse_width_cycles", "STEP high", "Width of a step pulse, 1 to 10⁹."),
  cycles("dir_setup_cycles", "DIR set-up", "From DIR's change to the rise of STEP, 0 to 10⁹."),
  cycles("dir_hold_cycles", "DIR hold", "From the fall of STEP to DIR's change, 0 to 10⁹."),
  { key: "distribution", label: "Steps in a tick", kind: "choice", choices: { spread: "spread evenly", burst: "burst at its start" }, hint: "Burst is the patent's: the first slots of the tick." },
  { key: "dir_line", label: "DIR lines", kind: "choice", choices: { per_channel: "one a channel", common: "one for all" }, hint: "One a channel changes when a tick starts; a common one changes within each slot." },
  { key: "pulses", label: "Pulses of a slot", kind: "choice", choices: { simultaneous: "all at once", staggered: "one after another" }, hint: "One after another, the drivers' current peaks do not meet." },
  { ...cycles("settle_cycles", "Current settles", "Time of the supply current after a step, 0 to 10⁹: the pulses of a slot are at most so far apart."), when: { key: "pulses", is: "staggered" } },
  integer("queue_depth", "Queue", "ticks", "Ticks that it holds, 1 to 255."),
  cycles("boot_cycles", "Self-test", "After reset, 0 to 2³² − 1; packets that end in it are dropped."),
];

/** A further controller: its own fields, its bus, and what of that is folded away. @type {{own: Field[], bus: Field[], folded: Field[]}} */
export const CONTROLLER = {
  own: [integer("address", "Address", "", "0 to 254, which no other controller has."), RECEIVER_BAUD],
  bus: BUS_SIZE, folded: BUS_PULSES,
};

/** Rules of a driver of one's own. @type {Field[]} */
export const RULE_FIELDS = Object.entries(RULES).map(([rule, label]) =>
  integer(`${rule}_ns`, label, "ns", "Least time, 0 to 10⁹ ns; 0 asks for nothing. A time such as 1.9 us is taken too."));

/**
 * The sections beside the source. Keys are paths below the section's own; a group is folded away.
 * @typedef {{path: string, fields: Field[]}} Block
 * @type {{title: string, open: boolean, blocks: Block[], group?: {title: string} & Block, list?: "glitches" | "controllers" | "driver"}[]}
 */
export const SECTIONS = [
  {
    title: "Serial line", open: true, list: "glitches",
    blocks: [{ path: "line", fields: LINE }, { path: "line.host", fields: HOST }],
    group: { title: "Noise", path: "line.noise", fields: NOISE },
  },
  { title: "Driver bus", open: true, blocks: [{ path: "bus", fields: [...BUS_SIZE, ...BUS_PULSES] }] },
  { title: "Further controllers", open: true, blocks: [], list: "controllers" },
  { title: "Driver timing", open: true, blocks: [], list: "driver" },
  {
    title: "Spectrum", open: false,
    blocks: [{ path: "analysis", fields: [
      integer("axis", "Axis", "", "Axis of the motion, or the channel: from 0, below the number of channels."),
      integer("order", "Order", "", "Highest harmonic that counts for the distortion, 2 to 1000."),
      { key: "fft_length", label: "Samples", kind: "choice", choices: Object.fromEntries([256, 512, 1024, 2048, 4096, 8192, 16384, 32768, 65536].map((n) => [n, `${n} a period`])), hint: "Length of the transform over one period of the motion." },
    ] }],
  },
  {
    title: "Clock and run", open: false,
    blocks: [{ path: "", fields: [
      integer("clock_hz", "Clock", "Hz", "Of the peripheral, 1 Hz to 1 GHz; all cycles count it."),
      { key: "run_cycles", label: "Length of the run", unit: "cycles", kind: "optional-cycles", hint: "Empty: until nothing can change any more. A time such as 20 ms is taken too." },
    ] }],
  },
  {
    title: "Name and note", open: false,
    blocks: [{ path: "", fields: [
      { key: "title", label: "Name", kind: "text", hint: "Up to 120 characters; goes with the link." },
      { key: "note", label: "Note", kind: "text", rows: 4, hint: "What to look at, and where it comes from; up to 2000 characters." },
    ] }],
  },
];

/**
 * Scenarios that hold one of everything that can be added; the core fills in the defaults, so that the page
 * knows none of its own.
 */
export const SAMPLES = {
  all: { bus: { channels: 5 }, line: { glitches: [{}] }, controllers: [{}], driver: { rules: {} },
    source: { motion: { axes: Object.keys(MECHANICS).map((kind) => ({ mechanics: { [kind]: {} }, moves: Object.keys(MOVES).map((move) => ({ [move]: {} })) })) } } },
  line: { source: { line: { sends: [{}] } } },
};
