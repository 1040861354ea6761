/** An additional controller in the form: its address, its bus and what it is to do. */
import { button, element } from "../dom.js";
import { MAX_FURTHER } from "../state/state.js";
import { controllerFields } from "./fields.js";
import { SOURCES } from "./sources.js";

/** @typedef {import("../state/types.js").Scenario} Scenario */
/** @typedef {import("./kit.js").Kit} Kit */

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
    button("Copy", `Copy ${name.toLowerCase()}`, () => add(index), all.length >= MAX_FURTHER),
    button("✕", `Remove ${name.toLowerCase()}`, () => kit.remove("controllers", index)),
  );
  return part(name, true, [
    errorOf(path),
    head,
    ...block(path, own),
    ...block(`${path}.bus`, bus),
    part(`Pulses and queue of controller ${index + 2}`, false, block(`${path}.bus`, folded)),
    ...SOURCES[kind].orderForm(kit, index),
  ]);
}
