/**
 * What the form asks for: one row a field, with its unit, its range in words, and how it is typed. Ranges
 * are judged by the core; the words here only help to give a number it accepts.
 */

/**
 * @typedef {object} Field
 * @property {string} key     Name in the scenario.
 * @property {string} label
 * @property {string} hint    What it is, and its range.
 * @property {"number" | "integer" | "optional" | "cycles" | "optional-cycles" | "choice" | "quantity" | "text" | "lines"} kind
 *   `optional…` may be empty (null); `cycles` also takes a time; `lines` is one hex packet a line.
 * @property {string} [unit]
 * @property {{[value: string]: string}} [choices]
 * @property {{[unit: string]: string}} [units]  Of a quantity: JSON's name to the printed one.
 * @property {number} [rows]
 * @property {{key: string, is: string}} [when]  Only of use while a field beside it has this value.
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

/** What the host sends. @type {{[kind: string]: string}} */
export const SOURCES = { motion: "Motion of axes", packets: "Packets in hex", line: "Line script" };

/** @type {Field} */
export const PACKET_LINES = { key: "packets", label: "Packets, one a line", kind: "lines", rows: 8, hint: "Hex, one byte a channel: bit 7 is the direction (1 right), bits 6 to 0 the steps. An addressed line has the address first. One packet orders one tick." };

/** @type {Field[]} */
export const SEND = [
  cycles("start_cycle", "Start", "Cycle in which the first start bit falls, from 1."),
  { key: "bytes", label: "Bytes", kind: "text", hint: "Hex, sent back to back." },
];

/** @type {Field[]} */
export const GLITCH = [
  cycles("start_cycle", "Start", "First forced cycle, from 1."),
  cycles("length_cycles", "Length", "From 1."),
  { key: "level", label: "Level", kind: "choice", choices: { 0: "0 (low)", 1: "1 (high)" }, hint: "Forced on the line whatever is sent; the later entry wins." },
];

/**
 * The sections beside source; keys are paths in the scenario.
 * @type {{title: string, open: boolean, fields: Field[], list?: "glitches"}[]}
 */
export const SECTIONS = [
  {
    title: "Serial line", open: true, list: "glitches",
    fields: [
      integer("line.baud", "Bit rate", "baud", "8N1; 1 to 100 000 000, at least 11 clock cycles a bit."),
      { key: "line.receiver_baud", label: "Receiver's rate", unit: "baud", kind: "optional", hint: "Where the receiver's clock differs from the host's, 1 to 100 000 000; empty for the same." },
      { key: "line.address", label: "Address", unit: "", kind: "optional", hint: "0 to 254 if packets begin with one; empty for none. 255 addresses all." },
    ],
  },
  {
    title: "Driver bus", open: true,
    fields: [
      integer("bus.channels", "Channels", "", "1 to 16; a packet has one byte for each."),
      integer("bus.slots", "Slots in a tick", "", "1 to 127: the most steps a channel makes in one tick."),
      cycles("bus.step_period_cycles", "Slot", "Length of a slot, 2 to 10⁹; a tick lasts slots × this."),
      cycles("bus.pulse_width_cycles", "STEP high", "Width of a step pulse, 1 to 10⁹."),
      cycles("bus.dir_setup_cycles", "DIR set-up", "From DIR's change to the rise of STEP, 0 to 10⁹."),
      cycles("bus.dir_hold_cycles", "DIR hold", "From the fall of STEP to DIR's change, 0 to 10⁹."),
      { key: "bus.distribution", label: "Steps in a tick", kind: "choice", choices: { spread: "spread evenly", burst: "burst at its start" }, hint: "Burst is the patent's: the first slots of the tick." },
      { key: "bus.dir_line", label: "DIR lines", kind: "choice", choices: { per_channel: "one a channel", common: "one for all" }, hint: "One a channel changes when a tick starts; a common one changes within each slot." },
      { key: "bus.pulses", label: "Pulses of a slot", kind: "choice", choices: { simultaneous: "all at once", staggered: "one after another" }, hint: "One after another, the drivers' current peaks do not meet." },
      { ...cycles("bus.settle_cycles", "Current settles", "Time of the supply current after a step, 0 to 10⁹: the pulses of a slot are at most so far apart."), when: { key: "bus.pulses", is: "staggered" } },
      integer("bus.queue_depth", "Queue", "ticks", "Ticks that it holds, 1 to 255."),
      cycles("bus.boot_cycles", "Self-test", "After reset, 0 to 2³² − 1; packets that end in it are dropped."),
    ],
  },
  {
    title: "Spectrum", open: false,
    fields: [
      integer("analysis.axis", "Axis", "", "Axis of the motion, or the channel: from 0, below the number of channels."),
      integer("analysis.order", "Order", "", "Highest harmonic that counts for the distortion, 2 to 1000."),
      { key: "analysis.fft_length", label: "Samples", kind: "choice", choices: Object.fromEntries([256, 512, 1024, 2048, 4096, 8192, 16384, 32768, 65536].map((n) => [n, `${n} a period`])), hint: "Length of the transform over one period of the motion." },
    ],
  },
  {
    title: "Clock and run", open: false,
    fields: [
      integer("clock_hz", "Clock", "Hz", "Of the peripheral, 1 Hz to 1 GHz; all cycles count it."),
      { key: "run_cycles", label: "Length of the run", unit: "cycles", kind: "optional-cycles", hint: "Empty: until nothing can change any more. A time such as 20 ms is taken too." },
    ],
  },
  {
    title: "Name and note", open: false,
    fields: [
      { key: "title", label: "Name", kind: "text", hint: "Up to 120 characters; goes with the link." },
      { key: "note", label: "Note", kind: "text", rows: 4, hint: "What to look at, and where it comes from; up to 2000 characters." },
    ],
  },
];

/**
 * A scenario that holds one of everything that can be added; the core fills in the defaults, so that the
 * page knows none of its own.
 */
export const SAMPLES = {
  motion: { bus: { channels: 5 }, line: { glitches: [{}] },
    source: { motion: { axes: Object.keys(MECHANICS).map((kind) => ({ mechanics: { [kind]: {} }, moves: Object.keys(MOVES).map((move) => ({ [move]: {} })) })) } } },
  line: { source: { line: { sends: [{}] } } },
};
