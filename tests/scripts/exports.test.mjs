import assert from "node:assert/strict";
import { test } from "node:test";
import { exportOffers, partsOf, sizeOf, statusOf } from "../../web/shell/export_offers.js";
import { baseName, between } from "../../web/shell/offers.js";
import { initial } from "../../web/state/initial.js";
import { update } from "../../web/state/update.js";

const controller = { channels: 1, records: 1234, violations: null };
const summary = { end_cycle: 1000, end_s: 2, clock_hz: 500, controllers: [controller] };
const validation = { problems: [], scenario: "{}", derived: null };
const start = initial({ title: "Übung: one turn", source: { motion: { engine: "ticks" } } });
const ran = (more = {}) =>
  [
    { type: "validated", revision: 0, validation },
    { type: "done", revision: 0, ms: 1, summary: { ...summary, ...more } },
  ].reduce(update, start);
const names = (state, span = null) =>
  exportOffers(state, {}, span).flatMap(({ offers }) => offers.map(({ name }) => name));

test("files are named after the experiment", () => {
  assert.equal(baseName(start), "ubung-one-turn");
  assert.equal(baseName({ scenario: { title: "…" } }), "stepscope");
  assert.equal(baseName({ scenario: { title: `${"a".repeat(39)} b` } }), "a".repeat(39));
});

test("before a run only the scenario is offered", () => {
  assert.deepEqual(names(start), []);
  assert.deepEqual(names(update(start, { type: "validated", revision: 0, validation })), ["ubung-one-turn.json"]);
  assert.equal(statusOf(start), "There is no run yet.");
});

test("a run is offered as signals, tables and a line script", () => {
  const base = "ubung-one-turn";
  const ends = [".vcd", "-edges.csv", ".trace", "-ticks.csv", "-harmonics.csv", ".json", "-line.json"];
  assert.deepEqual(
    names(ran()),
    ends.map((end) => base + end),
  );
  assert.equal(statusOf(ran()), "");
  assert.match(statusOf(update(ran(), { type: "edit", path: "x", value: 1 })), /earlier experiment/);
});

test("names of files state their part and their controller", () => {
  const two = ran({ controllers: [controller, { ...controller, violations: 3 }] });
  const second = update(two, { type: "controller", controller: 1 });
  const found = names(second, { start: 10, end: 20 });
  assert.ok(found.includes("ubung-one-turn-controller-2-10-20.vcd"));
  assert.ok(found.includes("ubung-one-turn-controller-2-violations.csv"));
  assert.ok(!names(two).some((name) => name.endsWith("-violations.csv")));
});

test("segments have lists in place of ticks, and a panel has neither", () => {
  const of = (source) => names({ ...ran(), scenario: { source } });
  assert.ok(of({ segments: {} }).includes("stepscope-segments.csv"));
  const panel = of({ standalone: [] });
  assert.ok(!panel.some((name) => /-(segments|ticks)\.csv$|-line\.json$/.test(name)));
});

test("the part between the cursors can be saved separately", () => {
  assert.equal(between({ cursors: { a: 5, b: 5 } }), null);
  const span = between({ cursors: { a: 750, b: 250 } });
  assert.deepEqual(span, { start: 250, end: 750 });
  assert.deepEqual(partsOf(ran(), span), [
    ["whole", "the whole run, 2 s"],
    ["cursors", "between A and B, 1 s"],
  ]);
  assert.deepEqual(partsOf(start, null), [["whole", "the whole run"]]);
});

test("a long file is fetched in pieces and kept in blobs", async () => {
  const calls = [];
  const engine = {
    async request(...question) {
      calls.push(question);
      const from = question.at(-1);
      return { bytes: new Uint8Array(10), next: from < 19 ? from + 1 : null, rows: 20 };
    },
  };
  const [signals] = exportOffers(ran(), engine, { start: 1, end: 9 });
  const paces = [];
  const parts = await signals.offers[0].make((part) => paces.push(part));
  assert.deepEqual(calls[0], ["file_piece", "vcd", 0, 1, 9, 0]);
  assert.deepEqual([parts.length, sizeOf(parts), sizeOf(["abc", new Uint8Array(2)])], [2, 200, 5]);
  assert.equal(paces.at(-1), 1);
  await assert.rejects(
    signals.offers[0].make(() => {
      throw new Error("left off");
    }),
    /left off/,
  );
});
