/** Additional controllers on the line, each with its address, bus and commands. */
import { button } from "../dom.js";
import { MAX_ADDITIONAL_CONTROLLERS } from "../state/limits.js";
import { hex } from "./source_kinds.js";
import { SOURCES } from "./sources.js";

/** @typedef {import("../state/types.js").Scenario} Scenario */
/** @typedef {import("./kit.js").Kit} Kit */

/** @param {Kit} kit @param {Scenario} scenario @returns {Node[]} */
export function controllerItems(kit, scenario) {
  const { change, errorOf, samples } = kit;
  /** @type {any[]} */
  const all = scenario.controllers;
  /** Adds a copy of an additional controller, or of the first one. @param {number} index */
  const add = (index) => change("", (now) => withAnother(now, now.controllers[index] ?? null, samples));
  return [
    errorOf("controllers"),
    ...(all.length > 0
      ? kit.loadItems((parts) => all.map((_, index) => parts.controllerPart(kit, scenario, index, add)))
      : []),
    button("Add controller", "Add controller", () => add(all.length - 1), all.length >= MAX_ADDITIONAL_CONTROLLERS),
  ];
}

/**
 * The scenario with an additional controller: a copy of `template`, or of the first one, with an unused address. On a raw line
 * the first one then needs an address, too.
 * @param {Scenario} scenario @param {any} template @param {import("./kit.js").Samples} samples
 */
function withAnother(scenario, template, samples) {
  const { line, source } = scenario;
  const scenarioWithAddress = line.protocol === "raw" && line.address === null ? withAddress(scenario, 0) : scenario;
  const usedAddresses = [
    line.address ?? 0,
    ...scenario.controllers.map((/** @type {any} */ controller) => controller.address),
  ];
  const address =
    Array.from({ length: 255 }, (_, i) => i).find((i) => i > usedAddresses[0] && !usedAddresses.includes(i)) ??
    Array.from({ length: 255 }, (_, i) => i).find((i) => !usedAddresses.includes(i));
  const first = { ...samples.controller, bus: scenario.bus, axes: source.motion?.axes ?? [] };
  const added = { ...structuredClone(template ?? first), address };
  const kind = Object.keys(source)[0];
  if (kind === "packets") added.packets = SOURCES.packets.additional(scenarioWithAddress, samples, added).packets;
  return { ...scenarioWithAddress, controllers: [...scenario.controllers, added] };
}

/** The scenario with an address for the first controller, also in its packets. @param {Scenario} scenario @param {number} address */
function withAddress(scenario, address) {
  const { packets } = scenario.source;
  const source = packets
    ? { packets: { ...packets, packets: packets.packets.map((/** @type {string} */ packet) => hex(address) + packet) } }
    : scenario.source;
  return { ...scenario, line: { ...scenario.line, address }, source };
}
