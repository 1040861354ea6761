/** The axes of a controller: mechanics, moves and motor. */
import { button, element } from "../dom.js";
import { MAX_CHANNELS } from "../state/limits.js";
import { get, set } from "../state/paths.js";
import { pointsFirst } from "./fields.js";
import { motorItems } from "./motor.js";
import { fieldsOfKind, labels, mostOf } from "./schema.js";
import { removed } from "./structure.js";

/** @typedef {import("./kit.js").Kit} Kit */
/** @typedef {{axes: string, bus: string, whose: string, least: number}} Place  Paths of the axes and of their bus; what tells them from another controller's; fewest axes. */

/** @param {Kit} kit @param {Place} place @returns {Node[]} */
export function axisItems(kit, place) {
  const { samples, now } = kit;
  /** @type {any[]} */
  const axes = get(now().scenario, place.axes) ?? [];
  const fresh = () => ({
    mechanics: { rotary: samples.mechanics.rotary },
    moves: [{ cosine: samples.moves.cosine }],
    motor: null,
  });
  return [
    ...axes.map((_, index) => axisItem(kit, place, axes, index)),
    button(
      "Add axis",
      `Add axis${place.whose}`,
      () => addAxis(kit, place, (now) => now[now.length - 1] ?? fresh()),
      axes.length >= MAX_CHANNELS,
    ),
  ];
}

/** @param {Kit} kit @param {Place} place @param {any[]} axes @param {number} index */
function axisItem(kit, place, axes, index) {
  const { samples, become, append, block, item, kindSelect } = kit;
  const axis = axes[index];
  const path = `${place.axes}[${index}]`;
  const list = `${path}.moves`;
  const name = `axis ${index}${place.whose}`;
  const kind = Object.keys(axis.mechanics)[0];
  const head = element(
    "div",
    { class: "item-head" },
    kindSelect(`Mechanics of ${name}`, `${path}.mechanics`, kind, labels("Mechanics"), (selected) =>
      become(`${path}.mechanics`, "Mechanics", selected, samples.mechanics[selected]),
    ),
    ...(axes.length > 1 ? [button("Copy to all", `Copy to all: ${name}`, () => copyToAll(kit, place, index))] : []),
    button("Copy", `Copy ${name}`, () => addAxis(kit, place, (now) => now[index]), axes.length >= MAX_CHANNELS),
    button("✕", `Remove ${name}`, () => removeAxis(kit, place, index), axes.length <= place.least),
  );
  const fields = block(`${path}.mechanics.${kind}`, fieldsOfKind("Mechanics", kind));
  const moves = axis.moves.map((/** @type {any} */ _, /** @type {number} */ i) => moveItem(kit, list, axis.moves, i));
  const add = button(
    "Add move",
    `Add move to ${name}`,
    () => append(list, (last) => structuredClone(last ?? { cosine: samples.moves.cosine })),
    axis.moves.length >= mostOf("Axis", "moves"),
  );
  return item(
    `Axis ${index} · channel ${index}`,
    path,
    [head, ...fields, ...motorItems(kit, path, axis, name), ...moves, add],
    `Mechanics.${kind}`,
  );
}

/** @param {Kit} kit @param {string} list @param {any[]} moves @param {number} index */
function moveItem({ samples, become, raise, remove, block, item, kindSelect }, list, moves, index) {
  const path = `${list}[${index}]`;
  const kind = Object.keys(moves[index])[0];
  const head = element(
    "div",
    { class: "item-head" },
    kindSelect(`Kind of move ${index + 1}`, path, kind, labels("Move"), (selected) =>
      become(path, "Move", selected, samples.moves[selected]),
    ),
    button("↑", `Move ${index + 1} earlier`, () => raise(list, index), index === 0),
    button("✕", `Remove move ${index + 1}`, () => remove(list, index), moves.length === 1),
  );
  const note = element("p", { class: "item-note", "data-note": path });
  const fields = block(`${path}.${kind}`, pointsFirst(fieldsOfKind("Move", kind)));
  return item(`Move ${index + 1}`, path, [head, ...fields, note], `Move.${kind}`);
}

/** Adds an axis, and a channel if needed. @param {Kit} kit @param {Place} place @param {(axes: any[]) => any} like */
function addAxis({ change }, place, like) {
  const path = `${place.bus}.channels`;
  change("", (scenario) => {
    const axes = get(scenario, place.axes) ?? [];
    const grown = [...axes, structuredClone(like(axes))];
    const channels = Math.max(Number(get(scenario, path)) || 1, grown.length);
    return set(set(scenario, path, channels), place.axes, grown);
  });
}

/** @param {Kit} kit @param {Place} place @param {number} index */
function copyToAll({ change, now }, place, index) {
  const others = get(now().scenario, place.axes).flatMap((/** @type {any} */ _, /** @type {number} */ at) =>
    at === index ? [] : [[`${place.axes}[${at}]`, null]],
  );
  change(
    place.axes,
    (axes) => axes.map((/** @type {any} */ axis) => (axis === axes[index] ? axis : structuredClone(axes[index]))),
    others,
  );
}

/** Removes an axis; the spectrum keeps its axis or moves to a neighbor. @param {Kit} kit @param {Place} place @param {number} index */
function removeAxis({ change, now }, place, index) {
  change(
    "",
    (scenario) => {
      const left = get(scenario, place.axes).toSpliced(index, 1);
      const without = set(scenario, place.axes, left);
      if (!place.axes.startsWith("source")) return without;
      const selected = without.analysis.axis;
      return set(without, "analysis.axis", Math.min(selected > index ? selected - 1 : selected, left.length - 1));
    },
    removed(place.axes, index, now()),
  );
}
