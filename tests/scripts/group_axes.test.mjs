import assert from "node:assert/strict";
import { test } from "node:test";
import { withAxis, withoutAxis } from "../../web/state/group_axes.js";

const groups = [
  { line: { distances: [{ steps: 1 }, { mm: 2 }], profile: "trapezoid" } },
  {
    way_points: {
      points: [
        { positions: [{ steps: 3 }, { steps: 4 }], speeds: null },
        { positions: [{ steps: 5 }, { steps: 6 }], speeds: [null, { steps_s: 7 }] },
      ],
    },
  },
  {
    time: {
      duration_s: 1,
      moves: [
        { axis: 0, move: "a" },
        { axis: 1, move: "b" },
      ],
    },
  },
  { time: { duration_s: null, moves: [{ axis: 0, move: "c" }] } },
];

test("another axis stands still in all groups", () => {
  const [line, points, ...times] = withAxis(groups);
  assert.deepEqual(line, { line: { distances: [{ steps: 1 }, { mm: 2 }, { steps: 0 }], profile: "trapezoid" } });
  assert.deepEqual(points.way_points.points, [
    { positions: [{ steps: 3 }, { steps: 4 }, { steps: 0 }], speeds: null },
    { positions: [{ steps: 5 }, { steps: 6 }, { steps: 0 }], speeds: [null, { steps_s: 7 }, null] },
  ]);
  assert.deepEqual(times, groups.slice(2));
});

test("a removed axis leaves all groups, and later axes keep their values", () => {
  const [line, points, time, ...others] = withoutAxis(groups, 0);
  assert.deepEqual(line.line.distances, [{ mm: 2 }]);
  assert.deepEqual(points.way_points.points, [
    { positions: [{ steps: 4 }], speeds: null },
    { positions: [{ steps: 6 }], speeds: [{ steps_s: 7 }] },
  ]);
  assert.deepEqual(time, { time: { duration_s: 1, moves: [{ axis: 0, move: "b" }] } });
  // It had no other move.
  assert.deepEqual(others, []);
});
