/** The virtual axis: hard stops, switches, the nut, and the position of the controller. */
import { element, fill, say } from "../../dom.js";
import { count } from "../../state/number.js";

/** @typedef {import("./front.js").Moment} Moment */

/** @param {HTMLElement} place @param {(steps: number) => void} push */
export function createAxis(place, push) {
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
      title: "Pushes the axis by hand at the cursor. It moves only while the windings have no current",
    },
    "Push",
  );
  hand.addEventListener("click", () => push(Math.round(Number(steps.value) || 0)));
  fill(place, rail, element("div", { class: "axis-line" }, text, element("span", { class: "group" }, steps, hand)));

  /** What was drawn, to leave it where it is the same. */
  let drawn = "";

  /**
   * @param {Moment} moment @param {any} axis  Its settings, or null. @param {Float64Array} records  Of the panel.
   */
  function show({ place: at, error, perUnit, decimals, position }, axis, records) {
    const given = axis ?? {};
    const believed = at - error;
    const marks = [
      given.min_switch_at_steps,
      given.max_switch_at_steps,
      given.home_from_steps,
      given.home_to_steps,
      given.hard_min_steps,
      given.hard_max_steps,
      given.start_steps ?? 0,
    ];
    const known = [...marks.filter((mark) => typeof mark === "number"), at, believed];
    let [low, high] = [Math.min(...known), Math.max(...known)];
    for (let i = 2; i < records.length; i += 4) {
      low = Math.min(low, records[i]);
      high = Math.max(high, records[i]);
    }
    const air = Math.max(1, (high - low) * 0.06);
    [low, high] = [low - air, high + air];
    const part = (/** @type {number} */ steps) =>
      `${(100 * Math.min(1, Math.max(0, (steps - low) / (high - low)))).toFixed(2)}%`;
    const key = JSON.stringify([low, high, at, believed, given]);
    if (key !== drawn) {
      drawn = key;
      const zone = (/** @type {string} */ name, /** @type {number | null} */ from, /** @type {number | null} */ to) => {
        if (typeof from !== "number" || typeof to !== "number") return [];
        const made = element("span", { class: `zone ${name.split(" ")[0]}` }, element("span", {}, name));
        made.style.left = part(from);
        made.style.right = `calc(100% - ${part(to)})`;
        return [made];
      };
      const mark = (/** @type {string} */ name, /** @type {number | null | undefined} */ steps, text = "") => {
        if (typeof steps !== "number") return [];
        const made = element("span", { class: name }, text);
        made.style.left = part(steps);
        return [made];
      };
      fill(
        rail,
        ...zone("min switch", typeof given.min_switch_at_steps === "number" ? low : null, given.min_switch_at_steps),
        ...zone("max switch", given.max_switch_at_steps, typeof given.max_switch_at_steps === "number" ? high : null),
        ...zone("home switch", given.home_from_steps, given.home_to_steps),
        ...mark("end", given.hard_min_steps),
        ...mark("end", given.hard_max_steps),
        ...mark("nut", at),
        ...mark("believed", believed, "▽"),
      );
    }
    const units = (/** @type {number} */ steps) => (steps / perUnit).toFixed(Math.max(1, decimals)).replace("-", "−");
    say(
      text,
      `Nut at ${count(at)} steps (${units(at)} units); position ${count(position)}${
        error === 0 ? " ✓" : `: ${count(Math.abs(error))} ${Math.abs(error) === 1 ? "step" : "steps"} off`
      }`,
    );
    text.classList.toggle("error", error !== 0);
  }
  return { show };
}
