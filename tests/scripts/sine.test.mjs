import assert from "node:assert/strict";
import { test } from "node:test";
import { addedSine, deviationEdit, targetOf, vertexEdit } from "../../web/views/study/sine_edits.js";
import {
  bestRow,
  bestRows,
  captionOf,
  cellsOf,
  indexAt,
  isAtEnd,
  joined,
  movedBy,
  pieces,
  progressOf,
  rounded,
  rowOf,
  whyNoChart,
} from "../../web/views/study/sine_sweep.js";

const rowsOf = (...rows) => {
  const names = ["d1", "segments", "position", "speed", "acceleration", "filtered", "euclidean"];
  return Object.fromEntries(names.map((name, at) => [name, Float64Array.from(rows, (row) => row[at])]));
};
const rows = rowsOf(
  [0.01, 8, 0.05, 0.1, 0.2, Number.NaN, 1],
  [0.02, 6, 0.09, 0.1, 0.2, Number.NaN, 2],
  [0.03, 6, 0.07, 0.1, 0.2, Number.NaN, 3],
);

test("the pieces cover all points and the whole range without a gap", () => {
  const { rows, best } = pieces({ low: 0.002, high: 0.06, points: 25, order: 3, sensor: undefined });
  assert.deepEqual(
    rows.map((piece) => piece.slice(5)),
    [
      [0, 10],
      [10, 20],
      [20, 30],
    ],
  );
  assert.equal(best[0][0], 0.002);
  assert.equal(best.at(-1)[1], 0.06);
  for (let at = 1; at < best.length; at++) assert.equal(best[at][0], best[at - 1][1]);
});

test("progress counts points first, and then the search", () => {
  assert.equal(progressOf(0, 25).text, "0 of 25 points");
  assert.equal(progressOf(2, 25).text, "20 of 25 points");
  assert.deepEqual(progressOf(19, 25), { part: 1, text: "best d1 of the range" });
});

test("a d1 is rounded up to the digits of the scenario", () => {
  assert.equal(rounded(0.004250000001), 0.00425);
  assert.equal(rounded(0.004250009), 0.00425001);
});

test("the best row of each number of segments has the lowest distortion of position", () => {
  const best = bestRows(rows);
  assert.deepEqual(
    best.map(({ segments, d1 }) => [segments, d1]),
    [
      [6, 0.03],
      [8, 0.01],
    ],
  );
  assert.equal(bestRow(best).d1, 0.01);
  assert.equal(bestRow([]), null);
});

test("pieces of rows are joined in order, and no row is beyond the last", () => {
  const all = joined([rows, rows]);
  assert.equal(all.d1.length, 6);
  assert.equal(rowOf(all, 4).segments, 6);
  assert.equal(rowOf(all, 6), null);
  assert.equal(rowOf(all, null), null);
  assert.equal(rowOf(null, 0), null);
});

test("pointer and keys stay within the rows", () => {
  const at = [
    [0, 0],
    [0.5, 1],
    [1.01, 2],
    [-0.5, 9],
  ];
  for (const [part, expected] of at) assert.equal(indexAt(part, rows, 9), expected);
  assert.deepEqual(
    [movedBy(rows, null, 1), movedBy(rows, null, -1), movedBy(rows, 1, 20), movedBy(null, null, 1)],
    [0, 0, 2, 0],
  );
});

test("the ends of the range are recognized", () => {
  assert.deepEqual([isAtEnd(0.01, rows.d1), isAtEnd(0.02, rows.d1)], [true, false]);
});

test("cells and texts show a missing row and a missing sensor", () => {
  assert.deepEqual(cellsOf("the scenario", null, "none"), ["the scenario", "none", "", "", "", "", "", ""]);
  assert.deepEqual(cellsOf("x", rowOf(rows, 0), ""), ["x", "0.01", "8", "5 %", "10 %", "20 %", "–", "1"]);
  assert.match(captionOf("filtered", 5, 7), /filtered by a sensor of 5 harmonics over d1, harmonics 2 to 7/);
  assert.equal(whyNoChart(rows, "position", undefined), "");
  assert.match(whyNoChart(rows, "filtered", undefined), /enter a sensor bandwidth/);
  assert.match(whyNoChart(rows, "filtered", 5), /has not run/);
});

const stateWith = (moves, problems = []) => ({
  validated: 0,
  revision: 0,
  axis: 0,
  result: null,
  validation: { problems, scenario: "{}" },
  scenario: { source: { motion: { axes: [{ moves }] } } },
});

test("an edit puts d1 into the first sine of the axis, or adds a sine", () => {
  const sine = { sine_segments: { max_deviation: 0.01, period_s: 2 } };
  const { axis, move } = targetOf(stateWith([{ points: {} }, sine]));
  assert.equal(move, 1);
  const edit = deviationEdit(axis, move, 0.0042);
  assert.deepEqual([edit.path, edit.value], ["source.motion.axes[0].moves[1].sine_segments.max_deviation", 0.0042]);
  const without = targetOf(stateWith([{ points: {} }]));
  assert.equal(without.move, -1);
  assert.deepEqual(addedSine(without.axis, { period_s: 1 }, 0.5).value.at(-1), {
    sine_segments: { period_s: 1, max_deviation: 0.5 },
  });
});

test("a form with problems is not edited", () => {
  const target = targetOf(stateWith([], [{ path: "bus", message: "no" }]));
  assert.equal(target.axis, null);
  assert.match(
    vertexEdit(target, {}, () => ({})),
    /^Not available while the form has errors/,
  );
});

test("vertices replace the sine, follow the other moves, or are refused with the reason", () => {
  const sine = { sine_segments: { period_s: 2 } };
  const make = (given) => ({ points: given });
  assert.deepEqual(vertexEdit(targetOf(stateWith([sine])), {}, make).value, { points: { period_s: 2 } });
  const added = vertexEdit(targetOf(stateWith([{ ramps: {} }])), { sine_segments: 1 }, make);
  assert.deepEqual(added.value, [{ ramps: {} }, { points: 1 }]);
  assert.equal(
    vertexEdit(targetOf(stateWith([sine])), {}, () => "too many"),
    "too many",
  );
});
