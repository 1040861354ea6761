/** The form, built from `fields.js` and `sources.js`. It is rebuilt only if the shape of the scenario changes (`shapeOf`). */

import { byId, element, fill } from "../dom.js";
import { get } from "../state/paths.js";
import { blockedBy } from "../state/queries.js";
import { controllerItems } from "./controllers.js";
import { showAbout, showDerived } from "./derived.js";
import { driverItems } from "./driver.js";
import { glitchFields, OF_SEGMENTS, SENSOR, sections } from "./fields.js";
import { saveFocus } from "./focus.js";
import { createKit } from "./kit.js";
import { plantItems } from "./plant.js";
import { createPointerHold, keepFocusVisible, showHints } from "./pointer.js";
import { showProblems } from "./problems.js";
import { field, labelOf, labels, termOf } from "./schema.js";
import { isUsed, needsRemedies, shapeOf } from "./shape.js";
import { hasNoLine, replacedBySource } from "./source_kinds.js";
import { SOURCES, withSource } from "./sources.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Scenario} Scenario */

/**
 * @param {{root: HTMLElement, samples: import("./kit.js").Samples, drivers: import("../state/types.js").DriverSheet[],
 *   dispatch: (message: import("../state/message.js").Message) => void,
 *   remedies: Parameters<typeof import("./remedies.js").showOffers>[0]}} page
 */
export function createForm({ root, samples, drivers, dispatch, remedies }) {
  let shape = "";
  /** @type {State} */
  let state;
  const scroller = byId("sheet-scroll");
  /** The field of the sensor is in the spectrum. */
  const sensor = byId("spectrum-sensor");
  const roots = [root, sensor];
  const pointer = createPointerHold([byId("sheet"), sensor], () => draw(state));
  showHints(roots);
  keepFocusVisible(scroller);
  /** The state that the form shows. @type {State | undefined} */
  let drawn;
  const kit = createKit({ samples, now: () => state, dispatch, rebuild });

  /** @param {Scenario} scenario @returns {Node[]} */
  function sourceItems(scenario) {
    const kind = Object.keys(scenario.source)[0];
    // The schema of stand-alone controllers may not be loaded yet.
    const kinds = { standalone: "Stand-alone controller", ...labels("Source") };
    const select = kit.kindSelect(labelOf("Scenario", "source"), "source", kind, kinds, (selected) => {
      const change = () => kit.change("", (now) => withSource(now, selected, samples), replacedBySource(scenario));
      const { load } = SOURCES[selected];
      if (!load) return change();
      const { scenario: before } = state;
      // A change of the user while it loads takes precedence.
      return load(kit).then(() => state.scenario === before && change(), showLoadError);
    });
    return [
      kit.errorOf("source"),
      element("div", { class: "item-head" }, select),
      element("p", { class: "item-note" }, termOf(`Source.${kind}`)?.text ?? ""),
      ...SOURCES[kind].form(kit, scenario),
    ];
  }

  /** Content of the sections with a `list`. @type {{[list: string]: (scenario: Scenario) => Node[]}} */
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

  /** Shows the view of the sensor's field. */
  function showSpectrum() {
    const { folded } = state.panes;
    dispatch({ type: "pane", panes: { largest: null, folded: folded.filter((name) => name !== "spectrum") } });
    dispatch({ type: "side", area: "spectrum", side: "spectrum" });
    dispatch({ type: "view", view: "spectrum" });
  }

  /** @param {Scenario} scenario */
  function build(scenario) {
    kit.clear();
    const restoreFocus = roots.map(saveFocus);
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
    fill(root, kit.part("Source", true, sourceItems(scenario)), ...parts);
    fill(sensor, kit.row(SENSOR.path, field("Analysis", SENSOR.key)));
    const control = /** @type {import("./control.js").Control} */ (kit.controls.get(SENSOR.path));
    kit.controls.set(SENSOR.path, {
      ...control,
      focus() {
        showSpectrum();
        control.focus();
      },
    });
    for (const restore of restoreFocus) restore();
  }

  /** @param {Scenario} scenario */
  const replaceScenario = (scenario) => kit.change("", () => scenario);
  /** Remedies load with the first problem. @type {Promise<typeof import("./remedies.js")> | null} */
  let loading = null;
  /** Shows remedies once they are loaded. @param {(remedies: typeof import("./remedies.js")) => void} show */
  function withRemedies(show) {
    if (!loading && !needsRemedies(state)) return;
    loading ??= import("./remedies.js");
    loading.then(show).catch(() => {
      loading = null;
    });
  }

  /** Draws a state, unless the pointer is pressed. Returns the promise of the parts that the form loads. @param {State} next */
  function render(next) {
    state = next;
    if (pointer.isPressed()) follow(next);
    else draw(next);
    return kit.loading();
  }

  /** @param {Error} error */
  function showLoadError({ message }) {
    dispatch({
      type: "notice",
      notice: { kind: "error", text: `The source is unchanged: ${message}`, location: null },
    });
    rebuild();
  }

  /** Rebuilds the form after a part of it has loaded. While the user types, it waits until the field loses the focus. */
  function rebuild() {
    const active = document.activeElement;
    if (roots.some((part) => part.contains(active)) && active?.matches("input:not([type=checkbox]), textarea")) {
      active.addEventListener("blur", () => setTimeout(rebuildNow), { once: true });
    } else rebuildNow();
  }

  function rebuildNow() {
    [shape, drawn] = ["", undefined];
    if (!pointer.isPressed()) draw(state);
  }

  /** Draws derived values and meanings while the pointer is pressed: they follow a dragged number. @param {State} next */
  function follow(next) {
    for (const [path, control] of kit.controls) control.follow(get(next.scenario, path), next);
    if (blockedBy(next) !== "unvalidated") showDerived(next, root, true);
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
      for (const [path, control] of kit.controls) control.show(get(next.scenario, path), next);
    }
    if (before?.scenario !== next.scenario) showAbout(next);
    // The name and note of another experiment are at the top.
    if (before && before.origin !== next.origin && next.origin !== "own") scroller.scrollTop = 0;
    const validated = blockedBy(next) !== "unvalidated";
    if (validated && (before?.validation !== next.validation || before?.drafts !== next.drafts)) {
      showProblems(next, kit.controls, kit.groups);
      withRemedies(({ showOffers }) => showOffers(remedies, () => state, replaceScenario, pointer.released));
    }
    if (
      before?.result !== next.result ||
      before?.validation !== next.validation ||
      before?.scenario !== next.scenario ||
      before?.drafts !== next.drafts
    ) {
      withRemedies(({ showRemedy }) => showRemedy(state, drivers, replaceScenario));
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
