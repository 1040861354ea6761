/** A long table that only has its visible rows in the document. */

/** Height of a row, and of the head, in CSS pixels; the style sheets have the same. */
export const ROW_PX = 24;
/** Browsers refuse boxes taller than some ten million pixels; a longer list scrolls in larger steps. */
const MAX_PX = 6_000_000;

/**
 * @param {HTMLElement} scroller
 * @param {HTMLElement} space  As tall as all rows would be; the table stands still in it.
 * @param {() => number} total  Rows that there are.
 */
export function virtualRows(scroller, space, total) {
  const visible = () => Math.max(1, Math.floor((scroller.clientHeight - ROW_PX) / ROW_PX));
  const last = () => Math.max(0, total() - visible());
  const path = () => space.offsetHeight - scroller.clientHeight;

  /** Position of the first visible row. */
  function first() {
    return path() <= 0 ? 0 : Math.min(last(), Math.round((scroller.scrollTop / path()) * last()));
  }

  /** Brings a row into view. @param {number} position */
  function scrollTo(position) {
    const from = first();
    if (position >= from && position < from + visible()) return;
    const target = position < from ? position : position - visible() + 1;
    scroller.scrollTop = (target / Math.max(1, last())) * path();
  }

  /** Gives the scroll bar the length of all rows. */
  function resize() {
    space.style.height = `${Math.min(MAX_PX, (total() + 1) * ROW_PX + 2)}px`;
  }
  return { first, visible, scrollTo, resize };
}
