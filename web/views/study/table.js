/** Tables of the study. */
import { element, fill } from "../../dom.js";

/** Moves the focus to a row of a table, after the focused element in it was removed or disabled. @param {HTMLElement | null} row */
export function focusRow(row) {
  row?.setAttribute("tabindex", "-1");
  row?.focus({ preventScroll: true });
}

/**
 * A scrolling table that keeps the focus in its row when it is filled again. A heading with `#` marks a column of numbers; with `~`
 * the column is hidden on a narrow screen.
 * @param {string} label @param {string[]} head
 */
export function table(label, head) {
  const kinds = head.map((text) =>
    `${text.includes("#") ? "number" : ""} ${text.startsWith("~") ? "wide-only" : ""}`.trim(),
  );
  const body = element("tbody");
  const root = element(
    "div",
    { class: "study-scroll", tabindex: "0", role: "group", "aria-label": label },
    element(
      "table",
      { "aria-label": label },
      element(
        "thead",
        {},
        element(
          "tr",
          {},
          ...head.map((text, at) =>
            element(
              text ? "th" : "td",
              { ...(text ? { scope: "col" } : {}), class: kinds[at] },
              text.replace(/^~?#?/, ""),
            ),
          ),
        ),
      ),
      body,
    ),
  );
  /** A row; its first cell is its heading. @param {(string | Node)[]} cells */
  const row = (cells) =>
    element(
      "tr",
      {},
      ...cells.map((cell, at) =>
        element(at === 0 ? "th" : "td", { ...(at === 0 ? { scope: "row" } : {}), class: kinds[at] }, cell),
      ),
    );
  /** @param {(string | Node)[][]} rows */
  const show = (rows) => {
    const focused = document.activeElement;
    const index = [...body.children].findIndex((each) => each.contains(focused));
    const isRowFocused = focused === body.children[index];
    fill(body, ...rows.map(row));
    if (index < 0) return;
    const newRow = /** @type {HTMLElement | undefined} */ (body.children[index]);
    const control = /** @type {HTMLElement | null | undefined} */ (
      isRowFocused ? null : newRow?.querySelector("button, input")
    );
    if (control) control.focus({ preventScroll: true });
    else if (newRow) focusRow(newRow);
    else root.focus({ preventScroll: true });
  };
  return { root, body, show };
}
