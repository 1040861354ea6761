/** Which fields an experiment's form has, and when the remedies have to be loaded. */
import { hasNoLine } from "./source_kinds.js";

/** @typedef {import("../state/types.js").Scenario} Scenario */

/** Whether something is wrong, or the line is made to go wrong. @param {import("../state/types.js").State} state */
export function needsRemedies({ validation, result, scenario: { line } }) {
  return (
    (validation?.problems.length ?? 0) > 0 ||
    (result?.summary.controllers ?? []).some(({ violations }) => violations) ||
    line.glitches.length > 0 ||
    Object.entries(line.noise).some(([key, value]) => key !== "seed" && value !== 0)
  );
}

/** Whether anything in a group of numbers is other than 0. @param {{[key: string]: number}} group */
export function isUsed(group) {
  return Object.values(group).some((value) => value !== 0);
}

/** What decides which fields there are; values do not. @param {Scenario} scenario */
export function shapeOf({ source, controllers, driver_timing: driver, line, plant }) {
  const kinds = (/** @type {any[]} */ axes) =>
    axes.map((axis) => [
      Object.keys(axis.mechanics)[0],
      Boolean(axis.motor),
      ...axis.moves.map((/** @type {any} */ move) => Object.keys(move)[0]),
    ]);
  return JSON.stringify([
    Object.keys(source)[0],
    hasNoLine({ source }),
    kinds(source.motion?.axes ?? []),
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
  const of = (/** @type {any} */ group) => [group, group.move?.until, group.profile?.motion].map(kindOf);
  return [groups?.map(of), Boolean(home), Boolean(soft_limits), Boolean(axis), inputs?.length];
}

/** @param {any} part */
const kindOf = (part) => part && Object.keys(part)[0];
