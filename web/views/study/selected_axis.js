/** The selected axis of the study. */
import { place } from "./place.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{json: string, controller: number, axis: number, path: string, moves: any[]}} SelectedAxis  An axis, with its scenario as JSON, its path there and its moves. */

/**
 * The axis that the study is about. @param {State} state
 * @returns {SelectedAxis | string | null}  A text says why there is none; empty if the form has problems, so that the previous content stays; null before validation.
 */
export function selectedAxis(state) {
  const { validation, validated, revision } = state;
  if (validated !== revision || !validation) return null;
  if (validation.problems.length > 0) return "";
  const axis = place(state);
  if (!axis.path) return "There is no axis with moves: select “Motion profile” as the source in the form.";
  return { json: validation.scenario, ...axis };
}

/** Whether a tab's replies for the selected axis may have changed. @param {State} state @param {State | undefined} before */
export function isAnother(state, before) {
  return (
    before?.validation !== state.validation ||
    before?.revision !== state.revision ||
    before?.axis !== state.axis ||
    before?.result !== state.result
  );
}
