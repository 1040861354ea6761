/**
 * The study: "which profile, stored how, for my motor?" On a wide screen it takes the place of all views while it is
 * open, on a narrow one it is a tab. Its own tabs are modules beside this one, each `createX(page)`, made when it is
 * first opened, and drawn only while it is open:
 *
 *     page     the engine, the state's `now` and `dispatch`, `samples` of all moves, and `panel`, the element that the tab fills
 *     render   (state, before) as any view's; `before` is the state that this tab was last drawn of, none at first
 */
import { byId, element, options } from "../../dom.js";
import { listen } from "../../shell/commands.js";
import { arrows, choose } from "../../shell/tabs.js";
import { lookedAt } from "../../state/state.js";
import { STUDIES } from "../../shell/view_part.js";
import { createCompare } from "./compare.js";
import { createMeasures } from "./measures.js";
import { createSine } from "./sine.js";
import { createTables } from "./tables.js";
import { createTorque } from "./torque.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{engine: import("../../engine/engine.js").Engine, samples: import("../../form/kit.js").Samples} & import("../../time/timeline.js").Page} Given */
/** @typedef {{panel: HTMLElement} & Given} StudyPage */
/** @typedef {{render: (state: State, before: State | undefined) => any}} StudyTab */

/** @type {{[name in import("../../state/types.js").StudyName]: {title: string, create: (page: StudyPage) => StudyTab}}} */
const TABS = {
  compare: { title: "Compare", create: createCompare },
  measures: { title: "Measures", create: createMeasures },
  tables: { title: "Tables", create: createTables },
  sine: { title: "Sine", create: createSine },
  torque: { title: "Torque", create: createTorque },
};

/** @param {Given} page */
export function createStudy(page) {
  const { dispatch, now } = page;
  const view = byId("view-study");
  const all = STUDIES.map((name) => {
    const tab = element("button", { type: "button", role: "tab", id: `study-tab-${name}`, "aria-controls": `study-${name}` }, TABS[name].title);
    const panel = element("div", { role: "tabpanel", id: `study-${name}`, class: "study-panel", "aria-labelledby": tab.id });
    tab.addEventListener("click", () => dispatch({ type: "study", study: name }));
    view.append(panel);
    return { name, tab, panel, made: /** @type {StudyTab | null} */ (null), drawn: /** @type {State | undefined} */ (undefined) };
  });
  byId("study-tabs").append(...all.map(({ tab }) => tab));
  arrows(all.map(({ tab }) => tab));

  const axes = /** @type {HTMLSelectElement} */ (byId("study-axis"));
  axes.addEventListener("change", () => dispatch({ type: "axis", axis: Number(axes.value) }));
  const isOpen = () => now().view === "study";
  /** Opens or closes it; what has the focus must not go out of sight with it. @param {boolean} [open] */
  function toggle(open = !isOpen()) {
    dispatch({ type: "view", view: open ? "study" : "motion" });
    const focus = open ? all.find(({ name }) => name === now().study)?.tab : byId("study");
    focus?.focus();
  }
  byId("study").addEventListener("click", () => toggle());
  byId("study-close").addEventListener("click", () => toggle(false));
  const key = { keys: ["F2"], text: "open or close the study", run: () => toggle() };
  listen(view, "Study", [key, { keys: ["Escape"], text: "in the study: show the views again", run: ({ target }) => (target instanceof HTMLInputElement ? false : toggle(false)) }]);
  listen(document, "Study", [key]);

  /** @param {State} state */
  function render(state) {
    const open = state.view === "study";
    byId("study").setAttribute("aria-pressed", String(open));
    for (const { name, tab, panel } of all) {
      choose(tab, name === state.study);
      panel.hidden = name !== state.study;
    }
    const each = all.find(({ name }) => name === state.study);
    if (!open || !each) return undefined;
    const channels = lookedAt(state)?.channels ?? 1;
    options(axes, Array.from({ length: channels }, (_, axis) => [String(axis), String(axis)]), String(state.axis));
    /** @type {HTMLElement} */ (axes.parentElement).hidden = channels < 2;
    each.made ??= TABS[each.name].create({ ...page, panel: each.panel });
    const before = each.drawn;
    each.drawn = state;
    return each.made.render(state, before);
  }
  return { render };
}
