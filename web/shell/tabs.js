/** On a narrow screen the views are tabs and the form folds away; on a wide one all of them stand. */
import { byId } from "../dom.js";
import { lookedAt } from "../state/state.js";

/** @typedef {import("../state/types.js").State} State */

const VIEWS = ["motion", "pulses", "packets", "spectrum", "timing"];

/** @param {import("../time/timeline.js").Page} page */
export function createTabs({ dispatch }) {
  const tab = (/** @type {string} */ view) => byId(`tab-${view}`);
  for (const view of VIEWS) {
    tab(view).addEventListener("click", () => dispatch({ type: "view", view }));
    tab(view).addEventListener("keydown", (event) => {
      const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (by === undefined) return;
      event.preventDefault();
      const offered = VIEWS.filter((name) => !tab(name).hidden);
      const next = offered[(offered.indexOf(view) + by + offered.length) % offered.length];
      dispatch({ type: "view", view: next });
      tab(next).focus();
    });
  }
  const narrow = matchMedia("(max-width: 899px)");
  const sheet = /** @type {HTMLDetailsElement} */ (byId("sheet"));
  const fold = () => { sheet.open = !narrow.matches; };
  narrow.addEventListener("change", fold);
  fold();

  /** @param {State} state */
  function render(state) {
    const driver = typeof lookedAt(state)?.violations === "number";
    tab("timing").hidden = !driver;
    const shown = state.view === "timing" && !driver ? "spectrum" : state.view;
    for (const view of VIEWS) {
      const open = view === shown;
      tab(view).setAttribute("aria-selected", String(open));
      tab(view).tabIndex = open ? 0 : -1;
      byId(`view-${view}`).classList.toggle("open", open);
    }
  }
  return { render };
}
