/**
 * Stand-alone controllers in the form: rates and units, the program as a table of groups, jog, return, homing, limits, axis,
 * memory and inputs. It loads when such a source is first on show.
 */
import { button, element } from "../dom.js";
import { MAX_CHANNELS } from "../state/limits.js";
import { count } from "../state/number.js";
import { get, set } from "../state/paths.js";
import { pointsFirst } from "./fields.js";
import { fields, fieldsOfKind, labelOf, labels, mostOf } from "./schema.js";
import { removed } from "./structure.js";

/** @typedef {import("./kit.js").Kit} Kit */
/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("../state/types.js").Scenario} Scenario */

const LIST = "source.standalone";
/** What every user sets; the rest is folded away. */
const FIRST = ["pulses_per_unit", "decimals", "start_speed_hz", "max_speed_hz", "level_hz_s", "short_move", "loops"];
/** Inputs that the form lists; the view Panel has all of them. */
const MAX_INPUT_ROWS = 40;
/** What can be chosen where the schema has 0 and 1. */
const CHOICES = {
  direction: { 1: "1 (right)", 0: "0 (left)" },
  level: { 0: "0", 1: "1" },
};

/** @param {Kit} kit @param {Scenario} scenario @returns {Node[]} */
export function standAloneItems(kit, scenario) {
  /** @type {any[]} */
  const all = scenario.source.standalone;
  return [
    kit.errorOf(LIST),
    ...all.map((_, index) => panelItem(kit, all, index)),
    button(
      "Add controller",
      "Add controller",
      () => add(kit, () => kit.samples.sources.standalone[0]),
      all.length >= MAX_CHANNELS,
    ),
  ];
}

/** A controller needs its channel: the bus grows with it. @param {Kit} kit @param {(all: any[]) => any} like */
function add({ change }, like) {
  change("", (scenario) => {
    const grown = [...scenario.source.standalone, structuredClone(like(scenario.source.standalone))];
    const channels = Math.max(Number(scenario.bus.channels) || 1, grown.length);
    return set(set(scenario, "bus.channels", channels), LIST, grown);
  });
}

/** @param {Kit} kit @param {any[]} all @param {number} index */
function panelItem(kit, all, index) {
  const at = `${LIST}[${index}]`;
  const panel = all[index];
  const name = `stand-alone controller ${index}`;
  const whose = all.length > 1 ? ` of controller ${index}` : "";
  const every = heeded(at, fields("StandAlone"));
  const own = every.filter(({ key }) => FIRST.includes(key));
  const rest = every.filter(({ key }) => !FIRST.includes(key));
  /** What power, emergency stop and clear are, the first one's inputs say for all. @param {any[]} now */
  const copy = (now) => ({ ...now[index], inputs: [] });
  const head = element(
    "div",
    { class: "item-head end" },
    button("Copy", `Copy ${name}`, () => add(kit, copy), all.length >= MAX_CHANNELS),
    button(
      "✕",
      `Remove ${name}`,
      () => kit.change(LIST, (list) => list.toSpliced(index, 1), removed(LIST, index, kit.now())),
      all.length === 1,
    ),
  );
  const block = (/** @type {string} */ key, /** @type {string} */ group) => chosen(kit, `${at}.${key}`, fields(group));
  const part = (/** @type {string} */ key, /** @type {string} */ group) =>
    kit.part(labelOf("StandAlone", key) + whose, false, block(key, group));
  const optional = (/** @type {string} */ key, /** @type {string} */ group, /** @type {any} */ sample) => {
    const label = labelOf("StandAlone", key);
    return kit.part(label + whose, Boolean(panel[key]), [
      kit.errorOf(`${at}.${key}`),
      kit.toggle(`${at}.${key}`, label, Boolean(panel[key]), sample),
      ...(panel[key] ? block(key, group) : []),
    ]);
  };
  return kit.item(
    `Controller ${index} · channel ${index}`,
    at,
    [
      head,
      ...kit.block(at, own),
      kit.part(`Self-test, debouncing, trust${whose}`, false, kit.block(at, rest)),
      ...program(kit, at, panel.groups ?? [], whose),
      part("jog", "Jog"),
      part("return", "ReturnToZero"),
      optional("home", "Homing", kit.samples.homing),
      optional("soft_limits", "SoftLimits", kit.samples.soft_limits),
      optional("axis", "VirtualAxis", kit.samples.axis),
      part("memory", "Eeprom"),
      kit.part(`${labelOf("StandAlone", "inputs")}${whose}`, false, inputs(kit, `${at}.inputs`, panel.inputs ?? [])),
    ],
    "Source.standalone",
  );
}

