import assert from "node:assert/strict";
import { test } from "node:test";
import { DEPTH } from "../../web/state/history.js";
import { initial } from "../../web/state/initial.js";
import { get, movedTo, set } from "../../web/state/paths.js";
import { blockedBy, derivedAxis, isStale } from "../../web/state/queries.js";
import { EARLIER_REVISION } from "../../web/state/result.js";
import { clamp, endOf, MIN_SPAN, readingCycle, shown } from "../../web/state/time_window.js";
import { update } from "../../web/state/update.js";

const first = { a: { b: 1 }, list: [{ c: 1 }, { c: 2 }] };
const begin = () => initial(structuredClone(first));
const play = (messages, from = begin()) => messages.flat().reduce(update, from);

const edit = (path, value, joins) => ({ type: "edit", path, value, joins });
const restructure = (value, moved) => ({ type: "edit", path: "list", value, moved });
const named = { title: "S", note: "n", a: { b: 7 } };
const texts = (state) => [state.scenario.title, state.scenario.note];
const undo = { type: "undo" };
const redo = { type: "redo" };
const validated = (revision, { problems = [], over = false, derived = null } = {}) => ({
  type: "validated",
  revision,
  validation: { problems, scenario: "{}", derived, cost: { over_budget: over } },
});
const controller = (channels) => ({ digest: "d", channels });
const done = (revision, end = 1000, { clock = 10, controllers = [controller(4)] } = {}) => ({
  type: "done",
  revision,
  ms: 1,
  summary: { end_cycle: end, clock_hz: clock, controllers },
});
const window = (start, end) => ({ type: "window", window: { start, end } });
const open = (start, end) => ({ type: "open", view: { window: { start, end } } });
const view = (parts) => ({ type: "open", view: parts });
const sender = { type: "sender", text: "x" };
const compared = (text = "x") => ({ type: "compared", text, comparison: { same: true } });
const cursor = (which, cycle) => ({ type: "cursor", which, cycle });
const marker = (digit, cycle) => ({ type: "marker", digit, cycle });
const replace = (scenario, origin = "preset:x") => ({ type: "replace", scenario, origin });
const draft = (path) => ({ type: "draft", path, text: "x", message: "no number" });
const many = (count) => Array.from({ length: count }, (_, at) => edit("a.b", at + 100));
const b = (state) => state.scenario.a.b;

const empty = (view, isEmpty) => ({ type: "empty", view, isEmpty });
const rows = (some) => ({ type: "rows", rows: some });

