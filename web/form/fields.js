/**
 * What the form asks for: one row a field, with its unit, its range in words, and how it is typed. Ranges
 * are judged by the core; the words here only help to give a number it accepts.
 */

import { RULES } from "../state/rules.js";
import { cycles, integer, number } from "./field.js";
import { MOVES } from "./moves/index.js";

/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("./field.js").Kind} Kind */

const FULL_STEP = number(
  "full_step_deg",
  "Full step",
  "°",
  "Angle of the motor's full step, above 0; 1.8° is 200 a turn.",
);
const MICROSTEPS = integer("microsteps", "Microsteps", "", "In a full step, 1 to 512.");

/** How an axis turns steps into millimetres and degrees. @type {{[kind: string]: Kind}} */
export const MECHANICS = {
  rotary: {
    label: "Rotary shaft",
    about: {
      text: "The motor turns something; distances are angles. Steps a turn = 360° / full step × microsteps.",
      from: "sonobe",
    },
    fields: [FULL_STEP, MICROSTEPS],
  },
  wheel: {
    label: "Wheel, pulley or gear",
    about: {
      text: "The motor moves something by a radius: one turn is 2π × radius. A step is that, divided by the steps of a turn.",
      from: "sonobe",
    },
    fields: [
      FULL_STEP,
      MICROSTEPS,
      number("radius_mm", "Radius", "mm", "Above 0; 2π × radius is the way of one turn."),
    ],
  },
  screw: {
    label: "Lead screw",
    about: { text: "The motor turns a screw; its nut moves by the lead in one turn.", from: "zhang" },
    fields: [FULL_STEP, MICROSTEPS, number("lead_mm", "Lead", "mm", "Above 0; way of the nut in one turn.")],
  },
  direct: {
    label: "Length of a step",
    about: {
      text: "The way of one step as it was measured: the fixed-length controller finds it by least squares over measured pairs of length and steps.",
      from: "zhang",
    },
    fields: [number("step_mm", "One step", "mm", "Above 0; measured or given length of one step.")],
  },
};

/** @type {Field} */
export const PACKET_LINES = {
  key: "packets",
  label: "Packets, one a line",
  kind: "lines",
  rows: 8,
  hint: "Hex, one byte a channel: bit 7 is the direction (1 right), bits 6 to 0 the steps. A raw line with addresses has the address first. One packet orders one tick.",
};

/** What runs a motion. @type {Field} */
export const ENGINE = {
  key: "engine",
  label: "Steps made by",
  kind: "choice",
  choices: { ticks: "ticks", segments: "segments" },
  hint: "Ticks: the host sends the steps of each tick. Segments: nothing is sent; the peripheral makes each step in the cycle in which it falls due.",
};

/** A channel's list of segments. @type {Field[]} */
export const SEGMENTS = [
  cycles("start_cycle", "Start", "Cycle in which the list's time begins, from 1."),
  {
    key: "segments",
    label: "Segments, one a line",
    kind: "segments",
    rows: 5,
    hint: "Count, interval, growth of the interval, direction: 20 1048576000 -500 right; or dwell 65536000. Times in 1/65536 cycle.",
  },
];

/** Only on a framed line. */
const FRAMED = { path: "line.protocol", is: "framed" };

/** @type {Field[]} */
export const SEND = [
  cycles("start_cycle", "Start", "Cycle in which the first start bit falls, from 1."),
  { key: "bytes", label: "Bytes", kind: "hex", hint: "Hex, sent back to back." },
  {
    key: "frame",
    label: "Or a frame",
    kind: "optional-hex",
    hint: "In place of bytes: address, kind and body in hex, such as ff 05 (STOP for all); check, COBS and end mark are added.",
    when: FRAMED,
  },
];

/** @type {Field[]} */
export const GLITCH = [
  cycles("start_cycle", "Start", "First forced cycle, from 1."),
  cycles("length_cycles", "Length", "From 1."),
  {
    key: "level",
    term: "forced_level",
    label: "Level",
    kind: "choice",
    choices: { 0: "0 (low)", 1: "1 (high)" },
    hint: "Forced on the line whatever is sent; the later entry wins.",
  },
];

