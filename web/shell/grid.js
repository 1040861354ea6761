/**
 * The grid of the views on a wide screen: bands from top to bottom, with columns in a band. The other views use the space of
 * folded ones.
 */

/** @typedef {import("../state/views.js").Placed} Placed */

/** Gap between two views in CSS pixels, as in the style sheet. */
export const GAP_PX = 8;
/** Height of a folded or empty view in CSS pixels. */
const FOLDED_PX = 36;

/** The visible views by band, from the top. @param {readonly Placed[]} shown @returns {Placed[][]} */
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
 * @param {readonly Placed[]} given.shown  One view per area.
 * @param {readonly number[] | null} given.rows  Heights of the bands relative to the views, as the user set them. If their sum exceeds 1 the views scroll.
 * @param {readonly number[] | null} given.columns  Relative widths of the columns.
 * @param {(view: string) => boolean} given.isSmall  Whether a view is folded or empty.
 */
export function template({ shown, rows, columns, isSmall }) {
  const bands = bandsOf(shown);
  const widest = bands.reduce((longest, band) => (band.length > longest.length ? band : longest));
  const widths = columns?.length === widest.length ? columns : widest.map(({ place }) => place.share);
  const heights = rows?.length === bands.length ? rows : null;
  const scrolls = heights !== null && heights.reduce((sum, part) => sum + part) > 1.001;
  const gaps = GAP_PX * (bands.length - 1);
  /** The first band with a large view gets the remaining height. */
  const first = bands.findIndex((band) => !band.every(({ name }) => isSmall(name)));
  const areas = (/** @type {Placed[]} */ views) =>
    `"${widest.map((_, at) => views[Math.min(at, views.length - 1)].place.area).join(" ")}"`;
  const tracks = bands.flatMap((band, at) => {
    const large = band.filter(({ name }) => !isSmall(name));
    if (large.length === 0) return [`${areas(band)} min-content`];
    const userHeight = heights?.[at];
    const { height } = band[0].place;
    const foldedBelow = (GAP_PX + FOLDED_PX) * (band.length - large.length);
    const maxHeight = at === first ? "1fr" : height && `calc(${height} - ${foldedBelow}px)`;
    const tall =
      userHeight !== undefined
        ? `minmax(${scrolls ? `calc((100% - ${gaps}px) * ${userHeight.toFixed(4)})` : 0}, ${(100 * userHeight).toFixed(2)}fr)`
        : maxHeight
          ? `minmax(min-content, ${maxHeight})`
          : "min-content";
    // A folded view of a band is below the large ones.
    const small = band.filter(({ name }) => isSmall(name));
    return [`${areas(large)} ${tall}`, ...small.map((view) => `${areas([view])} min-content`)];
  });
  return `${tracks.join(" ")} / ${widths.map((width) => `minmax(0, ${width.toFixed(4)}fr)`).join(" ")}`;
}
