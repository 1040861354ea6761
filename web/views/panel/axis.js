/** The virtual axis: hard stops, switches, the nut, and the position of the controller. */
import { element, fill, setText } from "../../dom.js";
import { count } from "../../state/number.js";

/** @typedef {import("./front.js").Moment} Moment */

/** @param {HTMLElement} root @param {(steps: number) => void} push */
export function createAxis(root, push) {
  const rail = element("div", { class: "rail", "aria-hidden": "true" });
  const text = element("p", { class: "axis-words" });
  const steps = element("input", {
    type: "number",
    value: "100",
    step: "1",
    "aria-label": "Steps of the push",
  });
  const hand = element(
    "button",
    {
      type: "button",
      title: "Push the axis by hand at the cursor. It moves only while the windings have no current",
    },
    "Push",
  );
  hand.addEventListener("click", () => push(Math.round(Number(steps.value) || 0)));
  fill(root, rail, element("div", { class: "axis-line" }, text, element("span", { class: "group" }, steps, hand)));

  /** Key of the drawing, to redraw only changes. */
  let drawnKey = "";

  /**
   * @param {Moment} moment @param {any} axis  Its settings, or null. @param {Float64Array} records  Records of the panel.
   */
  function show({ place: at, error, perUnit, decimals, position }, axis, records) {
    const settings = axis ?? {};
    const assumed = at - error;
    const marks = [
      settings.min_switch_at_steps,
      settings.max_switch_at_steps,
      settings.home_from_steps,
      settings.home_to_steps,
      settings.hard_min_steps,
      settings.hard_max_steps,
      settings.start_steps ?? 0,
    ];
    const positions = [...marks.filter((mark) => typeof mark === "number"), at, assumed];
    let [low, high] = [Math.min(...positions), Math.max(...positions)];
    for (let i = 2; i < records.length; i += 4) {
      low = Math.min(low, records[i]);
      high = Math.max(high, records[i]);
    }
    const margin = Math.max(1, (high - low) * 0.06);
    [low, high] = [low - margin, high + margin];
    const percent = (/** @type {number} */ steps) =>
      `${(100 * Math.min(1, Math.max(0, (steps - low) / (high - low)))).toFixed(2)}%`;
    const key = JSON.stringify([low, high, at, assumed, settings]);
    if (key !== drawnKey) {
      drawnKey = key;
      const zone = (/** @type {string} */ name, /** @type {number | null} */ from, /** @type {number | null} */ to) => {
        if (typeof from !== "number" || typeof to !== "number") return [];
        const made = element("span", { class: `zone ${name.split(" ")[0]}` }, element("span", {}, name));
        made.style.left = percent(from);
        made.style.right = `calc(100% - ${percent(to)})`;
        return [made];
      };
      const mark = (/** @type {string} */ name, /** @type {number | null | undefined} */ steps, text = "") => {
        if (typeof steps !== "number") return [];
        const made = element("span", { class: name }, text);
        made.style.left = percent(steps);
        return [made];
      };
      fill(
        rail,
        ...zone(
          "min switch",
          typeof settings.min_switch_at_steps === "number" ? low : null,
          settings.min_switch_at_steps,
        ),
        ...zone(
          "max switch",
          settings.max_switch_at_steps,
          typeof settings.max_switch_at_steps === "number" ? high : null,
        ),
        ...zone("home switch", settings.home_from_steps, settings.home_to_steps),
        ...mark("end", settings.hard_min_steps),
        ...mark("end", settings.hard_max_steps),
        ...mark("nut", at),
        ...mark("believed", assumed, "▽"),
      );
    }
    const units = (/** @type {number} */ steps) => (steps / perUnit).toFixed(Math.max(1, decimals)).replace("-", "−");
    setText(
      text,
      `Nut at ${count(at)} steps (${units(at)} units); controller position ${count(position)} steps${
        error === 0 ? " ✓" : `: ${count(Math.abs(error))} ${Math.abs(error) === 1 ? "step" : "steps"} of error`
      }`,
    );
    text.classList.toggle("error", error !== 0);
  }
  return { show };
}
