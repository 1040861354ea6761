import assert from "node:assert/strict";
import { test } from "node:test";
import { DEPTH } from "../../web/state/history.js";
import { initial } from "../../web/state/initial.js";
import { get, movedTo, set } from "../../web/state/paths.js";
import { blockedBy, derivedAxis, isStale, selected } from "../../web/state/queries.js";
import { EARLIER } from "../../web/state/result.js";
import { clamp, endOf, shown } from "../../web/state/time_window.js";
import { update } from "../../web/state/update.js";

const scenario = { title: "turn", note: "what to look at", bus: { channels: 2 }, list: [1, 2, 3] };
const summary = { end_cycle: 1000, clock_hz: 100, controllers: [{ channels: 2 }, { channels: 1 }] };
const after = (state, ...messages) => messages.reduce(update, state);
const start = () => initial(scenario);
const withResult = () => after(start(), { type: "done", revision: 0, summary, ms: 1 });

test("a path leads to a value, and set copies only what is on its way", () => {
  const next = set(scenario, "list[1]", 7);
  assert.deepEqual(next.list, [1, 7, 3]);
  assert.deepEqual(scenario.list, [1, 2, 3]);
  assert.equal(next.bus, scenario.bus);
  assert.equal(get(next, "bus.channels"), 2);
  assert.equal(get(next, "bus.none.deeper"), undefined);
});

test("a draft follows its part of the scenario, or goes with it", () => {
  const rows = [
    ["moves[1].duration_s", [["moves[1]", "moves[0]"]], "moves[0].duration_s"],
    ["moves[1].duration_s", [["moves[1]", null]], null],
    ["moves[10].duration_s", [["moves[1]", null]], "moves[10].duration_s"],
    ["anything", [["", null]], null],
  ];
  for (const [at, moved, expected] of rows) assert.equal(movedTo(at, moved), expected);
  const draft = { type: "draft", path: "list[0]", text: "x", message: "no number" };
  const replaced = after(start(), draft, { type: "edit", path: "list", value: [9] });
  assert.deepEqual(replaced.drafts, {});
});

test("keystrokes in one field are one step of undo until they are committed", () => {
  const type = (value) => ({ type: "edit", path: "title", value, joins: true });
  const typed = after(start(), type("a"), type("ab"), { type: "committed" }, type("abc"));
  assert.equal(typed.past.length, 2);
  const back = after(typed, { type: "undo" });
  assert.equal(back.scenario.title, "ab");
  assert.equal(after(back, { type: "undo" }, { type: "redo" }).scenario.title, "ab");
});

test("undo discards a draft first", () => {
  const draft = { type: "draft", path: "list[0]", text: "x", message: "no number" };
  const drafted = after(start(), { type: "edit", path: "bus.channels", value: 3 }, draft);
  const back = after(drafted, { type: "undo" });
  assert.deepEqual([back.drafts, back.scenario.bus.channels], [{}, 3]);
});

test("the history has a limit", () => {
  let state = start();
  for (let i = 0; i < DEPTH + 10; i++) state = update(state, { type: "edit", path: "bus.channels", value: 100 + i });
  assert.equal(state.past.length, DEPTH);
});

test("an edited preset is named after it and loses its note", () => {
  const preset = after(start(), { type: "replace", scenario, origin: "preset:turn" });
  const edited = after(preset, { type: "edit", path: "bus.channels", value: 4 });
  assert.equal(edited.scenario.title, "changed from turn");
  assert.equal(edited.scenario.note, "");
  assert.equal(edited.origin, "own");
  const named = after(preset, { type: "edit", path: "title", value: "mine" });
  assert.deepEqual([named.scenario.title, named.scenario.note], ["mine", scenario.note]);
});

test("an edit to the same value changes nothing", () => {
  const state = start();
  assert.equal(update(state, { type: "edit", path: "bus.channels", value: 2 }).revision, state.revision);
});

