/** The choice of a motor and a driver from the lists. */
import { element, fill, say } from "../../dom.js";
import { Dropped } from "../../engine/request_slots.js";
import { readJson } from "../../state/json.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{id: string, name: string, source: string, typical: string[]}} Sheet */

/** Why there is nothing to show. */
const NONE = "This experiment has no motor. Use the default motor, or choose one, to simulate it.";

/** @param {import("./pane.js").Page} page @param {HTMLDetailsElement} fold */
export function createChoice({ engine, dispatch, now }, fold) {
  const motor = element("select", { "aria-label": "Motor" });
  const drive = element("select", { "aria-label": "Driver" });
  const about = element("p", { class: "note", "aria-live": "polite" });
  const press = element(
    "button",
    { type: "button", title: "Replaces every motor and driver of the experiment" },
    "Use this motor",
  );
  press.addEventListener("click", take);
  fill(/** @type {Element} */ (fold.lastElementChild), motor, drive, about, press);
  /** @type {{motors: Sheet[], drives: Sheet[]} | null} */
  let sheets = null;
  /** @type {boolean | null} */
  let driven = null;
  for (const select of [motor, drive]) select.addEventListener("change", describe);
  fold.addEventListener("toggle", () => fold.open && !sheets && load());

  async function load() {
    try {
      sheets = await engine.consider("sheets", "sheets");
    } catch (error) {
      return say(about, error instanceof Error ? error.message : String(error));
    }
    if (!sheets) return undefined;
    const of = (/** @type {Sheet[]} */ list, /** @type {string} */ own) => [
      element("option", { value: "" }, own),
      ...list.map(({ id, name }) => element("option", { value: id }, name)),
    ];
    fill(motor, ...of(sheets.motors, "motor: as in the form"));
    fill(drive, ...of(sheets.drives, "driver: as in the form"));
    return describe();
  }

  /** Where the figures come from. */
  function describe() {
    const selected = [
      sheets?.motors.find(({ id }) => id === motor.value),
      sheets?.drives.find(({ id }) => id === drive.value),
    ].filter((sheet) => sheet !== undefined);
    const words = selected.map(({ source, typical }) =>
      typical.length > 0 ? `${source}; typical only: ${typical.join(", ").replaceAll("_", " ")}` : source,
    );
    say(about, words.join(". ") || (driven ? "" : NONE));
    press.disabled = driven === true && selected.length === 0;
  }

  async function take() {
    const json = JSON.stringify(now().scenario);
    const text = await engine
      .consider("with motor", "with_motor", json, motor.value, drive.value)
      .catch((error) => void (error instanceof Dropped || say(about, error instanceof Error ? error.message : error)));
    if (!text || JSON.stringify(now().scenario) !== json) return;
    dispatch({ type: "edit", path: "", value: readJson(text) });
    motor.value = drive.value = "";
    fold.open = false;
    describe();
  }

  /** @param {State} state @param {boolean} isDriven */
  function show(state, isDriven) {
    const was = driven;
    driven = isDriven || Boolean(state.scenario.plant);
    say(press, driven ? "Use this motor" : "Simulate a motor");
    press.classList.toggle("main", !driven);
    // There is nothing else to see where nothing is driven.
    if (state.result && was !== driven) fold.open = !driven;
    describe();
  }
  return { show };
}
