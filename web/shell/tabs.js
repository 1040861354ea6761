/** Tabs of the views on a narrow screen. */
import { byId, element } from "../dom.js";
import { isOffered, openTab, VIEWS } from "../state/views.js";

/** @typedef {import("../state/types.js").State} State */

/** @param {import("../state/types.js").Page} page */
export function createTabs({ dispatch }) {
  const tabs = VIEWS.map((view) => {
    const { name, title, tab: label = title } = view;
    const tab = element(
      "button",
      { type: "button", role: "tab", id: `tab-${name}`, "aria-controls": `view-${name}` },
      label,
    );
    tab.addEventListener("click", () => dispatch({ type: "view", view: name }));
    return { view, tab, section: byId(`view-${name}`) };
  });
  byId("tabs").append(...tabs.map(({ tab }) => tab));
  addTabKeys(tabs.map(({ tab }) => tab));
  const narrow = matchMedia("(max-width: 899px)");
  const sheet = /** @type {HTMLDetailsElement} */ (byId("sheet"));
  const fold = () => {
    sheet.open = !narrow.matches;
    // The hint is in the footer, which stays in sight.
    if (narrow.matches) {
      byId("views").after(byId("about"));
      byId("status").before(byId("field-hint"));
    } else {
      byId("derived").before(byId("about"));
      byId("sheet-scroll").after(byId("field-hint"));
    }
  };
  narrow.addEventListener("change", fold);
  fold();

  /** @param {State} state */
  function render(state) {
    const shown = openTab(state);
    for (const { view, tab, section } of tabs) {
      const open = view.name === shown;
      tab.hidden = !isOffered(view, state);
      markTab(tab, open);
      section.classList.toggle("open", open);
    }
  }
  return { render };
}

/** Adds the keys of tabs: arrow keys (with wraparound), Home and End open another tab. @param {HTMLElement[]} tabs */
export function addTabKeys(tabs) {
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

/** Marks a tab as open or not; only the open one is reachable with the Tab key. @param {HTMLElement} tab @param {boolean} open */
export function markTab(tab, open) {
  tab.setAttribute("aria-selected", String(open));
  tab.tabIndex = open ? 0 : -1;
}
