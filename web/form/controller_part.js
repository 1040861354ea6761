/** An additional controller in the form. */
import { button, element } from "../dom.js";
import { MAX_ADDITIONAL_CONTROLLERS } from "../state/limits.js";
import { fields } from "./schema.js";
import { SOURCES } from "./sources.js";

/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("../state/types.js").Scenario} Scenario */
/** @typedef {import("./kit.js").Kit} Kit */

/** The common fields of a bus. */
const BUS_SIZE = ["channels", "slots", "step_period_cycles"];

/** The fields of an additional controller and its bus; `folded` ones are rarely used. @returns {{own: Field[], bus: Field[], folded: Field[]}} */
const controllerFields = () => ({
  own: fields("Controller").filter(({ kind }) => kind !== "lines"),
  bus: fields("Bus", BUS_SIZE),
  folded: fields("Bus").filter(({ key }) => !BUS_SIZE.includes(key)),
});

/** @param {Kit} kit @param {Scenario} scenario @param {number} index @param {(index: number) => void} add */
export function controllerPart(kit, scenario, index, add) {
  const { block, part, errorOf } = kit;
  const all = scenario.controllers;
  const path = `controllers[${index}]`;
  const name = `Controller ${index + 2}`;
  const kind = Object.keys(scenario.source)[0];
  const { own, bus, folded } = controllerFields();
  const head = element(
    "div",
    { class: "item-head end" },
    button("Copy", `Copy ${name.toLowerCase()}`, () => add(index), all.length >= MAX_ADDITIONAL_CONTROLLERS),
    button("✕", `Remove ${name.toLowerCase()}`, () => kit.remove("controllers", index)),
  );
  return part(name, true, [
    errorOf(path),
    head,
    ...block(path, own),
    ...block(`${path}.bus`, bus),
    part(`Pulses and queue of controller ${index + 2}`, false, block(`${path}.bus`, folded)),
    ...SOURCES[kind].additionalForm(kit, index),
  ]);
}
