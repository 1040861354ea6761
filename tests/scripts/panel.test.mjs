import assert from "node:assert/strict";
import { test } from "node:test";
import { initial } from "../../web/state/initial.js";
import { update } from "../../web/state/update.js";
import {
  advice,
  INPUTS,
  lcd,
  led,
  numberName,
  read,
  SHARED,
  STATES,
  SWITCHES,
  sentence,
} from "../../web/views/panel/names.js";
import { parseHold, pressCycle, shortestPress, shownCycle, whyNoPush } from "../../web/views/panel/presses.js";
import { entriesOf, moved, ownerOf, press, put, sameEntry } from "../../web/views/panel/script.js";
import { createScriptEditor } from "../../web/views/panel/script_editor.js";
import { ignoredPresses, lastUpTo, levelAt, momentFrom, storyFrom, wearText } from "../../web/views/panel/story.js";
import { BANDS, entryAfter, entryAt, entryBelow, heights, rowOf, rowsOf } from "../../web/views/panel/strip_layout.js";

const timeOf = (cycle) => `${cycle} cycles`;
const entry = (cycle, input, level = 1) => ({ cycle, input, level, push_steps: null });
const placed = (index, cycle, input, owner = 0) => ({ owner, index, entry: entry(cycle, input) });

test("a press is two entries in the order of time", () => {
  const { inputs } = press([entry(50, "ok")], "start", 10, 90, null, timeOf);
  assert.deepEqual(
    inputs.map(({ cycle, input, level }) => [cycle, input, level]),
    [
      [10, "start", 1],
      [50, "ok", 1],
      [90, "start", 0],
    ],
  );
});

test("a press within another one of the same button is refused", () => {
  const script = [entry(10, "start"), entry(90, "start", 0)];
  assert.match(press(script, "start", 50, 60, null, timeOf).refused, /already pressed at .*, since 10 cycles/);
  assert.match(press(script, "start", 5, 20, null, timeOf).refused, /pressed again at 10 cycles/);
  assert.equal(press(script, "ok", 50, 60, null, timeOf).inputs.length, 4);
});

test("an input that the axis drives, or that changes in this cycle, is refused", () => {
  assert.match(
    put([], { cycle: 1, input: "limit_min", level: 1 }, { min_switch_at_steps: 5 }, timeOf).refused,
    /The left limit switch is driven by the left switch of the virtual axis/,
  );
  assert.match(
    put([entry(7, "ok")], { cycle: 7, input: "ok", level: 0 }, null, timeOf).refused,
    /already changes at 7 cycles/,
  );
  assert.equal(put([], { cycle: -3, input: "ok", level: 1 }, null, timeOf).inputs[0].cycle, 1);
});

test("an entry that moves keeps the script in order", () => {
  const script = [entry(10, "a"), entry(20, "b"), entry(30, "a", 0)];
  const to = moved(script, 0, 25, timeOf);
  assert.deepEqual([to.index, to.inputs.map(({ cycle }) => cycle)], [1, [20, 25, 30]]);
  assert.match(moved(script, 0, 30, timeOf).refused, /change twice/);
  assert.equal(moved(script, 1, 20, timeOf).inputs, script);
});

test("shared inputs are the first controller's for all", () => {
  const panels = [{ inputs: [entry(5, "power"), entry(6, "ok")] }, { inputs: [entry(1, "ok")] }];
  assert.deepEqual(
    SHARED.map((input) => ownerOf(1, input)),
    [0, 0, 0],
  );
  assert.equal(ownerOf(1, "start"), 1);
  assert.equal(ownerOf(1, null), 1);
  const all = entriesOf(panels, 1).map(({ owner, index }) => [owner, index]);
  assert.deepEqual(all, [
    [1, 0],
    [0, 0],
  ]);
  assert.equal(entriesOf(panels, 0).length, 2);
  assert.equal(sameEntry(panels, { owner: 0, index: 9, entry: entry(6, "ok") }).index, 1);
  assert.equal(sameEntry(panels, { owner: 0, index: 0, entry: entry(9, "ok") }), null);
});

