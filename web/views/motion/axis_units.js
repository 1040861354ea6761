/** The unit and the line of each axis in the motion view. */

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./bands.js").Quantity} Quantity */

/** Colors and dashes of the axes that are not selected. A dashed green line is the baseline. */
const [SOLID, DASHED] = [
  ["--enable", "--wire", "--ink", "--reply"],
  ["--wire", "--ink", "--reply"],
];
const DASHES = [2, 10, 6, 18];

/** The line of an axis. @param {State} state @param {number} axis */
export function lookOf(state, axis) {
  // Without a plan there is only the actual curve.
  if (axis === state.axis) return { ink: visibleAxis(state) ? "--ideal" : "--actual", dash: 0 };
  if (axis < SOLID.length) return { ink: SOLID[axis], dash: 0 };
  const index = axis - SOLID.length;
  return { ink: DASHED[index % DASHED.length], dash: DASHES[Math.floor(index / DASHED.length) % DASHES.length] };
}

/** The derived values of an axis of the visible controller. @param {State} state @param {number} [axis] */
export function visibleAxis(state, axis = state.axis) {
  return state.derived?.controllers[state.result?.controller ?? 0]?.axes[axis];
}

/** The length of a step of another axis in the visible unit; null if its mechanics do not have the unit. @param {State} state @param {number} axis */
export function scaleOf(state, axis) {
  const { name } = unitOf(state);
  return name === "steps" ? 1 : (visibleAxis(state, axis)?.[name === "mm" ? "step_mm" : "step_deg"] ?? null);
}

/** The other axes that are drawn with the selected one. @param {State} state @param {number} channels */
export function otherAxes(state, channels) {
  return Array.from({ length: channels }, (_, axis) => axis).filter(
    (axis) => axis !== state.axis && !state.hiddenAxes.includes(axis) && scaleOf(state, axis) !== null,
  );
}

/** The same axis of the baseline, or its last one. @param {State} state */
export function baselineAxis({ baseline, axis }) {
  const channels = baseline?.summary.controllers[baseline.controller]?.channels ?? 1;
  const index = Math.min(axis, channels - 1);
  return { index, derived: baseline?.derived?.axes[index] };
}

/** @param {State} state @returns {[string, string][]} */
export function unitsOf(state) {
  const axis = visibleAxis(state);
  return [["steps", "steps"], ...(axis?.step_mm ? [["mm", "mm"]] : []), ...(axis?.step_deg ? [["deg", "°"]] : [])].map(
    ([name, text]) => [name, text],
  );
}

/** The selected unit, or steps if the axis does not have it, with the length of a step in this run and in the baseline. @param {State} state */
export function unitOf(state) {
  const axis = visibleAxis(state);
  const { derived } = baselineAxis(state);
  const wanted = state.unit ?? axis?.unit;
  if (wanted === "mm" && axis?.step_mm)
    return { name: "mm", unit: "mm", scale: axis.step_mm, baseline: derived?.step_mm ?? axis.step_mm };
  if (wanted === "deg" && axis?.step_deg)
    return { name: "deg", unit: "°", scale: axis.step_deg, baseline: derived?.step_deg ?? axis.step_deg };
  return { name: "steps", unit: "steps", scale: 1, baseline: 1 };
}

/** The unit of a quantity. @param {State} state @param {Quantity} quantity */
export function unitFor(state, quantity) {
  return unitOf(state).unit + { position: "", speed: "/s", acceleration: "/s²" }[quantity];
}
