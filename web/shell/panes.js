/**
 * Panes of a wide screen: lines between them move their edges (pointer, arrow keys), each view folds to its head or
 * takes the whole place, and one that has nothing to show gives its room away. The state has it all, this device keeps
 * it; a narrow screen has tabs and none of this.
 */
import { button, byId, element } from "../dom.js";
import { keptRows } from "../state/row_choices.js";
import { hasPanel, inPlace, isOffered, PLACED, SHARED, VIEWS } from "../state/views.js";
import { listen } from "./commands.js";
import { bandsOf, GAP_PX, template } from "./grid.js";
import { loadPanes, savePanes } from "./storage.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Panes} Panes */
/**
 * @typedef {object} Edge  A line between two panes.
 * @property {string} pane  The pane before it, whose size it is: a view, or the form.
 * @property {string} label
 * @property {boolean} upright
 * @property {string} before  Selector of the pane before it.
 * @property {string} after   And of the one after it.
 * @property {import("../state/views.js").Place | null} place  Of the one after it; null for the views beside the form.
 * @property {number} least   Least size of the pane before it in CSS pixels.
 * @property {number} rest    Least size that is left for what comes after it.
 */

/** Least widths of the form, of all views beside it, and of one view beside another, in CSS pixels. */
const [MIN_FORM_PX, MIN_VIEWS_PX, MIN_VIEW_PX] = [270, 480, 200];
/** A key moves an edge by so many CSS pixels, with Shift by five times as many. */
const STEP_PX = 16;

/** All views by their bands, and the line between two neighbours, which goes by the name of the first. */
const BANDS = bandsOf(PLACED);
/** @type {Edge[]} */
const EDGES = [
  {
    pane: "form",
    label: "Width of the form",
    upright: true,
    before: "#sheet",
    after: "#views",
    place: null,
    least: MIN_FORM_PX,
    rest: MIN_VIEWS_PX,
  },
  ...BANDS.slice(1).map(([after], at) => between(firstOf(BANDS[at][BANDS[at].length - 1]), after, false)),
  ...BANDS.flatMap((band) =>
    band
      .slice(1)
      .flatMap((after, at) => (after.place.area === band[at].place.area ? [] : [between(band[at], after, true)])),
  ),
];

/** The first of the views in the place of one: it stands for all of them. @param {import("../state/views.js").Placed} view */
function firstOf({ place }) {
  return /** @type {import("../state/views.js").Placed} */ (PLACED.find((each) => each.place.area === place.area));
}

