/** When the form has to be rebuilt, and when it needs the remedies. */
import { hasNoLine } from "./source_kinds.js";

/** @typedef {import("../state/types.js").Scenario} Scenario */

/** Whether there is a problem, a violation, or a fault on the line. @param {import("../state/types.js").State} state */
export function needsRemedies({ validation, result, scenario: { line } }) {
  return (
    (validation?.problems.length ?? 0) > 0 ||
    (result?.summary.controllers ?? []).some(({ violations }) => violations) ||
    line.glitches.length > 0 ||
    Object.entries(line.noise).some(([key, value]) => key !== "seed" && value !== 0)
  );
}

/** Whether any value of a group of numbers is not 0. @param {{[key: string]: number}} group */
export function isUsed(group) {
  return Object.values(group).some((value) => value !== 0);
}

/** A text that changes whenever the form needs other fields, but not with values. @param {Scenario} scenario */
export function shapeOf({ source, controllers, driver_timing: driver, line, plant }) {
  const kinds = (/** @type {any[]} */ axes) =>
    axes.map((axis) => [
      Object.keys(axis.mechanics)[0],
      Boolean(axis.motor),
      kindOf(axis.input_shaper),
      ...axis.moves.map((/** @type {any} */ move) => [kindOf(move), kindOf(move.retarget?.target)]),
    ]);
  return JSON.stringify([
    Object.keys(source)[0],
    hasNoLine({ source }),
    kinds(source.motion?.axes ?? []),
    source.motion?.groups?.map(groupShape),
    source.line?.sends?.length,
    source.segments?.channels?.length,
    source.standalone?.map(panelShape),
    line.glitches.length,
    controllers.map((/** @type {any} */ { axes }) => kinds(axes)),
    driver && (driver.preset ?? "rules"),
    plant && [Boolean(plant.protection), plant.motors?.length],
  ]);
}

/** @param {any} panel */
function panelShape({ groups, home, soft_limits, axis, inputs }) {
  const programShape = (/** @type {any} */ group) => [group, group.move?.until, group.profile?.motion].map(kindOf);
  return [groups?.map(programShape), Boolean(home), Boolean(soft_limits), Boolean(axis), inputs?.length];
}

/** @param {any} group  Moves that start and end together. */
function groupShape({ time, line, way_points }) {
  return [
    time?.moves.map((/** @type {any} */ { move }) => [kindOf(move), kindOf(move.retarget?.target)]),
    line?.distances.length,
    way_points?.points.map((/** @type {any} */ { positions, speeds }) => [positions.length, speeds?.length]),
  ];
}

/** @param {any} part */
const kindOf = (part) => part && Object.keys(part)[0];
