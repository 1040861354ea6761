/** Settings of the rows of the pulses: height, and order, visibility and name of each group (a channel, a line signal, the ticks). */

/** @typedef {{px: number | null, order: string[], hidden: string[], names: {[group: string]: string}}} RowChoices  Height in CSS pixels, null for the default; groups that are not in `order` come last. */

/** @type {RowChoices} */
export const DEFAULT_ROWS = { px: null, order: [], hidden: [], names: {} };
/** Default, minimum and maximum height of a row, in CSS pixels. */
export const ROW_PX = 22;
export const MIN_PX = 20;
export const MAX_PX = 64;
/** Maximum length of a name. */
export const MAX_LETTERS = 24;
/** Maximum number of groups. */
const MAX_GROUPS = 64;

/** Height of a row in CSS pixels. @param {RowChoices} choices */
export function rowPx({ px }) {
  return px ?? ROW_PX;
}

/** Another height within the limits. @param {RowChoices} choices @param {number} by @returns {Partial<RowChoices>} */
export function taller(choices, by) {
  const px = Math.min(MAX_PX, Math.max(MIN_PX, rowPx(choices) + by));
  return { px: px === ROW_PX ? null : px };
}

/** Items in the selected order of their groups. @template T @param {RowChoices} choices @param {T[]} all @param {(each: T) => string} groupOf */
export function inOrder({ order }, all, groupOf) {
  const rank = (/** @type {T} */ each) => {
    const at = order.indexOf(groupOf(each));
    return at < 0 ? order.length : at;
  };
  return order.length === 0 ? all : [...all].sort((one, other) => rank(one) - rank(other));
}

/** Moves a group up or down. @param {string[]} groups  In their order. @param {string} group @param {number} by @returns {Partial<RowChoices>} */
export function moved(groups, group, by) {
  const from = groups.indexOf(group);
  const to = from + by;
  if (from < 0 || to < 0 || to >= groups.length) return {};
  const order = groups.filter((each) => each !== group);
  order.splice(to, 0, group);
  return { order };
}

/** @param {RowChoices} choices @param {string} group @param {boolean} hide @returns {Partial<RowChoices>} */
export function hidden({ hidden: all }, group, hide) {
  const others = all.filter((each) => each !== group);
  return { hidden: hide ? [...others, group] : others };
}

/** Renames a row; an empty name resets it. @param {RowChoices} choices @param {string} group @param {string} name @param {string} own @returns {Partial<RowChoices>} */
export function named({ names }, group, name, own) {
  const { [group]: _, ...others } = names;
  const text = name.trim().slice(0, MAX_LETTERS);
  return { names: text === "" || text === own ? others : { ...others, [group]: text } };
}

/** Reads saved settings as far as possible. @param {any} saved @returns {RowChoices} */
export function savedRows(saved) {
  const groups = (/** @type {any} */ list) =>
    Array.isArray(list) ? list.filter((each) => typeof each === "string").slice(0, MAX_GROUPS) : [];
  const names = Object.entries(saved?.names ?? {}).filter(([, name]) => typeof name === "string" && name !== "");
  return {
    px: saved?.px >= MIN_PX && saved?.px <= MAX_PX ? Math.round(saved.px) : null,
    order: groups(saved?.order),
    hidden: groups(saved?.hidden),
    names: Object.fromEntries(names.slice(0, MAX_GROUPS).map(([group, name]) => [group, name.slice(0, MAX_LETTERS)])),
  };
}
