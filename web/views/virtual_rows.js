/** A long table that only has its visible rows in the document. */

/** Height of a row and of the heading, in CSS pixels, as in the style sheets. */
export const ROW_PX = 24;
/** Maximum height of the scrolled box: browsers limit it to some ten million pixels. A longer list scrolls in larger steps. */
const MAX_PX = 6_000_000;

/**
 * @param {HTMLElement} scroller
 * @param {HTMLElement} space  A box as tall as all rows; the table does not move in it.
 * @param {() => number} total  Number of rows.
 */
export function virtualRows(scroller, space, total) {
  const visible = () => Math.max(1, Math.floor((scroller.clientHeight - ROW_PX) / ROW_PX));
  const last = () => Math.max(0, total() - visible());
  const scrollRange = () => space.offsetHeight - scroller.clientHeight;

  /** Position of the first visible row. */
  function first() {
    return scrollRange() <= 0 ? 0 : Math.min(last(), Math.round((scroller.scrollTop / scrollRange()) * last()));
  }

  /** Brings a row into view. @param {number} position */
  function scrollTo(position) {
    const from = first();
    if (position >= from && position < from + visible()) return;
    const target = position < from ? position : position - visible() + 1;
    scroller.scrollTop = (target / Math.max(1, last())) * scrollRange();
  }

  /** Gives the scroll bar the length of all rows. */
  function resize() {
    const height = `${Math.min(MAX_PX, (total() + 1) * ROW_PX + 2)}px`;
    space.style.height = height;
    scroller.style.setProperty("--list-px", height);
  }
  return { first, visible, scrollTo, resize };
}
