/** The line of the tab Sine that reports its edits of the scenario, and offers to add a sine to an axis without one. */
import { element, fill, setText } from "../../dom.js";
import { get } from "../../state/paths.js";
import { addedSine, deviationEdit, targetOf, vertexEdit, whyNoAxis } from "./sine_edits.js";
import { rounded } from "./sine_sweep.js";

/** @param {Pick<import("./study.js").StudyPage, "samples" | "dispatch" | "now">} page */
export function createSineNote({ samples, dispatch, now }) {
  const root = element("p", { class: "study-note", id: "sine-note", "aria-live": "polite", tabindex: "-1" });
  /** The edit that the note describes; the note goes when the edit is undone. @type {{path: string, json: string} | null} */
  let described = null;

  /** @param {import("./sine_edits.js").Edit} edit */
  function apply({ path, value, message }) {
    described = { path, json: JSON.stringify(value) };
    dispatch({ type: "edit", path, value });
    setText(root, message);
  }

  /** Sets the scenario's d1. @param {number} d1 */
  function setDeviation(d1) {
    const { axis, move } = targetOf(now());
    described = null;
    if (!axis) return setText(root, whyNoAxis(now()));
    if (move >= 0) return apply(deviationEdit(axis, move, d1));
    const press = element("button", { type: "button" }, `Add one with d1 = ${rounded(d1)}`);
    press.addEventListener("click", () => add(d1));
    return fill(root, `Axis ${axis.axis} has no sine in segments. `, press);
  }

  /** The axis may have changed since the offer. @param {number} d1 */
  function add(d1) {
    const { axis, move } = targetOf(now());
    root.focus({ preventScroll: true });
    if (!axis || move >= 0) return setDeviation(d1);
    return apply(addedSine(axis, samples.moves.sine_segments, d1));
  }

  /** @param {(sine: any) => object | string} make */
  function putMove(make) {
    described = null;
    const edit = vertexEdit(targetOf(now()), samples.moves, make);
    if (typeof edit === "string") return setText(root, edit);
    return apply(edit);
  }

  /** @param {import("../../state/types.js").State} state */
  function render({ scenario }) {
    if (!described || JSON.stringify(get(scenario, described.path)) === described.json) return;
    described = null;
    setText(root, "");
  }
  return { root, setDeviation, putMove, render };
}
