/**
 * The views in the order of their tabs, for tabs, headings, panes, links and help.
 *
 * A wide screen shows them in bands; the last band may have several columns. Views with the same place share it. A view
 * without a place fills the screen.
 */

/** @typedef {import("./types.js").State} State */
/**
 * @typedef {object} View
 * @property {string} name   Its name in ids (`view-motion`) and links. Never changes.
 * @property {string} title  Its heading.
 * @property {string} [tab]  A shorter title for its tab.
 * @property {string} about  First sentence of its help card; help/term_texts.js has its terms.
 * @property {Place | null} place  Its area on a wide screen; null fills the screen.
 * @property {(state: State) => boolean} [offered]  Whether the view is available; default: always.
 * @property {(state: State) => boolean} [isDefault]  Whether it is shown in its area if the user selected none; otherwise the first one is.
 *
 * @typedef {object} Place
 * @property {string} area  Name of the area; views of one area share it.
 * @property {number} band  From the top, 0 the first.
 * @property {string} [height]  Maximum height of the band, at its first view. Without it the band fits its content.
 * @property {number} share  Default share of the height of all bands, or of the width of a band with several columns.
 * @property {number} min_px  Minimum height.
 */

/** Whether the scenario has stand-alone controllers. @param {State} state */
export function hasPanel({ scenario }) {
  return Boolean(scenario.source?.standalone);
}

const ROWS = /** @type {const} */ ([
  {
    name: "motion",
    title: "Motion",
    about: "Position, speed and acceleration of all axes. Press an axis in the legend to hide it.",
    place: { area: "motion", band: 0, height: "1fr", share: 0.47, min_px: 120 },
  },
  {
    name: "panel",
    title: "Panel",
    about: "Front panel of a stand-alone controller: display, presses, switches and power over time.",
    place: { area: "motion", band: 0, share: 0.47, min_px: 120 },
    offered: hasPanel,
    isDefault: hasPanel,
  },
  {
    name: "motor",
    title: "Motor",
    about: "Simulated motor: rotor position, currents and lost steps.",
    place: { area: "motion", band: 0, share: 0.47, min_px: 120 },
    isDefault: (/** @type {State} */ state) => Boolean(state.scenario.plant),
  },
  {
    name: "pulses",
    title: "Pulses",
    about: "All signals between controller, drivers and line, cycle-exact.",
    place: { area: "pulses", band: 1, height: "min(var(--rows-px, 158px) + 106px, 40%)", share: 0.26, min_px: 110 },
  },
  {
    name: "packets",
    title: "Packets",
    about: "Packets on the line and their outcomes.",
    place: { area: "packets", band: 2, height: "max(27%, min(254px, 34%))", share: 6 / 11, min_px: 110 },
  },
  {
    name: "spectrum",
    title: "Spectrum",
    about: "Frequencies and distortion of the motion.",
    place: { area: "spectrum", band: 2, share: 5 / 11, min_px: 110 },
  },
  {
    name: "timing",
    title: "Driver timing",
    tab: "Timing",
    about: "Pulses checked against each rule of the driver data sheet.",
    place: { area: "spectrum", band: 2, share: 5 / 11, min_px: 110 },
    offered: (/** @type {State} */ { result }) =>
      typeof result?.summary.controllers[result.controller]?.violations === "number",
    isDefault: () => true,
  },
  {
    name: "study",
    title: "Study",
    about: "Compare profiles, step tables and motors for the selected axis.",
    place: null,
  },
]);

/** @typedef {(typeof ROWS)[number]["name"]} ViewName */
/** @typedef {View & {place: Place}} Placed */

/** @type {readonly View[]} */
export const VIEWS = ROWS;
export const NAMES = VIEWS.map(({ name }) => name);
/** Views with an area on a wide screen. */
export const PLACED = /** @type {Placed[]} */ (VIEWS.filter(({ place }) => place !== null));
/** Views that share an area, by area. */
export const SHARED = new Map(
  PLACED.map(({ place: { area } }) => [area, PLACED.filter(({ place }) => place.area === area)]),
);
for (const [area, views] of SHARED) if (views.length < 2) SHARED.delete(area);

/** Whether a view exists for the scenario. @param {View} view @param {State} state */
export function isOffered({ offered }, state) {
  return offered?.(state) ?? true;
}

/**
 * The visible view of an area. Order: the selected view, the default one, the first one.
 * @param {State} state @param {string} area
 */
export function visibleViewOf(state, area) {
  const here = PLACED.filter((view) => view.place.area === area && isOffered(view, state));
  const selected = here.find(({ name }) => name === state.sides[area]);
  const found = selected ?? here.find(({ isDefault }) => isDefault?.(state)) ?? here[0];
  return found.name;
}

/** The open tab of a narrow screen: the selected view, or the visible one of its area if it is not available. @param {State} state */
export function openTab(state) {
  const selected = VIEWS.find(({ name }) => name === state.view) ?? VIEWS[0];
  return isOffered(selected, state) || !selected.place ? selected.name : visibleViewOf(state, selected.place.area);
}
