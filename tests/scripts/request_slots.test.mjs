import assert from "node:assert/strict";
import { test } from "node:test";
import { Dropped, RequestSlots } from "../../web/engine/request_slots.js";

test("only the newest waiting request of a slot is sent", async () => {
  const sent = [];
  const replies = [];
  const slots = new RequestSlots((method, args) => {
    sent.push([method, ...args]);
    return new Promise((resolve) => {
      replies.push(resolve);
    });
  });
  const first = slots.latest("motion", "at", [1]);
  const dropped = assert.rejects(slots.latest("motion", "at", [2]), Dropped);
  const last = slots.latest("motion", "at", [3]);
  const other = slots.latest("pulses", "at", [4]);
  await dropped;
  assert.deepEqual(sent, [
    ["at", 1],
    ["at", 4],
  ]);
  replies[0]("one");
  replies[1]("four");
  assert.deepEqual([await first, await other], ["one", "four"]);
  await new Promise(setImmediate);
  assert.deepEqual(sent.at(-1), ["at", 3]);
  replies[2]("three");
  assert.equal(await last, "three");
});

test("a failed request does not block its slot", async () => {
  let failed = false;
  const slots = new RequestSlots(async () => {
    if (failed) return "fine";
    failed = true;
    throw new Error("broken");
  });
  await assert.rejects(slots.latest("a", "at", []), /broken/);
  assert.equal(await slots.latest("a", "at", []), "fine");
});
