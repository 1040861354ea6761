import assert from "node:assert/strict";
import { test } from "node:test";
import { jumpText, nearestEdge, reachOf, rowAfter, searchStart } from "../../web/views/pulses/edge_search.js";

const state = (a = null, window = { start: 100, end: 1100 }) => ({ window, cursors: { a }, result: null });

test("a pointer reaches a few pixels of the shown time", () => {
  assert.equal(reachOf(state(), { left: 0, right: 1000 }), 6);
  assert.equal(reachOf(state(), { left: 0, right: 500 }), 12);
});

test("a cursor snaps to the nearest edge within reach", () => {
  assert.equal(nearestEdge([10, 17], 14, 6), 17);
  assert.equal(nearestEdge([10, null], 12, 6), 10);
  assert.equal(nearestEdge([10, undefined], 50, 6), null);
  assert.equal(nearestEdge([0], 3, 6), 0);
});

test("a jump begins at cursor A while it is visible", () => {
  assert.deepEqual([searchStart(state(500), true), searchStart(state(500), false)], [500, 500]);
  assert.deepEqual([searchStart(state(50), true), searchStart(state(50), false)], [100, 1100]);
  assert.equal(searchStart(state(), true), 100);
});

test("a jump reports the edge, or that there is none", () => {
  assert.equal(jumpText("STEP 0", "rise", true, 50, 100), "STEP 0: rising edge at 500 ms, cycle 50.");
  assert.equal(jumpText("EN", "any", false, null, 100), "EN: no earlier edge.");
  assert.equal(jumpText("EN", "fall", true, null, 100), "EN: no later falling edge.");
});

test("keys choose among signals, and stop at the ends", () => {
  const rows = [
    { kind: "ticks", name: "ticks", ink: "" },
    { kind: "signal", name: "EN", bit: 32, ink: "" },
    { kind: "signal", name: "STEP 0", bit: 0, ink: "" },
  ];
  assert.equal(rowAfter(rows, 32, 1).bit, 0);
  assert.equal(rowAfter(rows, 0, 1).bit, 0);
  assert.equal(rowAfter(rows, 32, -1).bit, 32);
  assert.equal(rowAfter([rows[0]], 0, 1), undefined);
});
