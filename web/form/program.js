/** The program of a stand-alone controller in the form. */
import { button, element } from "../dom.js";
import { get } from "../state/paths.js";
import { pointsFirst } from "./fields.js";
import { choiceBlock } from "./panel_fields.js";
import { lengthText, withoutGroup, withRaisedGroup } from "./program_groups.js";
import { fields, fieldsOfKind, labels, maxLengthOf } from "./schema.js";
import { removed } from "./structure.js";

/** @typedef {import("./kit.js").Kit} Kit */
/** @typedef {import("./field.js").Field} Field */

/** Path of all stand-alone controllers. */
export const STAND_ALONE = "source.standalone";

/** @param {Kit} kit @param {string} at  Path of the controller. @param {any[]} groups @param {string} suffix  Of names, if there are several controllers. @returns {Node[]} */
export function programItems(kit, at, groups, suffix) {
  const list = `${at}.groups`;
  return [
    kit.errorOf(list),
    ...groups.map((_, index) => groupItem(kit, at, groups, index, suffix)),
    button(
      "Add group",
      `Add group to ${at.slice(STAND_ALONE.length)}`.replace(/\[(\d+)\]/, "controller $1"),
      () => kit.append(list, (last) => structuredClone(last ?? { move: kit.samples.groups.move })),
      groups.length >= maxLengthOf("StandAlone", "groups"),
    ),
  ];
}

/** @param {Kit} kit @param {string} at @param {any[]} groups @param {number} index @param {string} suffix */
function groupItem(kit, at, groups, index, suffix) {
  const list = `${at}.groups`;
  const path = `${list}[${index}]`;
  const kind = Object.keys(groups[index])[0];
  const head = element(
    "div",
    { class: "item-head" },
    kit.kindSelect(`Kind of group ${index + 1}${suffix}`, path, kind, labels("ProgramGroup"), (to) =>
      kit.become(path, "ProgramGroup", to, kit.samples.groups[to]),
    ),
    button("↑", `Group ${index + 1}${suffix} earlier`, () => raiseGroup(kit, list, index), index === 0),
    button("✕", `Remove group ${index + 1}${suffix}`, () => removeGroup(kit, list, index), groups.length === 1),
  );
  const groupFields = fieldsOfKind("ProgramGroup", kind).map((each) =>
    each.key === "length" ? withLengthText(each, at) : each,
  );
  const own = `${path}.${kind}`;
  const more =
    kind === "move"
      ? until(kit, own, groups[index].move)
      : kind === "profile"
        ? profile(kit, own, groups[index].profile)
        : [];
  return kit.item(
    `Group ${index + 1}`,
    path,
    [
      head,
      ...(kind === "profile" ? more : []),
      ...choiceBlock(kit, own, groupFields),
      ...(kind === "move" ? more : []),
    ],
    `ProgramGroup.${kind}`,
  );
}

/** @param {Kit} kit @param {string} path @param {any} move @returns {Node[]} */
function until(kit, path, move) {
  const at = `${path}.until`;
  const untilFields = fields("Until").map((each) =>
    each.key === "input"
      ? {
          ...each,
          choices: Object.fromEntries(Object.entries(each.choices ?? {}).filter(([name]) => !name.startsWith("limit"))),
        }
      : each,
  );
  return [
    kit.errorOf(at),
    kit.toggle(at, "End early on an input level", Boolean(move.until), kit.samples.until),
    ...(move.until ? choiceBlock(kit, at, untilFields) : []),
  ];
}

/** @param {Kit} kit @param {string} path @param {any} group @returns {Node[]} */
function profile(kit, path, group) {
  const at = `${path}.motion`;
  const kind = group.motion && Object.keys(group.motion)[0];
  const { moves } = kit.samples;
  return [
    kit.errorOf(at),
    kit.toggle(at, "Use a motion instead of a list of intervals", Boolean(kind), { cosine: moves.cosine }),
    ...(kind
      ? [
          kit.kindSelect("Kind of profile motion", at, kind, labels("Move"), (to) =>
            kit.become(at, "Move", to, moves[to]),
          ),
          ...kit.block(`${at}.${kind}`, pointsFirst(fieldsOfKind("Move", kind))),
        ]
      : []),
  ];
}

/** @param {Kit} kit @param {string} list @param {number} index */
function removeGroup(kit, list, index) {
  kit.change(list, (groups) => withoutGroup(groups, index), removed(list, index, kit.now()));
}

/** @param {Kit} kit @param {string} list @param {number} index */
function raiseGroup(kit, list, index) {
  kit.change(list, (groups) => withRaisedGroup(groups, index), [
    [`${list}[${index}]`, `${list}[${index - 1}]`],
    [`${list}[${index - 1}]`, `${list}[${index}]`],
  ]);
}

/** Adds the length in units and steps to the field of its digits. @param {Field} field @param {string} at @returns {Field} */
function withLengthText(field, at) {
  return { ...field, also: (value, { scenario }) => lengthText(value, get(scenario, at) ?? {}) };
}
