/**
 * Stand-alone controllers in the form: rates and units, the program as a table of groups, jog, return, homing, limits, axis,
 * memory and inputs. Loaded with the first such source.
 */
import { button, element } from "../dom.js";
import { MAX_CHANNELS } from "../state/limits.js";
import { count } from "../state/number.js";
import { set } from "../state/paths.js";
import { CHOICES, choiceBlock, withWarnings } from "./panel_fields.js";
import { programItems, STAND_ALONE } from "./program.js";
import { fields, labelOf } from "./schema.js";
import { removed } from "./structure.js";

/** @typedef {import("./kit.js").Kit} Kit */
/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("../state/types.js").Scenario} Scenario */

/** Fields that every user needs; the others are folded. */
const BASIC_FIELDS = [
  "pulses_per_unit",
  "decimals",
  "start_speed_hz",
  "max_speed_hz",
  "level_hz_s",
  "short_move",
  "loops",
];
/** Inputs that the form lists; the view Panel has all of them. */
const MAX_INPUT_ROWS = 40;
/** @param {Kit} kit @param {Scenario} scenario @returns {Node[]} */
export function standAloneItems(kit, scenario) {
  /** @type {any[]} */
  const all = scenario.source.standalone;
  return [
    kit.errorOf(STAND_ALONE),
    ...all.map((_, index) => panelItem(kit, all, index)),
    button(
      "Add controller",
      "Add controller",
      () => add(kit, () => kit.samples.sources.standalone[0]),
      all.length >= MAX_CHANNELS,
    ),
  ];
}

/** Adds a controller, and a channel if needed. @param {Kit} kit @param {(all: any[]) => any} templateOf  The controller to copy. */
function add({ change }, templateOf) {
  change("", (scenario) => {
    const grown = [...scenario.source.standalone, structuredClone(templateOf(scenario.source.standalone))];
    const channels = Math.max(Number(scenario.bus.channels) || 1, grown.length);
    return set(set(scenario, "bus.channels", channels), STAND_ALONE, grown);
  });
}

/** @param {Kit} kit @param {any[]} all @param {number} index */
function panelItem(kit, all, index) {
  const at = `${STAND_ALONE}[${index}]`;
  const panel = all[index];
  const name = `stand-alone controller ${index}`;
  const suffix = all.length > 1 ? ` of controller ${index}` : "";
  const allFields = withWarnings(at, fields("StandAlone"));
  const basicFields = allFields.filter(({ key }) => BASIC_FIELDS.includes(key));
  const otherFields = allFields.filter(({ key }) => !BASIC_FIELDS.includes(key));
  /** Power, emergency stop and clear are shared inputs of the first controller, so a copy has no inputs. @param {any[]} now */
  const copy = (now) => ({ ...now[index], inputs: [] });
  const head = element(
    "div",
    { class: "item-head end" },
    button("Copy", `Copy ${name}`, () => add(kit, copy), all.length >= MAX_CHANNELS),
    button(
      "✕",
      `Remove ${name}`,
      () => kit.change(STAND_ALONE, (list) => list.toSpliced(index, 1), removed(STAND_ALONE, index, kit.now())),
      all.length === 1,
    ),
  );
  const block = (/** @type {string} */ key, /** @type {string} */ group) =>
    choiceBlock(kit, `${at}.${key}`, fields(group));
  const part = (/** @type {string} */ key, /** @type {string} */ group) =>
    kit.part(labelOf("StandAlone", key) + suffix, false, block(key, group));
  const optional = (/** @type {string} */ key, /** @type {string} */ group, /** @type {any} */ sample) => {
    const label = labelOf("StandAlone", key);
    return kit.part(label + suffix, Boolean(panel[key]), [
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
      ...kit.block(at, basicFields),
      kit.part(`Self-test, debounce, position${suffix}`, false, kit.block(at, otherFields)),
      ...programItems(kit, at, panel.groups ?? [], suffix),
      part("jog", "Jog"),
      part("return", "ReturnToZero"),
      optional("home", "Homing", kit.samples.homing),
      optional("soft_limits", "SoftLimits", kit.samples.soft_limits),
      optional("axis", "VirtualAxis", kit.samples.axis),
      part("memory", "Eeprom"),
      kit.part(`${labelOf("StandAlone", "inputs")}${suffix}`, false, inputs(kit, `${at}.inputs`, panel.inputs ?? [])),
    ],
    "Source.standalone",
  );
}

/** @param {Kit} kit @param {string} path @param {any[]} list @returns {Node[]} */
function inputs(kit, path, list) {
  const more = list.length - MAX_INPUT_ROWS;
  const inputFields = fields("PanelInput").map((each) =>
    each.key === "level" ? { ...each, kind: /** @type {const} */ ("choice"), choices: CHOICES.level } : each,
  );
  const createInput = (/** @type {any} */ last) =>
    last
      ? { ...last, cycle: last.cycle + Math.round(kit.now().scenario.clock_hz / 10), level: 1 - last.level }
      : { ...kit.samples.input, input: "start" };
  const rows = kit.rows(path, list.slice(0, MAX_INPUT_ROWS), inputFields, "Input", createInput, "StandAlone.inputs");
  return [
    kit.errorOf(path),
    element("p", { class: "item-note" }, "Use the view Panel to add and move presses."),
    ...(more > 0 ? rows.slice(0, -1) : rows),
    ...(more > 0 ? [element("p", { class: "item-note" }, `${count(more)} more in the view Panel.`)] : []),
  ];
}
