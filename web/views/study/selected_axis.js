/** The selected axis of the study. */
import { place } from "./place.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{json: string, controller: number, axis: number, path: string, moves: any[]}} SelectedAxis  Scenario as text, and one of its axes: its path there, its moves. */

/**
 * The axis that the study is about. @param {State} state
 * @returns {SelectedAxis | string | null}  Why there is none: empty where the form has problems, and what was shown may stay; null until it is validated.
 */
export function selectedAxis(state) {
  const { validation, validated, revision } = state;
  if (validated !== revision || !validation) return null;
  if (validation.problems.length > 0) return "";
  const found = place(state);
  if (!found.path) return "There is no axis with moves: choose “Motion profile” as the source in the form.";
  return { json: validation.scenario, ...found };
}

/** Whether what a tab asks about the selected axis may have another answer than before. @param {State} state @param {State | undefined} before */
export function isAnother(state, before) {
  return (
    before?.validation !== state.validation ||
    before?.revision !== state.revision ||
    before?.axis !== state.axis ||
    before?.result !== state.result
  );
}
