/** Changes of the scenario by the tab Sine. */
import { selectedAxis } from "./selected_axis.js";
import { rounded } from "./sine_sweep.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./selected_axis.js").SelectedAxis} SelectedAxis */
/** @typedef {{axis: SelectedAxis | null, move: number}} Target  The selected axis and its first sine in segments; -1 if it has none. */
/** @typedef {{path: string, value: any, message: string}} Edit */

const NOT_NOW = "Not available while the form has errors or is being checked.";

/** @param {State} state @returns {Target} */
export function targetOf(state) {
  const axis = selectedAxis(state);
  if (!axis || typeof axis === "string") return { axis: null, move: -1 };
  return { axis, move: axis.moves.findIndex((/** @type {any} */ each) => each.sine_segments) };
}

/** Why a state has no axis to edit. @param {State} state */
export const whyNoAxis = (state) => (selectedAxis(state) ? "The scenario has no suitable axis." : NOT_NOW);

/** Gives the axis' sine a d1. @param {SelectedAxis} axis @param {number} move @param {number} d1 @returns {Edit} */
export const deviationEdit = (axis, move, d1) => ({
  path: `${axis.path}.moves[${move}].sine_segments.max_deviation`,
  value: rounded(d1),
  message: `Move ${move + 1} of axis ${axis.axis} now has d1 = ${rounded(d1)}; Undo restores the previous value.`,
});

/** Adds a sine with a d1 to an axis without one. @param {SelectedAxis} axis @param {any} sample @param {number} d1 @returns {Edit} */
export const addedSine = (axis, sample, d1) => ({
  path: `${axis.path}.moves`,
  value: [...axis.moves, { sine_segments: { ...sample, max_deviation: rounded(d1) } }],
  message: `Axis ${axis.axis} now ends with a sine in segments; Undo removes it.`,
});

/** Replaces the axis' sine by a move through vertices, or appends that move. @param {Target} target @param {any} sample @param {(sine: any) => object | string} make  The move for a sine; a text says why there is none. @returns {Edit | string} */
export function vertexEdit({ axis, move }, sample, make) {
  if (!axis) return NOT_NOW;
  const value = make((axis.moves[move] ?? sample).sine_segments);
  if (typeof value === "string") return value;
  if (move < 0)
    return {
      path: `${axis.path}.moves`,
      value: [...axis.moves, value],
      message: `Axis ${axis.axis} now ends with a curve through these vertices; Undo removes it.`,
    };
  return {
    path: `${axis.path}.moves[${move}]`,
    value,
    message: `Move ${move + 1} of axis ${axis.axis} now goes through these vertices; Undo restores the sine.`,
  };
}

/** The sensor's bandwidth in harmonics of the axis' sine; undefined if there is none. @param {State} state @returns {number | undefined} */
export function sensorHarmonics(state) {
  const { axis, move } = targetOf(state);
  const { analysis } = state.scenario;
  return axis && move >= 0 && analysis?.sensor_hz
    ? analysis.sensor_hz * axis.moves[move].sine_segments.period_s
    : undefined;
}
