import assert from "node:assert/strict";
import { test } from "node:test";
import { derivedRows, moveNote } from "../../web/form/derived_rows.js";
import { assignProblems, problemsOf } from "../../web/form/problem_places.js";
import { lengthText, withoutGroup, withRaisedGroup } from "../../web/form/program_groups.js";
import { isUsed, needsRemedies, shapeOf } from "../../web/form/shape.js";
import { hasNoLine, samplePackets, sampleSends } from "../../web/form/source_kinds.js";
import { convert, isList, isSame, meaning, print, read } from "../../web/form/values.js";

const state = { scenario: { clock_hz: 16_000_000 }, derived: null };
const value = (text, field, before) => read(text, { key: "x", ...field }, state, before);

test("a text is parsed by the kind of its field", () => {
  const rows = [
    ["true", { kind: "choice" }, true],
    ["2", { kind: "choice" }, 2],
    ["", { kind: "choice" }, null],
    ["raw", { kind: "choice" }, "raw"],
    ["0x81 0x0A", { kind: "hex" }, "810a"],
    [" ", { kind: "optional-hex" }, null],
    ["8a\n\n0x0a 1\n", { kind: "lines" }, ["8a", "0a1"]],
    ["", { kind: "optional" }, null],
    ["1.2k", { kind: "number", unit: "Hz" }, 1200],
    ["25 us", { kind: "cycles", unit: "cycles" }, 400],
    ["as it is ", { kind: "text" }, "as it is "],
  ];
  for (const [text, field, expected] of rows) assert.deepEqual(value(text, field), { value: expected }, text);
  assert.ok("message" in value("1.5", { kind: "whole" }));
  assert.ok("message" in value("x", { kind: "number", unit: "s" }));
});

test("a typed unit is chosen for its quantity", () => {
  const field = { kind: "quantity", units: { mm: "mm", deg: "°", mm_s2: "mm/s²" } };
  assert.deepEqual(value("250 mm", field, { deg: 5 }), { value: { mm: 250 } });
  assert.deepEqual(value("90 deg", field, { mm: 5 }), { value: { deg: 90 } });
  assert.deepEqual(value("3 mm/s2", field, { mm: 5 }), { value: { mm_s2: 3 } });
  assert.deepEqual(value("7", field, { mm: 5 }), { value: { mm: 7 } });
});

test("a quantity may be empty", () => {
  const field = { kind: "optional-quantity", units: { steps_s: "steps/s", mm_s: "mm/s" } };
  assert.deepEqual(value(" ", field, null), { value: null });
  assert.deepEqual(value("250", field, { mm_s: 0 }), { value: { mm_s: 250 } });
  assert.deepEqual(value("250 mm/s", field, null), { value: { mm_s: 250 } });
  assert.equal(print(null, field), "");
  assert.equal(print({ mm_s: 250 }, field), "250");
});

test("a printed value can be typed again", () => {
  assert.equal(print("810a", { kind: "hex" }), "81 0a");
  assert.equal(print(["810a", "ff"], { kind: "lines" }), "81 0a\nff");
  assert.equal(print({ mm: 5 }, { kind: "quantity" }), "5");
  assert.deepEqual([print(null, { kind: "number" }), print(0, { kind: "number" })], ["", "0"]);
  assert.ok(isSame({ mm: 5 }, { mm: 5 }));
  assert.deepEqual([isList({ kind: "points" }), isList({ kind: "hex" })], [true, false]);
});

test("a quantity keeps its travel in another unit where the mechanics are known", () => {
  const derived = { controllers: [{ axes: [{ step_mm: 0.01, step_deg: 1.8 }] }] };
  const path = "source.motion.axes[0].moves[0].distance";
  assert.deepEqual(convert({ mm: 5 }, "steps", path, { derived }), { steps: 500 });
  assert.deepEqual(convert({ steps: 100 }, "deg", path, { derived }), { deg: 180 });
  assert.deepEqual(convert({ mm: 5 }, "steps", path, { derived: null }), { steps: 5 });
});

