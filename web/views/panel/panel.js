/**
 * The view Panel: the front of a stand-alone controller as it is at the cursor, what was pressed over time, and its axis. A press
 * goes into the scenario at the cursor, or live; so it is undone, kept and linked as any change is. It loads when first opened.
 */
import { byId, element, fill, options, say, style } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count, exactTime, parseNumber, short, si } from "../../state/number.js";
import { endOf } from "../../state/time_window.js";
import { overlaid } from "../../time/cursors.js";
import { reveal } from "../../time/timeline.js";
import { createAxis } from "./axis.js";
import { createFront } from "./front.js";
import { createLive } from "./live.js";
import { lastUpTo } from "./paint.js";
import { moved, nameOf, ownerOf, press, put } from "./script.js";
import { createStrip } from "./strip.js";
import { INPUTS, read, SHARED, STATES } from "./words.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./script.js").Entry} Entry */
/** @typedef {import("./strip.js").Placed} Placed */

/** What a press lasts beyond the debouncing, and how far behind the end one stands, in s. */
const BEYOND_S = 0.01;
/** Most steps of a push. */
const MAX_PUSH = 1_000_000;
/** Presses without meaning that are told one by one. */
const MAX_LISTED = 20;
/** How slow live goes. */
const SPEEDS = [
  ["1", "real time"],
  ["0.1", "1/10"],
  ["0.01", "1/100"],
];