/** @type {[string, any[], (state: any) => any, any][]} name, messages, compared value, expected value */
const cases = [
  // History.
  ["an edit changes one value", [edit("a.b", 2)], (s) => s.scenario, { ...first, a: { b: 2 } }],
  ["an edit in a list changes one entry", [edit("list[1].c", 9)], (s) => s.scenario.list, [{ c: 1 }, { c: 9 }]],
  ["an edit counts a revision", [edit("a.b", 2), edit("a.b", 3)], (s) => s.revision, 2],
  ["an edit to the same value is none", [edit("a.b", 1)], (s) => [s.revision, s.past.length], [0, 0]],
  ["undo takes an edit back", [edit("a.b", 2), undo], (s) => [b(s), s.past.length, s.future.length], [1, 0, 1]],
  ["redo brings it again", [edit("a.b", 2), undo, redo], (s) => [b(s), s.past.length, s.future.length], [2, 1, 0]],
  ["undo and redo are revisions of their own", [edit("a.b", 2), undo, redo], (s) => s.revision, 3],
  ["undo with no past does nothing", [undo, redo], (s) => [b(s), s.revision], [1, 0]],
  [
    "an edit after undo ends the future",
    [edit("a.b", 2), undo, edit("a.b", 3), redo],
    (s) => [b(s), s.future.length],
    [3, 0],
  ],
  ["typing in one field is one step", [edit("a.b", 2, true), edit("a.b", 23, true), undo], b, 1],
  [
    "typing in another field is another step",
    [edit("a.b", 2, true), edit("list[0].c", 5, true), undo],
    (s) => [b(s), s.scenario.list[0].c],
    [2, 1],
  ],
  ["leaving the field ends the step", [edit("a.b", 2, true), { type: "committed" }, edit("a.b", 3, true), undo], b, 2],
  ["undo ends the step", [edit("a.b", 2, true), undo, edit("a.b", 3, true), edit("a.b", 4, true), undo], b, 1],
  ["the history is as deep as it says", [many(DEPTH + 20)], (s) => s.past.length, DEPTH],
  [
    "fifty steps back",
    [many(DEPTH), Array(DEPTH).fill(undo)],
    (s) => [b(s), s.past.length, s.future.length],
    [1, 0, DEPTH],
  ],
  [
    "fifty steps back and forth",
    [many(DEPTH), Array(DEPTH).fill(undo), Array(DEPTH).fill(redo)],
    (s) => [b(s), s.past.length, s.future.length],
    [99 + DEPTH, DEPTH, 0],
  ],
  ["beyond fifty the oldest is lost", [many(DEPTH + 1), Array(DEPTH + 5).fill(undo)], b, 100],
  ["undo brings the origin back", [replace({ a: { b: 7 } }), undo], (s) => [b(s), s.origin], [1, "own"]],
  ["an edit makes a preset one's own", [replace({ a: { b: 7 } }), edit("a.b", 8)], (s) => s.origin, "own"],
  [
    "a preset is one step",
    [replace({ a: { b: 7 } }), replace({ a: { b: 8 } }), undo],
    (s) => [b(s), s.origin],
    [7, "preset:x"],
  ],
  [
    "a preset begins with fresh views",
    [
      done(0),
      window(10, 50),
      cursor("a", 3),
      marker(4, 9),
      { type: "packet", packet: 2 },
      { type: "row", row: 3 },
      replace({ a: { b: 7 } }),
    ],
    (s) => [s.window, s.cursors.a, s.markers[4], s.packet, s.row],
    [null, null, null, null, 0],
  ],
  [
    "another kind of source shows its whole run, the same kind does not",
    [
      edit("source", { motion: {} }),
      done(1),
      window(10, 50),
      cursor("a", 12),
      edit("source", { motion: { engine: "ticks" } }),
      done(2),
    ],
    (s) => {
      const other = update(s, edit("source", { packets: {} }));
      return [s.window, s.cursors.a, other.window, other.zooms, other.cursors.a];
    },
    [{ start: 10, end: 50 }, 12, null, [], null],
  ],
  ["only a scenario that replaces another counts as opened", [edit("a.b", 2), replace({}), undo], (s) => s.opened, 1],
  // Drafts: texts that are not numbers yet.
  ["a draft holds the run", [validated(0), draft("a.b")], (s) => [blockedBy(s), isStale(s)], ["problems", true]],
  [
    "undo takes drafts away first",
    [edit("a.b", 2), draft("a.b"), undo],
    (s) => [b(s), Object.keys(s.drafts).length],
    [2, 0],
  ],
  [
    "redo brings drafts again",
    [draft("a.b"), undo, redo],
    (s) => [Object.keys(s.drafts), s.past.length, s.revision],
    [["a.b"], 0, 0],
  ],
  [
    "and undo takes them away again",
    [draft("a.b"), undo, redo, undo],
    (s) => [Object.keys(s.drafts), s.future.length],
    [[], 1],
  ],
  [
    "undo of an edit keeps the draft that was there before it",
    [draft("a.b"), edit("list", []), undo],
    (s) => [Object.keys(s.drafts), s.scenario.list.length],
    [["a.b"], 2],
  ],
  [
    "undo restores the draft in a part that was replaced",
    [draft("list[0].c"), edit("list", [{ c: 1 }]), undo],
    (s) => [s.drafts["list[0].c"]?.text, s.scenario.list.length],
    ["x", 2],
  ],
  [
    "undo restores the draft in an experiment that was replaced",
    [draft("a.b"), replace({ a: { b: 7 } }), undo],
    (s) => [s.drafts["a.b"]?.text, b(s)],
    ["x", 1],
  ],
  [
    "a draft on the way to a number is no step",
    [draft("a.b"), edit("a.b", 2, true), undo],
    (s) => [Object.keys(s.drafts), b(s), s.past.length],
    [[], 1, 0],
  ],
  [
    "a canceled gesture leaves nothing, not even in redo",
    [edit("a.b", 2), undo, { type: "committed" }, edit("a.b", 8, true), { type: "canceled", future: ["redo"] }],
    (s) => [b(s), s.past.length, s.future],
    [1, 0, ["redo"]],
  ],
  [
    "a gesture without an edit cancels no earlier one",
    [edit("a.b", 2), { type: "committed" }, { type: "canceled", future: [] }],
    (s) => [b(s), s.past.length],
    [2, 1],
  ],
  ["a number takes its draft's place", [draft("a.b"), edit("a.b", 2)], (s) => Object.keys(s.drafts), []],
  [
    "the same number again takes the draft away",
    [draft("a.b"), edit("a.b", 1)],
    (s) => [Object.keys(s.drafts), s.revision],
    [[], 0],
  ],
  [
    "an edit of the whole takes drafts of its parts",
    [draft("list[0].c"), draft("a.b"), edit("list", [{ c: 1 }])],
    (s) => Object.keys(s.drafts),
    ["a.b"],
  ],
  [
    "a part that is added leaves what is typed",
    [draft("list[0].c"), restructure([{ c: 1 }, { c: 2 }, { c: 3 }], [])],
    (s) => Object.keys(s.drafts),
    ["list[0].c"],
  ],
  [
    "what is typed goes where its part goes",
    [
      draft("list[0].c"),
      draft("a.b"),
      restructure(
        [{ c: 2 }, { c: 1 }],
        [
          ["list[0]", "list[1]"],
          ["list[1]", "list[0]"],
        ],
      ),
    ],
    (s) => Object.keys(s.drafts),
    ["list[1].c", "a.b"],
  ],
  [
    "and away with its part",
    [
      draft("list[0].c"),
      draft("list[1].c"),
      restructure(
        [{ c: 2 }],
        [
          ["list[0]", null],
          ["list[1]", "list[0]"],
        ],
      ),
    ],
    (s) => Object.keys(s.drafts),
    ["list[0].c"],
  ],
  // Name and note.
  [
    "an edited preset is changed from it and loses its note",
    [replace(named), edit("a.b", 8)],
    texts,
    ["changed from S", ""],
  ],
  [
    "in no more letters than a name can have",
    [replace({ ...named, title: "é".repeat(120) }), edit("a.b", 8)],
    texts,
    [`changed from ${"é".repeat(107)}`, ""],
  ],
  ["once", [replace(named), edit("a.b", 8), edit("a.b", 9)], texts, ["changed from S", ""]],
  [
    "also what was changed from it before",
    [replace({ ...named, title: "changed from S" }, "shared"), edit("a.b", 8)],
    texts,
    ["changed from S", ""],
  ],
  ["until it has a name", [replace(named), edit("a.b", 8), edit("title", "mine"), edit("a.b", 9)], texts, ["mine", ""]],
  ["a name that is given first stays", [replace(named), edit("title", "mine"), edit("a.b", 8)], texts, ["mine", ""]],
  [
    "a note that is written stays",
    [replace(named), edit("note", "why"), edit("a.b", 8)],
    texts,
    ["changed from S", "why"],
  ],
  ["undo gives name and note back", [replace(named), edit("a.b", 8), undo], texts, ["S", "n"]],
  [
    "and they are the preset's again",
    [replace(named), edit("a.b", 8), undo, edit("a.b", 9)],
    texts,
    ["changed from S", ""],
  ],
  ["redo as well", [replace(named), edit("a.b", 8), undo, redo, edit("a.b", 9)], texts, ["changed from S", ""]],
  ["one's own experiment keeps both", [replace(named, "own"), edit("a.b", 8)], texts, ["S", "n"]],
  // Validation.
  ["a validation is taken", [validated(0)], (s) => [s.validated, blockedBy(s)], [0, null]],
  [
    "a stale validation is ignored",
    [edit("a.b", 2), validated(0, { problems: [{ path: "", message: "" }] })],
    (s) => [s.validation, s.validated, blockedBy(s)],
    [null, -1, "unvalidated"],
  ],
  ["a validation of a state before undo is ignored", [edit("a.b", 2), undo, validated(1)], blockedBy, "unvalidated"],
  ["problems hold the run", [validated(0, { problems: [{ path: "", message: "" }] })], blockedBy, "problems"],
  ["a budget holds the run", [validated(0, { over: true })], blockedBy, "budget"],
  ["an approved budget does not", [validated(0, { over: true }), { type: "approve" }], blockedBy, null],
  [
    "the approval is of one revision",
    [validated(0, { over: true }), { type: "approve" }, edit("a.b", 2), validated(1, { over: true })],
    blockedBy,
    "budget",
  ],
  [
    "what follows stays while nothing new does",
    [validated(0, { derived: "d" }), edit("a.b", 2), validated(1)],
    (s) => s.derived,
    "d",
  ],
  // Results.
  [
    "a result is taken",
    [{ type: "running" }, done(0)],
    (s) => [s.result.revision, s.run.phase, isStale(s), endOf(s)],
    [0, "done", false, 1000],
  ],
  [
    "a result of an old revision is ignored",
    [edit("a.b", 2), { type: "running" }, done(0)],
    (s) => [s.result, s.run.phase],
    [null, "running"],
  ],
  ["a result is stale after an edit", [done(0), edit("a.b", 2)], (s) => [s.result.revision, isStale(s)], [0, true]],
  ["undo to the same scenario is another revision", [done(0), edit("a.b", 2), undo], isStale, true],
  [
    "a failed run keeps the last result",
    [done(0), edit("a.b", 2), { type: "failed", message: "m" }],
    (s) => [s.result.revision, s.run.phase, s.run.message],
    [0, "failed", "m"],
  ],
  [
    "a shorter run clamps the window",
    [done(0), window(800, 900), edit("a.b", 2), done(1, 500)],
    (s) => s.window,
    { start: 400, end: 500 },
  ],
  [
    "another clock drops the window and the cursors",
    [done(0), window(80, 90), cursor("a", 3), edit("a.b", 2), done(1, 1000, { clock: 11 })],
    (s) => [s.window, s.cursors.a],
    [null, null],
  ],
  [
    "cursors and markers behind the end go",
    [done(0), cursor("a", 700), cursor("b", 300), marker(1, 700), marker(2, 300), edit("a.b", 2), done(1, 500)],
    (s) => [s.cursors.a, s.cursors.b, s.markers[1], s.markers[2]],
    [null, 300, null, 300],
  ],
  [
    "a row of a channel that is gone is left",
    [done(0), { type: "row", row: 3 }, edit("a.b", 2), done(1, 1000, { controllers: [controller(2)] })],
    (s) => s.row,
    0,
  ],
  [
    "an axis that is gone is left",
    [done(0), { type: "axis", axis: 3 }, edit("a.b", 2), done(1, 1000, { controllers: [controller(2)] })],
    (s) => s.axis,
    1,
  ],
  [
    "a controller that is gone is left",
    [
      done(0, 1000, { controllers: [controller(1), controller(1)] }),
      { type: "controller", controller: 1 },
      edit("a.b", 2),
      done(1),
    ],
    (s) => [s.controller, s.result.controller],
    [1, 0],
  ],
  [
    "and found again when it is back",
    [
      done(0, 1000, { controllers: [controller(1), controller(1)] }),
      { type: "controller", controller: 1 },
      edit("a.b", 2),
      done(1),
      edit("a.b", 3),
      done(2, 1000, { controllers: [controller(1), controller(1)] }),
    ],
    (s) => s.result.controller,
    1,
  ],
  // The visible time.
  ["without a window all is shown", [done(0)], shown, { start: 0, end: 1000 }],
  ["before a result the least is shown", [], shown, { start: 0, end: MIN_SPAN }],
  ["a window is kept inside the run", [done(0), window(-50, 100)], (s) => s.window, { start: 0, end: 150 }],
  ["on the right as well", [done(0), window(950, 1050)], (s) => s.window, { start: 900, end: 1000 }],
  ["a window is no longer than the run", [done(0), window(-5000, 5000)], (s) => s.window, { start: 0, end: 1000 }],
  ["a window has a least length", [done(0), window(500, 500)], (s) => s.window, { start: 500, end: 500 + MIN_SPAN }],
  ["a window of no numbers is none", [done(0), window(NaN, 5)], (s) => s.window, null],
  ["a window is whole cycles", [done(0), window(10.4, 99.6)], (s) => s.window, { start: 10, end: 99 }],
  [
    "a link's window waits for the result",
    [open(10, 50), done(0)],
    (s) => [s.window, s.pendingView],
    [{ start: 10, end: 50 }, null],
  ],
  [
    "a view that is selected while a link's run lasts stays, with the link's window",
    [open(10, 50), { type: "view", view: "study" }, done(0)],
    (s) => [s.view, s.window],
    ["study", { start: 10, end: 50 }],
  ],
  ["a link's window beyond the run is left", [open(10, 5000), done(0)], (s) => s.window, null],
  [
    "a link's cursors, axis and unit are taken as far as the run has them",
    [view({ a: 5, b: 5000, axis: 9, unit: "mm", sides: { spectrum: "timing" } }), done(0)],
    (s) => [s.cursors, s.axis, s.unit, s.sides, s.pendingView],
    [{ a: 5, b: null }, 3, "mm", { spectrum: "timing" }, null],
  ],
  [
    "a link to the run on show is taken at once",
    [done(0), view({ a: 7, controller: 4 })],
    (s) => [s.cursors.a, s.result.controller],
    [7, 0],
  ],
  [
    "what a sender saw is kept until the run is compared",
    [sender, done(0), compared()],
    (s) => s.sender,
    { text: "x", comparison: { same: true } },
  ],
  ["another comparison is not this link's", [sender, done(0), compared("y")], (s) => s.sender.comparison, null],
  ["another run is compared anew", [sender, done(0), compared(), done(0)], (s) => s.sender.comparison, null],
  ["an edit forgets what a sender saw", [sender, done(0), compared(), edit("a.b", 2)], (s) => s.sender, null],
  ["so does undo", [edit("a.b", 2), sender, undo], (s) => s.sender, null],
  ["an edit forgets a link's window", [open(10, 50), edit("a.b", 2), done(1)], (s) => s.window, null],
  // Hover and highlights.
  [
    "the same highlight is no change",
    [
      { type: "highlight", highlighted: { start: 1, end: 2 } },
      { type: "highlight", highlighted: { start: 1, end: 2 } },
    ],
    (s) => s.highlighted,
    { start: 1, end: 2 },
  ],
  [
    "all channels fold at once",
    [
      { type: "fold-all", folded: true },
      { type: "fold", channel: 3, folded: false },
    ],
    (s) => [s.folds[2], s.folds[3], s.folds[15]],
    [true, false, true],
  ],
  // Layout of the views and of the rows of the pulses.
  [
    "a view that has nothing to show is told once",
    [empty("packets", true), empty("packets", true), empty("spectrum", true)],
    (s) => s.emptyViews,
    ["packets", "spectrum"],
  ],
  [
    "until it has",
    [empty("packets", true), empty("spectrum", true), empty("packets", false)],
    (s) => s.emptyViews,
    ["spectrum"],
  ],
  [
    "rows have a height, an order and names, each by itself",
    [rows({ px: 30 }), rows({ order: ["RX", "EN"] }), rows({ names: { 0: "X" } }), rows({ hidden: ["ticks"] })],
    (s) => s.panes.pulses,
    { px: 30, order: ["RX", "EN"], hidden: ["ticks"], names: { 0: "X" } },
  ],
  ["which outlive the scenario", [rows({ px: 30 }), replace({ a: { b: 7 } })], (s) => s.panes.pulses.px, 30],
  [
    "and what is done to the panes",
    [rows({ px: 30 }), { type: "pane", panes: { folded: ["motion"] } }],
    (s) => [s.panes.pulses.px, s.panes.folded],
    [30, ["motion"]],
  ],
  [
    "each place has its own side",
    [
      { type: "side", area: "spectrum", side: "timing" },
      { type: "side", area: "motion", side: "motor" },
    ],
    (s) => s.sides,
    { spectrum: "timing", motion: "motor" },
  ],
];