test("a press goes to the cursor, else after the end", () => {
  const state = (a) => ({ cursors: { a }, hover: null, result: { summary: { end_cycle: 5000 } } });
  assert.equal(pressCycle(state(700), null, 1000), 700);
  assert.equal(pressCycle(state(0), null, 1000), 1);
  assert.equal(pressCycle(state(null), null, 1000), 5010);
  assert.equal(pressCycle(state(700), 900, 1000), 900);
  const rows = [
    [{ ...state(700), hover: 3 }, null, 3],
    [state(700), null, 700],
    [state(null), null, 5000],
    [{ ...state(700), hover: 3 }, 42, 42],
  ];
  for (const [given, played, expected] of rows) assert.equal(shownCycle(given, played).cycle, expected);
});

test("a hold warns if it has no effect", () => {
  const panel = { debounce_cycles: 100 };
  assert.equal(shortestPress(panel, 1000), 110);
  assert.deepEqual(parseHold("", panel, 1000), { cycles: null, warning: "" });
  assert.deepEqual(parseHold("200 ms", panel, 1000), { cycles: 200, warning: "" });
  assert.match(parseHold("0.1 s", panel, 1000).warning, /has no effect/);
  assert.match(parseHold("0", panel, 1000).message, /A press of 0 s/);
  assert.ok("message" in parseHold("soon", panel, 1000));
  assert.deepEqual([whyNoPush(5), whyNoPush(0) !== "", whyNoPush(-2e6) !== ""], ["", true, true]);
});

test("the level of an input is that of its last change; power is on before it changes", () => {
  const inputs = Float64Array.from([10, INPUTS.indexOf("ok"), 1, 30, INPUTS.indexOf("ok"), 0]);
  const ignored = Float64Array.from([20, INPUTS.indexOf("home"), STATES.indexOf("READY")]);
  const story = storyFrom({ records: new Float64Array(8), inputs, ignored, writes: Float64Array.from([3, 7]) });
  assert.deepEqual(
    [9, 10, 29, 30].map((cycle) => levelAt(story, "ok", cycle)),
    [false, true, true, false],
  );
  assert.deepEqual([levelAt(story, "power", 0), levelAt(null, "start", 0)], [true, false]);
  assert.equal(wearText(story), "Memory: the most-written cell was written 7 times.");
  const { title, items, more } = ignoredPresses(story, false, timeOf);
  assert.equal(title, "1 press ignored");
  assert.deepEqual(items, [{ cycle: 20, text: "home at 20 cycles in READY: homing is not set up" }]);
  assert.equal(more, "");
});

test("only the first ignored presses are listed", () => {
  const ignored = Array.from({ length: 25 }, (_, cycle) => ({ cycle, input: "ok", state: "READY" }));
  const { items, more } = ignoredPresses({ ignored }, true, timeOf);
  assert.deepEqual([items.length, more], [20, "and 5 more"]);
});

test("the last index up to a value is found in a list with a stride", () => {
  const list = [10, 0, 20, 0, 20, 0, 30, 0];
  assert.deepEqual(
    [5, 10, 20, 25, 99].map((value) => lastUpTo(list, value, 2)),
    [-1, 0, 2, 2, 3],
  );
  assert.equal(lastUpTo([], 1), -1);
});

test("a panel's word has state, alarm, trust, outputs, group and loop", () => {
  const word = read(5 * 2 ** 32 + (3 << 16) + (0b1010 << 12) + (2 << 8) + (1 << 4) + STATES.indexOf("ALARM"));
  assert.deepEqual(word, { state: "ALARM", alarm: "ESTOP", trust: "SURE", outputs: 10, group: 3, loop: 5 });
  assert.equal(led(word), "quick");
  assert.match(advice(word, true), /^Release the emergency stop/);
  assert.match(advice({ state: "READY", alarm: "", trust: "LOST" }, true), /press home, or jog to a known position/);
  assert.match(sentence(word, { groups: 4, loops: 9 }), /^ALARM ESTOP · position confirmed · group 3\/4, loop 5\/9$/);
  assert.equal(momentFrom([0, 1, 2, 3, 4, 5, 6, 1, 8, 9]).powered, true);
});

test("the display shows six digits, or dashes where they do not fit", () => {
  const rows = [
    [0, 0, "     0"],
    [-12, 2, " -0.12"],
    [123456, 1, "12345.6"],
    [1_000_000, 0, "------"],
    [-100_000, 0, "------"],
  ];
  for (const [display, decimals, expected] of rows) assert.equal(lcd(display, decimals), expected);
  assert.equal(numberName(0), "pulses per unit");
  assert.equal(numberName(8 + 5), "length of move 2");
  assert.equal(SWITCHES[0], "limit_min");
});

