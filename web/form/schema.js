/**
 * The scenario's schema as the core describes it (`core/scenario/src/schema`), made what the form and the help take:
 * fields with label, unit, hint and choices; kinds; terms; and one of everything with its defaults. Nothing is said of
 * a field here: a row of the core says it.
 */

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

/** Heads and texts of the terms' cards, by group and name, once they are loaded. @type {{[id: string]: [string, string]}} */
let explanations = {};

/** Takes what the core says; nothing is built before. @param {Schema} described */
export function takeSchema(described) {
  schema = described;
}

/** Takes what terms mean. @param {typeof explanations} all */
export function takeExplanations(all) {
  explanations = all;
}

/** Where terms come from. */
export const documents = () => schema.documents;

/** @param {string} group @param {string} name @returns {Row} */
function row(group, name) {
  const found = schema.groups[group]?.fields.find((each) => each.name === name);
  if (!found) throw new Error(`the schema has no ${group}.${name}`);
  return found;
}

/** What a field or a kind is called. @param {string} group @param {string} name */
export const labelOf = (group, name) => row(group, name).label;

/** How many a list may have. @param {string} group @param {string} name */
export const mostOf = (group, name) => row(group, name).most ?? Number.POSITIVE_INFINITY;

/** A field of a group as the form takes it. @param {string} group @param {string} name @returns {Field} */
export function field(group, name) {
  const { label, type, unit, when, ...given } = row(group, name);
  // None of them is one more to choose.
  const words = [...(isOptional(type) ? [{ name: "", label: given.empty ?? "none" }] : []), ...wordsOf(type)];
  const units = quantity(type);
  return {
    key: name,
    label,
    kind: kindOf(type, unit),
    hint: hintOf({ type, unit, ...given }),
    term: `${group}.${name}`,
    ...(unit && !units ? { unit } : {}),
    ...(wordsOf(type).length > 0 ? { choices: Object.fromEntries(words.map(({ name, label }) => [name, label])) } : {}),
    ...(units ? { units } : {}),
    ...(when ? { when } : {}),
    initial: schema.groups[group].default?.[name],
  };
}

/** Fields of a group: those that are named, or all that are typed as one value. @param {string} group @param {string[]} [names] */
export function fields(group, names) {
  const typed = () =>
    schema.groups[group].fields.filter(({ type, unit }) => kindOf(type, unit) !== null).map(({ name }) => name);
  return (names ?? typed()).map((name) => field(group, name));
}

/** The kinds of a choice by their names: what each is called. @param {string} group @returns {{[kind: string]: string}} */
export function labels(group) {
  return Object.fromEntries(schema.groups[group].fields.map(({ name, label }) => [name, label]));
}

/** The fields of one of the kinds of a choice. @param {string} group @param {string} kind */
export function fieldsOfKind(group, kind) {
  return fields(groupIn(row(group, kind).type) ?? "");
}

/** What is meant by a field or a kind. @param {string} id  Its group and its name, such as `Bus.slots`. @returns {Term | undefined} */
export function termOf(id) {
  const [group, name] = id.split(".");
  const found = schema.groups[group]?.fields.find((each) => each.name === name);
  if (!found) return undefined;
  const { label, text, from } = found;
  const [head, described] = explanations[id] ?? [label, text];
  return { name: head, text: plain(described), from };
}

/** All terms of groups or of all but those, by their ids. @returns {{[id: string]: Term}} */
export function terms() {
  return Object.fromEntries(
    Object.entries(schema.groups).flatMap(([group, { fields, choice }]) =>
      fields
        .filter(({ name, from }) => explanations[`${group}.${name}`] || (choice && from))
        .map(({ name }) => [`${group}.${name}`, /** @type {Term} */ (termOf(`${group}.${name}`))]),
    ),
  );
}

/** One of everything that can be added, with the core's own defaults. @returns {Samples} */
export function samples() {
  // Of stand-alone controllers nothing is known before their part of the core is there.
  const one = (/** @type {string} */ group) => structuredClone(schema.groups[group]?.default);
  const each = (/** @type {string} */ group) =>
    Object.fromEntries(
      (schema.groups[group]?.fields ?? []).map(({ name, type }) => {
        const isList = typeof type === "object" && "list" in type;
        return [name, isList ? [one(groupIn(type.list) ?? "")] : one(groupIn(type) ?? "")];
      }),
    );
  return {
    moves: each("Move"),
    mechanics: each("Mechanics"),
    sources: each("Source"),
    glitch: one("Glitch"),
    send: one("ScriptedSend"),
    controller: one("Controller"),
    rules: one("TimingRules"),
    motor: one("Motor"),
    plant: one("PlantSettings"),
    protection: one("Protection"),
    plant_motor: one("PlantMotor"),
    groups: each("ProgramGroup"),
    until: one("Until"),
    homing: one("Homing"),
    soft_limits: one("SoftLimits"),
    axis: one("VirtualAxis"),
    input: one("PanelInput"),
  };
}

/** The name of a rule of a driver's timing. @param {string} rule  Without its unit. */
export function ruleName(rule) {
  return schema.groups.TimingRules?.fields.find(({ name }) => name === `${rule}_ns`)?.label ?? rule;
}

/** @param {Type} type @returns {string | null} */
function groupIn(type) {
  return typeof type === "object" && "group" in type ? type.group : null;
}

/** The units of a number that has some: JSON's name to the printed one. @param {Type} type */
function quantity(type) {
  const group = schema.groups[groupIn(type) ?? ""];
  const numbers = group?.choice && group.fields.every(({ type }) => type === "number");
  return numbers ? Object.fromEntries(group.fields.map(({ name, label }) => [name, label])) : null;
}

/** What may be chosen. @param {Type} type @returns {Word[]} */
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

/** How a value is typed; null where it is no single one. @param {Type} type @param {string} [unit] @returns {any} */
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

/** What a field is, which values it takes and what none of them means, in sentences. @param {Pick<Row, "text" | "type" | "range" | "empty" | "unit">} row */
function hintOf({ text, type, range, empty, unit }) {
  const words = type === "bool" ? [] : wordsOf(type);
  const described = words.filter(({ label, text }) => text !== label);
  const parts = [
    text,
    ...described.map(({ label, text }) => capital(text.startsWith(label) ? text : `${label}: ${text}`)),
    capital(range),
    empty && `Empty: ${empty}`,
    unit === "cycles" || unit === "ns" ? "A time such as 2.5 us is taken too" : "",
  ];
  return parts
    .filter((part) => part)
    .map((part) => plain(/** @type {string} */ (part)).replace(/\.?$/, "."))
    .join(" ");
}

/** @param {string} text */
const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** Text of the documentation as the page prints it. @param {string} text */
function plain(text) {
  const raised = (/** @type {string} */ digits) =>
    [...digits].map((digit) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(digit)]).join("");
  return text
    .replaceAll("`", "")
    .replace(/\^(-?\d+)/g, (_, digits) => raised(digits))
    .replace(/(?<=\w)\*(?=\w)/g, " · ")
    .replace(/ - (?=\d)/g, " − ")
    .replace(/(?<!\S)-(?=\d)/g, "−");
}
