/**
 * What the visitor chose for the rows of the pulses: their height, and by groups (a signal of the line with its
 * decoders, the ticks, a channel) their order, which are hidden, and what they are called. No DOM, no storage.
 */

/** @typedef {{px: number | null, order: string[], hidden: string[], names: {[group: string]: string}}} RowChoices  Height in CSS pixels, null as it is at first; groups that are not in `order` come after those that are. */

/** @type {RowChoices} */
export const AS_THEY_ARE = { px: null, order: [], hidden: [], names: {} };
/** Height of a row in CSS pixels until another is chosen, and what can be chosen. */
export const ROW_PX = 19;
export const LEAST_PX = 16;
export const MOST_PX = 64;
/** Longest name of a row. */
export const MOST_LETTERS = 24;
/** Groups that there can be: no more are kept. */
const MOST_GROUPS = 64;

/** Height of a row in CSS pixels. @param {RowChoices} choices */
export function rowPx({ px }) {
  return px ?? ROW_PX;
}

/** A height by so much more or less, as far as one can be chosen. @param {RowChoices} choices @param {number} by @returns {Partial<RowChoices>} */
export function taller(choices, by) {
  const px = Math.min(MOST_PX, Math.max(LEAST_PX, rowPx(choices) + by));
  return { px: px === ROW_PX ? null : px };
}

/** Things by groups in the order that was chosen. @template T @param {RowChoices} choices @param {T[]} all @param {(each: T) => string} groupOf */
export function ordered({ order }, all, groupOf) {
  const rank = (/** @type {T} */ each) => {
    const at = order.indexOf(groupOf(each));
    return at < 0 ? order.length : at;
  };
  return order.length === 0 ? all : [...all].sort((one, other) => rank(one) - rank(other));
}

/** One group a place up or down among those that there are. @param {string[]} groups  In their order. @param {string} group @param {number} by @returns {Partial<RowChoices>} */
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

/** A name of the visitor's own; an empty one, or the row's own, takes it back. @param {RowChoices} choices @param {string} group @param {string} name @param {string} own @returns {Partial<RowChoices>} */
export function named({ names }, group, name, own) {
  const { [group]: _, ...others } = names;
  const text = name.trim().slice(0, MOST_LETTERS);
  return { names: text === "" || text === own ? others : { ...others, [group]: text } };
}

/** Choices that were kept, or what can be read of them. @param {any} kept @returns {RowChoices} */
export function savedRows(kept) {
  const groups = (/** @type {any} */ list) =>
    Array.isArray(list) ? list.filter((each) => typeof each === "string").slice(0, MOST_GROUPS) : [];
  const names = Object.entries(kept?.names ?? {}).filter(([, name]) => typeof name === "string" && name !== "");
  return {
    px: kept?.px >= LEAST_PX && kept?.px <= MOST_PX ? Math.round(kept.px) : null,
    order: groups(kept?.order),
    hidden: groups(kept?.hidden),
    names: Object.fromEntries(names.slice(0, MOST_GROUPS).map(([group, name]) => [group, name.slice(0, MOST_LETTERS)])),
  };
}
