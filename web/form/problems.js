/** Shows the problems of the scenario next to their fields and in a list. */
import { button, byId, element, fill, setText } from "../dom.js";
import { counted } from "../state/number.js";
import { assignProblems, problemsOf, problemText } from "./problem_places.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("./control.js").Control} Control */

/** Maximum listed problems. */
const MAX_LISTED = 3;

/** @param {State} state @param {Map<string, Control>} controls @param {Map<string, HTMLElement>} groups */
export function showProblems(state, controls, groups) {
  const problems = problemsOf(state);
  const assigned = assignProblems(problems, controls, groups);
  for (const [path, control] of controls) control.fail(assigned.fields.get(path) ?? "");
  for (const [path, node] of groups) setText(node, assigned.parts.get(path) ?? "");
  markSections();
  const list = byId("problems");
  list.hidden = problems.length === 0;
  setText(
    /** @type {Element} */ (list.querySelector("h2")),
    problems.length === 0 ? "" : state.result ? "Not run: showing the last valid result." : "Not run.",
  );
  const fields = [...assigned.fields].map(([path, message]) => {
    const control = /** @type {Control} */ (controls.get(path));
    const text = `${nameOf(control)}: ${message}`;
    return button(text, text, () => control.focus());
  });
  const parts = [...assigned.parts].map(([path, message]) => button(message, message, () => show(groups.get(path))));
  const buttons = [...fields, ...parts];
  const more = buttons.length - MAX_LISTED;
  const items = [
    ...buttons.slice(0, MAX_LISTED),
    ...(more > 0 ? [`and ${counted(more, "more problem")}`] : []),
    ...assigned.others.map(problemText),
  ].map((item) => element("li", {}, item));
  fill(/** @type {Element} */ (list.querySelector("ul")), ...items);
}

/** Scrolls to a part of the form and unfolds it. @param {HTMLElement | undefined} part */
function show(part) {
  for (let at = part?.parentElement; at; at = at.parentElement) if (at instanceof HTMLDetailsElement) at.open = true;
  part?.scrollIntoView({ block: "center" });
}

/** The label of a field with the part of the form that contains it. @param {Control} control */
function nameOf({ label, root }) {
  const part = root.closest(".item")?.querySelector("legend")?.textContent;
  return part ? `${label}, ${part}` : label;
}

/** Marks sections that contain an error, also while they are folded. */
function markSections() {
  for (const part of document.querySelectorAll("details.part")) {
    const summary = /** @type {Element} */ (part.querySelector("summary"));
    const wrong = [...part.querySelectorAll(".error")].some((error) => error.textContent !== "");
    const mark = summary.querySelector(".mark");
    if (wrong && !mark) summary.append(element("span", { class: "mark" }, " – needs attention"));
    else if (!wrong) mark?.remove();
  }
}
