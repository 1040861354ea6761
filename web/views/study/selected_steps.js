/** The selected channel of the study without a plan. */
import { element, fill } from "../../dom.js";
import { isStale } from "../../state/queries.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../engine/engine.js").Engine} Engine */
/** @typedef {{json: string, revision: number, controller: number, channel: number, clock_hz: number}} SelectedSteps  A channel of a controller, with its scenario as JSON. */

/** The channel of the study; null if the source is a motion, or before the run of the scenario arrives. @param {State} state @returns {SelectedSteps | null} */
export function selectedSteps(state) {
  const { validation, validated, revision, scenario, result, axis: channel } = state;
  if (!validation || validated !== revision || scenario.source?.motion || !result || isStale(state)) return null;
  const { controller, summary } = result;
  return { json: validation.scenario, revision, controller, channel, clock_hz: summary.clock_hz };
}

/** A list of motors, requested once. @param {Engine} engine @param {() => void} change */
export function motorChoice(engine, change) {
  const select = element("select", {});
  const root = element("label", {}, "Motor ", select);
  let loaded = false;
  root.hidden = true;
  select.addEventListener("change", change);
  /** @param {boolean} isShown */
  async function show(isShown) {
    root.hidden = !isShown;
    if (!isShown || loaded) return;
    loaded = true;
    const reply = await engine.compute("motors", "sheets").catch(() => null);
    // If it failed, the next call requests it again.
    loaded = reply !== null;
    if (!reply) return;
    /** @type {{id: string, name: string}[]} */
    const motors = reply.motors;
    const listed = motors.map(({ id, name }) => element("option", { value: id }, name));
    fill(select, element("option", { value: "" }, "none"), ...listed);
  }
  return { root, show, value: () => (root.hidden ? "" : select.value) };
}
