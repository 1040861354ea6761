import assert from "node:assert/strict";
import { test } from "node:test";
import { cornerOf, movedCorner } from "../../web/state/corners.js";

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

test("a corner stays within the move", () => {
  const { duration_s, ramp_s } = movedCorner(cosine, { steps: 3200 }, { ramp_s: 99, top: 8000 });
  assert.ok(ramp_s <= duration_s / 2);
  assert.equal(movedCorner(cosine, { steps: 3200 }, { ramp_s: -1, top: 8000 }).ramp_s, 0);
  assert.equal(movedCorner(cosine, { steps: 3200 }, { ramp_s: 0.1, top: -5 }), null);
  assert.equal(movedCorner(trapezoid, rates, { ramp_s: 0.1, top: 500 }), null);
  assert.equal(movedCorner(trapezoid, rates, { ramp_s: 0, top: 5000 }), null);
});