for (const [name, messages, look, wanted] of cases) test(name, () => assert.deepEqual(look(play(messages)), wanted));

/** @param {any} value */
function frozen(value) {
  if (value === null || typeof value !== "object") return value;
  for (const inner of Object.values(value)) frozen(inner);
  return Object.freeze(value);
}

test("no message modifies the given state", () => {
  for (const [name, messages] of cases)
    assert.doesNotThrow(
      () => messages.flat().reduce((state, message) => frozen(update(state, message)), frozen(begin())),
      name,
    );
});

test("an edit shares what it does not touch, so that views can compare by identity", () => {
  const base = begin();
  assert.equal(play([edit("a.b", 2)], base).scenario.list, base.scenario.list);
});

test("a message without effect gives the same state", () => {
  const base = begin();
  for (const type of ["hover", "committed", "undo", "empty"])
    assert.equal(update(base, { type, cycle: null, isEmpty: false }), base, type);
});

test("the result of an earlier visit is shown until there is a new one", () => {
  const { result } = play([done(EARLIER_REVISION)]);
  assert.equal(result.revision, EARLIER_REVISION);
  assert.equal(play([done(0), done(EARLIER_REVISION)]).result.revision, 0);
});

test("the moves of one gesture are one undo step", () => {
  const pinch = (start, end) => ({ ...window(start, end), joins: "pinch" });
  const zoomed = play([done(0), window(0, 500), pinch(0, 400), pinch(0, 300)]);
  assert.deepEqual(shown(zoomed), { start: 0, end: 300 });
  assert.deepEqual(shown(update(zoomed, { type: "back" })), { start: 0, end: 500 });
});

