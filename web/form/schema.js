/** The schema of the core (`core/scenario/src/schema`) as fields, kinds, terms and samples for the form and the help. */

import { hintOf, plain } from "./schema_text.js";

/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("./field.js").Term} Term */
/** @typedef {import("./kit.js").Samples} Samples */
/** @typedef {"whole" | "number" | "bool" | "text" | "hex" | "point" | {words: Word[]} | {group: string} | {optional: Type} | {list: Type}} Type */
/** @typedef {{name: string, label: string, text: string}} Word */
/**
 * @typedef {{name: string, label: string, text: string, type: Type, range: string, most?: number, unit?: string, empty?: string,
 *   from?: string, when?: Field["when"]}} Row  A field of a group, or a kind of a choice.
 * @typedef {{doc: string, choice: boolean, default: any, fields: Row[]}} Group
 * @typedef {{documents: {[id: string]: {short: string, title: string}}, groups: {[name: string]: Group}}} Schema
 */

/** @type {Schema} */
let schema = { documents: {}, groups: {} };

/** Titles and texts of the help cards, by group and name, once loaded. @type {{[id: string]: [string, string]}} */
let explanations = {};

/** Sets the schema. @param {Schema} described */
export function setSchema(described) {
  schema = described;
}

/** Sets the texts of the help cards. @param {typeof explanations} all */
export function setExplanations(all) {
  explanations = all;
}

/** The papers. */
export const documents = () => schema.documents;

/** @param {string} group @param {string} name @returns {Row} */
function row(group, name) {
  const found = schema.groups[group]?.fields.find((each) => each.name === name);
  if (!found) throw new Error(`the schema has no ${group}.${name}`);
  return found;
}

/** The label of a field or a kind. @param {string} group @param {string} name */
export const labelOf = (group, name) => row(group, name).label;

/** The maximum length of a list. @param {string} group @param {string} name */
export const maxLengthOf = (group, name) => row(group, name).most ?? Number.POSITIVE_INFINITY;

/** A field of a group for the form. @param {string} group @param {string} name @returns {Field} */
export function field(group, name) {
  return fieldOf(group, row(group, name));
}

/** The field of an item of a list. @param {string} group @param {string} name @param {number} index @param {string} label @returns {Field} */
export function itemField(group, name, index, label) {
  const list = row(group, name);
  const { list: type } = /** @type {{list: Type}} */ (withoutOptional(list.type));
  return { ...fieldOf(group, { ...list, type }), key: `${name}[${index}]`, label, initial: null };
}

/** @param {string} group @param {Row} row @returns {Field} */
function fieldOf(group, { name, label, type, unit, when, ...texts }) {
  // An optional field can also be empty.
  const words = [...(isOptional(type) ? [{ name: "", label: texts.empty ?? "none" }] : []), ...wordsOf(type)];
  const units = quantity(withoutOptional(type));
  return {
    key: name,
    label,
    kind: kindOf(type, unit),
    hint: hintOf({ unit, ...texts }, type === "bool" ? [] : wordsOf(type), labelAt),
    term: `${group}.${name}`,
    range: texts.range,
    ...(unit && !units ? { unit } : {}),
    ...(wordsOf(type).length > 0 ? { choices: Object.fromEntries(words.map(({ name, label }) => [name, label])) } : {}),
    ...(units ? { units } : {}),
    ...(when ? { when } : {}),
    initial: schema.groups[group].default?.[name],
  };
}

/** The named fields of a group, or all with a single value. @param {string} group @param {string[]} [names] */
export function fields(group, names) {
  const singleValues = () =>
    schema.groups[group].fields.filter(({ type, unit }) => kindOf(type, unit) !== null).map(({ name }) => name);
  return (names ?? singleValues()).map((name) => field(group, name));
}

/** The labels of the kinds of a choice. @param {string} group @returns {{[kind: string]: string}} */
export function labels(group) {
  return Object.fromEntries(schema.groups[group].fields.map(({ name, label }) => [name, label]));
}

/** The fields of one of the kinds of a choice. @param {string} group @param {string} kind */
export function fieldsOfKind(group, kind) {
  return fields(groupIn(row(group, kind).type) ?? "");
}

/** The fields of a kind with their path below that of the choice. A kind that is a quantity has no fields of its own. @param {string} group @param {string} kind @returns {{path: string, fields: Field[]}} */
export function kindFields(group, kind) {
  const { type } = row(group, kind);
  return quantity(type)
    ? { path: "", fields: [field(group, kind)] }
    : { path: `.${kind}`, fields: fieldsOfKind(group, kind) };
}

/** The fields of a group that are choices of kinds with their own fields. @param {string} group @returns {{name: string, label: string, group: string}[]} */
export function choices(group) {
  return schema.groups[group].fields.flatMap(({ name, label, type }) => {
    const inner = groupIn(type) ?? "";
    return schema.groups[inner]?.choice && !quantity(type) ? [{ name, label, group: inner }] : [];
  });
}

/** The group of a kind. @param {string} group @param {string} kind */
export const groupOfKind = (group, kind) => groupIn(row(group, kind).type) ?? "";

/** The help text of a field or a kind. @param {string} id  Its group and its name, such as `Bus.slots`. @returns {Term | undefined} */
export function termOf(id) {
  const [group, name] = id.split(".");
  const found = schema.groups[group]?.fields.find((each) => each.name === name);
  if (!found) return undefined;
  const { label, text, from } = found;
  const [head, described] = explanations[id] ?? [label, text];
  return { name: head, text: plain(described, labelAt), from };
}

