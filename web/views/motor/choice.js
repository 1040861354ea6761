/** The choice of a motor and a driver from the lists. */

import { element, fill, setText } from "../../dom.js";
import { Dropped } from "../../engine/request_slots.js";
import { errorMessage } from "../../state/error_message.js";
import { readJson } from "../../state/json.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{id: string, name: string, source: string, typical: string[]}} Sheet */

/** The note without a motor. */
const NO_MOTOR = "This experiment has no motor. Use the default motor, or choose one, to simulate it.";

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
  press.addEventListener("click", useMotor);
  fill(/** @type {Element} */ (fold.lastElementChild), motor, drive, about, press);
  /** @type {{motors: Sheet[], drives: Sheet[]} | null} */
  let sheets = null;
  /** @type {boolean | null} */
  let isSimulated = null;
  for (const select of [motor, drive]) select.addEventListener("change", describe);
  const loadOnce = () => fold.open && !sheets && load();
  fold.addEventListener("toggle", loadOnce);
  loadOnce();

  async function load() {
    try {
      sheets = await engine.compute("sheets", "sheets");
    } catch (error) {
      return setText(about, errorMessage(error));
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

  /** Shows the sources of the selected data. */
  function describe() {
    const selected = [
      sheets?.motors.find(({ id }) => id === motor.value),
      sheets?.drives.find(({ id }) => id === drive.value),
    ].filter((sheet) => sheet !== undefined);
    const words = selected.map(({ source, typical }) =>
      typical.length > 0 ? `${source}; typical values only: ${typical.join(", ").replaceAll("_", " ")}` : source,
    );
    setText(about, words.join(". ") || (isSimulated ? "" : NO_MOTOR));
    press.disabled = isSimulated === true && selected.length === 0;
  }

  async function useMotor() {
    const json = JSON.stringify(now().scenario);
    const text = await engine
      .compute("with motor", "with_motor", json, motor.value, drive.value)
      .catch((error) => void (error instanceof Dropped || setText(about, errorMessage(error))));
    if (!text || JSON.stringify(now().scenario) !== json) return;
    dispatch({ type: "edit", path: "", value: readJson(text), moved: [] });
    motor.value = drive.value = "";
    fold.open = false;
    describe();
  }

  /** @param {State} state @param {boolean} hasReport */
  function show(state, hasReport) {
    const before = isSimulated;
    isSimulated = hasReport || Boolean(state.scenario.plant);
    setText(press, isSimulated ? "Use this motor" : "Simulate a motor");
    press.classList.toggle("main", !isSimulated);
    // Without a simulated motor the view has nothing else to show.
    if (state.result && before !== isSimulated) fold.open = !isSimulated;
    describe();
  }
  return { show };
}
