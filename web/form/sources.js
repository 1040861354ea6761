/** What the host can send: a row a kind, with its part of the form and what it begins with. */
import { element, say } from "../dom.js";
import { axisItems } from "./axes.js";
import { packetLines } from "./fields.js";
import { field } from "./schema.js";

/** @typedef {import("../state/types.js").Scenario} Scenario */
/** @typedef {import("./kit.js").Kit} Kit */
/** @typedef {import("./kit.js").Samples} Samples */
/**
 * @typedef {object} SourceKind
 * @property {(kit: Kit) => Promise<void>} [load]  Loads what the page begins without.
 * @property {(scenario: Scenario, samples: Samples) => any} fresh  What stands in the source when it is chosen.
 * @property {(kit: Kit, scenario: Scenario) => Node[]} form
 * @property {(scenario: Scenario, samples: Samples, controller: any) => {axes?: any[], packets?: string[]}} order  What an additional controller is to do when it is chosen.
 * @property {(kit: Kit, index: number) => Node[]} orderForm  The same in the form of additional controller `index`.
 */

/** @type {{[kind: string]: SourceKind}} */
export const SOURCES = {
  motion: {
    fresh: (_, samples) => structuredClone(samples.sources.motion),
    form: (kit) => [
      kit.row("source.motion.engine", field("Motion", "engine")),
      ...axisItems(kit, { axes: "source.motion.axes", bus: "bus", whose: "", least: 1 }),
    ],
    order: (_, samples) => ({ axes: structuredClone(samples.sources.motion.axes) }),
    orderForm: (kit, index) =>
      axisItems(kit, {
        axes: `controllers[${index}].axes`,
        bus: `controllers[${index}].bus`,
        whose: ` of controller ${index + 2}`,
        least: 0,
      }),
  },
  packets: {
    fresh: (scenario) => ({ packets: packets(scenario, scenario.bus, scenario.line.address) }),
    form: (kit) => [kit.row("source.packets.packets", packetLines("Packets"))],
    order: (scenario, _, controller) => ({ packets: packets(scenario, controller.bus, controller.address) }),
    orderForm: (kit, index) => [kit.row(`controllers[${index}].packets`, packetLines("Controller"))],
  },
  line: {
    fresh: (scenario) => ({ sends: sends(scenario) }),
    form: (kit, scenario) => kit.later((further) => further.sendRows(kit, scenario)),
    order: () => ({}),
    orderForm: () => [],
  },
  segments: {
    fresh: ({ bus }) => ({ channels: Array.from({ length: Number(bus.channels) || 1 }, list) }),
    form: (kit, scenario) => kit.later((further) => further.segmentRows(kit, scenario)),
    order: () => ({}),
    orderForm: () => [],
  },
  standalone: {
    fresh: (_, samples) => structuredClone(samples.sources.standalone),
    load: async (kit) => {
      [standAlone] = await Promise.all([import("./standalone.js"), kit.extend()]);
    },
    form: (kit, scenario) => {
      if (standAlone) return standAlone.standAloneItems(kit, scenario);
      const note = element("p", { class: "item-note" }, "Its fields are being loaded.");
      const missing = () =>
        say(note, "Its fields could not be loaded; undo, or reload the page when the network is there.");
      SOURCES.standalone.load?.(kit).then(kit.anew, missing);
      return [note];
    },
    order: () => ({}),
    orderForm: () => [],
  },
};

/** The form of stand-alone controllers, once it is needed. @type {typeof import("./standalone.js") | null} */
let standAlone = null;

/** Whether segments or panels run it: then nothing is on the line, and there are no ticks. @param {Scenario} scenario */
export function runsAlone({ source }) {
  return "segments" in source || "standalone" in source || source.motion?.engine === "segments";
}

/** Faster to the right, a pause, and evenly back: something to see and to change. */
export function list() {
  const ms = 16_000 * 65_536;
  return {
    start_cycle: 1,
    segments: [
      { steps: { count: 20, interval_q16: ms, add_q16: -ms / 32, dir: 1 } },
      { dwell: { length_q16: 5 * ms } },
      { steps: { count: 20, interval_q16: ms / 2, add_q16: 0, dir: 0 } },
    ],
  };
}

/** The scenario with another kind of source; each controller gets something to do that fits it. @param {Scenario} scenario @param {string} kind @param {Samples} samples */
export function withSource(scenario, kind, samples) {
  const controllers = scenario.controllers.map((/** @type {any} */ controller) => ({
    ...controller,
    axes: [],
    packets: [],
    ...SOURCES[kind].order(scenario, samples, controller),
  }));
  return { ...scenario, source: { [kind]: SOURCES[kind].fresh(scenario, samples) }, controllers };
}

/** What another kind of source takes the place of. @param {Scenario} scenario @returns {import("../state/paths.js").Moved} */
export function replacedBySource({ controllers }) {
  const parts = controllers.flatMap((/** @type {any} */ _, /** @type {number} */ index) =>
    ["axes", "packets"].map((key) => `controllers[${index}].${key}`),
  );
  return ["source", ...parts].map((path) => [path, null]);
}

/** @param {number} byte */
export function hex(byte) {
  return Number(byte).toString(16).padStart(2, "0");
}

/** Ten steps to the right and ten back on every channel: something to see and to change. @param {any} bus */
function orders(bus) {
  return ["8a", "0a"].map((order) => order.repeat(Number(bus.channels) || 1));
}

/** @param {Scenario} scenario @param {any} bus @param {number | null} address */
function packets({ line }, bus, address) {
  const prefix = line.protocol === "framed" || address === null ? "" : hex(address);
  return orders(bus).map((order) => prefix + order);
}

/** @param {Scenario} scenario */
function sends(scenario) {
  const { bus, line } = scenario;
  const start = bus.boot_cycles + 1;
  const tick = bus.slots * bus.step_period_cycles;
  if (line.protocol !== "framed") {
    return packets(scenario, bus, line.address).map((bytes, index) => ({
      start_cycle: start + index * tick,
      bytes,
      frame: null,
    }));
  }
  // TICKS with the sequence number 0, the two of them and one without steps, then STATUS.
  const to = hex(line.address ?? 0);
  const ticks = [...orders(bus), "00".repeat(Number(bus.channels) || 1)];
  return [`${to}0100${hex(ticks.length)}${ticks.join("")}`, `${to}04`].map((frame, index) => ({
    start_cycle: start + index * 4 * tick,
    bytes: "",
    frame,
  }));
}