/** @param {Kit} kit @param {string} at  The controller's path. @param {any[]} groups @param {string} whose  Where there are several. @returns {Node[]} */
function program(kit, at, groups, whose) {
  const list = `${at}.groups`;
  return [
    kit.errorOf(list),
    ...groups.map((_, index) => groupItem(kit, at, groups, index, whose)),
    button(
      "Add group",
      `Add group to ${at.slice(LIST.length)}`.replace(/\[(\d+)\]/, "controller $1"),
      () => kit.append(list, (last) => structuredClone(last ?? { move: kit.samples.groups.move })),
      groups.length >= mostOf("StandAlone", "groups"),
    ),
  ];
}

/** Groups that a group names, by its kind. @type {{[kind: string]: string}} */
const NAMED = { repeat: "first", wait: "then", jump: "to" };

/** Groups whose numbers have changed: those that name them still mean the same ones. @param {any[]} groups @param {(number: number) => number} to  New numbers, from 1. */
function renumbered(groups, to) {
  return groups.map((group) => {
    const [kind] = Object.keys(group);
    const key = NAMED[kind];
    const number = key && group[kind][key];
    return Number.isInteger(number) ? { [kind]: { ...group[kind], [key]: to(number) } } : group;
  });
}

/** @param {Kit} kit @param {string} list @param {number} index */
function removeGroup(kit, list, index) {
  // What named the one that goes names the one that follows it, or the last one.
  const to = (/** @type {number} */ number) => Math.max(1, number > index + 1 ? number - 1 : number);
  kit.change(
    list,
    (groups) => {
      const left = renumbered(groups.toSpliced(index, 1), to);
      return renumbered(left, (number) => Math.min(number, left.length));
    },
    removed(list, index, kit.now()),
  );
}

/** @param {Kit} kit @param {string} list @param {number} index */
function raiseGroup(kit, list, index) {
  const to = (/** @type {number} */ number) => (number === index + 1 ? index : number === index ? index + 1 : number);
  kit.change(list, (groups) => renumbered(groups.toSpliced(index - 1, 2, groups[index], groups[index - 1]), to), [
    [`${list}[${index}]`, `${list}[${index - 1}]`],
    [`${list}[${index - 1}]`, `${list}[${index}]`],
  ]);
}

/** @param {Kit} kit @param {string} at @param {any[]} groups @param {number} index @param {string} whose */
function groupItem(kit, at, groups, index, whose) {
  const list = `${at}.groups`;
  const path = `${list}[${index}]`;
  const kind = Object.keys(groups[index])[0];
  const head = element(
    "div",
    { class: "item-head" },
    kit.kindSelect(`Kind of group ${index + 1}${whose}`, path, kind, labels("ProgramGroup"), (to) =>
      kit.become(path, "ProgramGroup", to, kit.samples.groups[to]),
    ),
    button("↑", `Group ${index + 1}${whose} earlier`, () => raiseGroup(kit, list, index), index === 0),
    button("✕", `Remove group ${index + 1}${whose}`, () => removeGroup(kit, list, index), groups.length === 1),
  );
  const given = fieldsOfKind("ProgramGroup", kind).map((each) => (each.key === "length" ? inUnits(each, at) : each));
  // Of moves the level is an acceleration.
  const isMove = kind === "move" || kind === "move_to";
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
      ...chosen(kit, own, given, isMove ? ["direction"] : undefined),
      ...(kind === "move" ? more : []),
    ],
    `ProgramGroup.${kind}`,
  );
}