test("a window is clamped to the run", () => {
  const rows = [
    [{ start: 5, end: 100 }, 1000, { start: 5, end: 100 }],
    [{ start: 0, end: 1 }, 3, { start: 0, end: MIN_SPAN }],
    [{ start: 1e300, end: 2e300 }, 1000, { start: 0, end: 1000 }],
    [{ start: -Infinity, end: 5 }, 1000, { start: 0, end: 1000 }],
    [{ start: 0, end: Number.NaN }, 1000, null],
  ];
  for (const [given, last, wanted] of rows) assert.deepEqual(clamp(given, last), wanted);
});

test("a path leads to a value, and set makes no list of an object", () => {
  assert.deepEqual(set({ x: [1, 2] }, "x[0]", 9), { x: [9, 2] });
  assert.equal(get(first, "list[1].c"), 2);
  assert.equal(get(first, "none.deeper"), undefined);
});

test("a path follows its part of the scenario", () => {
  const rows = [
    ["moves[1].duration_s", [["moves[1]", "moves[0]"]], "moves[0].duration_s"],
    ["moves[1].duration_s", [["moves[1]", null]], null],
    ["moves[10].duration_s", [["moves[1]", null]], "moves[10].duration_s"],
    ["anything", [["", null]], null],
  ];
  for (const [at, moved, expected] of rows) assert.equal(movedTo(at, moved), expected);
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

test("values are read under the pointer, else at a visible cursor", () => {
  const state = play([done(0), window(100, 900), cursor("a", 50), cursor("b", 500)]);
  assert.equal(readingCycle(state), 500);
  assert.equal(readingCycle(update(state, { type: "hover", cycle: 300 })), 300);
  assert.equal(readingCycle(update(state, cursor("b", null))), null);
});
