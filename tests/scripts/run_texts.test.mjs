import assert from "node:assert/strict";
import { test } from "node:test";
import { hostText, statusText } from "../../web/shell/run_texts.js";
import { initial } from "../../web/state/initial.js";
import { update } from "../../web/state/update.js";

const validation = { problems: [], scenario: "{}", derived: null, cost: null };
const controllers = [{ channels: 1, edges: 12_345 }];
const summary = { end_cycle: 10, end_s: 0.4, clock_hz: 1, controllers };

test("the header states the progress and the result of a run", () => {
  const valid = update(initial({}), { type: "validated", revision: 0, validation });
  const running = update(valid, { type: "running" });
  const at = (cycle, end_cycle) =>
    update(running, { type: "progress", progress: { done: false, cycle, end_cycle, records: 5 } });
  const done = update(running, { type: "done", revision: 0, summary, ms: 1 });
  const rows = [
    [valid, false, "no result yet"],
    [running, false, "running…"],
    [at(0, 0), true, "planning the motion…"],
    [at(25, 100), true, "25 %, 5 cycles with edges so far"],
    [done, false, "12\u202f345 edges · 400 ms"],
    [update(done, { type: "draft", path: "x", text: "", message: "" }), false, "not run: fix the form"],
  ];
  for (const [state, long, expected] of rows) assert.equal(statusText(state, long), expected);
});

test("a host reports ticks, repeated frames, crashes and jobs that it gave up", () => {
  const job = (more) => ({ controller: 0, ticks: 5, acknowledged: 5, why: null, progress: "done", ...more });
  const host = (jobs, more = {}) => ({ host: { jobs, repeated: 0, crashes: 0, ...more }, controllers });
  const lost = job({ controller: 1, acknowledged: 2, why: "no reply", progress: "given_up" });
  assert.equal(hostText({ host: null, controllers }), "");
  assert.equal(hostText(host([job()])), "all 5 ticks done");
  assert.equal(
    hostText(host([job()], { repeated: 1, crashes: 2 })),
    "all 5 ticks done, 1 frame repeated, the host crashed 2 times",
  );
  assert.equal(hostText(host([lost])), "gave up: no reply, 2 of 5 ticks acknowledged");
  const two = { ...host([job(), lost]), controllers: [...controllers, ...controllers] };
  assert.equal(hostText(two), "gave up on controller 2: no reply, 7 of 10 ticks acknowledged");
});
