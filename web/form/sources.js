/** The kinds of sources, each with its part of the form and its initial content. */
import { button, element, setText } from "../dom.js";
import { axisItems } from "./axes.js";
import { packetLines } from "./fields.js";
import { field } from "./schema.js";
import { samplePackets, sampleSegments, sampleSends } from "./source_kinds.js";

/** @typedef {import("../state/types.js").Scenario} Scenario */
/** @typedef {import("./kit.js").Kit} Kit */
/** @typedef {import("./kit.js").Samples} Samples */
/**
 * @typedef {object} SourceKind
 * @property {(kit: Kit) => Promise<void>} [load]  Loads its form, if that is not part of the first load.
 * @property {(scenario: Scenario, samples: Samples) => any} fresh  Its initial content.
 * @property {(kit: Kit, scenario: Scenario) => Node[]} form
 * @property {(scenario: Scenario, samples: Samples, controller: any) => {axes?: any[], packets?: string[]}} additional  The initial content of an additional controller.
 * @property {(kit: Kit, index: number) => Node[]} additionalForm  Its part of the form of additional controller `index`.
 */

/** @type {{[kind: string]: SourceKind}} */
export const SOURCES = {
  motion: {
    fresh: (_, samples) => structuredClone(samples.sources.motion),
    form: (kit, scenario) => [
      kit.row("source.motion.engine", field("Motion", "engine")),
      ...axisItems(kit, { axes: "source.motion.axes", bus: "bus", suffix: "", minAxes: 1 }),
      groupPart(kit, scenario),
    ],
    additional: (_, samples) => ({ axes: structuredClone(samples.sources.motion.axes) }),
    additionalForm: (kit, index) =>
      axisItems(kit, {
        axes: `controllers[${index}].axes`,
        bus: `controllers[${index}].bus`,
        suffix: ` of controller ${index + 2}`,
        minAxes: 0,
      }),
  },
  packets: {
    fresh: (scenario) => ({ packets: samplePackets(scenario, scenario.bus, scenario.line.address) }),
    form: (kit) => [kit.row("source.packets.packets", packetLines("Packets"))],
    additional: (scenario, _, controller) => ({ packets: samplePackets(scenario, controller.bus, controller.address) }),
    additionalForm: (kit, index) => [kit.row(`controllers[${index}].packets`, packetLines("Controller"))],
  },
  line: {
    fresh: (scenario) => ({ sends: sampleSends(scenario) }),
    form: (kit, scenario) => kit.loadItems((parts) => parts.sendRows(kit, scenario)),
    additional: () => ({}),
    additionalForm: () => [],
  },
  segments: {
    fresh: ({ bus }) => ({ channels: Array.from({ length: Number(bus.channels) || 1 }, sampleSegments) }),
    form: (kit, scenario) => kit.loadItems((parts) => parts.segmentRows(kit, scenario)),
    additional: () => ({}),
    additionalForm: () => [],
  },
  standalone: {
    fresh: (_, samples) => structuredClone(samples.sources.standalone),
    load: async () => {
      standAlone = await import("./standalone.js");
    },
    form: (kit, scenario) => {
      if (standAlone) return standAlone.standAloneItems(kit, scenario);
      const note = element("p", { class: "item-note" }, "Loading fields…");
      const showError = () =>
        setText(note, "The fields could not be loaded. Check the network, then undo or reload the page.");
      SOURCES.standalone.load?.(kit).then(kit.rebuild, showError);
      return [note];
    },
    additional: () => ({}),
    additionalForm: () => [],
  },
};

/** Groups of moves; their fields are loaded when there is one. @param {Kit} kit @param {Scenario} scenario */
function groupPart(kit, { source }) {
  const count = source.motion.groups?.length ?? 0;
  const add = () => kit.change("source.motion", (motion) => ({ ...motion, groups: [firstGroup(motion.axes.length)] }));
  return kit.part("Groups of moves", count > 0, [
    kit.errorOf("source.motion.groups"),
    ...(count > 0
      ? kit.loadItems((parts) => parts.groupItems(kit))
      : [button("Add group", "Add a group of moves", add)]),
  ]);
}

/** A straight line of all axes. @param {number} axes */
const firstGroup = (axes) => ({ line: { distances: Array(axes).fill({ steps: 1000 }), profile: "jerk_limited" } });

/** The form of stand-alone controllers, once it is needed. @type {typeof import("./standalone.js") | null} */
let standAlone = null;

/** The scenario with another kind of source and initial content for each controller. @param {Scenario} scenario @param {string} kind @param {Samples} samples */
export function withSource(scenario, kind, samples) {
  const controllers = scenario.controllers.map((/** @type {any} */ controller) => ({
    ...controller,
    axes: [],
    packets: [],
    ...SOURCES[kind].additional(scenario, samples, controller),
  }));
  return { ...scenario, source: { [kind]: SOURCES[kind].fresh(scenario, samples) }, controllers };
}