/** @type {Field} */
const RECEIVER_BAUD = {
  key: "receiver_baud",
  label: "Receiver's rate",
  unit: "baud",
  kind: "optional",
  hint: "Where the receiver's clock differs from the host's, 1 to 100 000 000; empty for the same.",
};

/** @type {Field[]} */
const LINE = [
  integer("baud", "Bit rate", "baud", "8N1; 1 to 100 000 000, at least 11 clock cycles a bit."),
  RECEIVER_BAUD,
  {
    key: "protocol",
    label: "Protocol",
    kind: "choice",
    choices: { raw: "raw", framed: "framed" },
    hint: "Raw: bytes and pauses, as in RU 2704486, with no check and no answer. Framed: each frame has a check and a sequence number, is answered, and is repeated until it is.",
  },
  {
    key: "address",
    label: "Address",
    unit: "",
    kind: "optional",
    hint: "0 to 254; empty for none: raw packets then begin with no address, and a framed controller has 0. 255 addresses all.",
  },
];

/** How the host of a framed line behaves. @type {Field[]} */
const HOST = [
  integer("ticks_per_frame", "Ticks in a frame", "", "At most, 1 to 32; and at most half of the queue."),
  {
    key: "reply_timeout_cycles",
    label: "Reply time-out",
    unit: "cycles",
    kind: /** @type {const} */ ("optional-cycles"),
    hint: "How long a reply is waited for, from the end of the frame to the end of the reply, 1 to 2³² − 1; empty for 256 bit times. A time such as 3 ms is taken too.",
  },
  integer("attempts", "Attempts", "", "How often one frame is sent before the host gives up, 1 to 255."),
].map((field) => ({ ...field, when: FRAMED }));

/** @param {string} key @param {string} label @param {string} hint */
const rate = (key, label, hint) => integer(`${key}_ppm`, label, "ppm", `${hint} In millionths, 0 to 1 000 000.`);
/** @type {Field[]} */
const NOISE = [
  integer("seed", "Seed", "", "0 to 2³² − 1. The same seed gives the same noise."),
  rate("flipped_bits", "Bits flipped", "Of all bits of all bytes, both ways."),
  rate("lost_bytes", "Bytes lost", "Of all bytes, both ways."),
  rate("duplicated_bytes", "Bytes duplicated", "Of all bytes, both ways."),
  rate("glitches", "Glitches", "Levels forced for up to two bit times, of all bytes of the host."),
  rate("lost_replies", "Replies lost", "Replies that the host does not hear, of all replies."),
  rate(
    "host_crashes",
    "Host crashes",
    "Frames (raw: packets) within which the host crashes, of all of them; it restarts and remembers nothing but its orders.",
  ),
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
  {
    key: "distribution",
    label: "Steps in a tick",
    kind: "choice",
    choices: { spread: "spread evenly", burst: "burst at its start" },
    hint: "Burst is the patent's: the first slots of the tick.",
  },
  {
    key: "dir_line",
    label: "DIR lines",
    kind: "choice",
    choices: { per_channel: "one a channel", common: "one for all" },
    hint: "One a channel changes when a tick starts; a common one changes within each slot.",
  },
  {
    key: "pulse_phasing",
    label: "Pulses of a slot",
    kind: "choice",
    choices: { simultaneous: "all at once", staggered: "one after another" },
    hint: "One after another, the drivers' current peaks do not meet.",
  },
  {
    ...cycles(
      "settle_cycles",
      "Current settles",
      "Time of the supply current after a step, 0 to 10⁹: the pulses of a slot are at most so far apart.",
    ),
    when: { key: "pulse_phasing", is: "staggered" },
  },
  integer("queue_depth", "Queue", "ticks", "Ticks that it holds, 1 to 255."),
  cycles("boot_cycles", "Self-test", "After reset, 0 to 2³² − 1; packets that end in it are dropped."),
];

/** What of a bus counts where segments run it; and nothing of the line does. */
export const OF_SEGMENTS = ["channels", "pulse_width_cycles", "dir_setup_cycles", "dir_hold_cycles"];

