/** Paths into a scenario, such as `controllers[0].axes[1].moves`. */

/** @typedef {[from: string, to: string | null][]} Moved  Moved parts of the scenario, from path to path; null if they were removed. */

/** `a.b[2].c` as its parts. @param {string} path @returns {string[]} */
export function parts(path) {
  return path.split(/[.[\]]+/).filter((part) => part !== "");
}

/** @param {any} value @param {string} path */
export function get(value, path) {
  return parts(path).reduce((inner, part) => inner?.[part], value);
}

/** A copy with one value replaced; it shares all other parts. @param {any} value @param {string} path @param {any} leaf */
export function set(value, path, leaf) {
  const [first, ...rest] = parts(path);
  if (first === undefined) return leaf;
  const copy = Array.isArray(value) ? [...value] : { ...value };
  copy[first] = set(copy[first], rest.join("."), leaf);
  return copy;
}

/** The new path after parts of the scenario moved; null if it was removed. @param {string} at @param {Moved} moved */
export function movedTo(at, moved) {
  const found = moved.find(([from]) => isWithin(at, from));
  if (!found) return at;
  const [from, to] = found;
  return to === null ? null : to + at.slice(from.length);
}

/** Whether `path` is `outer` or a part of it. @param {string} path @param {string} outer */
function isWithin(path, outer) {
  return outer === "" || path === outer || path.startsWith(`${outer}.`) || path.startsWith(`${outer}[`);
}
