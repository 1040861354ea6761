/** Chart files for the export panel. */
import { baseName } from "../shell/offers.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../engine/engine.js").Engine} Engine */

const files = () => import("./chart_files.js");

/** @param {State} state @param {Engine} engine @returns {import("../shell/offers.js").Offer[]} */
export function chartFiles(state, engine) {
  if (!state.result) return [];
  const [png, svg, csv] = ["image/png", "image/svg+xml", "text/csv"];
  const base = baseName(state);
  const motion = async () => (await files()).motionSheet(state, engine);
  const spectrum = async () => (await files()).spectrumSheet(state, engine);
  const motor = async () => (await files()).motorSheet(state, engine);
  const driven = [
    {
      name: `${base}-motor.png`,
      type: png,
      label: "Motor, picture (PNG)",
      make: async () => [await (await files()).bitmap(await motor())],
    },
    {
      name: `${base}-motor.svg`,
      type: svg,
      label: "Motor, picture (SVG)",
      make: async () => [(await files()).vector(await motor())],
    },
    {
      name: `${base}-motor.csv`,
      type: csv,
      label: "Motor, values (CSV)",
      make: async () => [await (await files()).motorValues(state, engine)],
    },
  ];
  return [
    ...(state.scenario.plant ? driven : []),
    {
      name: `${base}-motion.png`,
      type: png,
      label: "Motion, picture (PNG)",
      make: async () => [await (await files()).bitmap(await motion())],
    },
    {
      name: `${base}-motion.svg`,
      type: svg,
      label: "Motion, picture (SVG)",
      make: async () => [(await files()).vector(await motion())],
    },
    {
      name: `${base}-motion.csv`,
      type: csv,
      label: "Motion, values (CSV)",
      make: async () => [await (await files()).motionValues(state, engine)],
    },
    {
      name: `${base}-spectrum.png`,
      type: png,
      label: "Spectrum, picture (PNG)",
      make: async () => [await (await files()).bitmap(await spectrum())],
    },
    {
      name: `${base}-spectrum.svg`,
      type: svg,
      label: "Spectrum, picture (SVG)",
      make: async () => [(await files()).vector(await spectrum())],
    },
  ];
}
