import assert from "node:assert/strict";
import { test } from "node:test";
import { createLiveEdit } from "../../web/form/live_edit.js";

/** A page with its frames, messages and made edits. */
function page() {
  const made = [];
  let frames = [];
  const dataset = { state: "ready" };
  globalThis.document = { documentElement: { dataset } };
  globalThis.requestAnimationFrame = (draw) => frames.push(draw);
  globalThis.cancelAnimationFrame = () => {
    frames = [];
  };
  const owner = { isConnected: true };
  const given = { dispatch: ({ type }) => made.push(type), now: () => ({ future: [] }) };
  return {
    made,
    dataset,
    owner,
    given,
    frame: () => {
      for (const draw of frames.splice(0)) draw();
    },
    waits: () => frames.length > 0,
    live: (options) => createLiveEdit(owner, given, options),
  };
}

test("the page draws an edit before the next one, and the newest one is made", () => {
  const { made, dataset, frame, live } = page();
  const { edit, end, isActive } = live();
  edit(() => made.push(1));
  dataset.state = "busy";
  for (const each of [2, 3]) edit(() => made.push(each));
  frame();
  assert.deepEqual(made, ["committed", 1]);
  dataset.state = "ready";
  frame();
  assert.deepEqual(made, ["committed", 1, 3]);
  assert.ok(isActive());
  dataset.state = "busy";
  edit(() => made.push(4));
  end();
  assert.deepEqual(made, ["committed", 1, 3, 4, "committed"]);
  assert.ok(!isActive());
});

test("keys end their step of undo themselves", () => {
  const { made, live } = page();
  const { edit, end } = live({ commits: false });
  edit(() => made.push(1));
  end();
  assert.deepEqual(made, [1]);
});

test("a canceled gesture drops its pending edit", () => {
  const { made, dataset, waits, live } = page();
  const { edit, end, cancel } = live();
  edit(() => made.push(1));
  dataset.state = "busy";
  edit(() => made.push(2));
  cancel();
  end();
  cancel();
  assert.deepEqual(made, ["committed", 1, "canceled"]);
  assert.ok(!waits());
});

test("the gesture ends when its field is removed", () => {
  const { made, owner, frame, waits, live } = page();
  const { edit, isActive } = live();
  edit(() => made.push(1));
  owner.isConnected = false;
  frame();
  assert.deepEqual(made, ["committed", 1, "committed"]);
  assert.ok(!isActive() && !waits());
});