test("cycles are shown as a time, too", () => {
  assert.equal(meaning(400, { kind: "cycles", key: "x" }, state), "= 25 µs");
  assert.equal(meaning(16e6, { kind: "whole", key: "clock_hz" }, state), "one cycle = 62.5 ns");
  assert.equal(meaning(9600, { kind: "whole", key: "baud", unit: "baud" }, state), "");
});

test("a problem is assigned to its field, else to its part, else to the list", () => {
  const fields = new Map([
    ["bus.channels", 1],
    ["source.packets.packets", 1],
  ]);
  const parts = new Map([["source.motion.axes[0]", 1]]);
  const problems = [
    { path: "bus.channels", message: "a" },
    { path: "bus.channels", message: "b" },
    { path: "source.packets.packets[2]", message: "c" },
    { path: "source.motion.axes[0].moves[1].ramps", message: "d" },
    { path: "analysis", message: "e" },
  ];
  const places = assignProblems(problems, fields, parts);
  assert.deepEqual(
    [...places.fields],
    [
      ["bus.channels", "a b"],
      ["source.packets.packets", "Line 3: c."],
    ],
  );
  assert.deepEqual([...places.parts], [["source.motion.axes[0]", "d"]]);
  assert.deepEqual(places.others, [problems[4]]);
});

test("a draft replaces the problems of the previous value", () => {
  const validation = {
    problems: [
      { path: "a.b", message: "old" },
      { path: "c", message: "N*m is mN*m" },
    ],
  };
  const found = problemsOf({ drafts: { a: { text: "", message: "no number" } }, validation });
  assert.deepEqual(found, [
    { path: "a", message: "no number" },
    { path: "c", message: "N*m is mN·m" },
  ]);
  assert.deepEqual(problemsOf({ drafts: {}, validation: null }), []);
});

// The linter takes an object with a method `then` for a promise.
const wait = (number) => JSON.parse(`{"wait":{"then":${number}}}`);

test("references between groups follow changes", () => {
  const program = [{ move: {} }, { jump: { to: 4 } }, { repeat: { first: 1 } }, wait(3)];
  assert.deepEqual(withoutGroup(program, 2), [{ move: {} }, { jump: { to: 3 } }, wait(3)]);
  assert.deepEqual(withoutGroup(program, 3)[1], { jump: { to: 3 } });
  assert.deepEqual(withoutGroup(program, 0)[1], { repeat: { first: 1 } });
  const raised = withRaisedGroup(program, 3);
  assert.deepEqual(raised[2], wait(4));
  assert.deepEqual(raised[1], { jump: { to: 3 } });
});

test("a length is shown in units and in whole steps", () => {
  assert.equal(lengthText(125, { decimals: 1, pulses_per_unit: 100 }), "= 12.5 units, 1\u202f250 steps");
  assert.equal(lengthText(1, { decimals: 3, pulses_per_unit: 500 }), "= 0.001 units, 1 steps");
  assert.equal(lengthText(1, { decimals: 9, pulses_per_unit: 500 }), "");
  assert.equal(lengthText(null, {}), "");
});

const scenario = {
  source: { motion: { axes: [{ mechanics: { belt: {} }, moves: [{ cosine: { duration_s: 1 } }] }] } },
  controllers: [],
  driver_timing: null,
  line: { glitches: [], noise: { seed: 3, drop_ppm: 0 }, protocol: "raw" },
  plant: null,
};

test("the form is rebuilt for another structure, not for other values", () => {
  const other = structuredClone(scenario);
  other.source.motion.axes[0].moves[0].cosine.duration_s = 2;
  assert.equal(shapeOf(other), shapeOf(scenario));
  other.source.motion.axes[0].moves.push({ points: {} });
  assert.notEqual(shapeOf(other), shapeOf(scenario));
  assert.notEqual(shapeOf({ ...scenario, plant: { motors: [] } }), shapeOf(scenario));
});

