/** Files of step tables for the tab Tables and the export panel. */
import { baseName } from "../../shell/offers.js";
import { selectedAxis } from "./selected_axis.js";
import { selectedSteps } from "./selected_steps.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../engine/engine.js").Engine} Engine */
/** @typedef {{json: string, controller: number, axis: number, run: number | null}} Tabled  An axis, or, where no plan is known, a channel and the revision that it is shown of. */
/** @typedef {{form: string, widths: string, us: number}} Choice */

/** @type {{[form: string]: string}} */
export const FORMS = { exact: "Exact list", document: "Table of the paper", compressed: "Compressed" };
/** @type {{[language: string]: [string, string, string]}} Label, ending of the file and its type. */
export const LANGUAGES = {
  c: ["C", ".c", "text/x-c"],
  avr: ["C for AVR (PROGMEM)", "-avr.c", "text/x-c"],
  rust: ["Rust", ".rs", "text/rust"],
  csv: ["CSV", ".csv", "text/csv"],
};
/** The table that is selected in the tab, which the export panel offers, too. @type {Choice} */
export const choice = { form: "compressed", widths: "q16", us: 25 };

/** Whose steps are kept. @param {State} state @returns {Tabled | string | null}  As `selectedAxis`. */
export function tabled(state) {
  const of = selectedAxis(state);
  if (of && typeof of !== "string") return { ...of, run: null };
  if (of !== null && of !== "" && !state.scenario.source?.motion) {
    const steps = selectedSteps(state);
    return steps && { json: steps.json, controller: steps.controller, axis: steps.channel, run: steps.revision };
  }
  return /** @type {string | null} */ (of);
}

/** A tableRequest about tables, and how its arguments begin. @param {Engine} engine @param {"step_table" | "step_source"} name @param {Tabled} of @returns {Promise<[string, any[]]>} */
export async function tableRequest(engine, name, { json, controller, axis, run }) {
  const begin = [json, controller, axis];
  return run === null ? [name, begin] : [`${name}_of_run`, [...begin, await engine.request("records_of", axis)]];
}

/** Files of the table that is selected, for the export panel. @param {State} state @param {Engine} engine @returns {import("../../shell/offers.js").Offer[]} */
export function tableFiles(state, engine) {
  const of = tabled(state);
  return of && typeof of !== "string" ? files(state, engine, of) : [];
}

/** @param {State} state @param {Engine} engine @param {Tabled} of */
export function files(state, engine, of) {
  const { controller, axis } = of;
  const { form, widths, us } = choice;
  const part = controller > 0 ? `-controller-${controller + 1}` : "";
  return Object.entries(LANGUAGES).map(([language, [label, ending, type]]) => ({
    name: `${baseName(state)}${part}-axis-${axis}-${form}-${widths}${ending}`,
    type,
    label: `${label}: axis ${axis}, ${form}, ${widths}`,
    language,
    make: async () => {
      const [method, begin] = await tableRequest(engine, "step_source", of);
      const pieces = [[...begin, form, widths, us, language]];
      return engine.distribute(method, pieces, new AbortController().signal);
    },
  }));
}