/** @param {import("../state/views.js").Placed} before @param {import("../state/views.js").Placed} after @param {boolean} upright @returns {Edge} */
function between(before, after, upright) {
  const all = (/** @type {import("../state/views.js").Placed} */ { place }) =>
    `:is(${PLACED.filter((each) => each.place.area === place.area)
      .map(({ name }) => `#view-${name}`)
      .join(", ")})`;
  return {
    pane: before.name,
    label: `${upright ? "Width" : "Height"} of ${before.title.toLowerCase()}`,
    upright,
    before: all(before),
    after: all(after),
    place: after.place,
    least: upright ? MIN_VIEW_PX : before.place.least_px,
    rest: upright ? MIN_VIEW_PX : after.place.least_px,
  };
}

/** @param {import("../state/types.js").Page} page */
export function createPanes({ dispatch, now }) {
  const main = /** @type {HTMLElement} */ (document.querySelector("main"));
  const views = byId("views");
  const wide = matchMedia("(min-width: 900px)");
  const edges = EDGES.map((edge) => ({ edge, line: line(edge) }));
  for (const { name } of VIEWS) byId(`view-${name}`).style.gridArea = areaOf(name);
  const sideways = [...SHARED.values()].flatMap(sides);
  for (const view of PLACED) buttons(view);
  const kept = read();
  if (kept) queueMicrotask(() => dispatch({ type: "pane", panes: kept }));
  wide.addEventListener("change", () => apply(now()));
  new ResizeObserver(() => {
    for (const each of edges) tell(each.edge, each.line);
  }).observe(views);

  /** @param {Edge} edge */
  function line(edge) {
    const made = element("div", {
      class: `edge ${edge.upright ? "upright" : "level"}`,
      id: `edge-${edge.pane}`,
      role: "separator",
      tabindex: "0",
      "aria-orientation": edge.upright ? "vertical" : "horizontal",
      "aria-label": edge.label,
      "aria-controls": edge.pane === "form" ? "sheet" : `view-${edge.pane}`,
      "aria-valuemin": "0",
      "aria-valuemax": "100",
      "aria-valuenow": "50",
      title: `${edge.label}: drag, or arrow keys; Enter or double click: as it was`,
    });
    document.querySelector(edge.after)?.before(made);
    const { area } = edge.place ?? {};
    if (area) made.style.gridArea = edge.upright ? area : `${area} / 1 / ${area} / -1`;
    made.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      event.preventDefault();
      made.focus();
      made.setPointerCapture(event.pointerId);
    });
    made.addEventListener("pointermove", (event) => {
      if (!made.hasPointerCapture(event.pointerId)) return;
      const [before] = boxes(edge);
      resize(edge, (edge.upright ? event.clientX - before.left : event.clientY - before.top) - 4);
    });
    made.addEventListener("dblclick", () => reset(edge));
    const by = (/** @type {number} */ px) => resize(edge, size(edge) + px);
    listen(made, "Line between two panes", [
      { keys: ["ArrowLeft", "ArrowUp"], text: "make the pane before it smaller", run: () => by(-STEP_PX) },
      { keys: ["ArrowRight", "ArrowDown"], text: "make the pane before it larger", run: () => by(STEP_PX) },
      { keys: ["Shift+ArrowLeft", "Shift+ArrowUp"], text: "much smaller", run: () => by(-5 * STEP_PX) },
      { keys: ["Shift+ArrowRight", "Shift+ArrowDown"], text: "much larger", run: () => by(5 * STEP_PX) },
      { keys: ["Home"], text: "as small as can be", run: () => resize(edge, 0) },
      { keys: ["End"], text: "as large as can be", run: () => resize(edge, 1e6) },
      {
        keys: ["Enter"],
        text: "as it was at first; the form: fold or unfold it",
        run: () => (edge.pane === "form" ? dispatch(change({ form: now().panes.form === 0 ? null : 0 })) : reset(edge)),
      },
    ]);
    return made;
  }

  /** Boxes of the pane before an edge and of the one after it. @param {Edge} edge */
  function boxes({ before, after }) {
    const shown = (/** @type {string} */ css) =>
      [...document.querySelectorAll(css)].map((node) => node.getBoundingClientRect()).find(({ width }) => width > 0) ??
      new DOMRect();
    return [shown(before), shown(after)];
  }

  /** @param {Edge} edge */
  function size(edge) {
    const [before] = boxes(edge);
    return edge.upright ? before.width : before.height;
  }

  /** What an edge can be moved to. @param {Edge} edge */
  function limits(edge) {
    const [before, after] = boxes(edge);
    const both = edge.upright ? before.width + after.width : before.height + after.height;
    return { least: edge.least, most: Math.max(edge.least, both - edge.rest), both };
  }

  /** @param {Partial<Panes>} some @returns {import("../state/message.js").Message} */
  const change = (some) => ({ type: "pane", panes: some });

  /** Gives the pane before an edge a size; the one after it has the rest. @param {Edge} edge @param {number} px */
  function resize(edge, px) {
    const { least, most, both } = limits(edge);
    const wanted = Math.round(Math.max(least, Math.min(most, px)));
    if (edge.pane === "form") return dispatch(change({ form: wanted }));
    if (edge.upright) return dispatch(change({ columns: [wanted / both, 1 - wanted / both] }));
    const shown = bandsOf(onShow(now()));
    const heights = shown.map((band) => Math.max(...band.map(({ name }) => byId(`view-${name}`).offsetHeight)));
    const at = shown.findIndex(([{ place }]) => place.band === edge.place?.band);
    [heights[at - 1], heights[at]] = [wanted, both - wanted];
    const room = Math.max(1, views.clientHeight - GAP_PX * (shown.length - 1));
    dispatch(change({ rows: heights.map((height) => height / room) }));
  }

  /** @param {Edge} edge */
  function reset({ pane, upright }) {
    dispatch(change(pane === "form" ? { form: null } : upright ? { columns: null } : { rows: null }));
  }

  /** Buttons in the heads of views that share a place, each to another of them. @param {import("../state/views.js").Placed[]} here */
  function sides(here) {
    return here.flatMap(({ name }) =>
      here
        .filter((other) => other.name !== name)
        .map((view) => {
          const made = element("button", { type: "button", class: "side", "data-side": view.name }, view.title);
          made.addEventListener("click", () => dispatch({ type: "side", area: view.place.area, side: view.name }));
          byId(`view-${name}`).querySelector(".head")?.append(made);
          return { made, view };
        }),
    );
  }

  /** Fold and maximise, in the head of a view. @param {import("../state/views.js").Placed} view */
  function buttons({ name: view, title }) {
    const section = byId(`view-${view}`);
    const head = /** @type {HTMLElement} */ (section.querySelector(".head"));
    const name = title.toLowerCase();
    const fold = button("–", `Fold ${name}`, () => foldOrNot(view));
    const most = button("□", `Maximise ${name}`, () => maximise(view));
    fold.classList.add("fold");
    most.classList.add("most");
    head.append(element("span", { class: "pane-buttons" }, fold, most));
    head.addEventListener("dblclick", (event) => {
      if (!(/** @type {Element} */ (event.target).closest("button, input, select, label"))) maximise(view);
    });
    listen(section, "Any view on a wide screen", [
      {
        keys: ["f"],
        text: "maximise the view, or show all views again",
        run: ({ target }) => {
          if (!wide.matches || /** @type {Element} */ (target).matches("input, textarea, select")) return false;
          maximise(view);
        },
      },
    ]);
  }

  /** Also a view that has nothing to show can be unfolded, and folded again. @param {string} view */
  function foldOrNot(view) {
    const { panes, bare } = now();
    const without = (/** @type {string[]} */ list) => list.filter((each) => each !== view);
    const small = isSmall(now(), view);
    dispatch(
      change({
        largest: null,
        folded: small || bare.includes(view) ? without(panes.folded) : [...panes.folded, view],
        open: small && bare.includes(view) ? [...panes.open, view] : without(panes.open),
      }),
    );
  }

  /** @param {string} view */
  function maximise(view) {
    const { bare, panes } = now();
    dispatch(
      change({
        open: bare.includes(view) && !panes.open.includes(view) ? [...panes.open, view] : panes.open,
        largest: areaOf(now().panes.largest) === areaOf(view) ? null : view,
        folded: now().panes.folded.filter((each) => each !== view),
      }),
    );
  }

  /** Says where an edge is. @param {Edge} edge @param {HTMLElement} made */
  function tell(edge, made) {
    const { both } = limits(edge);
    const small = PLACED.filter(({ name }) => isSmall(now(), name)).map(({ name }) => `#view-${name}`);
    const gone =
      !wide.matches ||
      (edge.pane !== "form" &&
        (largestOf(now()) !== null ||
          [edge.before, edge.after].some((css) =>
            small.some((id) => document.querySelector(id)?.matches(`${css}:not(.behind)`)),
          )));
    made.hidden = gone;
    if (both > 0) made.setAttribute("aria-valuenow", String(Math.round((100 * size(edge)) / both)));
  }

  /** @param {State} state */
  function apply(state) {
    const { form, rows, columns, folded } = state.panes;
    const largest = largestOf(state);
    const shown = onShow(state);
    main.classList.toggle("formless", wide.matches && form === 0);
    main.style.gridTemplateColumns =
      wide.matches && form !== null ? `${form === 0 ? "0px" : `minmax(0, ${form}px)`} minmax(0, 1fr)` : "";
    const most = shown.find(({ place }) => place.area === areaOf(largest));
    for (const view of PLACED) {
      const { name, title } = view;
      const section = byId(`view-${name}`);
      const small = isSmall(state, name);
      section.classList.toggle("folded", wide.matches && small && folded.includes(name));
      section.classList.toggle("bare", wide.matches && small && !folded.includes(name));
      section.classList.toggle("behind", wide.matches && !shown.includes(view));
      section.classList.toggle("away", wide.matches && largest !== null && view !== most);
      const [foldButton, mostButton] = /** @type {HTMLElement[]} */ ([
        ...section.querySelectorAll(".pane-buttons button"),
      ]);
      label(foldButton, small ? "+" : "–", `${small ? "Unfold" : "Fold"} ${title.toLowerCase()}`);
      label(
        mostButton,
        view === most ? "❐" : "□",
        view === most ? "Show all views (F)" : `Maximise ${title.toLowerCase()} (F)`,
      );
      foldButton.setAttribute("aria-expanded", String(!small));
      mostButton.setAttribute("aria-pressed", String(view === most));
    }
    for (const { name, place } of VIEWS)
      if (!place) byId(`view-${name}`).classList.toggle("away", wide.matches && name !== state.view);
    for (const { made, view } of sideways) made.hidden = !isOffered(view, state);
    views.classList.toggle("arranged", rows !== null);
    views.style.gridTemplate = !wide.matches
      ? ""
      : largest !== null
        ? `"${areaOf(largest)}" minmax(0, 1fr) / minmax(0, 1fr)`
        : template({ shown, rows, columns, isSmall: (view) => isSmall(state, view) });
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    const changed =
      before?.panes !== state.panes ||
      before?.bare !== state.bare ||
      before?.result !== state.result ||
      before?.sides !== state.sides ||
      before?.scenario.plant !== state.scenario.plant ||
      hasPanel(before) !== hasPanel(state) ||
      before?.view !== state.view;
    if (!changed) return;
    apply(state);
    for (const each of edges) tell(each.edge, each.line);
    if (before && before.panes !== state.panes) savePanes(JSON.stringify(state.panes));
  }
  return { render };
}