test("remedies load after the first problem or deliberate error", () => {
  const fine = { validation: { problems: [] }, result: null, scenario };
  assert.equal(needsRemedies(fine), false);
  assert.ok(needsRemedies({ ...fine, validation: { problems: [{}] } }));
  assert.ok(needsRemedies({ ...fine, result: { summary: { controllers: [{ violations: 2 }] } } }));
  assert.ok(needsRemedies({ ...fine, scenario: { ...scenario, line: { glitches: [], noise: { drop_ppm: 1 } } } }));
  assert.deepEqual([isUsed({ a: 0 }), isUsed({ a: 0, b: 1 })], [false, true]);
});

test("segments and panels do not use the line", () => {
  const rows = [
    [{ segments: {} }, true],
    [{ standalone: [] }, true],
    [{ motion: { engine: "segments" } }, true],
    [{ motion: { engine: "ticks" } }, false],
    [{ packets: {} }, false],
  ];
  for (const [source, expected] of rows) assert.equal(hasNoLine({ source }), expected);
});

test("sample packets begin with the address of their controller on a raw line", () => {
  const bus = { channels: 2, self_test_cycles: 9, slots: 4, step_period_cycles: 10 };
  const raw = { bus, line: { protocol: "raw", address: 5 } };
  assert.deepEqual(samplePackets(raw, bus, 5), ["058a8a", "050a0a"]);
  assert.deepEqual(samplePackets({ ...raw, line: { protocol: "framed" } }, bus, 5), ["8a8a", "0a0a"]);
  assert.deepEqual(
    sampleSends(raw).map(({ start_cycle }) => start_cycle),
    [10, 50],
  );
  const framed = sampleSends({ bus, line: { protocol: "framed", address: 1 } });
  assert.deepEqual(
    framed.map(({ frame }) => frame),
    ["010100038a8a0a0a0000", "0104"],
  );
});

test("a rate above a bus' limit is marked, unless nothing limits it", () => {
  const derived = {
    controllers: [{ tick_s: 0.001, limit_steps_s: 1000, ticks: 5, axes: [{ peak_speed_steps_s: 2000, step_mm: 0.5 }] }],
    ticks: 5,
    sends: 2,
    line_load: 1.5,
    duration_s: 0.4,
  };
  const of = (source, more = {}) => ({
    unit: "steps",
    scenario: { ...scenario, source },
    result: null,
    revision: 0,
    ...more,
  });
  const row = (rows, name) => rows.find(([each]) => each === name);
  const ticks = derivedRows(of({ motion: { engine: "ticks" } }), derived);
  assert.deepEqual(row(ticks, "Peak rate").slice(1, 3), ["2\u202f000 steps/s", "over"]);
  assert.deepEqual(row(ticks, "Line load").slice(1, 3), ["150 %", "over"]);
  assert.equal(row(ticks, "Packets")[1], "1\u202f000 /s");
  const segments = derivedRows(of({ motion: { engine: "segments" } }), derived);
  assert.equal(row(segments, "Peak rate")[2], "");
  assert.deepEqual(row(segments, "On the line")[1], "nothing");
  const inMm = derivedRows(of({ motion: { engine: "ticks" } }, { unit: "mm" }), derived);
  assert.match(row(inMm, "Peak rate")[1], /· 1000\u00a0mm\/s$/);
});

test("a move's note has its times, its steps and the motor's warning", () => {
  const move = { start_s: 0, duration_s: 0.5, steps: 0, detail: "", warning: "" };
  const of = (more, kind) => ({
    derived: { controllers: [{ axes: [{ moves: [{ ...move, ...more }] }] }] },
    scenario: { source: { motion: { axes: [{ moves: [{ [kind]: {} }] }] } } },
  });
  const path = "source.motion.axes[0].moves[0]";
  assert.equal(moveNote(path, of({ steps: 1 }, "cosine")).text, "0 s to 500 ms · 1 step");
  assert.match(moveNote(path, of({}, "sine")).text, /back at the start$/);
  assert.equal(moveNote(path, of({ warning: "5 mN*m" }, "cosine")).warning, " ⚠ Motor: 5 mN·m.");
  assert.deepEqual(moveNote("source.motion.axes[0].moves[4]", of({}, "sine")), { text: "", warning: "" });
});
