/**
 * The view in part `v` of a link: parts separated by dots, each with a letter for its kind.
 *
 *     v=120-4500.k1.x2.a300.b900.tpackets.stiming.umm
 *
 * | part | meaning |
 * | --- | --- |
 * | `120-4500` | shown time, first and last cycle |
 * | `k1` | selected controller, 0 the first |
 * | `x2` | axis of motion, motor and study |
 * | `a300`, `b900` | cursors, in cycles |
 * | `tpackets` | tab on a narrow screen |
 * | `stiming` | which of spectrum and driver timing is open |
 * | `omotor` | which of motion, panel and motor is open |
 * | `umm` | unit of the motion view; by default the unit of the first distance |
 * | `ysine` | tab of the study |
 * | `qphases-supply` | quantities of the motor view |
 *
 * Defaults are left out. Invalid and unknown parts, such as those of a later version, are ignored; of two parts of one kind the
 * first counts. A published part never changes its meaning.
 */

import { NAMES, SHARED } from "../state/views.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").ViewPart} ViewPart */

/** Tabs of the study, in their order. @type {import("../state/types.js").StudyName[]} */
export const STUDIES = ["compare", "measures", "tables", "sine", "torque", "motor"];
const UNITS = ["steps", "mm", "deg"];
/** Maximum characters that are read. */
const MAX_LENGTH = 200;

/** A kind of part: `put` adds a text to a view, `of` returns its value in a view. @typedef {{put: (view: ViewPart, text: string) => void, of: (view: ViewPart) => any}} Part */

/** A part for a field of the view. @param {Exclude<keyof ViewPart, "sides" | "window">} name @param {(text: string) => any} read @returns {Part} */
const field = (name, read) => ({
  put: (view, text) => {
    const value = read(text);
    if (value !== undefined && view[name] === undefined) Object.assign(view, { [name]: value });
  },
  of: (view) => view[name],
});

/** A part for the selected view of a shared area. @param {string} area @returns {Part} */
const side = (area) => ({
  put: (view, text) => {
    const name = known(text, SHARED.get(area)?.map(({ name }) => name) ?? []);
    if (name && !view.sides?.[area]) view.sides = { ...view.sides, [area]: name };
  },
  of: (view) => view.sides?.[area],
});

/** @type {{[letter: string]: Part}} */
const PARTS = {
  k: field("controller", (text) => number(text, 31)),
  x: field("axis", (text) => number(text, 15)),
  a: field("a", (text) => number(text)),
  b: field("b", (text) => number(text)),
  t: field("view", (text) => known(text, NAMES)),
  s: side("spectrum"),
  u: field("unit", (text) => known(text, UNITS)),
  y: field("study", (text) => known(text, STUDIES)),
  o: side("motion"),
  q: {
    put: (view, text) => {
      if (/^[a-z]+(-[a-z]+)*$/.test(text)) view.quantities ??= text.split("-");
    },
    of: ({ quantities }) => quantities?.join("-"),
  },
};

/** @param {string} text @param {number} [max] */
function number(text, max = Number.MAX_SAFE_INTEGER) {
  return /^\d{1,16}$/.test(text) && Number(text) <= max ? Number(text) : undefined;
}

/** @param {string} text @param {string[]} names */
function known(text, names) {
  return names.includes(text) ? text : undefined;
}

/** The view of a part `v`; empty if it is invalid. @param {string | undefined} text @returns {ViewPart} */
export function parseView(text) {
  /** @type {ViewPart} */
  const view = {};
  for (const part of (text ?? "").slice(0, MAX_LENGTH).split(".")) {
    const [start, end] = part.split("-").map((cycle) => number(cycle));
    if (start !== undefined && end !== undefined && start < end && part === `${start}-${end}`)
      view.window ??= { start, end };
    if (Object.hasOwn(PARTS, part[0] ?? "")) PARTS[part[0]].put(view, part.slice(1));
  }
  return view;
}

/** @param {ViewPart} view */
export function writeView(view) {
  const parts = view.window ? [`${view.window.start}-${view.window.end}`] : [];
  for (const [letter, { of }] of Object.entries(PARTS)) {
    const value = of(view);
    if (value !== undefined) parts.push(`${letter}${value}`);
  }
  return parts.join(".");
}

/** The view of a state as part `v`; empty if all values are defaults. @param {State | undefined} state */
export function viewOf(state) {
  if (!state) return "";
  if (state.pendingView) return writeView(state.pendingView);
  const { window, controller, axis, cursors, view, sides, unit, study, quantities } = state;
  return writeView({
    window: window ?? undefined,
    controller: controller || undefined,
    axis: axis || undefined,
    a: cursors.a ?? undefined,
    b: cursors.b ?? undefined,
    view: view === "motion" ? undefined : view,
    sides,
    unit: unit ?? undefined,
    study: study === "compare" ? undefined : study,
    quantities: quantities ?? undefined,
  });
}
