/** The legend of all axes: a press hides or shows the curves of an axis. */
import { byId, element, fill } from "../../dom.js";
import { selected } from "../../state/queries.js";
import { swatch } from "../lines.js";
import { axisNames } from "./axis_names.js";
import { lookOf, scaleOf, unitOf } from "./axis_units.js";

/** @typedef {import("../../state/types.js").State} State */

/** @param {import("../../state/types.js").Page} page */
export function createAxes({ dispatch, now }) {
  const root = byId("motion-axes");
  root.addEventListener("click", ({ target }) => {
    const press = target instanceof Element ? target.closest("button") : null;
    if (!press) return;
    const axis = Number(press.dataset.axis);
    const { hiddenAxes } = now();
    const others = hiddenAxes.filter((each) => each !== axis);
    dispatch({ type: "axes", hidden: others.length < hiddenAxes.length ? others : [...others, axis] });
  });

  /** @param {State} state */
  function entries(state) {
    const names = axisNames(state);
    return Array.from({ length: selected(state)?.channels ?? 1 }, (_, axis) => {
      const { ink, dash } = lookOf(state, axis);
      const name = names[axis] ?? "";
      const isShown = !state.hiddenAxes.includes(axis);
      const hasUnit = scaleOf(state, axis) !== null;
      const press = element(
        "button",
        {
          type: "button",
          class: axis === state.axis ? "selected" : "",
          "data-axis": String(axis),
          "aria-pressed": String(isShown && hasUnit),
          "aria-label": `Axis ${axis} ${name}`.trim(),
          title: hasUnit ? `${isShown ? "Hide" : "Show"} axis ${axis}` : `Axis ${axis} has no ${unitOf(state).unit}`,
        },
        swatch(ink, dash > 0),
        ` ${axis} ${name}`.trimEnd(),
      );
      // A short dash is drawn as dots.
      if (dash === 2) /** @type {HTMLElement} */ (press.firstElementChild).style.borderTopStyle = "dotted";
      press.disabled = !hasUnit;
      return press;
    });
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (
      before?.result === state.result &&
      before?.derived === state.derived &&
      before?.axis === state.axis &&
      before?.unit === state.unit &&
      before?.hiddenAxes === state.hiddenAxes
    )
      return;
    root.hidden = (selected(state)?.channels ?? 1) === 1;
    const focused = root.contains(document.activeElement) ? document.activeElement?.getAttribute("data-axis") : null;
    fill(root, ...(root.hidden ? [] : entries(state)));
    if (focused) /** @type {HTMLElement | null} */ (root.querySelector(`[data-axis="${focused}"]`))?.focus();
  }
  return { render };
}