test("rows are those that changed and those of the script, in the core's order", () => {
  const rows = rowsOf(["start", "power"], [placed(0, 1, null)]);
  assert.deepEqual(rows, ["power", "start", "push"]);
  assert.equal(rowOf(rows, { input: null }), BANDS.length + 2);
  const { curve, all } = heights(0, rows);
  assert.equal(all - curve, (BANDS.length + 3) * 22);
  assert.ok(heights(1e4, rows).curve > curve);
});

test("keys choose the next entry, and the nearest of another row", () => {
  const rows = ["ok", "back"];
  const all = [placed(0, 10, "ok"), placed(1, 20, "back"), placed(2, 90, "back")];
  assert.equal(entryAfter(all, null, 1), all[0]);
  assert.equal(entryAfter(all, null, -1), all[2]);
  assert.equal(entryAfter(all, all[2], 1), undefined);
  assert.equal(entryBelow(all, rows, all[0], 1), all[1]);
  assert.equal(entryBelow(all, rows, all[2], -1), all[0]);
  assert.equal(entryBelow(all, rows, all[0], -1), undefined);
});

test("a pointer selects the nearest entry of its row", () => {
  const rows = ["ok"];
  const all = [placed(0, 10, "ok"), placed(1, 16, "ok")];
  const distance = (at) => (cycle) => Math.abs(cycle - at);
  assert.equal(entryAt(all, rows, BANDS.length, distance(14)), all[1]);
  assert.equal(entryAt(all, rows, BANDS.length, distance(40)), undefined);
  assert.equal(entryAt(all, rows, 0, distance(14)), undefined);
});

/** An editor of two controllers, with what it reported. */
function editorOf(panels) {
  const bench = { reports: [], state: { ...initial({ clock_hz: 1000, source: { standalone: panels } }), axis: 1 } };
  bench.editor = createScriptEditor({
    report: (text, isError = false) => bench.reports.push([text, isError]),
    played: () => null,
    dispatch: (message) => {
      bench.state = update(bench.state, message);
    },
    now: () => bench.state,
  });
  return bench;
}

test("an edit goes into the selected controller's script and is one step of undo", () => {
  const bench = editorOf([{ inputs: [] }, { inputs: [], debounce_cycles: 10 }]);
  bench.state = update(bench.state, { type: "cursor", which: "a", cycle: 500 });
  bench.editor.click("start", 20);
  const of = (controller) => bench.state.scenario.source.standalone[controller].inputs.map(({ cycle }) => cycle);
  assert.deepEqual(of(1), [500, 520]);
  assert.match(bench.reports[0][0], /^Start is pressed at 500 ms for 20 ms\.$/);
  assert.equal(bench.state.cursors.a, 540);
  bench.editor.set("power", 0);
  assert.deepEqual(of(0), [540]);
  assert.equal(bench.state.past.length, 2);
});

test("a refused edit is reported and changes nothing", () => {
  const bench = editorOf([{ inputs: [] }, { inputs: [entry(100, "start")] }]);
  bench.state = update(bench.state, { type: "cursor", which: "a", cycle: 500 });
  bench.editor.click("start", 20);
  bench.editor.push(0);
  assert.deepEqual(
    bench.reports.map(([, isError]) => isError),
    [true, true],
  );
  assert.equal(bench.state.past.length, 0);
});

test("the moves of one drag are one step of undo", () => {
  const bench = editorOf([{ inputs: [] }, { inputs: [entry(100, "start"), entry(200, "start", 0)] }]);
  const [first] = bench.editor.entries();
  const to = bench.editor.move(bench.editor.move(first, 120, true), 140, true);
  assert.deepEqual([to.entry.cycle, bench.state.past.length], [140, 1]);
  assert.deepEqual(bench.editor.same(to), to);
  bench.editor.remove(to);
  assert.equal(bench.editor.entries().length, 1);
  assert.equal(bench.editor.same(to), null);
});

test("only the release of a held button is postponed", () => {
  const bench = editorOf([{ inputs: [] }, { inputs: [] }]);
  assert.ok(bench.editor.hold("ok", 100, 200, null));
  assert.ok(bench.editor.hold("ok", 100, 300, 200));
  assert.deepEqual(
    bench.editor.entries().map(({ entry }) => entry.cycle),
    [100, 300],
  );
  assert.equal(bench.editor.hold("ok", 100, 400, 200), false);
});
