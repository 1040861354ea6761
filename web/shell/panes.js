/**
 * Panes of a wide screen: lines between them move their edges (pointer, arrow keys), each view folds to its head or
 * takes the whole place. The state has it all, this device keeps it; a narrow screen has tabs and none of this.
 */
import { button, byId, element } from "../dom.js";
import { listen } from "./commands.js";
import { loadPanes, savePanes } from "./storage.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Panes} Panes */
/**
 * @typedef {object} Edge  A line between two panes.
 * @property {"form" | "motion" | "pulses" | "packets"} pane  The pane before it, whose size it is.
 * @property {string} label
 * @property {boolean} upright
 * @property {string} before  Selector of the pane before it.
 * @property {string} after   And of the one after it.
 */

const VIEWS = ["motion", "pulses", "packets", "spectrum", "timing"];
/** @type {Edge[]} */
const EDGES = [
  { pane: "form", label: "Width of the form", upright: true, before: "#sheet", after: "#views" },
  { pane: "motion", label: "Height of the curves", upright: false, before: "#view-motion", after: "#view-pulses" },
  { pane: "pulses", label: "Height of the pulses", upright: false, before: "#view-pulses", after: "#view-packets" },
  {
    pane: "packets",
    label: "Width of the packets",
    upright: true,
    before: "#view-packets",
    after: ":is(#view-spectrum, #view-timing)",
  },
];
/** Least size of a pane in CSS pixels. */
const MIN_PX = { form: 270, motion: 120, pulses: 110, packets: 200 };
/** Least room that is left for the views beside the form. */
const MIN_VIEWS_PX = 480;
/** A key moves an edge by so many CSS pixels, with Shift by five times as many. */
const STEP_PX = 16;

/** @param {import("../state/types.js").Page} page */
export function createPanes({ dispatch, now }) {
  const main = /** @type {HTMLElement} */ (document.querySelector("main"));
  const views = byId("views");
  const wide = matchMedia("(min-width: 900px)");
  const edges = EDGES.map((edge) => ({ edge, line: line(edge) }));
  for (const view of VIEWS) buttons(view);
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
      "aria-controls": edge.before.slice(1),
      "aria-valuemin": "0",
      "aria-valuemax": "100",
      "aria-valuenow": "50",
      title: `${edge.label}: drag, or arrow keys; Enter or double click: as it was`,
    });
    document.querySelector(edge.after)?.before(made);
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
    const rest = edge.pane === "form" ? MIN_VIEWS_PX : MIN_PX[edge.upright ? "packets" : "pulses"];
    return { least: MIN_PX[edge.pane], most: Math.max(MIN_PX[edge.pane], both - rest), both };
  }

  /** @param {Partial<Panes>} some @returns {import("../state/state.js").Message} */
  const change = (some) => ({ type: "pane", panes: some });

  /** Gives the pane before an edge a size; the one after it has the rest. @param {Edge} edge @param {number} px */
  function resize(edge, px) {
    const { least, most, both } = limits(edge);
    const wanted = Math.round(Math.max(least, Math.min(most, px)));
    if (edge.pane === "form") return dispatch(change({ form: wanted }));
    if (edge.pane === "packets") return dispatch(change({ columns: [wanted / both, 1 - wanted / both] }));
    const heights = [EDGES[1], EDGES[2]].map(size);
    const [, below] = boxes(EDGES[2]);
    const all = [...heights, below.height];
    const at = edge.pane === "motion" ? 0 : 1;
    all[at] = wanted;
    all[at + 1] = both - wanted;
    const sum = all[0] + all[1] + all[2];
    dispatch(change({ rows: /** @type {[number, number, number]} */ (all.map((height) => height / sum)) }));
  }

  /** @param {Edge} edge */
  function reset({ pane }) {
    dispatch(change(pane === "form" ? { form: null } : pane === "packets" ? { columns: null } : { rows: null }));
  }

  /** Fold and maximise, in the head of a view. @param {string} view */
  function buttons(view) {
    const section = byId(`view-${view}`);
    const head = /** @type {HTMLElement} */ (section.querySelector(".head"));
    const name = (head.querySelector("h2")?.textContent ?? view).trim();
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

  /** @param {string} view */
  function foldOrNot(view) {
    const { folded } = now().panes;
    dispatch(
      change({
        largest: null,
        folded: folded.includes(view) ? folded.filter((each) => each !== view) : [...folded, view],
      }),
    );
  }

  /** @param {string} view */
  function maximise(view) {
    dispatch(
      change({
        largest: now().panes.largest === view ? null : view,
        folded: now().panes.folded.filter((each) => each !== view),
      }),
    );
  }

  /** Says where an edge is. @param {Edge} edge @param {HTMLElement} made */
  function tell(edge, made) {
    const { both } = limits(edge);
    const { panes } = now();
    const gone =
      !wide.matches ||
      (edge.pane !== "form" &&
        (largestOf(now()) !== null ||
          [edge.before, edge.after].some((css) => panes.folded.some((view) => css.includes(`view-${view}`)))));
    made.hidden = gone;
    if (both > 0) made.setAttribute("aria-valuenow", String(Math.round((100 * size(edge)) / both)));
  }

  /** @param {State} state */
  function apply(state) {
    const { form, rows, columns, folded } = state.panes;
    const largest = largestOf(state);
    const side = byId("views").classList.contains("timing-open") ? "timing" : "spectrum";
    const isFolded = (/** @type {string} */ view) => wide.matches && largest === null && folded.includes(view);
    main.classList.toggle("formless", wide.matches && form === 0);
    main.style.gridTemplateColumns =
      wide.matches && form !== null ? `${form === 0 ? "0px" : `minmax(0, ${form}px)`} minmax(0, 1fr)` : "";
    for (const view of VIEWS) {
      const section = byId(`view-${view}`);
      section.classList.toggle("folded", isFolded(view));
      section.classList.toggle(
        "away",
        wide.matches &&
          largest !== null &&
          largest !== view &&
          !(largest === "spectrum" && view === "timing") &&
          !(largest === "timing" && view === "spectrum"),
      );
      const [fold, most] = /** @type {HTMLElement[]} */ ([...section.querySelectorAll(".pane-buttons button")]);
      label(
        fold,
        folded.includes(view) ? "+" : "–",
        `${folded.includes(view) ? "Unfold" : "Fold"} ${titleOf(section)}`,
      );
      label(
        most,
        largest === view ? "❐" : "□",
        largest === view ? "Show all views (F)" : `Maximise ${titleOf(section)} (F)`,
      );
      fold.setAttribute("aria-expanded", String(!isFolded(view)));
      most.setAttribute("aria-pressed", String(largest === view));
    }
    views.style.gridTemplate = wide.matches ? template(rows, columns, isFolded, side, largest) : "";
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    const changed =
      before?.panes !== state.panes ||
      before?.result !== state.result ||
      before?.side !== state.side ||
      before?.view !== state.view;
    if (!changed) return;
    // After the timing check has taken or left the spectrum's place.
    queueMicrotask(() => {
      apply(now());
      for (const each of edges) tell(each.edge, each.line);
    });
    if (before && before.panes !== state.panes) savePanes(JSON.stringify(state.panes));
  }
  return { render };
}