/** What takes the whole place: a view that has none of its own, while it is open, or one made to. @param {State} state */
const largestOf = ({ view, panes: { largest, open }, bare }) =>
  isAlone(view) ? view : largest && bare.includes(largest) && !open.includes(largest) ? null : largest;

/** The place of a view in the grid. @param {string | null} view */
function areaOf(view) {
  return PLACED.find(({ name }) => name === view)?.place.area ?? view ?? "";
}

/** @param {string} view */
const isAlone = (view) => !PLACED.some(({ name }) => name === view);

/** The views on show, one a place. @param {State} state */
function onShow(state) {
  return PLACED.filter(({ name, place }) => inPlace(state, place.area) === name);
}

/** Whether a view is not more than its head: folded, or with nothing to show. @param {State} state @param {string} view */
function isSmall(state, view) {
  if (largestOf(state) !== null) return false;
  return state.panes.folded.includes(view) || (state.bare.includes(view) && !state.panes.open.includes(view));
}

/** @param {HTMLElement} node @param {string} text @param {string} said */
function label(node, text, said) {
  node.textContent = text;
  node.title = said;
  node.setAttribute("aria-label", said);
}

/** What an earlier visit left; nothing where it cannot be read. @returns {Partial<Panes> | null} */
function read() {
  try {
    const { form, rows, columns, folded, open, pulses } = JSON.parse(loadPanes() ?? "null");
    const parts = (/** @type {any} */ list, /** @type {number} */ length, /** @type {number} */ most) =>
      Array.isArray(list) && list.length === length && list.every((part) => part > 0 && part < most) ? list : null;
    const views = (/** @type {any} */ list) =>
      PLACED.map(({ name }) => name).filter((view) => Array.isArray(list) && list.includes(view));
    return {
      form: form === 0 || (form >= MIN_FORM_PX && form <= 4000) ? form : null,
      rows: parts(rows, BANDS.length, 4),
      columns: parts(columns, 2, 1),
      folded: views(folded),
      open: views(open),
      pulses: keptRows(pulses),
    };
  } catch {
    return null;
  }
}
