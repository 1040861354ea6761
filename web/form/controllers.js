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
  /** One like the controller of this index, or like the first. @param {number} index */
  const add = (index) => change("", (now) => withAnother(now, now.controllers[index] ?? null, samples));
  return [
    errorOf("controllers"),
    ...(all.length > 0
      ? kit.later((parts) => all.map((_, index) => parts.controllerPart(kit, scenario, index, add)))
      : []),
    button("Add controller", "Add controller", () => add(all.length - 1), all.length >= MAX_ADDITIONAL_CONTROLLERS),
  ];
}

/**
 * One controller more, like another one or like the first, with an address of its own. On a raw line the first one
 * needs an address then, too.
 * @param {Scenario} scenario @param {any} like @param {import("./kit.js").Samples} samples
 */
function withAnother(scenario, like, samples) {
  const { line, source } = scenario;
  const addressed = line.protocol === "raw" && line.address === null ? withAddress(scenario, 0) : scenario;
  const taken = [line.address ?? 0, ...scenario.controllers.map((/** @type {any} */ controller) => controller.address)];
  const address =
    Array.from({ length: 255 }, (_, i) => i).find((i) => i > taken[0] && !taken.includes(i)) ??
    Array.from({ length: 255 }, (_, i) => i).find((i) => !taken.includes(i));
  const first = { ...samples.controller, bus: scenario.bus, axes: source.motion?.axes ?? [] };
  const made = { ...structuredClone(like ?? first), address };
  const kind = Object.keys(source)[0];
  if (kind === "packets") made.packets = SOURCES.packets.additional(addressed, samples, made).packets;
  return { ...addressed, controllers: [...scenario.controllers, made] };
}

/** The first controller gets an address, and its packets begin with it. @param {Scenario} scenario @param {number} address */
function withAddress(scenario, address) {
  const { packets } = scenario.source;
  const source = packets
    ? { packets: { ...packets, packets: packets.packets.map((/** @type {string} */ packet) => hex(address) + packet) } }
    : scenario.source;
  return { ...scenario, line: { ...scenario.line, address }, source };
}
