/** Creates all views, and the export panel with the files of the views. */
import { NAMES } from "../state/views.js";
import { createMini } from "./motion/mini.js";
import { createMotion } from "./motion/motion.js";
import { createMotorPane } from "./motor/pane.js";
import { createPackets } from "./packets/packets.js";
import { createPanelPane } from "./panel/pane.js";
import { createPulses } from "./pulses/pulses.js";
import { createSpectrum } from "./spectrum/pane.js";
import { createStudy } from "./study/study.js";
import { createTiming } from "./timing.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/views.js").ViewName} ViewName */
/** @typedef {{render: (state: State, before: State | undefined) => any}} View */
/** @typedef {{engine: import("../engine/engine.js").Engine} & import("../state/types.js").Page} Page */

/**
 * The views in the order of their tabs; `loadKeys` loads views with keys.
 * @param {Page} page @param {import("../state/types.js").DriverSheet[]} drivers @param {import("../form/kit.js").Samples} samples
 */
export function createViews(page, drivers, samples) {
  const pulses = createPulses(page);
  const spectrum = createSpectrum(page);
  /** @type {{[view in ViewName]: View}} */
  const views = {
    motion: createMotion(page),
    motor: createMotorPane(page),
    pulses,
    packets: createPackets(page),
    panel: createPanelPane(page),
    spectrum,
    timing: createTiming({ drivers, speak: pulses.speak, ...page }),
    study: createStudy({ samples, ...page }),
  };
  const all = NAMES.map((name) => views[/** @type {ViewName} */ (name)]);
  return { all: [...all, createMini(page)], loadKeys: spectrum.load };
}

/** The content of the export panel, loaded on demand. @param {Page} page @param {import("../shell/lazy_popover.js").Popover} popover */
export async function exportsOf(page, popover) {
  const [{ createExports }, { chartFiles }, { packetFiles }, { tableFiles }] = await Promise.all([
    import("../shell/exports.js"),
    import("./chart_offers.js"),
    import("./packets/files.js"),
    import("./study/table_files.js"),
  ]);
  return createExports(
    page,
    [
      ["Charts", chartFiles],
      ["Packets", packetFiles],
      ["Step tables", tableFiles],
    ],
    popover,
  );
}
