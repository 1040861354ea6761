/** On a narrow screen the views are tabs and the form folds away; on a wide one all of them stand. */
import { byId } from "../dom.js";
import { selected } from "../state/state.js";

/** @typedef {import("../state/types.js").State} State */

const VIEWS = ["motion", "pulses", "packets", "spectrum", "timing", "study"];

/** @param {import("../state/types.js").Page} page */
export function createTabs({ dispatch }) {
  const tab = (/** @type {string} */ view) => byId(`tab-${view}`);
  for (const view of VIEWS) {
    tab(view).addEventListener("click", () => dispatch({ type: "view", view }));
  }
  arrows(VIEWS.map(tab));
  const narrow = matchMedia("(max-width: 899px)");
  const sheet = /** @type {HTMLDetailsElement} */ (byId("sheet"));
  const fold = () => {
    sheet.open = !narrow.matches;
  };
  narrow.addEventListener("change", fold);
  fold();

  /** @param {State} state */
  function render(state) {
    const driver = typeof selected(state)?.violations === "number";
    tab("timing").hidden = !driver;
    const shown = state.view === "timing" && !driver ? "spectrum" : state.view;
    for (const view of VIEWS) {
      const open = view === shown;
      choose(tab(view), open);
      byId(`view-${view}`).classList.toggle("open", open);
    }
  }
  return { render };
}

/** The arrow keys go from tab to tab, round, Home and End to the first and the last, and open what they come to. @param {HTMLElement[]} tabs */
export function arrows(tabs) {
  for (const tab of tabs) {
    tab.addEventListener("keydown", (event) => {
      const offered = tabs.filter((each) => !each.hidden);
      const at = offered.indexOf(tab);
      const to = { ArrowLeft: at - 1, ArrowRight: at + 1, Home: 0, End: -1 }[event.key];
      if (to === undefined) return;
      event.preventDefault();
      const next = offered[(to + offered.length) % offered.length];
      next.click();
      next.focus();
    });
  }
}

/** Marks the open one of some tabs; it alone is in the order of the Tab key. @param {HTMLElement} tab @param {boolean} open */
export function choose(tab, open) {
  tab.setAttribute("aria-selected", String(open));
  tab.tabIndex = open ? 0 : -1;
}