/** @param {import("./pane.js").Page} page */
export async function createPanel({ engine, dispatch, now }) {
  await style("panel");
  const view = byId("view-panel");
  const head = /** @type {HTMLElement} */ (view.querySelector(".head"));
  const which = element("select", {});
  const whichLabel = element("label", {}, "controller ", which);
  const at = element("output", { class: "panel-at", "aria-live": "off" });
  const hold = element("input", { class: "time", size: "8", spellcheck: "false", "aria-describedby": "panel-said" });
  const play = element(
    "button",
    {
      type: "button",
      "aria-pressed": "false",
      title: "The cursor goes on with the clock; a button is pressed as long as it is held",
    },
    "▶ Live",
  );
  const speed = element("select", { "aria-label": "Speed of live" });
  options(speed, /** @type {[string, string][]} */ (SPEEDS), "1");
  /** @type {Element} */ (head.firstElementChild).after(
    whichLabel,
    element(
      "label",
      { title: "How long a press lasts; it has to stand through the debouncing to count" },
      "hold ",
      hold,
    ),
    element("span", { class: "group", role: "group", "aria-label": "Live" }, play, speed),
    at,
  );
  const end = element(
    "button",
    {
      type: "button",
      hidden: "",
      title: "Lets cursor A go: the panel is as it is at the end, and presses come after it",
    },
    "To the end",
  );
  end.addEventListener("click", () => dispatch({ type: "cursor", which: "a", cycle: null }));
  at.after(end);
  const front = element("div", { class: "front", role: "group", "aria-label": "Front panel" });
  const said = element("p", { id: "panel-said", class: "panel-said", role: "status" });
  const axisPlace = element("div", { class: "axis", role: "group", "aria-label": "Virtual axis" });
  const stripPlace = element("div", { class: "strip" });
  const entryName = element("span", { "aria-live": "polite" });
  const entryCycle = element("input", {
    class: "time",
    "aria-label": "Time of the chosen input, in cycles or as a time",
    spellcheck: "false",
  });
  const entryRemove = element("button", { type: "button" }, "Remove");
  const entryLine = element("p", { class: "entry-line", hidden: "" }, entryName, " ", entryCycle, " ", entryRemove);
  const idle = element(
    "p",
    { class: "entry-line quiet" },
    "Diamonds are inputs: drag one, or choose it with ",
    element("kbd", {}, "N"),
    " and ",
    element("kbd", {}, "P"),
    " and move it with ",
    element("kbd", {}, ","),
    " and ",
    element("kbd", {}, "."),
  );
  const ignored = element("details", { class: "ignored", hidden: "" }, element("summary", {}), element("ul", {}));
  const wear = element("p", { class: "wear" });
  const keys = element(
    "p",
    { id: "panel-keys", class: "unseen" },
    "N and P choose the next and the previous input, comma and full stop move it, Delete removes it.",
  );
  const body = element("div", { class: "panel-body" });
  view.append(body);
  /** The rows stand beside the front. */
  const beside = matchMedia("(min-width: 1100px)");
  fill(
    body,
    front,
    element("div", { class: "time-side" }, axisPlace, stripPlace, entryLine, idle, ignored, wear, keys),
  );

  /** @type {import("./paint.js").Story | null} */
  let story = null;
  /** The result, and the controller, that it is of. @type {{result: State["result"], index: number} | null} */
  let about = null;
  /** A hold that a person gave, in cycles. @type {number | null} */
  let held = null;
  /** @type {Placed | null} */
  let chosen = null;
  /** Whether this view changes the scenario now. */
  let changing = false;

  const clock = () => now().result?.summary.clock_hz ?? now().scenario.clock_hz;
  /** @returns {any[]} */
  const panels = () => now().scenario.source?.standalone ?? [];
  const index = () => Math.max(0, Math.min(now().axis, panels().length - 1));
  const parameters = () => panels()[index()];
  const shortest = () => (parameters()?.debounce_cycles ?? 160_000) + Math.round(BEYOND_S * clock());
  const timeOf = (/** @type {number} */ cycle) => exactTime(cycle, clock());

  /** The cycle that is on show: under the pointer, at the cursor, else the end. @param {State} state */
  function momentOf(state) {
    if (live.isOn()) return { cycle: live.cycle(), name: "live" };
    const { hover, cursors } = state;
    if (hover !== null) return { cycle: hover, name: "at the pointer" };
    if (cursors.a !== null) return { cycle: cursors.a, name: "at cursor A" };
    return { cycle: endOf(state), name: "at the end" };
  }

  /** Where a press goes: to the cursor, else behind the end. */
  function target() {
    if (live.isOn()) return Math.max(1, live.cycle());
    const { cursors } = now();
    return cursors.a === null ? endOf(now()) + Math.round(BEYOND_S * clock()) : Math.max(1, cursors.a);
  }

  /** @param {number} owner @returns {Entry[]} */
  const inputsOf = (owner) => panels()[owner]?.inputs ?? [];

  /** Puts a changed script in the place of a controller's, or tells why not. @param {number} owner @param {import("./script.js").Changed} changed @param {boolean} [joins] */
  function take(owner, changed, joins = false) {
    if ("refused" in changed) {
      tell(changed.refused, true);
      return false;
    }
    changing = true;
    dispatch({ type: "edit", path: `source.standalone[${owner}].inputs`, value: changed.inputs, joins });
    changing = false;
    if (!joins) dispatch({ type: "committed" });
    return true;
  }

  /** @param {string} text @param {boolean} [wrong] */
  function tell(text, wrong = false) {
    said.classList.toggle("error", wrong);
    say(said, text);
  }

  /** A press at the cursor. @param {string} input */
  function click(input) {
    if (live.isOn()) return;
    const owner = ownerOf(index(), input);
    const from = target();
    const until = from + (held ?? shortest());
    if (take(owner, press(inputsOf(owner), input, from, until, parameters()?.axis, timeOf)))
      behind(until, `${input} is pressed at ${timeOf(from)}, for ${si((until - from) / clock(), "s")}.`);
  }

  /** What was put stands; the cursor goes behind it, so that the next press comes after and what became of it is shown. @param {number} cycle @param {string} text */
  function behind(cycle, text) {
    if (now().cursors.a !== null) dispatch({ type: "cursor", which: "a", cycle: cycle + shortest() });
    tell(text);
  }

  /** A level at the cursor. @param {string} input @param {number} level */
  function set(input, level) {
    const owner = ownerOf(index(), input);
    const cycle = target();
    if (take(owner, put(inputsOf(owner), { cycle, input, level }, parameters()?.axis, timeOf)))
      behind(cycle, `${input} is ${level} from ${timeOf(cycle)} on.`);
  }

  /** @param {number} steps */
  function push(steps) {
    const cycle = target();
    if (steps === 0) return tell("A push of 0 steps moves nothing.", true);
    if (Math.abs(steps) > MAX_PUSH)
      return tell(`A push has at most ${count(MAX_PUSH)} steps either way; push several times.`, true);
    if (take(index(), put(inputsOf(index()), { cycle, input: null, level: 1, push_steps: steps }, null, timeOf)))
      behind(
        cycle,
        `The axis is pushed by ${count(steps)} steps at ${timeOf(cycle)}; it moves if its windings are without current.`,
      );
    return undefined;
  }

  const live = createLive({
    hz: clock,
    speed: () => Number(speed.value),
    shortest,
    at: (cycle) => {
      // What nobody sees does not go on.
      if (panels().length === 0 || !view.checkVisibility()) {
        live.stop();
        return played();
      }
      dispatch({ type: "cursor", which: "a", cycle });
      const { window } = now();
      if (window && cycle > window.end && cycle <= endOf(now())) reveal({ dispatch, now }, cycle);
    },
    press: (input, from, until, before) => {
      const owner = ownerOf(index(), input);
      const inputs = inputsOf(owner);
      if (before === null) return take(owner, press(inputs, input, from, until, parameters()?.axis, timeOf), true);
      const place = inputs.findIndex((each) => each.input === input && each.level === 0 && each.cycle === before);
      if (place < 0) return false;
      return take(owner, moved(inputs, place, until, timeOf), true);
    },
  });
  play.addEventListener("click", () => {
    if (live.isOn()) {
      live.stop();
      dispatch({ type: "committed" });
    } else live.play(target());
    played();
    draw(now());
  });

  function played() {
    play.setAttribute("aria-pressed", String(live.isOn()));
    say(play, live.isOn() ? "❚❚ Stop" : "▶ Live");
    tell(live.isOn() ? "Live: hold a button as long as it is to be pressed." : "");
  }

  const faces = createFront(front, {
    down: (input) => live.isOn() && live.down(input),
    up: (input) => {
      live.up(input);
      if (live.isOn()) dispatch({ type: "committed" });
    },
    click,
    set,
  });
  // Over the buttons, where it is seen whatever is pressed; in the place of what there is to do.
  front.querySelector(".panel-told")?.prepend(said);
  const axis = createAxis(axisPlace, push);
  const strip = createStrip(stripPlace, {
    engine,
    dispatch,
    now,
    entries,
    move,
    remove,
    // Beside the axis, the cursors' handles and the lines under the rows.
    room: () => (beside.matches ? body.clientHeight - axisPlace.offsetHeight - 24 - 90 : 0),
    channel: index,
    print: (steps) => short(steps / (parameters()?.pulses_per_unit || 1), 6),
    chosen: (placed) => {
      chosen = placed;
      line();
    },
  });

  /** @returns {Placed[]} */
  function entries() {
    const own = inputsOf(index()).map((entry, at) => ({ owner: index(), index: at, entry }));
    if (index() === 0) return own;
    const shared = inputsOf(0).map((entry, at) => ({ owner: 0, index: at, entry }));
    return [...own, ...shared.filter(({ entry }) => entry.input !== null && SHARED.includes(entry.input))].sort(
      (a, b) => a.entry.cycle - b.entry.cycle,
    );
  }

  /** The same entry in a script that may be another by now. @param {Placed} placed @returns {Placed | null} */
  function same({ owner, entry }) {
    const index = inputsOf(owner).findIndex((each) => JSON.stringify(each) === JSON.stringify(entry));
    return index < 0 ? null : { owner, index, entry: inputsOf(owner)[index] };
  }

  /** @param {Placed} placed @param {number} cycle @param {boolean} joins @returns {Placed | null} */
  function move({ owner, index: from }, cycle, joins) {
    const to = moved(inputsOf(owner), from, cycle, timeOf);
    if (!take(owner, to, joins) || "refused" in to) return null;
    const place = to.index ?? from;
    return { owner, index: place, entry: to.inputs[place] };
  }

  /** @param {Placed} placed */
  function remove({ owner, index: from, entry }) {
    take(owner, { inputs: inputsOf(owner).toSpliced(from, 1) });
    tell(`${nameOf(entry)} at ${timeOf(entry.cycle)} is removed.`);
    strip.choose(null);
  }

  /** The line of the chosen input. */
  function line() {
    entryLine.hidden = chosen === null;
    idle.hidden = chosen !== null || entries().length === 0;
    if (!chosen) return;
    say(entryName, `${nameOf(chosen.entry)} at ${timeOf(chosen.entry.cycle)}, cycle`);
    if (document.activeElement !== entryCycle) entryCycle.value = String(chosen.entry.cycle);
    entryRemove.title = `Remove ${nameOf(chosen.entry)} (Delete)`;
  }
  entryCycle.addEventListener("change", () => {
    const given = parseNumber(entryCycle.value, "cycles", { integer: true, clockHz: clock() });
    if ("message" in given) return tell(given.message, true);
    const to = chosen && move(chosen, given.value, false);
    if (to) {
      entryCycle.value = String(to.entry.cycle);
      strip.choose(to);
    }
    return undefined;
  });
  entryRemove.addEventListener("click", () => {
    if (chosen) remove(chosen);
    stripPlace.querySelector("canvas")?.focus();
  });
  which.addEventListener("change", () => dispatch({ type: "axis", axis: Number(which.value) }));
  hold.addEventListener("change", () => {
    if (hold.value.trim() === "") held = null;
    else {
      const given = parseNumber(hold.value, "s");
      if ("message" in given) return tell(given.message, true);
      if (!(given.value > 0)) return tell("A press lasts longer than 0 s.", true);
      held = Math.max(1, Math.round(given.value * clock()));
      tell(
        held <= shortest() - Math.round(BEYOND_S * clock())
          ? "Not longer than the debouncing: such a press is not seen."
          : "",
      );
    }
    return holds();
  });

  function holds() {
    if (document.activeElement !== hold || held !== null) hold.value = si((held ?? shortest()) / clock(), "s", 6);
  }

  /** Whether an input has the level 1 at a cycle. @param {string} input @param {number} cycle */
  function level(input, cycle) {
    const { cycles = [], levels = [] } = story?.inputs.get(input) ?? {};
    const place = lastUpTo(cycles, cycle);
    return place < 0 ? input === "power" : levels[place] === 1;
  }

  /** @param {State} state */
  async function storyOf(state) {
    const of = { result: state.result, index: index() };
    const answer = await engine.latest("panel", "panel", of.index).catch(unlessDropped);
    if (answer === undefined || now().result !== of.result) return;
    about = of;
    story = answer && storyFrom(answer);
    const none = story === null;
    body.hidden = none;
    say(byId("panel-note"), none && state.result ? "No stand-alone controller runs this." : "");
    if (!story) return;
    const drawn = strip.show(
      story,
      `Rows of panel ${of.index}: ${story.inputs.size} inputs, ${count(story.records.length / 4)} changes of what it shows`,
    );
    tellIgnored();
    const most = story.writes.reduce((a, b) => Math.max(a, b), 0);
    say(wear, `Memory: its most worn cell was written ${count(most)} ${most === 1 ? "time" : "times"}.`);
    await Promise.all([drawn, draw(state)]);
  }

  function tellIgnored() {
    const all = story?.ignored ?? [];
    ignored.hidden = all.length === 0;
    say(
      /** @type {Element} */ (ignored.firstElementChild),
      `${count(all.length)} ${all.length === 1 ? "press" : "presses"} meant nothing`,
    );
    const items = all.slice(0, MAX_LISTED).map(({ cycle, input, state }) => {
      const go = element(
        "button",
        { type: "button" },
        `${input} at ${timeOf(cycle)} in ${state}${input === "home" && !parameters()?.home ? ": homing is not set up" : ""}`,
      );
      go.addEventListener("click", () => {
        dispatch({ type: "cursor", which: "a", cycle });
        reveal({ dispatch, now }, cycle);
      });
      return element("li", {}, go);
    });
    if (all.length > MAX_LISTED) items.push(element("li", {}, `and ${count(all.length - MAX_LISTED)} more`));
    fill(/** @type {Element} */ (ignored.lastElementChild), ...items);
  }

  /** The panel at its moment. @param {State} state */
  async function draw(state) {
    strip.paintCursor(state);
    const { cycle, name } = momentOf(state);
    say(at, `${name}: ${timeOf(cycle)}`);
    end.hidden = live.isOn() || state.cursors.a === null;
    const inside = Math.min(cycle, endOf(state));
    const answer = await engine.latest("panel at", "panel_at", index(), inside).catch(unlessDropped);
    if (!answer || about?.result !== now().result) return;
    const [word, position, display, place, error, perUnit, decimals, powered, loops, groups] = answer;
    const moment = {
      ...{ word: read(word), position, display, place, error, perUnit, decimals, loops, groups },
      powered: powered === 1,
    };
    faces.show(moment, (input) => level(input, cycle), parameters());
    axis.show(moment, parameters()?.axis, story?.records ?? new Float64Array());
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    const all = panels();
    if (all.length === 0 && live.isOn()) {
      live.stop();
      played();
    }
    whichLabel.hidden = all.length < 2;
    options(
      which,
      all.map((_, i) => [String(i), String(i)]),
      String(index()),
    );
    if (before?.scenario !== state.scenario) {
      holds();
      if (chosen) strip.choose(same(chosen));
      else strip.paint();
      line();
      // What was told is of a change that may be undone by now.
      if (before && !changing) tell("");
    }
    if (about?.result !== state.result || about?.index !== index()) return storyOf(state);
    if (before?.window !== state.window) return Promise.all([strip.window(), draw(state)]);
    if (overlaid(before, state)) return draw(state);
    return undefined;
  }
  return { render };
}

/** What the core tells of a panel. @param {{records: Float64Array, inputs: Float64Array, ignored: Float64Array, writes: Float64Array}} answer @returns {import("./paint.js").Story} */
function storyFrom({ records, inputs, ignored, writes }) {
  /** @type {import("./paint.js").Story["inputs"]} */
  const changes = new Map();
  for (let i = 0; i < inputs.length; i += 3) {
    const name = INPUTS[inputs[i + 1]];
    const of = changes.get(name) ?? { cycles: [], levels: [] };
    changes.set(name, of);
    of.cycles.push(inputs[i]);
    of.levels.push(inputs[i + 2]);
  }
  const pressed = Array.from({ length: ignored.length / 3 }, (_, i) => ({
    cycle: ignored[3 * i],
    input: INPUTS[ignored[3 * i + 1]],
    state: STATES[ignored[3 * i + 2]],
  }));
  return { records, inputs: changes, ignored: pressed, writes };
}
