/** Panes of a wide screen: edges to drag, and views that fold or maximize. A narrow screen has tabs instead. */
import { button, byId, element } from "../dom.js";
import { hasPanel, isOffered, PLACED, SHARED, VIEWS } from "../state/views.js";
import { registerCommands } from "./commands.js";
import { bandsOf, template } from "./grid.js";
import { createEdge } from "./pane_edge.js";
import {
  areaOf,
  EDGES,
  folded,
  isSmall,
  largestOf,
  maximized,
  readPanes,
  resized,
  shownViews,
  unsized,
} from "./pane_layout.js";
import { loadPanes, savePanes } from "./storage.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/views.js").Placed} Placed */

/** @param {import("../state/types.js").Page} page */
export function createPanes({ dispatch, now }) {
  const main = /** @type {HTMLElement} */ (document.querySelector("main"));
  const views = byId("views");
  const wide = matchMedia("(min-width: 900px)");
  /** @param {Partial<import("../state/types.js").Panes>} panes */
  const change = (panes) => dispatch({ type: "pane", panes });
  const edges = EDGES.map((edge) => ({
    edge,
    line: createEdge(edge, {
      resize(px, before, after) {
        const bands = bandsOf(shownViews(now()));
        const heights = bands.map((band) => Math.max(...band.map(({ name }) => byId(`view-${name}`).offsetHeight)));
        change(resized(edge, px, { before, after, heights, bands, total: views.clientHeight }));
      },
      reset(byKey) {
        const isUnfolded = byKey && edge.pane === "form" && now().panes.form !== 0;
        change(isUnfolded ? { form: 0 } : unsized(edge));
      },
    }),
  }));
  for (const { name } of VIEWS) byId(`view-${name}`).style.gridArea = areaOf(name);
  const sideButtons = [...SHARED.values()].flatMap(createSideButtons);
  for (const view of PLACED) createPaneButtons(view);
  const saved = readPanes(loadPanes());
  if (saved) queueMicrotask(() => change(saved));
  wide.addEventListener("change", () => apply(now()));
  new ResizeObserver(showEdges).observe(views);

  /** Buttons in the headers of views that share an area, each for another of them. @param {Placed[]} sharing */
  function createSideButtons(sharing) {
    return sharing.flatMap(({ name }) =>
      sharing
        .filter((other) => other.name !== name)
        .map((view) => {
          const made = element("button", { type: "button", class: "side", "data-side": view.name }, view.title);
          made.addEventListener("click", () => dispatch({ type: "side", area: view.place.area, side: view.name }));
          byId(`view-${name}`).querySelector(".head")?.append(made);
          return { made, view };
        }),
    );
  }

  /** The buttons Fold and Maximize in the header of a view. @param {Placed} view */
  function createPaneButtons({ name: view, title }) {
    const section = byId(`view-${view}`);
    const head = /** @type {HTMLElement} */ (section.querySelector(".head"));
    const name = title.toLowerCase();
    const maximize = () => change(maximized(now(), view));
    const fold = button("–", `Fold ${name}`, () => change(folded(now(), view)));
    const most = button("□", `Maximize ${name}`, maximize);
    fold.classList.add("fold");
    most.classList.add("most");
    head.append(element("span", { class: "pane-buttons" }, fold, most));
    head.addEventListener("dblclick", (event) => {
      if (!(/** @type {Element} */ (event.target).closest("button, input, select, label"))) maximize();
    });
    registerCommands(section, "Any view on a wide screen", [
      {
        keys: ["f"],
        text: "maximize the view, or show all views",
        run: ({ target }) => {
          if (!wide.matches || /** @type {Element} */ (target).matches("input, textarea, select")) return false;
          maximize();
        },
      },
    ]);
  }

  /** Hides the edges next to a folded or empty view, and all but the form's while one view fills the screen. */
  function showEdges() {
    const state = now();
    const small = PLACED.filter(({ name }) => isSmall(state, name)).map(({ name }) => byId(`view-${name}`));
    const isFilled = largestOf(state) !== null;
    for (const { edge, line } of edges)
      line.render(
        (css) =>
          !wide.matches ||
          (edge.pane !== "form" && (isFilled || small.some((view) => view.matches(`${css}:not(.behind)`)))),
      );
  }

  /** @param {State} state */
  function apply(state) {
    const { form, rows, columns } = state.panes;
    const largest = largestOf(state);
    const shown = shownViews(state);
    main.classList.toggle("formless", wide.matches && form === 0);
    main.style.gridTemplateColumns =
      wide.matches && form !== null ? `${form === 0 ? "0px" : `minmax(0, ${form}px)`} minmax(0, 1fr)` : "";
    const most = shown.find(({ place }) => place.area === areaOf(largest));
    for (const view of PLACED) applyView(state, view, { isShown: shown.includes(view), isMost: view === most });
    for (const { name, place } of VIEWS)
      if (!place) byId(`view-${name}`).classList.toggle("away", wide.matches && name !== state.view);
    for (const { made, view } of sideButtons) made.hidden = !isOffered(view, state);
    views.classList.toggle("arranged", rows !== null);
    views.style.gridTemplate = !wide.matches
      ? ""
      : largest !== null
        ? `"${areaOf(largest)}" minmax(0, 1fr) / minmax(0, 1fr)`
        : template({ shown, rows, columns, isSmall: (view) => isSmall(state, view) });
  }

  /** @param {State} state @param {Placed} view @param {{isShown: boolean, isMost: boolean}} place */
  function applyView(state, { name, title }, { isShown, isMost }) {
    const section = byId(`view-${name}`);
    const small = isSmall(state, name);
    const isFolded = state.panes.folded.includes(name);
    section.classList.toggle("folded", wide.matches && small && isFolded);
    section.classList.toggle("bare", wide.matches && small && !isFolded);
    section.classList.toggle("behind", wide.matches && !isShown);
    section.classList.toggle("away", wide.matches && largestOf(state) !== null && !isMost);
    const [fold, most] = /** @type {HTMLElement[]} */ ([...section.querySelectorAll(".pane-buttons button")]);
    const lower = title.toLowerCase();
    label(fold, small ? "+" : "–", `${small ? "Unfold" : "Fold"} ${lower}`);
    label(most, isMost ? "❐" : "□", isMost ? "Show all views (F)" : `Maximize ${lower} (F)`);
    fold.setAttribute("aria-expanded", String(!small));
    most.setAttribute("aria-pressed", String(isMost));
  }

  let isApplied = false;

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    const isChanged =
      !isApplied ||
      before?.panes !== state.panes ||
      before?.emptyViews !== state.emptyViews ||
      before?.result !== state.result ||
      before?.sides !== state.sides ||
      before?.scenario.plant !== state.scenario.plant ||
      hasPanel(before) !== hasPanel(state) ||
      before?.view !== state.view;
    if (!isChanged) return;
    isApplied = true;
    apply(state);
    showEdges();
    if (before && before.panes !== state.panes) savePanes(JSON.stringify(state.panes));
  }
  return { render };
}

/** @param {HTMLElement} node @param {string} text @param {string} name */
function label(node, text, name) {
  node.textContent = text;
  node.title = name;
  node.setAttribute("aria-label", name);
}
