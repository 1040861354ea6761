import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { createRunner, nextStep } from "../../web/shell/runner.js";
import { initial } from "../../web/state/initial.js";
import { update } from "../../web/state/update.js";

const validation = { problems: [], warnings: [], scenario: "{}", derived: null, cost: null };
const summary = { end_cycle: 10, clock_hz: 1, controllers: [{ channels: 1 }] };

/** A runner with its own state, and its requests to the engine. */
function bench() {
  const calls = [];
  const made = { state: initial({ title: "turn" }), calls, blocked: 0 };
  const dispatch = (message) => {
    made.state = update(made.state, message);
  };
  made.dispatch = dispatch;
  made.runner = createRunner({
    engine: {
      latest: async (...question) => {
        calls.push(question[1]);
        return validation;
      },
      run: (revision) => calls.push(`run ${revision}`),
      cancel: (revision) => calls.push(`cancel ${revision}`),
      revive: () => calls.push("revive"),
    },
    dispatch,
    now: () => made.state,
    blocked: () => {
      made.blocked += 1;
    },
    started: () => calls.push("started"),
  });
  return made;
}

test("a scenario waits for its validation, runs once, and stops for problems", () => {
  const start = initial({});
  const of = (more) => update(start, { type: "validated", revision: 0, validation: { ...validation, ...more } });
  const rows = [
    [start, -1, "wait"],
    [of({}), -1, "run"],
    [of({}), 0, "done"],
    [of({ problems: [{ path: "", message: "" }] }), -1, "blocked"],
    [of({ cost: { over_budget: true } }), -1, "blocked"],
  ];
  for (const [state, ran, expected] of rows) assert.equal(nextStep(state, ran), expected);
});

test("a validation is assigned to the revision that requested it", async () => {
  const { runner, calls, dispatch, ...made } = bench();
  await runner.validate();
  assert.deepEqual(calls, ["check"]);
  assert.equal(made.blocked, 0);
});

test("typing runs once after a pause if runs are long, and at once if they are short", async () => {
  for (const [ms, expected] of [
    [300, ["run 0", "run 3"]],
    [10, ["run 0", "run 1", "run 2", "run 3"]],
  ])
    assert.deepEqual(await runsWhileTyping(ms), expected);
});

/** The runs of three changes with 50 ms between them, after a run of `ms`. */
async function runsWhileTyping(ms) {
  mock.timers.enable({ apis: ["setTimeout"] });
  const made = bench();
  await made.runner.validate();
  made.runner.plan();
  mock.timers.tick(0);
  made.dispatch({ type: "done", revision: 0, summary, ms });
  for (const value of [1, 2, 3]) {
    made.dispatch({ type: "edit", path: "title", value });
    await made.runner.validate();
    made.runner.plan();
    mock.timers.tick(50);
  }
  mock.timers.tick(1000);
  const runs = made.calls.filter((call) => call.startsWith("run"));
  made.runner.plan();
  mock.timers.tick(1000);
  assert.equal(made.calls.filter((call) => call.startsWith("run")).length, runs.length);
  mock.timers.reset();
  return runs;
}

test("a run without progress is shown as planning", async () => {
  mock.timers.enable({ apis: ["setTimeout"] });
  const made = bench();
  await made.runner.validate();
  made.runner.plan();
  mock.timers.tick(0);
  assert.equal(made.state.run.progress, null);
  mock.timers.tick(100);
  assert.deepEqual(made.state.run.progress, { done: false, cycle: 0, end_cycle: 0, records: 0 });
  mock.timers.reset();
});

test("a crashed scenario is not tried again by itself, but on request", async () => {
  mock.timers.enable({ apis: ["setTimeout"] });
  const made = bench();
  await made.runner.validate();
  made.runner.giveUp();
  made.runner.plan();
  mock.timers.tick(1000);
  assert.deepEqual(made.calls, ["check"]);
  made.runner.retry();
  made.runner.plan();
  mock.timers.tick(0);
  assert.deepEqual(made.calls, ["check", "revive", "check", "started", "run 0"]);
  mock.timers.reset();
});

test("a canceled run keeps the last result", () => {
  const made = bench();
  made.runner.cancel();
  assert.deepEqual(made.calls, ["cancel 0"]);
  assert.match(made.state.run.message, /^The run was canceled/);
});
