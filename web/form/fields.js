/** The layout of the form. The schema has labels, units, ranges and kinds. */
import { field, fields, labelOf } from "./schema.js";

/** @typedef {import("./field.js").Field} Field */

/** The field of packets, one per line: of the host, or of an additional controller. @param {"Packets" | "Controller"} group @returns {Field} */
export const packetLines = (group) => ({ ...field(group, "packets"), rows: 8 });

/** The fields of a glitch; its level is a choice. @returns {Field[]} */
export const glitchFields = () =>
  fields("Glitch").map((each) =>
    each.key === "level" ? { ...each, kind: "choice", choices: { 0: "0 (low)", 1: "1 (high)" } } : each,
  );

/** The fields of a bus that affect segments. */
export const OF_SEGMENTS = ["channels", "pulse_width_cycles", "dir_setup_cycles", "dir_hold_cycles"];

/** Sorts the points of a curve before its other fields. @param {Field[]} fields */
export const pointsFirst = (fields) =>
  fields
    .map((each) => (each.kind === "points" ? { ...each, rows: 8 } : each))
    .sort((a, b) => Number(b.kind === "points") - Number(a.kind === "points"));

/** The field of the sensor's bandwidth, which is in the spectrum. */
export const SENSOR = { path: "analysis.sensor_hz", key: "sensor_hz" };

/** Name and note of the experiment. */
const ABOUT = ["title", "note"];

/**
 * The sections after the source. A group is folded at first. `onLine`: the section only affects scenarios that send something.
 * @typedef {{path: string, fields: Field[]}} Block
 * @returns {{title: string, open: boolean, onLine?: boolean, blocks: Block[], group?: {title: string} & Block, list?: "glitches" | "controllers" | "driver_timing" | "plant"}[]}
 */
export const sections = () => [
  {
    title: labelOf("Scenario", "line"),
    open: true,
    onLine: true,
    list: "glitches",
    blocks: [
      { path: "line", fields: fields("Line") },
      { path: "line.host", fields: fields("Host") },
    ],
    group: { title: labelOf("Line", "noise"), path: "line.noise", fields: fields("Noise") },
  },
  { title: labelOf("Scenario", "bus"), open: true, blocks: [{ path: "bus", fields: fields("Bus") }] },
  { title: labelOf("Scenario", "controllers"), open: true, onLine: true, blocks: [], list: "controllers" },
  { title: labelOf("Scenario", "driver_timing"), open: true, blocks: [], list: "driver_timing" },
  { title: labelOf("Scenario", "plant"), open: true, blocks: [], list: "plant" },
  {
    title: labelOf("Scenario", "analysis"),
    open: false,
    blocks: [{ path: "analysis", fields: fields("Analysis").filter(({ key }) => key !== SENSOR.key) }],
  },
  {
    title: "Clock and run",
    open: false,
    blocks: [{ path: "", fields: fields("Scenario").filter(({ key }) => !ABOUT.includes(key) && key !== "version") }],
  },
  {
    title: "Name and note",
    open: false,
    blocks: [
      {
        path: "",
        fields: fields("Scenario", ABOUT).map((each) => (each.key === "note" ? { ...each, rows: 4 } : each)),
      },
    ],
  },
];
