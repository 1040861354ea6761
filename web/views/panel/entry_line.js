/** The selected entry of the script: name, time and remove button. */
import { element, setText } from "../../dom.js";
import { parseNumber } from "../../state/parse_number.js";
import { nameOf } from "./script.js";

/** @typedef {import("./script.js").Placed} Placed */

/**
 * @param {{clock: () => number, timeOf: (cycle: number) => string, report: (text: string, isError?: boolean) => void,
 *   move: (placed: Placed, cycle: number) => Placed | null, remove: (placed: Placed) => void}} page
 */
export function createEntryLine({ clock, timeOf, report, move, remove }) {
  const name = element("span", { "aria-live": "polite" });
  const cycle = element("input", {
    class: "time",
    "aria-label": "Time of the selected input, in cycles or as a time",
    spellcheck: "false",
  });
  const removeButton = element("button", { type: "button" }, "Remove");
  const line = element("p", { class: "entry-line", hidden: "" }, name, " ", cycle, " ", removeButton);
  const key = (/** @type {string} */ text) => element("kbd", {}, text);
  const idle = element(
    "p",
    { class: "entry-line quiet" },
    "Diamonds are inputs. Drag one, or select it with ",
    ...[key("N"), " and ", key("P"), " and move it with ", key(","), " and ", key(".")],
  );
  /** @type {Placed | null} */
  let selected = null;
  cycle.addEventListener("change", () => {
    const given = parseNumber(cycle.value, "cycles", { integer: true, clockHz: clock() });
    if ("message" in given) return report(given.message, true);
    const moved = selected && move(selected, given.value);
    if (moved) cycle.value = String(moved.entry.cycle);
    return undefined;
  });
  removeButton.addEventListener("click", () => {
    if (selected) remove(selected);
  });

  return {
    parts: [line, idle],
    /** @param {Placed | null} placed @param {boolean} hasEntries */
    show(placed, hasEntries) {
      selected = placed;
      line.hidden = placed === null;
      idle.hidden = placed !== null || !hasEntries;
      if (!placed) return;
      const { entry } = placed;
      setText(name, `${nameOf(entry)} at ${timeOf(entry.cycle)}, cycle`);
      if (document.activeElement !== cycle) cycle.value = String(entry.cycle);
      removeButton.title = `Remove ${nameOf(entry)} (Delete)`;
    },
  };
}