test("only a validated scenario without problems runs", () => {
  const validation = { problems: [], warnings: [], scenario: "{}", derived: null, cost: null };
  const validated = (more) =>
    after(start(), { type: "validated", revision: 0, validation: { ...validation, ...more } });
  const costly = validated({ cost: { over_budget: true } });
  const rows = [
    [start(), "unvalidated"],
    [validated({}), null],
    [validated({ problems: [{ path: "bus", message: "no" }] }), "problems"],
    [costly, "budget"],
    [update(costly, { type: "approve" }), null],
    [update(validated({}), { type: "draft", path: "bus", text: "", message: "" }), "problems"],
    [after(start(), { type: "validated", revision: 9, validation }), "unvalidated"],
  ];
  for (const [state, expected] of rows) assert.equal(blockedBy(state), expected);
});

test("a result of another revision is ignored, except an earlier visit's while there is none", () => {
  assert.equal(after(start(), { type: "done", revision: 5, summary, ms: 1 }).result, null);
  const earlier = after(start(), { type: "done", revision: EARLIER, summary, ms: 1 });
  assert.equal(earlier.result.revision, EARLIER);
  assert.ok(isStale(earlier));
  assert.ok(!isStale(withResult()));
});

test("a run of another clock takes away window, cursors and markers", () => {
  const set = after(
    withResult(),
    { type: "window", window: { start: 100, end: 900 } },
    { type: "cursor", which: "a", cycle: 500 },
    { type: "marker", digit: 3, cycle: 950 },
  );
  const shorter = after(set, { type: "done", revision: 0, summary: { ...summary, end_cycle: 600 }, ms: 1 });
  assert.deepEqual(shorter.window, { start: 0, end: 600 });
  assert.deepEqual([shorter.cursors.a, shorter.markers[3]], [500, null]);
  const other = after(set, { type: "done", revision: 0, summary: { ...summary, clock_hz: 7 }, ms: 1 });
  assert.deepEqual([other.window, other.cursors.a, other.zooms], [null, null, []]);
});

test("a selected controller limits axis and row to its channels", () => {
  const state = after(withResult(), { type: "axis", axis: 1 }, { type: "row", row: 1 });
  const second = after(state, { type: "controller", controller: 1 });
  assert.deepEqual([second.axis, second.row, selected(second).channels], [0, 0, 1]);
  assert.equal(after(state, { type: "controller", controller: 9 }).result.controller, 1);
});

test("a link's view waits for the run", () => {
  const view = { window: { start: 10, end: 110 }, a: 50, b: 5000, axis: 1, unit: "mm" };
  const early = after(start(), { type: "open", view });
  assert.equal(early.window, null);
  const run = after(early, { type: "done", revision: 0, summary, ms: 1 });
  assert.deepEqual(
    [run.window, run.cursors, run.axis, run.unit, run.awaited],
    [{ start: 10, end: 110 }, { a: 50, b: null }, 1, "mm", null],
  );
});

test("the window stays inside the run and the moves of a gesture are one step back", () => {
  const rows = [
    [
      { start: -50, end: 50 },
      { start: 0, end: 100 },
    ],
    [
      { start: 990, end: 1090 },
      { start: 900, end: 1000 },
    ],
    [
      { start: 500, end: 501 },
      { start: 500, end: 516 },
    ],
    [{ start: Number.NaN, end: 5 }, null],
  ];
  for (const [window, expected] of rows) assert.deepEqual(clamp(window, 1000), expected);
  const zoomed = after(
    withResult(),
    { type: "window", window: { start: 0, end: 500 } },
    { type: "window", window: { start: 0, end: 400 }, joins: "pinch" },
    { type: "window", window: { start: 0, end: 300 }, joins: "pinch" },
  );
  assert.deepEqual(shown(zoomed), { start: 0, end: 300 });
  assert.deepEqual(shown(after(zoomed, { type: "back" })), { start: 0, end: 500 });
  assert.deepEqual(shown(after(zoomed, { type: "back" }, { type: "back" })), { start: 0, end: endOf(zoomed) });
});

test("the axis of a field is found by its path", () => {
  const derived = { controllers: [{ axes: ["a", "b"] }, { axes: ["c"] }] };
  const rows = [
    ["source.motion.axes[1].moves[0].duration_s", "b"],
    ["controllers[0].axes[0].motor", "c"],
    ["clock_hz", "a"],
  ];
  for (const [path, expected] of rows) assert.equal(derivedAxis({ derived }, path), expected);
});
