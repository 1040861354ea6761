import assert from "node:assert/strict";
import { test } from "node:test";
import * as costs from "../../web/views/study/compare_costs.js";
import { comparedRows, distortion, durationRows, figureRows } from "../../web/views/study/measure_rows.js";
import * as motor from "../../web/views/study/motor_findings.js";
import * as torque from "../../web/views/study/torque_report.js";

const NBSP = "\u00a0";
const THIN = "\u202f";

test("a kind of motion is recognized by its parts, whatever its numbers", () => {
  const rows = [
    [{ cosine: { duration_s: 1 } }, "cosine"],
    [{ points: { interpolation: "bezier", points: [] } }, "points bezier"],
    [{ ramps: { shape: "sine", method: "area" } }, "ramps area sine"],
  ];
  for (const [move, expected] of rows) assert.equal(costs.kindOf(move), expected);
  assert.ok(costs.isSame({ a: 0.1 + 0.2, distance: 1 }, { a: 0.3, distance: 2 }));
  assert.ok(!costs.isSame({ a: 0.3 }, { a: 0.301 }));
  assert.ok(!costs.isSame({ a: { b: 1 } }, { a: null }));
});

test("an applied motion keeps the distance of the move", () => {
  const before = { ramps: { distance: { mm: 5 } } };
  assert.deepEqual(costs.replacement({ cosine: { distance: 1, ramp_s: 2 } }, before), {
    cosine: { distance: { mm: 5 }, ramp_s: 2 },
  });
  assert.deepEqual(costs.replacement({ points: { points: [] } }, before), { points: { points: [] } });
});

test("the compared move is within the axis and has its own duration and ramp", () => {
  const moves = [{ cosine: { duration_s: 0.4, ramp_s: 0.1 } }, { bezier: {} }];
  const axis = { json: "", path: "p", controller: 0, axis: 0, moves };
  const state = { derived: { controllers: [{ axes: [{ moves: [{ steps: 8 }, { steps: 9, duration_s: 2 }] }] }] } };
  const first = costs.subjectOf(state, axis, 0);
  assert.deepEqual([first.duration_s, costs.ownRamp(first), first.steps], [0.4, 0.1, 8]);
  const last = costs.subjectOf(state, axis, 7);
  assert.deepEqual([last.index, last.duration_s, costs.ownRamp(last)], [1, 2, 0.5]);
  assert.match(costs.aboutText(last, 0), /^Axis 0, move 2: 9 steps in 2 s; it has no ramp, so enter one/);
  assert.match(costs.aboutText({ ...last, steps: 0 }, 0), /ends where it starts/);
});

test("a ramp is refused only if all kinds refuse it for the same reason", () => {
  const refused = [
    { why: "too long", move: { cosine: {} } },
    { why: "other", move: { points: {} } },
  ];
  assert.equal(costs.whyRampRefused(refused), "too long");
  assert.equal(costs.whyRampRefused([...refused, { why: null, move: { ramps: {} } }]), "");
  assert.equal(costs.whyRampRefused([{ why: null, move: { cosine: {} } }]), "");
});

test("a jump of speed makes acceleration and jerk infinite", () => {
  const cost = { speed: 1000, jump: 0, acceleration: 5, jerk: 6, acceleration_jump: 0, torque: null };
  const cells = (more) =>
    costs.cellsOf({ ...cost, time_error_s: 0, last_step_s: 0.4, ...more }, 0.4).map(({ text }) => text);
  assert.deepEqual(cells({}), [`1${THIN}000`, "5", "6", "no motor", "none", "400 ms"]);
  assert.deepEqual(cells({ jump: 50 }).slice(1, 3), [`unbounded, jumps by 50${NBSP}steps/s`, "unbounded"]);
  assert.equal(cells({ acceleration_jump: 7 })[2], `unbounded, jumps by 7${NBSP}steps/s²`);
  assert.equal(cells({ time_error_s: 0.004 })[4], "4 ms (1 %)");
  const least = { needed_mn_m: -30, available_mn_m: 20, at_s: 0.1 };
  const [, , , lacking] = costs.cellsOf({ ...cost, torque: { is_met: false, least } }, 1);
  assert.deepEqual([lacking.text, lacking.mark], ["✕ 150 %", "error"]);
});

