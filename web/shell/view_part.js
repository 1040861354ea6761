/**
 * The view as a link's part `v` writes it: parts between dots, each of which says by its first letter what it is.
 *
 *     v=120-4500.k1.x2.a300.b900.tpackets.stiming.umm
 *
 * | part | what |
 * | --- | --- |
 * | `120-4500` | shown time, first and last cycle |
 * | `k1` | selected controller, 0 the first |
 * | `x2` | axis of the motion view |
 * | `a300`, `b900` | cursors, in cycles |
 * | `tpackets` | tab on a narrow screen |
 * | `stiming` | which of spectrum and driver timing is open |
 * | `umm` | unit of the motion view |
 * | `ysine` | tab of the study |
 *
 * What is as on a fresh page is left out; parts that cannot be read, or are not known (a later version's), are
 * ignored, of two of one kind the first counts. A part that was published keeps its meaning for ever.
 */

import { NAMES, SHARED } from "../state/views.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").ViewPart} ViewPart */

/** Tabs of the study, in their order. @type {import("../state/types.js").StudyName[]} */
export const STUDIES = ["compare", "measures", "tables", "sine", "torque"];
const SIDES = [...SHARED.values()].flat().map(({ name }) => name);
const UNITS = ["steps", "mm", "deg"];
/** No part is longer, and there are not more kinds of them. */
const MOST = 200;

/** @type {{[letter: string]: [keyof ViewPart, (text: string) => any]}} */
const PARTS = {
  k: ["controller", (text) => number(text, 31)],
  x: ["axis", (text) => number(text, 15)],
  a: ["a", (text) => number(text)],
  b: ["b", (text) => number(text)],
  t: ["view", (text) => known(text, NAMES)],
  s: ["side", (text) => known(text, SIDES)],
  u: ["unit", (text) => known(text, UNITS)],
  y: ["study", (text) => known(text, STUDIES)],
};

/** @param {string} text @param {number} [most] */
function number(text, most = Number.MAX_SAFE_INTEGER) {
  return /^\d{1,16}$/.test(text) && Number(text) <= most ? Number(text) : undefined;
}

/** @param {string} text @param {string[]} names */
function known(text, names) {
  return names.includes(text) ? text : undefined;
}

/** What a part `v` asks to be shown; an empty object where nothing of it can be read. @param {string | undefined} text @returns {ViewPart} */
export function parseView(text) {
  /** @type {ViewPart} */
  const view = {};
  for (const part of (text ?? "").slice(0, MOST).split(".")) {
    const [start, end] = part.split("-").map((cycle) => number(cycle));
    if (start !== undefined && end !== undefined && start < end && part === `${start}-${end}`)
      view.window ??= { start, end };
    if (!Object.hasOwn(PARTS, part[0] ?? "")) continue;
    const [name, read] = PARTS[part[0]];
    const value = read(part.slice(1));
    if (value !== undefined && view[name] === undefined) view[name] = value;
  }
  return view;
}

/** @param {ViewPart} view */
export function writeView(view) {
  const parts = view.window ? [`${view.window.start}-${view.window.end}`] : [];
  for (const [letter, [name]] of Object.entries(PARTS))
    if (view[name] !== undefined) parts.push(`${letter}${view[name]}`);
  return parts.join(".");
}

/** The view of a state as a part `v`; empty where all is as on a fresh page. @param {State | undefined} state */
export function viewOf(state) {
  if (!state) return "";
  if (state.awaited) return writeView(state.awaited);
  const { window, controller, axis, cursors, view, side, unit, study } = state;
  return writeView({
    window: window ?? undefined,
    controller: controller || undefined,
    axis: axis || undefined,
    a: cursors.a ?? undefined,
    b: cursors.b ?? undefined,
    view: view === "motion" ? undefined : view,
    side: side ?? undefined,
    unit: unit === "steps" ? undefined : unit,
    study: study === "compare" ? undefined : study,
  });
}
