/** The differences of a recording from the baseline: a button next to “recording” opens a table with links to their times. */
import { button, byId, element, fill } from "../../dom.js";
import { count, counted, time } from "../../state/number.js";
import { showLocation } from "../notices.js";
import { locationAround } from "../sender_comparison.js";

/** Maximum rows of the table; the command writes all. */
const MAX_ROWS = 10;

/** @typedef {{recorded: number, rows: {text: string, recorded_s: number}[], differences: {count: number}}} Found */

/**
 * Adds the button if there are differences. Returns how to remove it.
 * @param {import("../../state/types.js").Page} page @param {Found} found
 */
export function offerDifferences(page, { rows, recorded, differences }) {
  if (rows.length === 0) return () => {};
  const open = button("Differences…", `Differences from the baseline: ${count(differences.count)}`, () => show());
  byId("on-show").append(" ", open);
  return () => open.remove();

  function show() {
    const dialog = element("dialog", { class: "recording", "aria-label": "Differences" });
    const close = () => dialog.remove();
    const listed = rows.slice(0, MAX_ROWS).map(({ text, recorded_s }) => {
      const at = button(time(recorded_s), `Go to ${time(recorded_s)}: ${text}`, () => {
        close();
        showTime(recorded_s);
      });
      return element("tr", {}, element("td", {}, at), element("td", {}, text));
    });
    const head = ["Time", "Difference"].map((name) => element("th", { scope: "col" }, name));
    const more = differences.count > listed.length ? `; the first ${listed.length}` : "";
    fill(
      dialog,
      element("h2", {}, "Differences from the baseline"),
      element("p", {}, `${counted(differences.count, "difference")}${more}:`),
      element(
        "table",
        { class: "channels" },
        element("thead", {}, element("tr", {}, ...head)),
        element("tbody", {}, ...listed),
      ),
      element("p", { class: "named" }, button("Close", "Close the differences", close)),
    );
    dialog.addEventListener("close", close);
    document.body.append(dialog);
    dialog.showModal();
  }

  /** @param {number} at_s */
  function showTime(at_s) {
    const { result } = page.now();
    if (!result) return;
    const { clock_hz, end_cycle } = result.summary;
    const cycle = Math.round(at_s * clock_hz);
    const margin = Math.round((4 * end_cycle) / Math.max(1, recorded));
    const location = locationAround(cycle - margin, cycle + margin, end_cycle, result.controller);
    showLocation(page, { ...location, cycle });
  }
}
