/** The models of the motion view: units and lines of axes, the comparison with a baseline, and the cursor of a tap. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { setSchema } from "../../web/form/schema.js";
import { tapped } from "../../web/time/timeline.js";
import { axisNames } from "../../web/views/motion/axis_names.js";
import { lookOf, otherAxes, scaleOf, unitFor, unitOf, unitsOf } from "../../web/views/motion/axis_units.js";
import { comparedRows, stretched } from "../../web/views/motion/compared_rows.js";

const wheel = { step_mm: 0.01, step_deg: 0.1, unit: "mm" };
const screw = { step_mm: 0.02, step_deg: 0.1, unit: "steps" };
const shaft = { step_mm: null, step_deg: 0.2, unit: "deg" };
/** @param {{[field: string]: any}} more @returns {any} */
const state = (more = {}) => ({
  axis: 0,
  unit: null,
  hiddenAxes: [],
  baseline: null,
  result: { controller: 0 },
  derived: { controllers: [{ axes: [wheel, screw, shaft] }] },
  ...more,
});

test("a motion is drawn in the unit in which it was typed, until another one is selected", () => {
  assert.deepEqual(
    [0, 1, 2].map((axis) => unitOf(state({ axis })).unit),
    ["mm", "steps", "°"],
  );
  assert.equal(unitFor(state(), "acceleration"), "mm/s²");
  assert.deepEqual(unitOf(state({ unit: "steps" })), { name: "steps", unit: "steps", scale: 1, baseline: 1 });
  assert.deepEqual(unitOf(state({ unit: "deg" })), { name: "deg", unit: "°", scale: 0.1, baseline: 0.1 });
  // A shaft has no millimeters.
  assert.equal(unitOf(state({ axis: 2, unit: "mm" })).name, "steps");
  assert.deepEqual(
    unitsOf(state({ axis: 2 })).map(([name]) => name),
    ["steps", "deg"],
  );
});

test("all axes are drawn that are not hidden and have the unit", () => {
  assert.deepEqual(otherAxes(state(), 3), [1]);
  assert.deepEqual(otherAxes(state({ unit: "steps" }), 3), [1, 2]);
  assert.deepEqual(otherAxes(state({ unit: "steps", hiddenAxes: [1] }), 3), [2]);
  assert.deepEqual([scaleOf(state(), 1), scaleOf(state(), 2), scaleOf(state({ unit: "deg" }), 2)], [0.02, null, 0.2]);
});

test("sixteen axes have sixteen different lines", () => {
  const looks = Array.from({ length: 16 }, (_, axis) => JSON.stringify(lookOf(state({ axis: 5 }), axis)));
  assert.equal(new Set(looks).size, 16);
  // That is the baseline.
  assert.ok(!looks.some((look) => look.includes("--enable") && !look.includes('"dash":0')));
  assert.equal(lookOf(state({ derived: null }), 0).ink, "--actual", "there is no ideal curve");
});

test("the legend names what differs between the axes", () => {
  const words = [
    ["sigmoid", "sigmoid"],
    ["straight", "straight"],
  ].map(([name, label]) => ({ name, label, text: label }));
  const move = (name, label) => ({ name, label, text: "", type: { group: "Ramps" } });
  setSchema({
    documents: {},
    groups: {
      Move: { fields: [move("ramps", "Ramps of a shape"), move("cosine", "Cosine S-curve")] },
      Ramps: { fields: [{ name: "shape", label: "Shape", text: "shape", range: "", type: { words } }] },
    },
  });
  const of = (...moves) =>
    axisNames({ result: null, scenario: { source: { motion: { axes: moves.map((each) => ({ moves: each })) } } } });
  const [sigmoid, straight, cosine] = [
    { ramps: { shape: "sigmoid" } },
    { ramps: { shape: "straight" } },
    { cosine: {} },
  ];
  assert.deepEqual(of([sigmoid], [straight], [cosine]), ["sigmoid", "straight", "Cosine S-curve"]);
  assert.deepEqual(of([sigmoid], [sigmoid]), []);
  assert.deepEqual(of([sigmoid], [cosine, cosine]), ["sigmoid", ""]);
  assert.deepEqual(axisNames({ result: null, scenario: { source: { packets: {} } } }), []);
});

const figure = (name, unit, before, after) => ({
  name,
  unit,
  before,
  after,
  change: before === null || after === null ? null : after - before,
});

test("ramps are compared at equal duration: speeds and accelerations are those of the stretched motion", () => {
  const figures = stretched([
    figure("duration", "seconds", 0.4, 0.5),
    figure("peak speed", "speed", 8000, 8000),
    figure("jump of speed", "speed", null, 100),
    figure("peak acceleration", "acceleration", 2000, null),
    figure("RMS lag", "length", 0.5, 0.25),
    figure("THD, speed", "ratio", 0.01, 0.02),
  ]);
  assert.deepEqual(comparedRows(figures, null, "mm"), [
    ["duration", "400 ms", "400 ms", "equal"],
    ["peak speed", "8\u202f000 mm/s", "10\u202f000 mm/s", "+2\u202f000 mm/s (+25 %)"],
    ["jump of speed", "none", "125 mm/s", "–"],
    ["peak acceleration", "2\u202f000 mm/s²", "none (speed jumps)", "–"],
  ]);
  // The duration of a division is the same although its last digit differs.
  const [duration, acceleration] = stretched([
    figure("duration", "seconds", 0.3, 0.7),
    figure("peak acceleration", "acceleration", 100, 100),
  ]);
  assert.equal(duration.change, 0);
  assert.ok(Math.abs(acceleration.after - (100 * 49) / 9) < 1e-9);
});

test("a comparison says what changes, and what is undefined", () => {
  const rows = comparedRows(
    [
      figure("duration", "seconds", 0.4, 0.5),
      figure("peak speed", "speed", 8000, 8000),
      figure("jump of speed", "speed", null, 100),
      figure("peak acceleration", "acceleration", 2000, null),
      figure("RMS lag", "length", 0.5, 0.25),
      figure("THD, speed", "ratio", 0.01, 0.02),
      figure("lost steps", "full_steps", 0, 4),
    ],
    [10, 12],
    "mm",
  );
  assert.deepEqual(rows, [
    ["duration", "400 ms", "500 ms", "+100 ms (+25 %)"],
    ["peak speed", "8\u202f000 mm/s", "8\u202f000 mm/s", "equal"],
    ["jump of speed", "none", "100 mm/s", "–"],
    ["peak acceleration", "2\u202f000 mm/s²", "none (speed jumps)", "–"],
    ["RMS lag", "0.5 mm", "0.25 mm", "−0.25 mm (−50 %)"],
    ["THD, speed", "1 %", "2 %", "+100 %"],
    ["lost steps", "0", "4", "+4"],
    ["edges", "10", "12", "+2 (+20 %)"],
  ]);
});

test("taps set both cursors, then move the nearer one", () => {
  const cursors = (a, b) => /** @type {any} */ ({ cursors: { a, b } });
  assert.equal(tapped(cursors(null, null), 5), "a");
  assert.equal(tapped(cursors(10, null), 11), "b");
  assert.equal(tapped(cursors(null, 10), 11), "a");
  assert.equal(tapped(cursors(10, 20), 11), "a");
  assert.equal(tapped(cursors(10, 20), 19), "b");
});