test("the resonance map is divided into pieces without gap or overlap", () => {
  const pieces = motor.resonancePieces({ json: "{}", controller: 0, channel: 2, channels: 4 });
  let next = motor.MAP.from;
  let rates = 0;
  for (const [, , channel, from, rung, number] of pieces) {
    assert.deepEqual([channel, from], [2, next]);
    next += rung * number;
    rates += number;
  }
  assert.equal(rates, motor.MAP_RATES);
  assert.equal(next - motor.MAP.rung, motor.MAP.to);
});

test("the motor of the study is that of the selected channel, if its controller is there", () => {
  const scenario = { bus: { channels: 2 }, controllers: [{ bus: { channels: 1 } }] };
  const state = { scenario, validation: { scenario: "{}" }, axis: 1 };
  assert.equal(motor.subjectOf({ ...state, result: null }).channel, 1);
  const second = motor.subjectOf({ ...state, result: { controller: 1 } });
  assert.deepEqual([second.controller, second.channel], [1, 0]);
  assert.match(motor.subjectText(second), /^Motor of channel 0 of controller 2 alone/);
  assert.equal(motor.subjectOf({ ...state, result: { controller: 2 } }), null);
});

test("limits state the rate of maximum oscillation and whether it is at the map's edge", () => {
  const found = { ...motor.noFindings(), start: 1234.5, oscillation: [1, 3, 2], loses: [0, 1, 1] };
  const rows = motor.limitRows(found);
  assert.deepEqual(rows[0][1], `1${THIN}234 steps/s`);
  assert.deepEqual(rows[1][1], "below 500 steps/s");
  assert.deepEqual(rows[2], ["Maximum oscillation at", "24 full steps/s"]);
  assert.equal(rows[4][1], "2 of 3");
  assert.equal(
    motor.limitRows({ ...found, oscillation: [3, 2, 1] })[2][0],
    "Maximum oscillation at the edge of the map",
  );
  assert.equal(motor.limitRows(motor.noFindings()).length, 2);
});

test("a measured settling time is applied to the bus of its controller", () => {
  const step = { reached_cycles: 40 };
  assert.deepEqual(motor.settleEdit({ step }, 0), { path: "bus.settle_cycles", value: 40 });
  assert.equal(motor.settleEdit({ step }, 2).path, "controllers[1].bus.settle_cycles");
  assert.equal(motor.settleEdit({ step: { reached_cycles: null } }, 0), null);
  assert.equal(motor.settleEdit({ step: null }, 0), null);
});

test("pulses that are staggered already keep the scenario's settling time", () => {
  const pair = (phasing) => {
    const json = JSON.stringify({ bus: { pulse_phasing: phasing, settle_cycles: 7 } });
    return motor.pairPieces({ json, controller: 0 }, 99).map(([text]) => JSON.parse(text).bus);
  };
  assert.deepEqual(pair("simultaneous"), [
    { pulse_phasing: "simultaneous", settle_cycles: 7 },
    { pulse_phasing: "staggered", settle_cycles: 99 },
  ]);
  assert.equal(pair("staggered")[1].settle_cycles, 7);
});

test("a run that cannot be compared has a reason", () => {
  const state = { validation: { cost: { over_budget: true } }, approved: -1, revision: 0, scenario: { source: {} } };
  assert.match(motor.whyNoPair(state, 1), /one motor/);
  assert.match(motor.whyNoPair(state, 2), /start it to compare/);
  assert.equal(motor.whyNoPair({ ...state, approved: 0 }, 2), "");
  const supply = (above_a, below_a) => ({ above_a, below_a });
  assert.match(motor.pairText([supply(0.4, 0.2), supply(0.1, 0.2)]), /, 2 times less\.$/);
  assert.match(motor.pairText([supply(null, null), supply(1, 1)]), /at least eight steps/);
});

