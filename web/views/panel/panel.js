/**
 * The panel view: the front panel at the cursor, its inputs over time, and its axis. Presses become inputs of the
 * scenario.
 */
import { byId, element, fill, loadStyle, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { short } from "../../state/number.js";
import { endOf } from "../../state/time_window.js";
import { hasOverlayChanged } from "../../time/cursors.js";
import { reveal } from "../../time/timeline.js";
import { createAxis } from "./axis.js";
import { createEntryLine } from "./entry_line.js";
import { createFront } from "./front.js";
import { createHead } from "./head.js";
import { createPlayback } from "./playback.js";
import { shownCycle } from "./presses.js";
import { createScriptEditor } from "./script_editor.js";
import { ignoredPresses, levelAt, momentFrom, storyFrom, storyLabel, wearText } from "./story.js";
import { createStrip } from "./strip.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./script.js").Placed} Placed */

/** Height of the lines below the rows and of the cursor handles, in CSS pixels. */
const LINES_PX = 24 + 90;

/** @param {import("./pane.js").Page} page */
export async function createPanel({ engine, dispatch, now }) {
  await loadStyle("panel");
  const view = byId("view-panel");
  const playedCycle = () => (live.isOn() ? live.cycle() : null);
  const editor = createScriptEditor({ report, played: playedCycle, dispatch, now });
  const { clock, panels, index, panel, timeOf } = editor;

  const head = createHead(/** @type {Element} */ (view.querySelector(".head")?.firstElementChild), {
    ...{ panel, clock, report },
    select: (axis) => dispatch({ type: "axis", axis }),
    play,
    toEnd: () => dispatch({ type: "cursor", which: "a", cycle: null }),
  });
  const front = element("div", { class: "front", role: "group", "aria-label": "Front panel" });
  const status = element("p", { id: "panel-status", class: "panel-status", role: "status" });
  const axisRoot = element("div", { class: "axis", role: "group", "aria-label": "Virtual axis" });
  const stripRoot = element("div", { class: "strip" });
  const line = createEntryLine({
    ...{ clock, timeOf, report },
    move(placed, cycle) {
      const to = editor.move(placed, cycle, false);
      if (to) strip.choose(to);
      return to;
    },
    remove(placed) {
      remove(placed);
      stripRoot.querySelector("canvas")?.focus();
    },
  });
  const ignored = element("details", { class: "ignored", hidden: "" }, element("summary", {}), element("ul", {}));
  const wear = element("p", { class: "wear" });
  const keys = element(
    "p",
    { id: "panel-keys", class: "unseen" },
    "N and P select the next and previous input, comma and period move it, Delete removes it.",
  );
  const body = element("div", { class: "panel-body" });
  view.append(body);
  /** Whether the rows are next to the front panel. */
  const isWide = matchMedia("(min-width: 1100px)");
  fill(body, front, element("div", { class: "time-side" }, axisRoot, stripRoot, ...line.parts, ignored, wear, keys));

  /** @type {import("./story.js").Story | null} */
  let story = null;
  /** The result and the controller of the story. @type {{result: State["result"], index: number} | null} */
  let storySource = null;
  /** @type {Placed | null} */
  let selected = null;

  const live = createPlayback({
    hz: clock,
    speed: head.speed,
    shortest: editor.shortest,
    at(cycle) {
      // A hidden panel stops.
      if (panels().length === 0 || !view.checkVisibility()) {
        live.stop();
        return showLive();
      }
      dispatch({ type: "cursor", which: "a", cycle });
      const { window } = now();
      if (window && cycle > window.end && cycle <= endOf(now())) reveal({ dispatch, now }, cycle);
    },
    press: editor.hold,
  });
  const faces = createFront(front, {
    down: (input) => live.isOn() && live.down(input),
    up(input) {
      live.up(input);
      if (live.isOn()) dispatch({ type: "committed" });
    },
    click(input) {
      if (!live.isOn()) editor.click(input, head.holdCycles());
    },
    set: editor.set,
  });
  // Above the buttons, where it is always visible; it replaces the advice.
  front.querySelector(".panel-messages")?.prepend(status);
  const axis = createAxis(axisRoot, editor.push);
  const strip = createStrip(stripRoot, {
    ...{ engine, dispatch, now, remove },
    move: editor.move,
    entries: editor.entries,
    availableHeight: () => (isWide.matches ? body.clientHeight - axisRoot.offsetHeight - LINES_PX : 0),
    channel: index,
    print: (steps) => short(steps / (panel()?.pulses_per_unit || 1), 6),
    selected(placed) {
      selected = placed;
      showLine();
    },
  });

  /** @param {string} text @param {boolean} [isError] */
  function report(text, isError = false) {
    status.classList.toggle("error", isError);
    setText(status, text);
  }

  function showLine() {
    line.show(selected, editor.entries().length > 0);
  }

  function play() {
    if (live.isOn()) {
      live.stop();
      dispatch({ type: "committed" });
    } else live.play(editor.target());
    showLive();
    draw(now());
  }

  function showLive() {
    head.showLive(live.isOn());
    report(live.isOn() ? "Live: buttons react while you hold them." : "");
  }

  /** @param {Placed} placed */
  function remove(placed) {
    editor.remove(placed);
    strip.choose(null);
  }

  /** @param {State} state */
  async function loadStory(state) {
    const source = { result: state.result, index: index() };
    const reply = await engine.latest("panel", "panel", source.index).catch(unlessDropped);
    if (reply === undefined || now().result !== source.result) return;
    storySource = source;
    story = reply && storyFrom(reply);
    body.hidden = story === null;
    setText(byId("panel-note"), !story && state.result ? "This experiment has no stand-alone controller." : "");
    if (!story) return;
    const drawn = strip.show(story, storyLabel(story, source.index));
    showIgnored(story);
    setText(wear, wearText(story));
    await Promise.all([drawn, draw(state)]);
  }

  /** @param {import("./story.js").Story} story */
  function showIgnored(story) {
    const { title, items, more } = ignoredPresses(story, Boolean(panel()?.home), timeOf);
    ignored.hidden = items.length === 0;
    setText(/** @type {Element} */ (ignored.firstElementChild), title);
    const buttons = items.map(({ cycle, text }) => {
      const link = element("button", { type: "button" }, text);
      link.addEventListener("click", () => {
        dispatch({ type: "cursor", which: "a", cycle });
        reveal({ dispatch, now }, cycle);
      });
      return element("li", {}, link);
    });
    const moreItem = more ? [element("li", {}, more)] : [];
    fill(/** @type {Element} */ (ignored.lastElementChild), ...buttons, ...moreItem);
  }

  /** The panel at the visible cycle. @param {State} state */
  async function draw(state) {
    strip.paintCursor(state);
    const { cycle, name } = shownCycle(state, playedCycle());
    head.showTime(`${name}: ${timeOf(cycle)}`, live.isOn() || state.cursors.a === null);
    const cycleInRun = Math.min(cycle, endOf(state));
    const reply = await engine.latest("panel at", "panel_at", index(), cycleInRun).catch(unlessDropped);
    if (!reply || storySource?.result !== now().result) return;
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
      if (selected) strip.choose(editor.same(selected));
      else strip.paint();
      showLine();
      // The reported change may have been undone.
      if (before && !editor.isChanging()) report("");
    }
    if (storySource?.result !== state.result || storySource?.index !== index()) return loadStory(state);
    if (before?.window !== state.window) return Promise.all([strip.updateWindow(), draw(state)]);
    return hasOverlayChanged(before, state) ? draw(state) : undefined;
  }
  return { render };
}
