/** Shows what the core says about the scenario: problems beside their fields, and what follows from it. */
import { button, byId, element, fill, flash, say } from "../dom.js";
import { count, counted, plain, pretty, short, si } from "../state/number.js";
import { get } from "../state/paths.js";
import { derivedAxis, derivedShown } from "../state/queries.js";
import { runsAlone } from "./sources.js";
import { termButton } from "./term_button.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("./control.js").Control} Control */

/** Places that are told one by one. */
const MAX_TOLD = 3;

/** @param {State} state @param {Map<string, Control>} controls @param {Map<string, HTMLElement>} groups */
export function showProblems(state, controls, groups) {
  const problems = [
    ...Object.entries(state.drafts).map(([path, { message }]) => ({ path, message })),
    // What the core says of a field that holds no number is about the value before.
    ...(state.validation?.problems ?? []).filter(
      ({ path }) => !Object.keys(state.drafts).some((at) => within(path, at) || within(at, path)),
    ),
  ].map(({ path, message }) => ({ path, message: pretty(message) }));
  /** @type {Map<string, string>} */
  const atField = new Map();
  /** @type {Map<string, string>} */
  const atGroup = new Map();
  /** @type {{path: string, message: string}[]} */
  const others = [];
  for (const { path, message } of problems) {
    const field = nearest(path, controls);
    const group = field === null ? nearest(path, groups) : null;
    const line = field !== null && path.slice(field.length).match(/^\[(\d+)\]/);
    if (field !== null) add(atField, field, line ? `Line ${Number(line[1]) + 1}: ${message}.` : message);
    else if (group !== null) add(atGroup, group, message);
    else others.push({ path, message });
  }
  for (const [path, control] of controls) control.fail(atField.get(path) ?? "");
  for (const [path, node] of groups) say(node, atGroup.get(path) ?? "");
  markSections();

  const list = byId("problems");
  list.hidden = problems.length === 0;
  say(
    /** @type {Element} */ (list.querySelector("h2")),
    problems.length === 0 ? "" : state.result ? "Not run: the views show the last good result." : "Not run.",
  );
  const fields = [...atField].map(([path, message]) => {
    const control = /** @type {Control} */ (controls.get(path));
    const text = `${nameOf(control)}: ${message}`;
    return button(text, text, () => control.focus());
  });
  const parts = [...atGroup].map(([path, message]) => button(message, message, () => show(groups.get(path))));
  const ways = [...fields, ...parts];
  const more = ways.length - MAX_TOLD;
  const items = [
    ...ways.slice(0, MAX_TOLD),
    ...(more > 0 ? [`and ${counted(more, "other place")}`] : []),
    ...others.map(({ path, message }) => (path ? `${path}: ${message}` : message)),
  ].map((item) => element("li", {}, item));
  fill(/** @type {Element} */ (list.querySelector("ul")), ...items);
}

/** Shows a part of the form, also where it is folded. @param {HTMLElement | undefined} part */
function show(part) {
  for (let at = part?.parentElement; at; at = at.parentElement) if (at instanceof HTMLDetailsElement) at.open = true;
  part?.scrollIntoView({ block: "center" });
}

/** A field with the part of the form that it is in. @param {Control} control */
function nameOf({ label, root }) {
  const part = root.closest(".item")?.querySelector("legend")?.textContent;
  return part ? `${label}, ${part}` : label;
}