/** What takes the whole place: the study, while it is open, or a view made to. @param {State} state */
const largestOf = ({ view, panes }) => (view === "study" ? view : panes.largest);

/** @param {HTMLElement} node @param {string} text @param {string} said */
function label(node, text, said) {
  node.textContent = text;
  node.title = said;
  node.setAttribute("aria-label", said);
}

/** @param {HTMLElement} section */
function titleOf(section) {
  return (section.querySelector("h2")?.textContent ?? "").toLowerCase();
}

/**
 * The grid of the views; empty for the style sheet's own.
 * @param {Panes["rows"]} rows @param {Panes["columns"]} columns @param {(view: string) => boolean} isFolded @param {string} side  What has the place beside the packets. @param {string | null} largest
 */
export function template(rows, columns, isFolded, side, largest) {
  if (largest !== null) {
    const area = largest === "timing" ? "spectrum" : largest;
    return `"${area} ${area}" minmax(0, 1fr) / minmax(0, 1fr) minmax(0, 1fr)`;
  }
  const [packets, other] = [isFolded("packets"), isFolded(side)];
  if (!rows && !columns && !isFolded("motion") && !isFolded("pulses") && !packets && !other) return "";
  const [motion, pulses, low] = rows ?? [0.47, 0.26, 0.27];
  const tall = (/** @type {boolean} */ folded, /** @type {number} */ part) =>
    folded ? "min-content" : `minmax(0, ${(100 * part).toFixed(2)}fr)`;
  // Of the two beside each other a folded one lies under the other.
  const lowest =
    packets && other
      ? '"packets packets" min-content "spectrum spectrum" min-content'
      : packets
        ? `"spectrum spectrum" ${tall(false, low)} "packets packets" min-content`
        : other
          ? `"packets packets" ${tall(false, low)} "spectrum spectrum" min-content`
          : `"packets spectrum" ${tall(false, low)}`;
  const [left, right] = columns ?? [6 / 11, 5 / 11];
  return `"motion motion" ${tall(isFolded("motion"), motion)} "pulses pulses" ${tall(isFolded("pulses"), pulses)} ${lowest} / minmax(0, ${left.toFixed(4)}fr) minmax(0, ${right.toFixed(4)}fr)`;
}

/** What an earlier visit left; nothing where it cannot be read. @returns {Partial<Panes> | null} */
function read() {
  try {
    const { form, rows, columns, folded } = JSON.parse(loadPanes() ?? "null");
    const parts = (/** @type {any} */ list, /** @type {number} */ length) =>
      Array.isArray(list) && list.length === length && list.every((part) => part > 0 && part < 1) ? list : null;
    return {
      form: form === 0 || (form >= MIN_PX.form && form <= 4000) ? form : null,
      rows: /** @type {any} */ (parts(rows, 3)),
      columns: /** @type {any} */ (parts(columns, 2)),
      folded: VIEWS.filter((view) => Array.isArray(folded) && folded.includes(view)),
    };
  } catch {
    return null;
  }
}
