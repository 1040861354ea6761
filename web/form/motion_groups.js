/** Groups of moves that start and end together: of equal time, on a straight line, or through waypoints. */
import { button, element } from "../dom.js";
import { get } from "../state/paths.js";
import { moveFields } from "./axes.js";
import { fields, itemField, labels, maxLengthOf } from "./schema.js";

/** @typedef {import("./kit.js").Kit} Kit */

const GROUPS = "source.motion.groups";

/** @param {Kit} kit @returns {Node[]} */
export function groupItems(kit) {
  const { scenario } = kit.now();
  /** @type {any[]} */
  const groups = get(scenario, GROUPS) ?? [];
  return [
    ...groups.map((group, index) => groupItem(kit, group, index)),
    button(
      "Add group",
      "Add a group of moves",
      () => kit.append(GROUPS, (last) => structuredClone(last ?? sampleOf(kit, "line"))),
      groups.length >= maxLengthOf("Motion", "groups"),
    ),
  ];
}

/** @param {Kit} kit */
const axisCount = ({ now }) => now().scenario.source.motion.axes.length;

/** A group for all axes. @param {Kit} kit @param {string} kind */
function sampleOf(kit, kind) {
  const all = Array.from({ length: axisCount(kit) }, (_, axis) => axis);
  const quantity = { steps: 0 };
  const values = {
    time: {
      duration_s: null,
      moves: all.map((axis) => ({ axis, move: { jerk_limited: kit.samples.moves.jerk_limited } })),
    },
    line: { ...kit.samples.motion_groups.line, distances: all.map(() => ({ steps: 1000 })) },
    way_points: { points: [{ positions: all.map(() => quantity), speeds: null }] },
  };
  return structuredClone({ [kind]: /** @type {any} */ (values)[kind] });
}

/** @param {Kit} kit @param {any} group @param {number} index */
function groupItem(kit, group, index) {
  const path = `${GROUPS}[${index}]`;
  const [kind] = Object.keys(group);
  const name = `Group ${index + 1}`;
  const head = element(
    "div",
    { class: "item-head" },
    kit.kindSelect(`Kind of group ${index + 1}`, path, kind, labels("Group"), (selected) =>
      kit.become(path, "Group", selected, sampleOf(kit, selected)[selected]),
    ),
    button("↑", `${name} earlier`, () => kit.raise(GROUPS, index), index === 0),
    button("✕", `Remove ${name.toLowerCase()}`, () => kit.remove(GROUPS, index)),
  );
  const parts = /** @type {{[kind: string]: (kit: Kit, path: string, group: any) => Node[]}} */ ({
    time: timeItems,
    line: lineItems,
    way_points: pointItems,
  })[kind](kit, `${path}.${kind}`, group[kind]);
  return kit.item(name, path, [head, ...parts], `Group.${kind}`);
}

/** A quantity of each axis. @param {Kit} kit @param {string} path @param {string} group @param {string} list @param {string} name  Name of one quantity. */
function perAxis(kit, path, group, list, name) {
  return Array.from({ length: axisCount(kit) }, (_, axis) =>
    kit.row(`${path}.${list}[${axis}]`, itemField(group, list, axis, `${name}, axis ${axis}`)),
  );
}

/** @param {Kit} kit @param {string} path */
function lineItems(kit, path) {
  return [
    ...perAxis(kit, path, "LineGroup", "distances", "Distance"),
    ...kit.block(path, fields("LineGroup", ["profile"])),
  ];
}

/** @param {Kit} kit @param {string} path @param {{moves: any[]}} group @returns {Node[]} */
function timeItems(kit, path, { moves }) {
  const list = `${path}.moves`;
  const items = moves.map(({ move }, index) => {
    const at = `${list}[${index}]`;
    const [kind] = Object.keys(move);
    const { retarget: _, dwell: __, ...kinds } = labels("Move");
    const head = element(
      "div",
      { class: "item-head" },
      kit.kindSelect(`Kind of move ${index + 1}`, `${at}.move`, kind, kinds, (selected) =>
        kit.become(`${at}.move`, "Move", selected, kit.samples.moves[selected]),
      ),
      button("✕", `Remove move ${index + 1}`, () => kit.remove(list, index), moves.length === 1),
    );
    const own = [head, ...kit.block(at, fields("GroupMove", ["axis"])), ...moveFields(kit, `${at}.move`, kind)];
    return kit.item(`Move ${index + 1} of the group`, at, own, `Move.${kind}`);
  });
  const add = button(
    "Add move",
    "Add move to the group",
    () => kit.append(list, (last) => ({ ...structuredClone(last), axis: moves.length })),
    moves.length >= axisCount(kit),
  );
  return [...kit.block(path, fields("TimeGroup", ["duration_s"])), ...items, add];
}

/** @param {Kit} kit @param {string} path @param {{points: any[]}} group @returns {Node[]} */
function pointItems(kit, path, { points }) {
  const list = `${path}.points`;
  const items = points.map(({ speeds }, index) => {
    const at = `${list}[${index}]`;
    return kit.item(
      `Point ${index + 1}`,
      at,
      [
        ...perAxis(kit, at, "WayPoint", "positions", "Position"),
        kit.toggle(`${at}.speeds`, "Given speeds", Boolean(speeds), Array(axisCount(kit)).fill(null)),
        ...(speeds ? perAxis(kit, at, "WayPoint", "speeds", "Speed") : []),
        button("Remove", `Remove point ${index + 1}`, () => kit.remove(list, index), points.length === 1),
      ],
      "Group.way_points",
    );
  });
  const add = button("Add point", "Add point", () => kit.append(list, (last) => structuredClone(last)));
  return [...items, add];
}
