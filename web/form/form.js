/** The form, built from `fields.js` and `sources.js`. It is only rebuilt if the shape of the scenario changes. */

import { byId, element, fill } from "../dom.js";
import { get } from "../state/paths.js";
import { blockedBy } from "../state/queries.js";
import { controllerItems } from "./controllers.js";
import { showAbout, showDerived } from "./derived.js";
import { driverItems } from "./driver.js";
import { glitchFields, OF_SEGMENTS, sections } from "./fields.js";
import { createKit } from "./kit.js";
import { plantItems } from "./plant.js";
import { createPointerHold, keepFocusInSight, showHints } from "./pointer.js";
import { showProblems } from "./problems.js";
import { labelOf, labels, termOf } from "./schema.js";
import { isUsed, needsRemedies, shapeOf } from "./shape.js";
import { hasNoLine, replacedBySource } from "./source_kinds.js";
import { SOURCES, withSource } from "./sources.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Scenario} Scenario */

/**
 * @param {{root: HTMLElement, samples: import("./kit.js").Samples, drivers: import("../state/types.js").DriverSheet[],
 *   dispatch: (message: import("../state/message.js").Message) => void,
 *   remedies: Parameters<typeof import("./remedies.js").showOffers>[0]}} given
 */
export function createForm({ root, samples, drivers, dispatch, remedies }) {
  let shape = "";
  /** @type {State} */
  let state;
  const scroller = byId("sheet-scroll");
  const pointer = createPointerHold(byId("sheet"), () => draw(state));
  showHints(root);
  keepFocusInSight(scroller);
  /** The state that the form shows. @type {State | undefined} */
  let drawn;
  const kit = createKit({ samples, now: () => state, dispatch, anew });

  /** @param {Scenario} scenario @returns {Node[]} */
  function source(scenario) {
    const kind = Object.keys(scenario.source)[0];
    // The first of them is in a part of the core that may not be there yet.
    const kinds = { standalone: "Stand-alone controller", ...labels("Source") };
    const select = kit.kindSelect(labelOf("Scenario", "source"), "source", kind, kinds, (selected) => {
      const change = () => kit.change("", (now) => withSource(now, selected, samples), replacedBySource(scenario));
      const { load } = SOURCES[selected];
      if (!load) return change();
      const { scenario: before } = state;
      // What was changed while it came is newer.
      return load(kit).then(() => state.scenario === before && change(), refused);
    });
    return [
      kit.errorOf("source"),
      element("div", { class: "item-head" }, select),
      element("p", { class: "item-note" }, termOf(`Source.${kind}`)?.text ?? ""),
      ...SOURCES[kind].form(kit, scenario),
    ];
  }

  /** Lists whose length changes, by the name that a section gives them. @type {{[list: string]: (scenario: Scenario) => Node[]}} */
  const LISTS = {
    glitches: (scenario) =>
      kit.rows(
        "line.glitches",
        scenario.line.glitches,
        glitchFields(),
        "Glitch",
        (last) =>
          last ? { ...last, start_cycle: last.start_cycle + 2 * last.length_cycles } : structuredClone(samples.glitch),
        "Noise.glitches_ppm",
      ),
    controllers: (scenario) => controllerItems(kit, scenario),
    driver_timing: (scenario) => driverItems(kit, scenario, drivers),
    plant: (scenario) => plantItems(kit, scenario),
  };

  /** Where the focus is, to find it again in the form built anew: a field by its path, a button by what it does. @param {HTMLElement} active */
  function focusOf(active) {
    const { path } = active.dataset;
    const selector = path
      ? `[data-path="${CSS.escape(path)}"]`
      : `button[aria-label="${CSS.escape(active.getAttribute("aria-label") ?? "")}"]`;
    return { selector, nth: [...root.querySelectorAll(selector)].indexOf(active), place: reachable().indexOf(active) };
  }

  /** What the focus can go to, in the order of the form. @returns {HTMLElement[]} */
  function reachable() {
    return [...root.querySelectorAll("button:enabled, input:enabled, select:enabled, textarea:enabled, summary")].map(
      (each) => /** @type {HTMLElement} */ (each),
    );
  }

  /** @param {Scenario} scenario */
  function build(scenario) {
    kit.clear();
    const active = /** @type {HTMLElement | null} */ (document.activeElement);
    const focus = active && root.contains(active) ? focusOf(active) : null;
    const isLineless = hasNoLine(scenario);
    const shown = sections().filter(({ onLine }) => !(onLine && isLineless) || scenario.controllers.length > 0);
    const parts = shown.map(({ title, open, blocks, group, list }) =>
      kit.part(title, open, [
        ...blocks.flatMap(({ path, fields }) =>
          kit.block(
            path,
            path === "bus" && isLineless ? fields.filter(({ key }) => OF_SEGMENTS.includes(key)) : fields,
          ),
        ),
        ...(group
          ? [kit.part(group.title, isUsed(get(scenario, group.path)), kit.block(group.path, group.fields))]
          : []),
        ...(list ? LISTS[list](scenario) : []),
      ]),
    );
    fill(root, kit.part("Source", true, source(scenario)), ...parts);
    if (!focus) return;
    const again = /** @type {HTMLElement | undefined} */ (root.querySelectorAll(focus.selector)[focus.nth]);
    // What was removed with the focus on it leaves it to what stands there now.
    const there = reachable();
    (again?.matches(":enabled, summary") ? again : there[Math.min(focus.place, there.length - 1)])?.focus();
  }

  /** @param {Scenario} scenario */
  const take = (scenario) => kit.change("", () => scenario);
  /** What puts things right; it loads when something is wrong for the first time. @type {Promise<typeof import("./remedies.js")> | null} */
  let loading = null;
  /** @param {(fixes: typeof import("./remedies.js")) => void} show */
  function putRight(show) {
    if (!loading && !needsRemedies(state)) return;
    loading ??= import("./remedies.js");
    loading.then(show).catch(() => {
      loading = null;
    });
  }

  /** What is under the pointer stays where it is until it is let go. Whoever waits for the form waits for what it loads. @param {State} next */
  function render(next) {
    state = next;
    if (!pointer.holds()) draw(next);
    return kit.loading();
  }

  /** Another kind of source could not be loaded. @param {Error} error */
  function refused({ message }) {
    dispatch({ type: "notice", notice: { kind: "error", text: `The source is unchanged: ${message}`, place: null } });
    anew();
  }

  /** A part of the form that had to be loaded is there. What is being typed is not taken away: it waits for the next field. */
  function anew() {
    const active = document.activeElement;
    if (root.contains(active) && active?.matches("input:not([type=checkbox]), textarea")) {
      active.addEventListener("blur", () => setTimeout(buildAnew), { once: true });
    } else buildAnew();
  }

  function buildAnew() {
    [shape, drawn] = ["", undefined];
    if (!pointer.holds()) draw(state);
  }

  /** @param {State} next */
  function draw(next) {
    const before = drawn;
    if (before === next) return;
    drawn = next;
    const nextShape = shapeOf(next.scenario);
    if (nextShape !== shape) {
      shape = nextShape;
      build(next.scenario);
    }
    if (before?.scenario !== next.scenario || before?.drafts !== next.drafts || before?.derived !== next.derived) {
      for (const [path, made] of kit.controls) made.show(get(next.scenario, path), next);
    }
    if (before?.scenario !== next.scenario) showAbout(next);
    // Another experiment begins with what it is about.
    if (before && before.origin !== next.origin && next.origin !== "own") scroller.scrollTop = 0;
    const validated = blockedBy(next) !== "unvalidated";
    if (validated && (before?.validation !== next.validation || before?.drafts !== next.drafts)) {
      showProblems(next, kit.controls, kit.groups);
      putRight(({ showOffers }) => showOffers(remedies, () => state, take, pointer.released));
    }
    if (
      before?.result !== next.result ||
      before?.validation !== next.validation ||
      before?.scenario !== next.scenario ||
      before?.drafts !== next.drafts
    ) {
      putRight(({ showRemedy }) => showRemedy(state, drivers, take));
    }
    if (
      validated &&
      (before?.validation !== next.validation ||
        before?.drafts !== next.drafts ||
        before?.result !== next.result ||
        before?.unit !== next.unit)
    )
      showDerived(next, root);
  }

  return { render };
}