test("an extent leaves space around the values and ignores gaps", () => {
  assert.deepEqual(motor.extent([[0, Number.NaN, 100]]), { min: -8, max: 108 });
  assert.deepEqual(motor.extent([[5]]), { min: 4, max: 6 });
  assert.deepEqual(motor.extent([[]]), { min: -0.08, max: 1.08 });
});

test("shortages of rate and of torque are reported together", () => {
  assert.equal(torque.shortageText({ over_working_rate: null, total: 0 }), "");
  assert.match(torque.shortageText({ over_working_rate: 2000, total: 2 }), /working rate.*in 2 intervals/);
  assert.match(torque.shortageText({ over_working_rate: null, total: 1 }), /^⚠ Too little torque in one interval/);
});

test("the table of ramps distinguishes limits of rate and of torque", () => {
  const ramp = { index: 0, duration_s: 1, longest_s: null, too_fast: false, room_s: 0.5, enough_s: [0.1, 0.2] };
  const cells = (more) => torque.rampRows({ ramps: [{ ...ramp, ...more }] })[0];
  assert.deepEqual(cells({}), ["1, 1 s", "0.1000 to 0.2000 s", "any", "0.5000 s"]);
  assert.equal(cells({ enough_s: null, too_fast_s: [0, 1] })[1], "all above the working rate");
  assert.equal(cells({ enough_s: null, without_ramps: true })[1], "without ramps only; with ramps none");
  assert.equal(cells({ too_fast: true })[2], "too fast");
});

test("a motor without current is not reported as having full torque", () => {
  const report = { standing_mn_m: 100, load_mn_m: 10, torque_rate: null, working_rate: null, least: null, jump: 0 };
  const first = (corner_rate) => torque.motorRows({ ...report, corner_rate })[0][0];
  assert.deepEqual([first(0), first(500)], ["Torque at standstill", "Full torque"]);
  assert.match(torque.stepsText(3, "", { least: {} }), /torque of its motor/);
  assert.match(torque.stepsText(3, "", { least: null }), /has no steps/);
});

test("distortion is shown of a periodic motion of the selected axis only", () => {
  const pulses = {
    periodic: true,
    order: 7,
    fundamental_hz: 2,
    thd_position: 0.01,
    thd_speed: 0.02,
    thd_acceleration: 0.03,
    thd_acceleration_filtered: null,
  };
  const found = distortion({ axis: 1, ideal: null, pulses }, 1);
  assert.match(found.note, /^To harmonic 7 of 2 Hz/);
  assert.deepEqual(found.rows[0].slice(0, 3), ["position", "–", "1 %"]);
  assert.equal(found.rows.length, 3);
  assert.equal(
    distortion({ axis: 1, ideal: null, pulses: { ...pulses, thd_acceleration_filtered: 1 } }, 1).rows.length,
    4,
  );
  assert.equal(distortion({ axis: 0, ideal: null, pulses }, 1), null);
  assert.equal(distortion({ axis: 1, ideal: null, pulses: { ...pulses, periodic: false } }, 1), null);
  assert.equal(distortion(null, 0), null);
});

test("measures print missing numbers as a dash and small means as zero", () => {
  const comparison = { correlation: null, uncorrelated: null, largest_at_s: 0, points: 3 };
  const errors = { largest_at_s: 0, mean_s: 1e-12, rms_s: 1e-3, largest_s: null };
  const rows = comparedRows({
    steps: comparison,
    ticks: comparison,
    pulses: comparison,
    step_errors: errors,
    tick_errors: errors,
  });
  const row = (name) => rows.find(([each]) => each === name);
  assert.equal(row("correlation")[1], "–");
  assert.equal(row("mean time error")[1], "0 s");
  const lengths = { requested_s: 1, planned_s: 1, plan_error_s: 0, last_due_s: null, last_pulse_s: 1, end_error_s: 0 };
  const duration = durationRows({ duration: lengths, counts: { due: 5, actual: 5, stray: 0 } });
  assert.equal(duration.find(([name]) => name === "last step due")[1], "–");
  assert.equal(figureRows({ steps: 12345, shortest_interval_s: null })[0][1], `12${THIN}345`);
});
