/**
 * The view Panel: the front of a stand-alone controller as it is at the cursor, its presses over time, and its axis. A press goes
 * into the scenario at the cursor, or live; so it is undone, saved and linked as any change is. It loads when first opened.
 */
import { byId, element, fill, say, style } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { exactTime, short } from "../../state/number.js";
import { endOf } from "../../state/time_window.js";
import { overlaid } from "../../time/cursors.js";
import { reveal } from "../../time/timeline.js";
import { createAxis } from "./axis.js";
import { createEntryLine } from "./entry_line.js";
import { createFront } from "./front.js";
import { createHead } from "./head.js";
import { createPlayback } from "./playback.js";
import { levelText, pressCycle, pressText, pushText, shortestPress, shownCycle, whyNoPush } from "./presses.js";
import { entriesOf, inputsOf, moved, nameOf, ownerOf, press, put, sameEntry } from "./script.js";
import { ignoredPresses, levelAt, momentFrom, storyFrom, storyLabel, wearText } from "./story.js";
import { createStrip } from "./strip.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./script.js").Placed} Placed */

/** Height that the lines under the rows, and the cursors' handles, take beside the axis, in CSS pixels. */
const LINES_PX = 24 + 90;

/** @param {import("./pane.js").Page} page */
export async function createPanel({ engine, dispatch, now }) {
  await style("panel");
  const view = byId("view-panel");
  const clock = () => now().result?.summary.clock_hz ?? now().scenario.clock_hz;
  /** @returns {any[]} */
  const panels = () => now().scenario.source?.standalone ?? [];
  const index = () => Math.max(0, Math.min(now().axis, panels().length - 1));
  const panel = () => panels()[index()];
  const shortest = () => shortestPress(panel(), clock());
  const timeOf = (/** @type {number} */ cycle) => exactTime(cycle, clock());
  const played = () => (live.isOn() ? live.cycle() : null);
  const target = () => pressCycle(now(), played(), clock());

  const head = createHead(/** @type {Element} */ (view.querySelector(".head")?.firstElementChild), {
    ...{ panel, clock, report },
    select: (axis) => dispatch({ type: "axis", axis }),
    play,
    toEnd: () => dispatch({ type: "cursor", which: "a", cycle: null }),
  });
  const front = element("div", { class: "front", role: "group", "aria-label": "Front panel" });
  const status = element("p", { id: "panel-said", class: "panel-said", role: "status" });
  const axisPlace = element("div", { class: "axis", role: "group", "aria-label": "Virtual axis" });
  const stripPlace = element("div", { class: "strip" });
  const line = createEntryLine({
    ...{ clock, timeOf, report },
    move(placed, cycle) {
      const to = move(placed, cycle, false);
      if (to) strip.choose(to);
      return to;
    },
    remove(placed) {
      remove(placed);
      stripPlace.querySelector("canvas")?.focus();
    },
  });
  const ignored = element("details", { class: "ignored", hidden: "" }, element("summary", {}), element("ul", {}));
  const wear = element("p", { class: "wear" });
  const keys = element(
    "p",
    { id: "panel-keys", class: "unseen" },
    "N and P choose the next and the previous input, comma and full stop move it, Delete removes it.",
  );
  const body = element("div", { class: "panel-body" });
  view.append(body);
  /** Whether the rows are next to the front. */
  const isWide = matchMedia("(min-width: 1100px)");
  fill(body, front, element("div", { class: "time-side" }, axisPlace, stripPlace, ...line.parts, ignored, wear, keys));

  /** @type {import("./story.js").Story | null} */
  let story = null;
  /** The result and the controller of the story. @type {{result: State["result"], index: number} | null} */
  let storyOf = null;
  /** @type {Placed | null} */
  let chosen = null;
  /** Whether this view changes the scenario now. */
  let isChanging = false;

  const live = createPlayback({
    hz: clock,
    speed: head.speed,
    shortest,
    at(cycle) {
      // Out of sight it does not go on.
      if (panels().length === 0 || !view.checkVisibility()) {
        live.stop();
        return showLive();
      }
      dispatch({ type: "cursor", which: "a", cycle });
      const { window } = now();
      if (window && cycle > window.end && cycle <= endOf(now())) reveal({ dispatch, now }, cycle);
    },
    press(input, from, until, before) {
      const owner = ownerOf(index(), input);
      const inputs = inputsOf(panels(), owner);
      if (before === null) return take(owner, press(inputs, input, from, until, panel()?.axis, timeOf), true);
      const place = inputs.findIndex((each) => each.input === input && each.level === 0 && each.cycle === before);
      return place >= 0 && take(owner, moved(inputs, place, until, timeOf), true);
    },
  });
  const faces = createFront(front, {
    down: (input) => live.isOn() && live.down(input),
    up(input) {
      live.up(input);
      if (live.isOn()) dispatch({ type: "committed" });
    },
    click,
    set,
  });
  // Over the buttons, where it stays in sight, in place of the advice.
  front.querySelector(".panel-told")?.prepend(status);
  const axis = createAxis(axisPlace, push);
  const strip = createStrip(stripPlace, {
    ...{ engine, dispatch, now, move, remove },
    entries: () => entriesOf(panels(), index()),
    room: () => (isWide.matches ? body.clientHeight - axisPlace.offsetHeight - LINES_PX : 0),
    channel: index,
    print: (steps) => short(steps / (panel()?.pulses_per_unit || 1), 6),
    chosen(placed) {
      chosen = placed;
      showLine();
    },
  });

  /** @param {string} text @param {boolean} [isError] */
  function report(text, isError = false) {
    status.classList.toggle("error", isError);
    say(status, text);
  }

  function showLine() {
    line.show(chosen, entriesOf(panels(), index()).length > 0);
  }

  /** Replaces the script of a controller, or reports why not. @param {number} owner @param {import("./script.js").Changed} changed @param {boolean} [joins] */
  function take(owner, changed, joins = false) {
    if ("refused" in changed) {
      report(changed.refused, true);
      return false;
    }
    isChanging = true;
    dispatch({ type: "edit", path: `source.standalone[${owner}].inputs`, value: changed.inputs, joins });
    isChanging = false;
    if (!joins) dispatch({ type: "committed" });
    return true;
  }

  /** The cursor goes behind a new press, so that the next one comes after it and its effect is shown. @param {number} cycle @param {string} text */
  function goBehind(cycle, text) {
    if (now().cursors.a !== null) dispatch({ type: "cursor", which: "a", cycle: cycle + shortest() });
    report(text);
  }

  /** @param {string} input */
  function click(input) {
    if (live.isOn()) return;
    const owner = ownerOf(index(), input);
    const from = target();
    const until = from + head.holdCycles();
    if (take(owner, press(inputsOf(panels(), owner), input, from, until, panel()?.axis, timeOf)))
      goBehind(until, pressText(input, timeOf(from), (until - from) / clock()));
  }

  /** @param {string} input @param {number} level */
  function set(input, level) {
    const owner = ownerOf(index(), input);
    const cycle = target();
    if (take(owner, put(inputsOf(panels(), owner), { cycle, input, level }, panel()?.axis, timeOf)))
      goBehind(cycle, levelText(input, level, timeOf(cycle)));
  }

  /** @param {number} steps */
  function push(steps) {
    const cycle = target();
    const why = whyNoPush(steps);
    if (why) return report(why, true);
    const entry = { cycle, input: null, level: 1, push_steps: steps };
    if (take(index(), put(inputsOf(panels(), index()), entry, null, timeOf)))
      goBehind(cycle, pushText(steps, timeOf(cycle)));
    return undefined;
  }

  function play() {
    if (live.isOn()) {
      live.stop();
      dispatch({ type: "committed" });
    } else live.play(target());
    showLive();
    draw(now());
  }

  function showLive() {
    head.showLive(live.isOn());
    report(live.isOn() ? "Live: hold a button as long as it is to be pressed." : "");
  }

  /** @param {Placed} placed @param {number} cycle @param {boolean} joins @returns {Placed | null} */
  function move({ owner, index: from }, cycle, joins) {
    const to = moved(inputsOf(panels(), owner), from, cycle, timeOf);
    if (!take(owner, to, joins) || "refused" in to) return null;
    const place = to.index ?? from;
    return { owner, index: place, entry: to.inputs[place] };
  }

  /** @param {Placed} placed */
  function remove({ owner, index: from, entry }) {
    take(owner, { inputs: inputsOf(panels(), owner).toSpliced(from, 1) });
    report(`${nameOf(entry)} at ${timeOf(entry.cycle)} is removed.`);
    strip.choose(null);
  }

  /** @param {State} state */
  async function loadStory(state) {
    const of = { result: state.result, index: index() };
    const reply = await engine.latest("panel", "panel", of.index).catch(unlessDropped);
    if (reply === undefined || now().result !== of.result) return;
    storyOf = of;
    story = reply && storyFrom(reply);
    body.hidden = story === null;
    say(byId("panel-note"), !story && state.result ? "No stand-alone controller runs this." : "");
    if (!story) return;
    const drawn = strip.show(story, storyLabel(story, of.index));
    showIgnored(story);
    say(wear, wearText(story));
    await Promise.all([drawn, draw(state)]);
  }

  /** @param {import("./story.js").Story} story */
  function showIgnored(story) {
    const { title, items, more } = ignoredPresses(story, Boolean(panel()?.home), timeOf);
    ignored.hidden = items.length === 0;
    say(/** @type {Element} */ (ignored.firstElementChild), title);
    const buttons = items.map(({ cycle, text }) => {
      const go = element("button", { type: "button" }, text);
      go.addEventListener("click", () => {
        dispatch({ type: "cursor", which: "a", cycle });
        reveal({ dispatch, now }, cycle);
      });
      return element("li", {}, go);
    });
    const rest = more ? [element("li", {}, more)] : [];
    fill(/** @type {Element} */ (ignored.lastElementChild), ...buttons, ...rest);
  }

  /** The panel at the cycle on show. @param {State} state */
  async function draw(state) {
    strip.paintCursor(state);
    const { cycle, name } = shownCycle(state, played());
    head.showTime(`${name}: ${timeOf(cycle)}`, live.isOn() || state.cursors.a === null);
    const inside = Math.min(cycle, endOf(state));
    const reply = await engine.latest("panel at", "panel_at", index(), inside).catch(unlessDropped);
    if (!reply || storyOf?.result !== now().result) return;
    const moment = momentFrom(reply);
    faces.show(moment, (input) => levelAt(story, input, cycle), panel());
    axis.show(moment, panel()?.axis, story?.records ?? new Float64Array());
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (panels().length === 0 && live.isOn()) {
      live.stop();
      showLive();
    }
    head.showControllers(panels().length, index());
    if (before?.scenario !== state.scenario) {
      head.showHold();
      if (chosen) strip.choose(sameEntry(panels(), chosen));
      else strip.paint();
      showLine();
      // The report is of a change that may be undone by now.
      if (before && !isChanging) report("");
    }
    if (storyOf?.result !== state.result || storyOf?.index !== index()) return loadStory(state);
    if (before?.window !== state.window) return Promise.all([strip.window(), draw(state)]);
    return overlaid(before, state) ? draw(state) : undefined;
  }
  return { render };
}
