/** The axes of a controller: mechanics, moves and motor. */
import { button, element } from "../dom.js";
import { withAxis, withoutAxis } from "../state/group_axes.js";
import { MAX_CHANNELS } from "../state/limits.js";
import { get, set } from "../state/paths.js";
import { choiceItem } from "./choice.js";
import { pointsFirst } from "./fields.js";
import { choices, fields, fieldsOfKind, groupOfKind, labels, maxLengthOf } from "./schema.js";
import { removed } from "./structure.js";

/** @typedef {import("./kit.js").Kit} Kit */
/** @typedef {{axes: string, bus: string, suffix: string, minAxes: number}} AxisList  Paths of the axes and of their bus; suffix of their names, such as ` of controller 2`; minimum number of axes. */

/** @param {Kit} kit @param {AxisList} list @returns {Node[]} */
export function axisItems(kit, list) {
  const { samples, now } = kit;
  /** @type {any[]} */
  const axes = get(now().scenario, list.axes) ?? [];
  const firstAxis = () => ({
    mechanics: { rotary: samples.mechanics.rotary },
    moves: [{ cosine: samples.moves.cosine }],
    motor: null,
  });
  return [
    ...axes.map((_, index) => axisItem(kit, list, axes, index)),
    button(
      "Add axis",
      `Add axis${list.suffix}`,
      () => addAxis(kit, list, (now) => now[now.length - 1] ?? firstAxis()),
      axes.length >= MAX_CHANNELS,
    ),
  ];
}

/** @param {Kit} kit @param {AxisList} list @param {any[]} axes @param {number} index */
function axisItem(kit, list, axes, index) {
  const { samples, become, append, block, item, kindSelect, part } = kit;
  const axis = axes[index];
  const path = `${list.axes}[${index}]`;
  const movesPath = `${path}.moves`;
  const name = `axis ${index}${list.suffix}`;
  const kind = Object.keys(axis.mechanics)[0];
  const head = element(
    "div",
    { class: "item-head" },
    kindSelect(`Mechanics of ${name}`, `${path}.mechanics`, kind, labels("Mechanics"), (selected) =>
      become(`${path}.mechanics`, "Mechanics", selected, samples.mechanics[selected]),
    ),
    ...(axes.length > 1 ? [button("Copy to all", `Copy to all: ${name}`, () => copyToAll(kit, list, index))] : []),
    button("Copy", `Copy ${name}`, () => addAxis(kit, list, (now) => now[index]), axes.length >= MAX_CHANNELS),
    button("✕", `Remove ${name}`, () => removeAxis(kit, list, index), axes.length <= list.minAxes),
  );
  const mechanics = block(`${path}.mechanics.${kind}`, fieldsOfKind("Mechanics", kind));
  const moves = axis.moves.map((/** @type {any} */ _, /** @type {number} */ i) =>
    moveItem(kit, movesPath, axis.moves, i),
  );
  const add = button(
    "Add move",
    `Add move to ${name}`,
    () => append(movesPath, (last) => structuredClone(last ?? { cosine: samples.moves.cosine })),
    axis.moves.length >= maxLengthOf("Axis", "moves"),
  );
  const shaper = choiceItem(kit, `${path}.input_shaper`, "Input shaper", {
    group: "InputShaper",
    samples: samples.shapers,
    term: "Axis.input_shaper",
    empty: "not shaped",
  });
  const limits = part(`Limits and shaper of ${name}`, Boolean(axis.input_shaper), [
    ...block(`${path}.limits`, fields("AxisLimits")),
    shaper,
  ]);
  return item(
    `Axis ${index} · channel ${index}`,
    path,
    [head, ...mechanics, ...moves, add, limits],
    `Mechanics.${kind}`,
  );
}

/** @param {Kit} kit @param {string} movesPath @param {any[]} moves @param {number} index */
function moveItem(kit, movesPath, moves, index) {
  const { samples, become, raise, remove, item, kindSelect } = kit;
  const path = `${movesPath}[${index}]`;
  const kind = Object.keys(moves[index])[0];
  const head = element(
    "div",
    { class: "item-head" },
    kindSelect(`Kind of move ${index + 1}`, path, kind, labels("Move"), (selected) =>
      become(path, "Move", selected, samples.moves[selected]),
    ),
    button("↑", `Move ${index + 1} earlier`, () => raise(movesPath, index), index === 0),
    button("✕", `Remove move ${index + 1}`, () => remove(movesPath, index), moves.length === 1),
  );
  const note = element("p", { class: "item-note", "data-note": path });
  return item(`Move ${index + 1}`, path, [head, ...moveFields(kit, path, kind), note], `Move.${kind}`);
}

/** The fields of a move. @param {Kit} kit @param {string} path @param {string} kind */
export function moveFields(kit, path, kind) {
  const group = groupOfKind("Move", kind);
  return [
    ...choices(group).map(({ name, label, group: inner }) =>
      choiceItem(kit, `${path}.${kind}.${name}`, label, {
        group: inner,
        samples: kit.samples.targets,
        term: `${group}.${name}`,
      }),
    ),
    ...kit.block(`${path}.${kind}`, pointsFirst(fieldsOfKind("Move", kind))),
  ];
}

/** Adds an axis, and a channel if needed. @param {Kit} kit @param {AxisList} list @param {(axes: any[]) => any} templateOf  The axis to copy. */
function addAxis({ change }, list, templateOf) {
  const path = `${list.bus}.channels`;
  change("", (scenario) => {
    const axes = get(scenario, list.axes) ?? [];
    const grown = [...axes, structuredClone(templateOf(axes))];
    const channels = Math.max(Number(get(scenario, path)) || 1, grown.length);
    return withGroups(set(set(scenario, path, channels), list.axes, grown), list, withAxis);
  });
}

/** Changes the groups of moves of the first controller. @param {any} scenario @param {AxisList} list @param {(groups: any[]) => any[]} change */
function withGroups(scenario, list, change) {
  const path = list.axes.replace(/axes$/, "groups");
  const groups = get(scenario, path);
  return groups ? set(scenario, path, change(groups)) : scenario;
}

/** @param {Kit} kit @param {AxisList} list @param {number} index */
function copyToAll({ change, now }, list, index) {
  const others = get(now().scenario, list.axes).flatMap((/** @type {any} */ _, /** @type {number} */ at) =>
    at === index ? [] : [[`${list.axes}[${at}]`, null]],
  );
  change(
    list.axes,
    (axes) => axes.map((/** @type {any} */ axis) => (axis === axes[index] ? axis : structuredClone(axes[index]))),
    others,
  );
}

/** Removes an axis. The spectrum keeps its axis, or selects a neighbor of the removed one. @param {Kit} kit @param {AxisList} list @param {number} index */
function removeAxis({ change, now }, list, index) {
  change(
    "",
    (scenario) => {
      const remaining = get(scenario, list.axes).toSpliced(index, 1);
      const without = withGroups(set(scenario, list.axes, remaining), list, (groups) => withoutAxis(groups, index));
      if (!list.axes.startsWith("source")) return without;
      const selected = without.analysis.axis;
      return set(without, "analysis.axis", Math.min(selected > index ? selected - 1 : selected, remaining.length - 1));
    },
    removed(list.axes, index, now()),
  );
}
