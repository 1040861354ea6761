/**
 * The views in the order of their tabs, for tabs, headings, panes, links and help.
 *
 * A wide screen shows them in bands; the last band may have several columns. Views with the same place share it. A view
 * without a place fills the screen.
 */

/** @typedef {import("./types.js").State} State */
/**
 * @typedef {object} View
 * @property {string} name   As links, tabs and ids have it (`view-motion`). Published in links: it stays.
 * @property {string} title  Its heading.
 * @property {string} [tab]  Its tab, where that is shorter.
 * @property {string} about  What the card behind its heading says first; what its words mean stands in `help/texts.js`.
 * @property {Place | null} place  On a wide screen; null stands alone.
 * @property {(state: State) => boolean} [offered]  Whether there is such a view now; always without it.
 * @property {(state: State) => boolean} [leads]  Whether it has its place where none was selected; else the first has it.
 *
 * @typedef {object} Place
 * @property {string} area  Name of the place; views of one name share it.
 * @property {number} band  From the top, 0 the first.
 * @property {string} [height]  Of the band, of its first view: at most so much, but what it holds has its room. Without it just that.
 * @property {number} part  Of the room of all, in which an edge that is moved leaves the others: of the height, or of the width beside others.
 * @property {number} least_px  Least height that an edge can be moved to.
 */

/** Whether stand-alone controllers run it. @param {State} state */
export function hasPanel({ scenario }) {
  return Boolean(scenario.source?.standalone);
}

const ROWS = /** @type {const} */ ([
  {
    name: "motion",
    title: "Motion",
    about: "Position, speed and acceleration of one axis.",
    place: { area: "motion", band: 0, height: "1fr", part: 0.47, least_px: 120 },
  },
  {
    name: "panel",
    title: "Panel",
    about: "Front panel of a stand-alone controller: display, presses, switches and power over time.",
    place: { area: "motion", band: 0, part: 0.47, least_px: 120 },
    offered: hasPanel,
    leads: hasPanel,
  },
  {
    name: "motor",
    title: "Motor",
    about: "Simulated motor: rotor position, currents and lost steps.",
    place: { area: "motion", band: 0, part: 0.47, least_px: 120 },
    leads: (/** @type {State} */ state) => Boolean(state.scenario.plant),
  },
  {
    name: "pulses",
    title: "Pulses",
    about: "All signals between controller, drivers and line, cycle-exact.",
    place: { area: "pulses", band: 1, height: "min(var(--rows-px, 158px) + 110px, 40%)", part: 0.26, least_px: 110 },
  },
  {
    name: "packets",
    title: "Packets",
    about: "Packets on the line and their outcomes.",
    place: { area: "packets", band: 2, height: "27%", part: 6 / 11, least_px: 110 },
  },
  {
    name: "spectrum",
    title: "Spectrum",
    about: "Frequencies and distortion of the motion.",
    place: { area: "spectrum", band: 2, part: 5 / 11, least_px: 110 },
  },
  {
    name: "timing",
    title: "Driver timing",
    tab: "Timing",
    about: "Pulses checked against each rule of the driver data sheet.",
    place: { area: "spectrum", band: 2, part: 5 / 11, least_px: 110 },
    offered: (/** @type {State} */ { result }) =>
      typeof result?.summary.controllers[result.controller]?.violations === "number",
    leads: () => true,
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
/** Views with a place on a wide screen. */
export const PLACED = /** @type {Placed[]} */ (VIEWS.filter(({ place }) => place !== null));
/** Views by shared place. */
export const SHARED = new Map(
  PLACED.map(({ place: { area } }) => [area, PLACED.filter(({ place }) => place.area === area)]),
);
for (const [area, views] of SHARED) if (views.length < 2) SHARED.delete(area);

/** Whether a view exists for the scenario. @param {View} view @param {State} state */
export function isOffered({ offered }, state) {
  return offered?.(state) ?? true;
}

/**
 * The visible view in the place of one: that which was selected, else that which leads there, else the first.
 * @param {State} state @param {string} area
 */
export function inPlace(state, area) {
  const here = PLACED.filter((view) => view.place.area === area && isOffered(view, state));
  const selected = here.find(({ name }) => name === state.sides[area]);
  const found = selected ?? here.find(({ leads }) => leads?.(state)) ?? here[0];
  return found.name;
}

/** The open tab of a narrow screen: that which was selected, or what has its place if there is none. @param {State} state */
export function openTab(state) {
  const selected = VIEWS.find(({ name }) => name === state.view) ?? VIEWS[0];
  return isOffered(selected, state) || !selected.place ? selected.name : inPlace(state, selected.place.area);
}
