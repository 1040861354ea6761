/** The axes of a controller in the form: their mechanics and their moves. The first controller's and any further one's alike. */
import { button, element } from "../dom.js";
import { get, MAX_CHANNELS, set } from "../state/state.js";
import { pointsFirst } from "./fields.js";
import { motorItems } from "./motor.js";
import { fieldsOfKind, labels, mostOf } from "./schema.js";

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
      () => addAxis(kit, place, axes, structuredClone(axes[axes.length - 1] ?? fresh())),
      axes.length >= MAX_CHANNELS,
    ),
  ];
}

/** @param {Kit} kit @param {Place} place @param {any[]} axes @param {number} index */
function axisItem(kit, place, axes, index) {
  const { samples, put, block, item, kindSelect } = kit;
  const axis = axes[index];
  const path = `${place.axes}[${index}]`;
  const list = `${path}.moves`;
  const name = `axis ${index}${place.whose}`;
  const kind = Object.keys(axis.mechanics)[0];
  const head = element(
    "div",
    { class: "item-head" },
    kindSelect(`Mechanics of ${name}`, `${path}.mechanics`, kind, labels("Mechanics"), (chosen) =>
      put(`${path}.mechanics`, { [chosen]: samples.mechanics[chosen] }),
    ),
    ...(axes.length > 1
      ? [
          button("To all", `Copy ${name} to all others`, () =>
            put(
              place.axes,
              axes.map((other) => (other === axis ? axis : structuredClone(axis))),
            ),
          ),
        ]
      : []),
    button(
      "Copy",
      `Copy ${name}`,
      () => addAxis(kit, place, axes, structuredClone(axis)),
      axes.length >= MAX_CHANNELS,
    ),
    button("✕", `Remove ${name}`, () => removeAxis(kit, place, axes, index), axes.length <= place.least),
  );
  const fields = block(`${path}.mechanics.${kind}`, fieldsOfKind("Mechanics", kind));
  const moves = axis.moves.map((/** @type {any} */ _, /** @type {number} */ i) => moveItem(kit, list, axis.moves, i));
  const last = axis.moves[axis.moves.length - 1];
  const add = button(
    "Add move",
    `Add move to ${name}`,
    () => put(list, [...axis.moves, structuredClone(last ?? { cosine: samples.moves.cosine })]),
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
function moveItem({ samples, put, block, item, kindSelect }, list, moves, index) {
  const path = `${list}[${index}]`;
  const kind = Object.keys(moves[index])[0];
  const head = element(
    "div",
    { class: "item-head" },
    kindSelect(`Kind of move ${index + 1}`, path, kind, labels("Move"), (chosen) =>
      put(path, { [chosen]: samples.moves[chosen] }),
    ),
    button("↑", `Move ${index + 1} earlier`, () => put(list, swapped(moves, index - 1)), index === 0),
    button("✕", `Remove move ${index + 1}`, () => put(list, moves.toSpliced(index, 1)), moves.length === 1),
  );
  const note = element("p", { class: "item-note", "data-note": path });
  const fields = block(`${path}.${kind}`, pointsFirst(fieldsOfKind("Move", kind)));
  return item(`Move ${index + 1}`, path, [head, ...fields, note], `Move.${kind}`);
}

/** An axis needs its channel: the bus grows with it. @param {Kit} kit @param {Place} place @param {any[]} axes @param {any} axis */
function addAxis({ put, now }, place, axes, axis) {
  const grown = [...axes, axis];
  const path = `${place.bus}.channels`;
  const channels = Math.max(Number(get(now().scenario, path)) || 1, grown.length);
  put("", set(set(now().scenario, path, channels), place.axes, grown));
}

/** The spectrum stays with its axis, or goes to a neighbour of the one that is removed. @param {Kit} kit @param {Place} place @param {any[]} axes @param {number} index */
function removeAxis({ put, now }, place, axes, index) {
  const left = axes.toSpliced(index, 1);
  const without = set(now().scenario, place.axes, left);
  if (!place.axes.startsWith("source")) return put("", without);
  const selected = without.analysis.axis;
  put("", set(without, "analysis.axis", Math.min(selected > index ? selected - 1 : selected, left.length - 1)));
}

/** @param {any[]} list @param {number} index */
function swapped(list, index) {
  return list.toSpliced(index, 2, list[index + 1], list[index]);
}