/** A further controller: its own fields, its bus, and what of that is folded away. @type {{own: Field[], bus: Field[], folded: Field[]}} */
export const CONTROLLER = {
  own: [integer("address", "Address", "", "0 to 254, which no other controller has."), RECEIVER_BAUD],
  bus: BUS_SIZE,
  folded: BUS_PULSES,
};

/** Rules of a driver of one's own. @type {Field[]} */
export const RULE_FIELDS = Object.entries(RULES).map(([rule, label]) =>
  integer(
    `${rule}_ns`,
    label,
    "ns",
    "Least time, 0 to 10⁹ ns; 0 asks for nothing. A time such as 1.9 us is taken too.",
  ),
);

/**
 * The sections beside the source. Keys are paths below the section's own; a group is folded away.
 * `onLine` is of use only where something is sent.
 * @typedef {{path: string, fields: Field[]}} Block
 * @type {{title: string, open: boolean, onLine?: boolean, blocks: Block[], group?: {title: string} & Block, list?: "glitches" | "controllers" | "driver_timing"}[]}
 */
export const SECTIONS = [
  {
    title: "Serial line",
    open: true,
    onLine: true,
    list: "glitches",
    blocks: [
      { path: "line", fields: LINE },
      { path: "line.host", fields: HOST },
    ],
    group: { title: "Noise", path: "line.noise", fields: NOISE },
  },
  { title: "Driver bus", open: true, blocks: [{ path: "bus", fields: [...BUS_SIZE, ...BUS_PULSES] }] },
  { title: "Further controllers", open: true, onLine: true, blocks: [], list: "controllers" },
  { title: "Driver timing", open: true, blocks: [], list: "driver_timing" },
  {
    title: "Spectrum",
    open: false,
    blocks: [
      {
        path: "analysis",
        fields: [
          integer("axis", "Axis", "", "Axis of the motion, or the channel: from 0, below the number of channels."),
          integer("order", "Order", "", "Highest harmonic that counts for the distortion, 2 to 1000."),
          integer(
            "fft_length",
            "Samples",
            "a period",
            "Length of the transform over one period of the ideal motion, 16 to 65536; any number is coherent.",
          ),
          {
            key: "sensor_hz",
            label: "Sensor's bandwidth",
            unit: "Hz",
            kind: "optional-number",
            hint: "Of the accelerometer on the rig (−3 dB, first order), 0.001 to 10⁹; empty for none. The distortion of what it feels is told beside that of the acceleration.",
          },
        ],
      },
    ],
  },
  {
    title: "Clock and run",
    open: false,
    blocks: [
      {
        path: "",
        fields: [
          integer("clock_hz", "Clock", "Hz", "Of the peripheral, 11 Hz to 1 GHz; all cycles count it."),
          {
            key: "run_cycles",
            label: "Length of the run",
            unit: "cycles",
            kind: "optional-cycles",
            hint: "Empty: until nothing can change any more. A time such as 20 ms is taken too.",
          },
        ],
      },
    ],
  },
  {
    title: "Name and note",
    open: false,
    blocks: [
      {
        path: "",
        fields: [
          { key: "title", label: "Name", kind: "text", hint: "Up to 120 characters; goes with the link." },
          {
            key: "note",
            label: "Note",
            kind: "text",
            rows: 4,
            hint: "What to look at, and where it comes from; up to 2000 characters.",
          },
        ],
      },
    ],
  },
];

/**
 * Scenarios that hold one of everything that can be added; the core fills in the defaults, so that the page
 * knows none of its own.
 */
export const SAMPLES = {
  all: {
    bus: { channels: 5 },
    line: { glitches: [{}] },
    controllers: [{}],
    driver_timing: { rules: {} },
    source: {
      motion: {
        axes: Object.keys(MECHANICS).map((kind) => ({
          mechanics: { [kind]: {} },
          motor: {},
          moves: Object.keys(MOVES).map((move) => ({ [move]: {} })),
        })),
      },
    },
  },
  line: { source: { line: { sends: [{}] } } },
};
