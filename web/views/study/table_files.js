/** Files of step tables for the tab Tables and the export panel. */
import { baseName } from "../../shell/offers.js";
import { selectedAxis } from "./selected_axis.js";
import { selectedSteps } from "./selected_steps.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../engine/engine.js").Engine} Engine */
/** @typedef {{json: string, controller: number, axis: number, run: number | null}} Tabled  An axis; without a plan, a channel and the revision of its run. */
/** @typedef {{form: string, widths: string, us: number}} Choice */

/** Labels of the forms. @type {{[form: string]: string}} */
export const FORMS = { exact: "Exact list", document: "Table of the paper", compressed: "Compressed" };
/** Labels of the widths of an entry. @type {{[widths: string]: string}} */
export const WIDTHS = { q16: "20 bytes, 1/65536 cycle", q8: "8 bytes, 1/256 cycle", ticks: "8 bytes, whole cycles" };
/** Label, extension and type of the file of each language. @type {{[language: string]: [string, string, string]}} */
const LANGUAGES = {
  c: ["C", ".h", "text/x-c"],
  avr: ["C for AVR (PROGMEM)", "-avr.h", "text/x-c"],
  rust: ["Rust", ".rs", "text/rust"],
  csv: ["CSV", ".csv", "text/csv"],
};
/** The table selected in the tab; the export panel offers it, too. @type {Choice} */
export const choice = { form: "exact", widths: "ticks", us: 25 };

/** What a form loses, for the text of a button. @param {Choice} choice */
export const loss = ({ form, us }) =>
  form === "compressed" ? `, steps up to ${us} µs off` : form === "document" ? ", steps rounded as in the paper" : "";

/** The axis or channel of the tables. @param {State} state @returns {Tabled | string | null}  As `selectedAxis`. */
export function tabled(state) {
  const axis = selectedAxis(state);
  if (axis && typeof axis !== "string") return { ...axis, run: null };
  if (axis !== null && axis !== "" && !state.scenario.source?.motion) {
    const steps = selectedSteps(state);
    return steps && { json: steps.json, controller: steps.controller, axis: steps.channel, run: steps.revision };
  }
  return /** @type {string | null} */ (axis);
}

/** The method of a request for a table, and its first arguments. @param {Engine} engine @param {"step_table" | "step_source"} name @param {Tabled} subject @returns {Promise<[string, any[]]>} */
export async function tableRequest(engine, name, { json, controller, axis, run }) {
  const begin = [json, controller, axis];
  return run === null ? [name, begin] : [`${name}_of_run`, [...begin, await engine.request("records_of", axis)]];
}

/** Files of the selected table, for the export panel. @param {State} state @param {Engine} engine @returns {import("../../shell/offers.js").Offer[]} */
export function tableFiles(state, engine) {
  const subject = tabled(state);
  return subject && typeof subject !== "string" ? files(state, engine, subject) : [];
}

/** The files of a table, one for each language, and the walker of those in C. @param {State} state @param {Engine} engine @param {Tabled} subject */
export function files(state, engine, subject) {
  const { controller, axis } = subject;
  const { form, widths, us } = choice;
  const part = controller > 0 ? `-controller-${controller + 1}` : "";
  const base = baseName(state);
  const signal = new AbortController().signal;
  const walker = {
    name: "stepscope_walk.h",
    type: "text/x-c",
    button: "stepscope_walk.h",
    label: "stepscope_walk.h: walks the tables in C",
    language: "walker",
    make: () => engine.distribute("step_walker", [[]], signal),
  };
  const tables = Object.entries(LANGUAGES).map(([language, [label, extension, type]]) => ({
    name: `${base}${part}-axis-${axis}-${form}-${widths}${extension}`,
    type,
    button: `${label}${loss(choice)}`,
    label: `${label}: axis ${axis}, ${FORMS[form].toLowerCase()}, ${WIDTHS[widths]}${loss(choice)}`,
    language,
    make: async () => {
      const [method, begin] = await tableRequest(engine, "step_source", subject);
      return engine.distribute(method, [[...begin, form, widths, us, language, `${base}.json`]], signal);
    },
  }));
  return [...tables, walker];
}
