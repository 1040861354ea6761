/** Values derived from the state. */

/** @typedef {import("./types.js").State} State */

/** The summary of the visible controller; undefined before the first run. @param {State} state */
export function selected({ result }) {
  return result?.summary.controllers[result.controller];
}

/**
 * The derived values of the scenario in the form; if it is invalid, the values of the last run.
 * @param {State} state @returns {{derived: import("./types.js").Derived | null, fresh: boolean}}
 */
export function derivedShown({ validation, drafts, result, validated, revision }) {
  const fresh = validated === revision && Boolean(validation?.derived) && Object.keys(drafts).length === 0;
  return { derived: (fresh ? validation?.derived : result?.derived) ?? null, fresh };
}

/** The derived values of the axis of a field in the form. @param {State} state @param {string} path */
export function derivedAxis({ derived }, path) {
  const additional = /^controllers\[(\d+)\]/.exec(path);
  const axis = /axes\[(\d+)\]/.exec(path);
  return derived?.controllers[additional ? Number(additional[1]) + 1 : 0]?.axes[axis ? Number(axis[1]) : 0];
}

/** @param {State["filter"]} filter */
export function isFiltering({ text, kind, address, outcome }) {
  return text.trim() !== "" || kind !== "" || address !== null || outcome !== "";
}

/** Why the scenario does not run; null if it can run. @param {State} state @returns {"unvalidated" | "problems" | "budget" | null} */
export function blockedBy(state) {
  if (Object.keys(state.drafts).length > 0) return "problems";
  if (state.validated !== state.revision || !state.validation) return "unvalidated";
  if (state.validation.problems.length > 0) return "problems";
  return state.validation.cost?.over_budget && state.approved !== state.revision ? "budget" : null;
}

/** Whether the views show an earlier scenario than the form. @param {State} state */
export function isStale(state) {
  return state.result?.revision !== state.revision || Object.keys(state.drafts).length > 0;
}