/** Whether a path is another one, or of something in it. @param {string} path @param {string} other */
function within(path, other) {
  return path.startsWith(other) && /^([.[]|$)/.test(path.slice(other.length));
}

/** The longest path that is the problem's own or leads to it. @param {string} path @param {Map<string, unknown>} places */
function nearest(path, places) {
  for (let at = path; at; at = at.replace(/(\.[^.[\]]+|\[\d+\])$|^[^.[\]]+$/, "")) if (places.has(at)) return at;
  // A quantity's problem may name its unit's value further down, never further up.
  return null;
}

/** @param {Map<string, string>} map @param {string} path @param {string} message */
function add(map, path, message) {
  const before = map.get(path);
  map.set(path, before ? `${before} ${message}` : message);
}

/** Name and note of the scenario: what to look at. @param {State} state */
export function showAbout({ scenario }) {
  const root = byId("about");
  root.hidden = !scenario.title && !scenario.note;
  say(/** @type {Element} */ (root.querySelector("h2")), String(scenario.title ?? ""));
  say(/** @type {Element} */ (root.querySelector("p")), String(scenario.note ?? ""));
}

/** A folded section tells that something in it is wrong. */
function markSections() {
  for (const part of document.querySelectorAll("details.part")) {
    const summary = /** @type {Element} */ (part.querySelector("summary"));
    const wrong = [...part.querySelectorAll(".error")].some((error) => error.textContent !== "");
    const mark = summary.querySelector(".mark");
    if (wrong && !mark) summary.append(element("span", { class: "mark" }, " – needs attention"));
    else if (!wrong) mark?.remove();
  }
}

const OF_LAST_RUN = "of the last run: what the form holds is refused";

/** @param {State} state @param {HTMLElement} form */
export function showDerived(state, form) {
  const root = byId("derived");
  const { derived, fresh } = derivedShown(state);
  root.classList.toggle("stale", !fresh);
  root.title = fresh ? "" : OF_LAST_RUN;
  const rows = derived ? rowsOf(state, derived) : [];
  const terms = [...root.querySelectorAll("dt")];
  if (rows.length !== terms.length || rows.some(([name], index) => terms[index].textContent !== name)) {
    fill(
      root,
      element(
        "dl",
        {},
        ...rows.map(([name, value, mark, term]) =>
          element("div", {}, element("dt", {}, termButton(name, term)), element("dd", { class: mark }, value)),
        ),
      ),
    );
  } else {
    for (const [index, value] of [...root.querySelectorAll("dd")].entries()) {
      const [, text, mark] = rows[index];
      value.classList.toggle("over", mark === "over");
      if (value.textContent === text) continue;
      say(value, text);
      flash(value);
    }
  }
  for (const note of /** @type {NodeListOf<HTMLElement>} */ (form.querySelectorAll("[data-note]"))) {
    const { text, warning } = moveNote(note.dataset.note ?? "", { ...state, derived });
    note.classList.toggle("stale", !fresh);
    note.title = fresh ? "" : OF_LAST_RUN;
    if (note.textContent !== text + warning)
      fill(note, text, ...(warning ? [element("strong", { class: "short" }, warning)] : []));
  }
}

/** Name, value, `over` where it is too much, and the term that explains it. @param {State} state @param {import("../state/types.js").Derived} derived @returns {[string, string, string, string][]} */
function rowsOf(state, derived) {
  const [{ tick_s, limit_steps_s }] = derived.controllers;
  // Additional controllers can have ticks of another length.
  const several = derived.controllers.length > 1;
  const ticks = several ? derived.controllers[0].ticks : derived.ticks;
  const axes = derived.controllers.flatMap((controller) => controller.axes);
  const peak = Math.max(0, ...axes.map((axis) => axis.peak_speed_steps_s));
  const way =
    state.unit === "steps" ? null : axes.find((axis) => axis.peak_speed_steps_s === peak)?.[`step_${state.unit}`];
  const along = way ? ` · ${short(peak * way, 5)}\u00a0${state.unit === "deg" ? "°" : "mm"}/s` : "";
  const load = derived.line_load;
  const { source, line } = state.scenario;
  const sends = "line" in source;
  const alone = runsAlone(state.scenario);
  const over =
    !alone &&
    derived.controllers.some((controller) =>
      controller.axes.some((axis) => axis.peak_speed_steps_s > controller.limit_steps_s),
    );
  return [
    // When the last tick of packets or of a line script begins and ends, and what becomes of it on a line that goes wrong, is known only after the run.
    [
      line.protocol === "framed" && !alone && !sends
        ? "Duration, about"
        : sends || "packets" in source || (!alone && !isQuiet(line))
          ? "Duration at most"
          : "Duration",
      si(derived.duration_s, "s"),
      "",
      "duration",
    ],
    ["Peak rate", axes.length ? plain(peak, "steps/s") + along : "–", over ? "over" : "", "peak_rate"],
    ...(alone
      ? [/** @type {[string, string, string, string]} */ (["On the line", "nothing", "", "on_the_line"])]
      : /** @type {[string, string, string, string][]} */ ([
          [
            several ? "Tick of controller 1" : "Tick",
            sends ? si(tick_s, "s") : `${si(tick_s, "s")}, ${count(ticks)} in all`,
            "",
            "tick",
          ],
          [several ? "Limit of its bus" : "Limit of the bus", plain(limit_steps_s, "steps/s"), "", "limit"],
          sent(state, derived),
          [
            "Line load",
            load === null ? "–" : `${short(load * 100, 3)} %`,
            load !== null && load > 1 ? "over" : "",
            "line_load",
          ],
        ])),
  ];
}

/** Whether nothing on the line goes wrong. @param {any} line */
function isQuiet({ glitches, noise }) {
  return glitches.length === 0 && Object.entries(noise).every(([key, value]) => key === "seed" || value === 0);
}

/** What goes over the line: how much, or how often. @param {State} state @param {import("../state/types.js").Derived} derived @returns {[string, string, string, string]} */
function sent({ scenario: { source, line }, result, revision }, { sends, line_load, controllers }) {
  if ("line" in source) return ["Sends", count(sends), "", "Source.line"];
  // How many are repeated on a noisy line only the run tells; a controller that dies is asked everything again.
  const ran = result?.revision === revision ? result.summary.host : null;
  const most = line.noise.host_crashes_ppm > 0 ? "after the run" : `at most ${count(sends)}`;
  if (line.protocol === "framed")
    return ["Frames", ran ? count(ran.frames) : isQuiet(line) ? count(sends) : most, "", "ScriptedSend.frame"];
  const busy = controllers.filter(({ ticks }) => ticks > 0).length;
  return ["Packets", line_load === null ? "–" : plain(busy / controllers[0].tick_s, "/s"), "", "rate_of_packets"];
}

/** @param {string} path @param {State} state */
function moveNote(path, state) {
  const [, index] = path.match(/\.moves\[(\d+)\]/) ?? [];
  const move = derivedAxis(state, path)?.moves[Number(index)];
  if (!move) return { text: "", warning: "" };
  const [kind] = Object.keys(get(state.scenario, path) ?? {});
  const steps = move.steps === 0 && kind?.startsWith("sine") ? "back at the start" : counted(move.steps, "step");
  return {
    text: [`${si(move.start_s, "s")} to ${si(move.start_s + move.duration_s, "s")}`, steps, pretty(move.detail ?? "")]
      .filter(Boolean)
      .join(" · "),
    warning: move.warning && ` ⚠ Motor: ${pretty(move.warning)}.`,
  };
}