/** A length in units and in steps, beside its digits. @param {Field} field @param {string} at @returns {Field} */
function inUnits(field, at) {
  return {
    ...field,
    also: (value, { scenario }) => {
      const { decimals, pulses_per_unit } = get(scenario, at) ?? {};
      if (!Number.isInteger(value) || !(decimals >= 0 && decimals <= 3) || !(pulses_per_unit > 0)) return "";
      const scale = 10 ** decimals;
      const steps = Math.floor((2 * value * pulses_per_unit + scale) / (2 * scale));
      return `= ${(value / scale).toFixed(decimals)} units, ${count(steps)} steps`;
    },
  };
}

/** @param {Kit} kit @param {string} path @param {any} move @returns {Node[]} */
function until(kit, path, move) {
  const at = `${path}.until`;
  const given = fields("Until").map((each) =>
    each.key === "input"
      ? {
          ...each,
          choices: Object.fromEntries(Object.entries(each.choices ?? {}).filter(([name]) => !name.startsWith("limit"))),
        }
      : each,
  );
  return [
    kit.errorOf(at),
    kit.toggle(at, "Ends early, when an input has a level", Boolean(move.until), kit.samples.until),
    ...(move.until ? chosen(kit, at, given) : []),
  ];
}

/** @param {Kit} kit @param {string} path @param {any} given @returns {Node[]} */
function profile(kit, path, given) {
  const at = `${path}.motion`;
  const kind = given.motion && Object.keys(given.motion)[0];
  const { moves } = kit.samples;
  return [
    kit.errorOf(at),
    kit.toggle(at, "By a motion, not by intervals", Boolean(kind), { cosine: moves.cosine }),
    ...(kind
      ? [
          kit.kindSelect("Kind of the profile's motion", at, kind, labels("Move"), (to) =>
            kit.become(at, "Move", to, moves[to]),
          ),
          ...kit.block(`${at}.${kind}`, pointsFirst(fieldsOfKind("Move", kind))),
        ]
      : []),
  ];
}

/** Fields that tell what holds, but may not be meant. @param {string} path @param {Field[]} given @returns {Field[]} */
function heeded(path, given) {
  return given.map((each) => ({
    ...each,
    also: (value, state) => {
      const at = `${path}.${each.key}`;
      const warning = state.validation?.warnings.find((/** @type {{path: string}} */ one) => one.path === at);
      return warning?.message ?? each.also?.(value, state) ?? "";
    },
  }));
}

/** Fields of which those that are 0 or 1 are chosen. @param {Kit} kit @param {string} path @param {Field[]} given @param {string[]} [keys]  Which those are; of jog, return and moves the level is an acceleration. */
function chosen(kit, path, given, keys = /jog$|return$/.test(path) ? ["direction"] : ["direction", "level"]) {
  return kit.block(
    path,
    heeded(path, given).map((each) =>
      keys.includes(each.key) && each.key in CHOICES
        ? { ...each, kind: "choice", choices: CHOICES[/** @type {keyof typeof CHOICES} */ (each.key)] }
        : each,
    ),
  );
}

/** @param {Kit} kit @param {string} path @param {any[]} list @returns {Node[]} */
function inputs(kit, path, list) {
  const more = list.length - MAX_INPUT_ROWS;
  const given = fields("PanelInput").map((each) =>
    each.key === "level" ? { ...each, kind: /** @type {const} */ ("choice"), choices: CHOICES.level } : each,
  );
  const fresh = (/** @type {any} */ last) =>
    last
      ? { ...last, cycle: last.cycle + Math.round(kit.now().scenario.clock_hz / 10), level: 1 - last.level }
      : { ...kit.samples.input, input: "start" };
  const rows = kit.rows(path, list.slice(0, MAX_INPUT_ROWS), given, "Input", fresh, "StandAlone.inputs");
  return [
    kit.errorOf(path),
    element("p", { class: "item-note" }, "The view Panel puts presses here, and moves them."),
    ...(more > 0 ? rows.slice(0, -1) : rows),
    ...(more > 0 ? [element("p", { class: "item-note" }, `${count(more)} more are in the view Panel.`)] : []),
  ];
}
