import assert from "node:assert/strict";
import { test } from "node:test";
import { cornerOf, dragged, durationOf, movedCorner } from "../../web/state/corners.js";

const cosine = { cosine: { duration_s: 0.4, ramp_s: 0.1 } };
const trapezoid = { trapezoid: {} };
const rates = { steps: 3200, start: 500, max: 8500, acceleration: 40_000 };

test("the corner is where the ramp meets the plateau", () => {
  const { ramp_s, top } = cornerOf(cosine, { steps: 3200 });
  assert.equal(ramp_s, 0.1);
  assert.ok(Math.abs(top - 3200 / 0.3) < 1e-9);
  assert.deepEqual(cornerOf(trapezoid, rates), { ramp_s: 0.2, top: 8500 });
  // 100 steps are too short for the maximum speed.
  const short = cornerOf(trapezoid, { ...rates, steps: 100 });
  assert.ok(Math.abs(short.top - Math.sqrt(500 ** 2 + 40_000 * 100)) < 1e-9);
  for (const [move, of] of [
    [{ dwell: {} }, { steps: 0 }],
    [{ constant: {} }, { steps: 5 }],
    [cosine, { steps: 0 }],
    [trapezoid, { ...rates, max: 500 }],
    // The area of the ramp, and so the plateau, is unknown.
    [{ ramps: cosine.cosine }, { steps: 3200 }],
  ])
    assert.equal(cornerOf(move, of), null);
});

test("a moved corner is where it was moved to", () => {
  const to = { ramp_s: 0.05, top: 10_000 };
  const fields = movedCorner(cosine, { steps: 3200 }, to);
  assert.deepEqual(cornerOf({ cosine: fields }, { steps: 3200 }), to);
  const faster = movedCorner(trapezoid, rates, { ramp_s: 0.1, top: 4500 });
  assert.deepEqual(faster, { max: 4500, acceleration: 40_000 });
  assert.deepEqual(cornerOf(trapezoid, { ...rates, ...faster }), { ramp_s: 0.1, top: 4500 });
});

test("an unsymmetric ramp keeps its share of the travel", () => {
  // An exponential ramp with an area of 0.7: peak = steps / (duration - 2 · ramp · 0.3).
  const peak = 3200 / (0.4 - 0.6 * 0.1);
  const { duration_s, ramp_s } = movedCorner(
    { ramps: cosine.cosine },
    { steps: 3200, peak },
    { ramp_s: 0.08, top: 9000 },
  );
  assert.equal(ramp_s, 0.08);
  assert.ok(Math.abs(3200 / (duration_s - 0.6 * ramp_s) - 9000) < 1e-6);
});

test("a move ends where its corners say", () => {
  const peak = 3200 / 0.3;
  assert.equal(durationOf(cosine, { steps: 3200 }, { ramp_s: 0.1, top: peak }), 0.4);
  // 900 steps in each ramp, 1400 steps at 8500 steps/s.
  assert.ok(Math.abs(durationOf(trapezoid, rates, cornerOf(trapezoid, rates)) - (0.4 + 1400 / 8500)) < 1e-12);
  // Without a plateau: up to 3200 steps/s and down in 0.2 s each.
  const short = { steps: 640, start: 0, max: 9000, acceleration: 16_000 };
  assert.ok(Math.abs(durationOf(trapezoid, short, cornerOf(trapezoid, short)) - 0.4) < 1e-12);
});

test("a drag changes only the digits that it means", () => {
  const rows = [
    [8533.3333, 8534.9, 8533.3333],
    [8533.3333, 8551, 8550],
    [0.1, 0.1294, 0.129],
    [0.1, 0.0996, 0.0996],
  ];
  for (const [before, value, expected] of rows) assert.equal(dragged(before, value), expected, String(value));
});

test("a corner stays within the move", () => {
  const { duration_s, ramp_s } = movedCorner(cosine, { steps: 3200 }, { ramp_s: 99, top: 8000 });
  assert.ok(ramp_s <= duration_s / 2);
  assert.equal(movedCorner(cosine, { steps: 3200 }, { ramp_s: -1, top: 8000 }).ramp_s, 0);
  assert.equal(movedCorner(cosine, { steps: 3200 }, { ramp_s: 0.1, top: -5 }), null);
  assert.equal(movedCorner(trapezoid, rates, { ramp_s: 0.1, top: 500 }), null);
  assert.equal(movedCorner(trapezoid, rates, { ramp_s: 0, top: 5000 }), null);
});
