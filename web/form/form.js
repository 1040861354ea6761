/**
 * The form: built from the layout of `fields.js` and the kinds of `sources.js`. It is built anew only when the scenario's shape
 * changes (kinds, numbers of axes, moves, rows, controllers); else values are put into the fields that stand.
 */

import { byId, element, fill, say } from "../dom.js";
import { get } from "../state/paths.js";
import { blockedBy } from "../state/queries.js";
import { controllerItems } from "./controllers.js";
import { driverItems } from "./driver.js";
import { glitchFields, OF_SEGMENTS, sections } from "./fields.js";
import { createKit } from "./kit.js";
import { plantItems } from "./plant.js";
import { labelOf, labels, termOf } from "./schema.js";
import { replacedBySource, runsAlone, SOURCES, withSource } from "./sources.js";
import { showAbout, showDerived, showProblems } from "./validation.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Scenario} Scenario */

/**
 * @param {{root: HTMLElement, samples: import("./kit.js").Samples, drivers: import("../state/types.js").DriverSheet[],
 *   dispatch: (message: import("../state/message.js").Message) => void,
 *   remedies: Parameters<typeof import("./remedies.js").showOffers>[0],
 *   extend: () => Promise<void>}} given  `extend` brings the fields and samples of what the page begins without.
 */
export function createForm({ root, samples, drivers, dispatch, remedies, extend }) {
  let shape = "";
  /** @type {State} */
  let state;
  const scroller = byId("sheet-scroll");
  const hand = createHand(byId("sheet"), () => draw(state));
  showHints(root);
  keepFocusInSight(scroller);
  /** The state that the form shows. @type {State | undefined} */
  let drawn;
  const kit = createKit({ samples, now: () => state, dispatch, anew, extend });

  /** @param {Scenario} scenario @returns {Node[]} */
  function source(scenario) {
    const kind = Object.keys(scenario.source)[0];
    // The first of them is in a part of the core that may not be there yet.
    const kinds = { standalone: "Stand-alone controller", ...labels("Source") };
    const select = kit.kindSelect(labelOf("Scenario", "source"), "source", kind, kinds, (chosen) => {
      const change = () => kit.change("", (now) => withSource(now, chosen, samples), replacedBySource(scenario));
      const { load } = SOURCES[chosen];
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
    const alone = runsAlone(scenario);
    const shown = sections().filter(({ onLine }) => !(onLine && alone) || scenario.controllers.length > 0);
    const parts = shown.map(({ title, open, blocks, group, list }) =>
      kit.part(title, open, [
        ...blocks.flatMap(({ path, fields }) =>
          kit.block(path, path === "bus" && alone ? fields.filter(({ key }) => OF_SEGMENTS.includes(key)) : fields),
        ),
        ...(group ? [kit.part(group.title, used(get(scenario, group.path)), kit.block(group.path, group.fields))] : []),
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
    if (!loading && !isIll(state)) return;
    loading ??= import("./remedies.js");
    loading.then(show).catch(() => {
      loading = null;
    });
  }

  /** What is under the pointer stays where it is until it is let go. Whoever waits for the form waits for what it loads. @param {State} next */
  function render(next) {
    state = next;
    if (!hand.holds()) draw(next);
    return kit.loading();
  }

  /** Another kind of source could not be loaded. @param {Error} error */
  function refused({ message }) {
    dispatch({ type: "notice", notice: { kind: "error", text: `The source stays as it is: ${message}`, place: null } });
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
    if (!hand.holds()) draw(state);
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
      putRight(({ showOffers }) => showOffers(remedies, () => state, take, hand.released));
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

/** Whether something is wrong, or the line is made to go wrong. @param {State} state */
function isIll({ validation, result, scenario: { line } }) {
  return (
    (validation?.problems.length ?? 0) > 0 ||
    (result?.summary.controllers ?? []).some(({ violations }) => violations) ||
    line.glitches.length > 0 ||
    Object.entries(line.noise).some(([key, value]) => key !== "seed" && value !== 0)
  );
}

/** The hint of the field that has the focus, where it moves nothing; to a screen reader the field itself describes it. @param {HTMLElement} root */
function showHints(root) {
  const place = byId("field-hint");
  root.addEventListener("focusin", ({ target }) => {
    const field = /** @type {Element} */ (target).closest(".field:not(.wide)");
    say(place, field?.querySelector(".hint")?.textContent ?? "");
  });
  root.addEventListener("focusout", () => say(place, ""));
}

/** The field that has the focus stays in sight when what is said under the form takes room from it. @param {HTMLElement} scroller */
function keepFocusInSight(scroller) {
  let height = scroller.clientHeight;
  new ResizeObserver(() => {
    const before = height;
    height = scroller.clientHeight;
    const active = document.activeElement;
    const becameLower = height < before && scroller.scrollHeight > height;
    if (!becameLower || !active || !scroller.contains(active)) return;
    const [field, sight] = [active.getBoundingClientRect(), scroller.getBoundingClientRect()];
    // What the visitor had scrolled away from stays away.
    if (field.top >= sight.top && field.bottom <= sight.top + before) active.scrollIntoView({ block: "nearest" });
  }).observe(scroller);
}

/**
 * Whether the pointer is pressed on the form: what is computed meanwhile is drawn when it is let go, so that nothing
 * moves between press and release. A select opens at the press, and what ends it is not always told.
 * @param {HTMLElement} root @param {() => void} draw
 */
function createHand(root, draw) {
  let holds = false;
  /** Who waits for the release. @type {(() => void)[]} */
  const waiting = [];
  root.addEventListener("pointerdown", ({ target }) => {
    holds = !(/** @type {Element} */ (target).closest("select"));
  });
  // A click comes after its release.
  const free = () =>
    setTimeout(() => {
      if (!holds) return;
      holds = false;
      draw();
      for (const go of waiting.splice(0)) go();
    });
  for (const event of ["pointerup", "pointercancel", "keydown", "blur"]) window.addEventListener(event, free);
  const released = async () => {
    if (holds) await new Promise((/** @type {(value?: any) => void} */ go) => waiting.push(go));
  };
  return { holds: () => holds, released };
}

/** Whether anything in a group of numbers is other than 0. @param {{[key: string]: number}} group */
function used(group) {
  return Object.values(group).some((value) => value !== 0);
}

/** What decides which fields there are; values do not. @param {Scenario} scenario */
function shapeOf({ source, controllers, driver_timing: driver, line, plant }) {
  const kinds = (/** @type {any[]} */ axes) =>
    axes.map((axis) => [
      Object.keys(axis.mechanics)[0],
      Boolean(axis.motor),
      ...axis.moves.map((/** @type {any} */ move) => Object.keys(move)[0]),
    ]);
  return JSON.stringify([
    Object.keys(source)[0],
    runsAlone({ source }),
    kinds(source.motion?.axes ?? []),
    source.line?.sends?.length,
    source.segments?.channels?.length,
    source.standalone?.map(panelShape),
    line.glitches.length,
    controllers.map((/** @type {any} */ { axes }) => kinds(axes)),
    driver && (driver.preset ?? "rules"),
    plant && [Boolean(plant.protection), plant.motors?.length],
  ]);
}

/** @param {any} panel */
function panelShape({ groups, home, soft_limits, axis, inputs }) {
  const of = (/** @type {any} */ group) => [group, group.move?.until, group.profile?.motion].map(kindOf);
  return [groups?.map(of), Boolean(home), Boolean(soft_limits), Boolean(axis), inputs?.length];
}

/** @param {any} part */
const kindOf = (part) => part && Object.keys(part)[0];
