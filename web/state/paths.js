/** Paths into a scenario, such as `controllers[0].axes[1].moves`. */

/** @typedef {[from: string, to: string | null][]} Moved  Where parts of the scenario went: from path to path, null where they are gone. */

/** `a.b[2].c` as its parts. @param {string} path @returns {string[]} */
export function parts(path) {
  return path.split(/[.[\]]+/).filter((part) => part !== "");
}

/** @param {any} value @param {string} path */
export function get(value, path) {
  return parts(path).reduce((inner, part) => inner?.[part], value);
}

/** A copy with one value replaced; what is not on the way is shared. @param {any} value @param {string} path @param {any} leaf */
export function set(value, path, leaf) {
  const [first, ...rest] = parts(path);
  if (first === undefined) return leaf;
  const copy = Array.isArray(value) ? [...value] : { ...value };
  copy[first] = set(copy[first], rest.join("."), leaf);
  return copy;
}

/** Where a path goes when parts of the scenario move; null where it is gone. @param {string} at @param {Moved} moved */
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
