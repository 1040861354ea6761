/** The step tables of an axis as files for a firmware: in the study's tab Tables and in the export panel. */
import { baseName } from "../../shell/offers.js";
import { selectedAxis } from "./selected_axis.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../engine/engine.js").Engine} Engine */
/** @typedef {import("./selected_axis.js").SelectedAxis} SelectedAxis */
/** @typedef {{form: string, widths: string, us: number}} Choice */

/** @type {{[form: string]: string}} */
export const FORMS = { exact: "Exact list", document: "Document's table", compressed: "Compressed" };
/** @type {{[language: string]: [string, string, string]}} Label, ending of the file and its type. */
export const LANGUAGES = {
  c: ["C", ".c", "text/x-c"],
  avr: ["C for AVR (PROGMEM)", "-avr.c", "text/x-c"],
  rust: ["Rust", ".rs", "text/rust"],
  csv: ["CSV", ".csv", "text/csv"],
};
/** The table that is chosen in the tab, which the export panel offers, too. @type {Choice} */
export const chosen = { form: "compressed", widths: "q16", us: 25 };

/** Files of the table that is chosen, for the export panel. @param {State} state @param {Engine} engine @returns {import("../../shell/offers.js").Offer[]} */
export function tableFiles(state, engine) {
  const of = selectedAxis(state);
  return of && typeof of !== "string" ? files(state, engine, of) : [];
}

/** @param {State} state @param {Engine} engine @param {SelectedAxis} of */
export function files(state, engine, { json, controller, axis }) {
  const { form, widths, us } = chosen;
  const part = controller > 0 ? `-controller-${controller + 1}` : "";
  return Object.entries(LANGUAGES).map(([language, [label, ending, type]]) => ({
    name: `${baseName(state)}${part}-axis-${axis}-${form}-${widths}${ending}`,
    type,
    label: `${label}: axis ${axis}, ${form}, ${widths}`,
    language,
    make: () =>
      engine.distribute(
        "step_source",
        [[json, controller, axis, form, widths, us, language]],
        new AbortController().signal,
      ),
  }));
}
