/**
 * The grid of the views on a wide screen: bands from top to bottom, with columns in a band. Folded views leave their
 * room to the others.
 */

/** @typedef {import("../state/views.js").Placed} Placed */

/** Room between two views in CSS pixels; the style sheet has the same. */
export const GAP_PX = 8;
/** Least height of a view that is small. */
const LINE_PX = 36;

/** Views that are visible by the bands that they stand in, from the top. @param {readonly Placed[]} shown @returns {Placed[][]} */
export function bandsOf(shown) {
  /** @type {Placed[][]} */
  const bands = [];
  for (const view of shown) {
    bands[view.place.band] ??= [];
    bands[view.place.band].push(view);
  }
  return bands.filter(Boolean);
}

/**
 * @param {object} given
 * @param {readonly Placed[]} given.shown  One view a place.
 * @param {readonly number[] | null} given.rows  Heights that the user gave the bands, as parts of the room; more than 1 together scroll.
 * @param {readonly number[] | null} given.columns  Widths, as parts, of columns next to each other.
 * @param {(view: string) => boolean} given.isSmall
 */
export function template({ shown, rows, columns, isSmall }) {
  const bands = bandsOf(shown);
  const widest = bands.reduce((most, band) => (band.length > most.length ? band : most));
  const parts = columns?.length === widest.length ? columns : widest.map(({ place }) => place.part);
  const heights = rows?.length === bands.length ? rows : null;
  const scrolls = heights !== null && heights.reduce((sum, part) => sum + part) > 1.001;
  const gaps = GAP_PX * (bands.length - 1);
  /** The first one that is not small takes what the others leave. */
  const first = bands.findIndex((band) => !band.every(({ name }) => isSmall(name)));
  const areas = (/** @type {Placed[]} */ views) =>
    `"${widest.map((_, at) => views[Math.min(at, views.length - 1)].place.area).join(" ")}"`;
  const tracks = bands.flatMap((band, at) => {
    const large = band.filter(({ name }) => !isSmall(name));
    if (large.length === 0) return [`${areas(band)} min-content`];
    const given = heights?.[at];
    const { height } = band[0].place;
    const under = (GAP_PX + LINE_PX) * (band.length - large.length);
    const most = at === first ? "1fr" : height && `calc(${height} - ${under}px)`;
    const tall =
      given !== undefined
        ? `minmax(${scrolls ? `calc((100% - ${gaps}px) * ${given.toFixed(4)})` : 0}, ${(100 * given).toFixed(2)}fr)`
        : most
          ? `minmax(min-content, ${most})`
          : "min-content";
    // What is small beside something large lies under it.
    const small = band.filter(({ name }) => isSmall(name));
    return [`${areas(large)} ${tall}`, ...small.map((view) => `${areas([view])} min-content`)];
  });
  return `${tracks.join(" ")} / ${parts.map((part) => `minmax(0, ${part.toFixed(4)}fr)`).join(" ")}`;
}
