/**
 * The study: "which profile, stored how, for my motor?" On a wide screen it takes the place of all views while it is
 * open, on a narrow one it is a tab. Its own tabs are modules beside this one (tabs.js), which load when the study is
 * first opened: each `createX(page)`, made when it is first shown, and drawn only while it is:
 *
 *     page     the engine, the state's `now` and `dispatch`, `samples` of all moves, and `panel`, the element that the tab fills
 *     render   (state, before) as any view's; `before` is the state that this tab was last drawn of, none at first
 */
import { byId, element, fill, loadStyle, setOptions } from "../../dom.js";
import { registerCommands } from "../../shell/commands.js";
import { addTabKeys, markTab } from "../../shell/tabs.js";
import { STUDIES } from "../../shell/view_part.js";
import { selected } from "../../state/queries.js";
import { place } from "./place.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{engine: import("../../engine/engine.js").Engine, samples: import("../../form/kit.js").Samples} & import("../../state/types.js").Page} Given */
/** @typedef {{panel: HTMLElement} & Given} StudyPage */
/** @typedef {{render: (state: State, before: State | undefined) => any}} StudyTab */

/** @type {{[name in import("../../state/types.js").StudyName]: string}} */
const TITLES = {
  compare: "Compare",
  measures: "Measures",
  tables: "Tables",
  sine: "Sine",
  torque: "Torque",
  motor: "Motor",
};

/** @param {Given} page */
export function createStudy(page) {
  const { dispatch, now } = page;
  const view = byId("view-study");
  const all = STUDIES.map((name) => {
    const tab = element(
      "button",
      { type: "button", role: "tab", id: `study-tab-${name}`, "aria-controls": `study-${name}` },
      TITLES[name],
    );
    const panel = element("div", {
      role: "tabpanel",
      id: `study-${name}`,
      class: "study-panel",
      "aria-labelledby": tab.id,
    });
    tab.addEventListener("click", () => dispatch({ type: "study", study: name }));
    view.append(panel);
    return {
      name,
      tab,
      panel,
      made: /** @type {StudyTab | null} */ (null),
      drawn: /** @type {State | undefined} */ (undefined),
    };
  });
  byId("study-tabs").append(...all.map(({ tab }) => tab));
  addTabKeys(all.map(({ tab }) => tab));

  const axes = /** @type {HTMLSelectElement} */ (byId("study-axis"));
  axes.addEventListener("change", () => dispatch({ type: "axis", axis: Number(axes.value) }));
  const isOpen = () => now().view === "study";
  /** Opens or closes it; what has the focus must not go out of sight with it. @param {boolean} [open] */
  function toggle(open = !isOpen()) {
    if (open && begins(now())) dispatch({ type: "study", study: "sine" });
    dispatch({ type: "view", view: open ? "study" : "motion" });
    const focus = open ? all.find(({ name }) => name === now().study)?.tab : byId("study");
    focus?.focus();
  }
  byId("study").addEventListener("click", () => toggle());
  byId("study-close").addEventListener("click", () => toggle(false));
  const key = { keys: ["F2"], text: "open or close the study", run: () => toggle() };
  registerCommands(view, "Study", [
    key,
    {
      keys: ["Escape"],
      text: "in the study: back to the views",
      run: ({ target }) => (target instanceof HTMLInputElement ? false : toggle(false)),
    },
  ]);
  registerCommands(document, "Study", [key]);

  /** @type {typeof import("./tabs.js").TABS | null} */
  let tabs = null;
  /** @type {Promise<void> | null} */
  let loading = null;
  /** Loads the tabs once, and draws the open one. @param {HTMLElement} panel */
  async function load(panel) {
    loading ??= Promise.all([import("./tabs.js"), loadStyle("study")]).then(([{ TABS }]) => {
      tabs = TABS;
    });
    try {
      await loading;
    } catch {
      loading = null;
      const press = element("button", { type: "button" }, "Try again");
      press.addEventListener("click", () => render(now()));
      return fill(
        panel,
        element(
          "p",
          { class: "study-note" },
          "The study could not be loaded. Check the network and try again. ",
          press,
        ),
      );
    }
    return render(now());
  }

  let wasOpened = false;
  /** A sine makes no n steps in a time that could be compared: the study of one that the user opens begins with its own tab. @param {State} state */
  function begins(state) {
    const first = !wasOpened;
    return (
      first &&
      state.study === STUDIES[0] &&
      place(state).moves?.some((/** @type {object} */ move) => "sine" in move || "sine_segments" in move)
    );
  }

  /** @param {State} state @returns {any} */
  function render(state) {
    const open = state.view === "study";
    wasOpened ||= open;
    byId("study").setAttribute("aria-pressed", String(open));
    for (const { name, tab, panel } of all) {
      markTab(tab, name === state.study);
      panel.hidden = name !== state.study;
    }
    const each = all.find(({ name }) => name === state.study);
    if (!open || !each) return undefined;
    const channels = selected(state)?.channels ?? 1;
    setOptions(
      axes,
      Array.from({ length: channels }, (_, axis) => [String(axis), String(axis)]),
      String(state.axis),
    );
    /** @type {HTMLElement} */ (axes.parentElement).hidden = channels < 2;
    if (!tabs) return load(each.panel);
    each.made ??= tabs[each.name]({ ...page, panel: each.panel });
    const before = each.drawn;
    each.drawn = state;
    return each.made.render(state, before);
  }
  return { render };
}
