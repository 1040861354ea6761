/** Saves the channel maps of the last recordings, by the names of their channels. */

const KEY = "stepscope.maps";
const MAX_MAPS = 30;

/** @typedef {[names: string, map: string][]} Maps  Newest first. */

/** @param {string | null} text  Saved JSON. @returns {Maps} */
export function parseMaps(text) {
  try {
    const maps = JSON.parse(text ?? "[]");
    return Array.isArray(maps) ? maps : [];
  } catch {
    return [];
  }
}

/** @param {Maps} maps @param {string[]} channels */
export const mapFor = (maps, channels) => maps.find(([names]) => names === JSON.stringify(channels))?.[1] ?? null;

/** @param {Maps} maps @param {string[]} channels @param {string} map @returns {Maps} */
export function withMap(maps, channels, map) {
  const names = JSON.stringify(channels);
  /** @type {Maps} */
  const next = [[names, map], ...maps.filter(([other]) => other !== names)];
  return next.slice(0, MAX_MAPS);
}

/** @param {string[]} channels */
export function savedMap(channels) {
  try {
    return mapFor(parseMaps(localStorage.getItem(KEY)), channels);
  } catch {
    return null;
  }
}

/** @param {string[]} channels @param {string} map */
export function saveMap(channels, map) {
  try {
    localStorage.setItem(KEY, JSON.stringify(withMap(parseMaps(localStorage.getItem(KEY)), channels, map)));
  } catch {
    // Private windows and full disks reject this; the page works without.
  }
}