/** All terms by their ids. @returns {{[id: string]: Term}} */
export function terms() {
  return Object.fromEntries(
    Object.entries(schema.groups).flatMap(([group, { fields, choice }]) =>
      fields
        .filter(({ name, from }) => explanations[`${group}.${name}`] || (choice && from))
        .map(({ name }) => [`${group}.${name}`, /** @type {Term} */ (termOf(`${group}.${name}`))]),
    ),
  );
}

/** Defaults of everything that can be added. @returns {Samples} */
export function samples() {
  const defaultOf = (/** @type {string} */ group) => structuredClone(schema.groups[group]?.default);
  const defaultsByKind = (/** @type {string} */ group) =>
    Object.fromEntries(
      (schema.groups[group]?.fields ?? []).map(({ name, type }) => {
        const isList = typeof type === "object" && "list" in type;
        return [name, isList ? [defaultOf(groupIn(type.list) ?? "")] : defaultOf(groupIn(type) ?? "")];
      }),
    );
  return {
    moves: defaultsByKind("Move"),
    targets: defaultsByKind("Target"),
    shapers: defaultsByKind("InputShaper"),
    motion_groups: defaultsByKind("Group"),
    mechanics: defaultsByKind("Mechanics"),
    sources: defaultsByKind("Source"),
    glitch: defaultOf("Glitch"),
    send: defaultOf("ScriptedSend"),
    controller: defaultOf("Controller"),
    rules: defaultOf("TimingRules"),
    motor: defaultOf("Motor"),
    plant: defaultOf("PlantSettings"),
    protection: defaultOf("Protection"),
    plant_motor: defaultOf("PlantMotor"),
    groups: defaultsByKind("ProgramGroup"),
    until: defaultOf("Until"),
    homing: defaultOf("Homing"),
    soft_limits: defaultOf("SoftLimits"),
    axis: defaultOf("VirtualAxis"),
    input: defaultOf("PanelInput"),
  };
}

/** The label of a timing rule. @param {string} rule  Without its unit. */
export function ruleName(rule) {
  return schema.groups.TimingRules?.fields.find(({ name }) => name === `${rule}_ns`)?.label ?? rule;
}

/** @param {Type} type @returns {string | null} */
function groupIn(type) {
  return typeof type === "object" && "group" in type ? type.group : null;
}

/** The units of a quantity: names in JSON and labels. @param {Type} type */
function quantity(type) {
  const group = schema.groups[groupIn(type) ?? ""];
  const numbers = group?.choice && group.fields.every(({ type }) => type === "number");
  return numbers ? Object.fromEntries(group.fields.map(({ name, label }) => [name, label])) : null;
}

/** The words of a choice. @param {Type} type @returns {Word[]} */
function wordsOf(type) {
  if (type === "bool")
    return [
      ["false", "no"],
      ["true", "yes"],
    ].map(([name, label]) => ({ name, label, text: label }));
  if (isOptional(type)) return wordsOf(type.optional);
  return typeof type === "object" && "words" in type ? type.words : [];
}

/** @param {Type} type @returns {type is {optional: Type}} */
function isOptional(type) {
  return typeof type === "object" && "optional" in type;
}

/** The kind of a field; null if it is not a single value. @param {Type} type @param {string} [unit] @returns {any} */
function kindOf(type, unit) {
  if (type === "whole") return unit === "cycles" ? "cycles" : "integer";
  if (type === "bool") return "choice";
  if (typeof type === "string") return type === "point" ? null : type;
  if ("words" in type) return "choice";
  if ("group" in type) return quantity(type) ? "quantity" : null;
  if ("optional" in type) {
    const inner = kindOf(type.optional, unit);
    if (inner === "choice") return inner;
    return inner && (inner === "integer" ? "optional" : `optional-${inner}`);
  }
  if (type.list === "hex") return "lines";
  if (type.list === "whole") return "wholes";
  if (type.list === "point") return "points";
  return groupIn(type.list) === "Segment" ? "segments" : null;
}

/** The label of a field or word by its name or path; undefined for other text. @param {string} path */
function labelAt(path) {
  const names = path.split(/[.[\]\d]+(?!_)/).filter(Boolean);
  const name = /** @type {string} */ (names.pop());
  const fields = Object.values(schema.groups).flatMap((group) => group.fields);
  const parent = groupIn(withoutOptional(fields.find((field) => field.name === names.at(-1))?.type ?? "text"));
  const inParent = schema.groups[parent ?? ""]?.fields.find((field) => field.name === name);
  const words = () => fields.flatMap(({ type }) => (type === "bool" ? [] : wordsOf(type)));
  return (inParent ?? fields.find((field) => field.name === name) ?? words().find((word) => word.name === name))?.label;
}

/** A path as text: the label of its field, with the numbers of move, axis and controller. @param {string} path */
export function pathText(path) {
  const indexOf = (/** @type {string} */ list) =>
    Number(new RegExp(`\\b${list}\\[(\\d+)\\]`).exec(path)?.[1] ?? Number.NaN);
  const [move, axis, controller] = ["moves", "axes", "controllers"].map(indexOf);
  return [
    labelAt(path) ?? path,
    ...(move >= 0 ? [`move ${move + 1}`] : []),
    ...(axis >= 0 ? [`axis ${axis}`] : []),
    ...(controller >= 0 ? [`controller ${controller + 2}`] : []),
  ].join(", ");
}

/** The type of the value of an optional type. @param {Type} type @returns {Type} */
function withoutOptional(type) {
  return isOptional(type) ? type.optional : type;
}

/** A message of the core with labels instead of names: “Channels” instead of `bus.channels`. @param {string} text */
export function withLabels(text) {
  return text.replace(/`([\w.[\]]+)`|\b[a-z]+(?:_[a-z0-9]+)+\b/g, (found, quoted) => {
    const label = labelAt(quoted ?? found);
    return label ? `“${label}”` : (quoted ?? found);
  });
}
