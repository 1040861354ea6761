import assert from "node:assert/strict";
import { test } from "node:test";
import { mapFor, parseMaps, withMap } from "../../web/shell/recording/channel_maps.js";
import { lastCycle, MAX_BYTES, makeRoom, sizeOf } from "../../web/shell/recording/record_limits.js";
import { emptyBaud, hasMap, needsRate, requestOf, shownFields } from "../../web/shell/recording/request.js";
import * as texts from "../../web/shell/recording/texts.js";

const LEVELS = { has_levels: true, has_bytes: false, has_times: true, channels: ["a"] };
const BYTES = { has_levels: false, has_bytes: true, has_times: false, channels: ["a"] };

test("fields depend on the file and on the channels with a serial line", () => {
  const none = { hasLine: false, hasPlan: true, isPart: false, choosesPart: false, isCompared: true };
  const rows = [
    [LEVELS, {}, { part: false, choosePart: true, compare: true, align: true, baud: false, uart: false }],
    [LEVELS, { hasLine: true }, { baud: true, uart: true }],
    [LEVELS, { isPart: true }, { part: true, choosePart: false, compare: false, align: false }],
    [LEVELS, { choosesPart: true }, { part: true, choosePart: false, compare: true }],
    [LEVELS, { isCompared: false }, { compare: true, align: false }],
    [LEVELS, { hasPlan: false }, { compare: false, align: false }],
    [BYTES, {}, { baud: true, uart: false }],
  ];
  for (const [facts, more, expected] of rows) {
    const shown = shownFields(facts, { ...none, ...more });
    for (const [name, value] of Object.entries(expected))
      assert.equal(shown[name], value, `${name} of ${JSON.stringify(more)}`);
  }
});

test("the file decides which options are required", () => {
  assert.deepEqual(
    [needsRate(LEVELS), needsRate({ ...LEVELS, has_times: false }), needsRate(BYTES)],
    [false, true, false],
  );
  assert.deepEqual([emptyBaud(LEVELS), emptyBaud(BYTES)], ["measured", "required"]);
  assert.deepEqual([hasMap(LEVELS), hasMap(BYTES), hasMap({ ...BYTES, channels: ["a", "b"] })], [true, false, true]);
});

test("a request has the fields that are shown and filled", () => {
  const values = { map: "STEP0=#0", clock: 0, rate: 24e6, baud: 9600, uart: "8N1", from_s: 0, to_s: null };
  const all = { map: true, rate: true, baud: true, uart: true };
  const request = requestOf(values, all);
  assert.deepEqual(request, { map: "STEP0=#0", sample_rate_hz: 24_000_000n, baud: 9600, uart: "8N1", from_s: 0 });
  assert.deepEqual(requestOf({ ...values, map: "", from_s: null }, { map: true }), {});
});

test("the last channel map of the same names is found, and old ones are dropped", () => {
  assert.deepEqual(parseMaps(null), []);
  assert.deepEqual(parseMaps("{broken"), []);
  assert.deepEqual(parseMaps('{"a":1}'), []);
  let maps = withMap([], ["a"], "STEP0=#0");
  maps = withMap(maps, ["a"], "DIR0=#0");
  assert.deepEqual([mapFor(maps, ["a"]), mapFor(maps, ["b"]), maps.length], ["DIR0=#0", null, 1]);
  for (let i = 0; i < 40; i++) maps = withMap(maps, [`channel ${i}`], "");
  assert.deepEqual([maps.length, mapFor(maps, ["a"])], [30, null]);
});

test("the newest recordings stay as far as they fit", () => {
  const saved = (id, bytes) => ({ id, file: "", scenario: "", sizes: [bytes] });
  const small = [saved("1", 16), saved("3", 16), saved("2", 16)];
  assert.deepEqual(makeRoom(small, saved("4", 16)), { staying: ["2", "3"], leaving: ["1"] });
  const large = makeRoom(small, saved("4", MAX_BYTES - 20));
  assert.deepEqual(large, { staying: ["3"], leaving: ["2", "1"] });
  assert.deepEqual(makeRoom([{ id: "1" }], saved("2", 16)).leaving, ["1"]);
  assert.equal(sizeOf({ sizes: [1, 2], replies: new Uint8Array(3) }), 6);
});

test("saved records are accepted only with rising cycles and levels of 36 signals", () => {
  const piece = (...records) => {
    const words = new Uint32Array(records.flatMap(([cycle, upper = 0]) => [cycle, 0, 0, upper]));
    return new Uint8Array(words.buffer);
  };
  assert.equal(lastCycle(piece([1], [5]), 32, -1), 5);
  assert.equal(lastCycle(piece([1], [5]), 32, 1), null);
  assert.equal(lastCycle(piece([5], [5]), 32, -1), null);
  assert.equal(lastCycle(piece([1, 0x10]), 16, -1), null);
  assert.equal(lastCycle(piece([1]), 32, -1), null);
  assert.equal(lastCycle(piece([1]).subarray(0, 8), 8, -1), null);
  assert.equal(lastCycle("text", 16, -1), null);
});

const COMPARISON = {
  kind: "steps",
  recorded: 100,
  model: 100,
  differing: 0,
  largest: { step: 7, late_s: 0, recorded_s: 0.5 },
  rms_s: 0,
  drift_ppm: -0.01,
  largest_jitter_s: 0,
  rms_jitter_s: 0,
  outliers: 0,
  other_values: 0,
  missing: 0,
  extra: 0,
  differences: { count: 0 },
  rows: [],
};

test("a comparison reports drift only between clocks that are close", () => {
  const text = texts.comparisonText(COMPARISON, 0);
  assert.match(text, /^Compared with the baseline: all 100 steps compared, 0 differ/);
  assert.match(text, /no deviation; RMS 0 s\. Drift 0\.0 ppm/);
  assert.doesNotMatch(texts.comparisonText({ ...COMPARISON, drift_ppm: 60_000 }, 0), /Drift/);
  assert.match(texts.comparisonText({ ...COMPARISON, outliers: 1 }, 0), /, 1 outlier excluded\.$/);
});

test("a comparison names the alignment, the worst step and the first differences", () => {
  const rows = ["a", "b", "c", "d"].map((text) => ({ text }));
  const found = { ...COMPARISON, kind: "bytes", missing: 2, extra: 1, differences: { count: 9 }, rows };
  const text = texts.comparisonText(
    { ...found, largest: { step: 3, late_s: -1e-6, recorded_s: 0 }, other_values: 4 },
    5,
  );
  assert.match(text, /, aligned by byte 5: 100 bytes, the baseline has 100, 2 missing, 1 extra; the others compared/);
  assert.match(text, /byte 3 \(the first is 0\) has the maximum deviation, 1 µs early, 4 with another value/);
  assert.match(text, / a; b; c; 9 differences in total\./);
});

test("the location of the worst step has the step in its middle and stays in the run", () => {
  const run = { summary: { clock_hz: 1000, end_cycle: 100_000 }, controller: 1 };
  const largest = { step: 3, late_s: 1, recorded_s: 50 };
  const location = texts.worstLocation({ ...COMPARISON, largest }, run);
  assert.deepEqual([location.cycle, location.controller], [50_000, 1]);
  assert.equal(location.start + location.end, 100_000);
  const early = texts.worstLocation({ ...COMPARISON, largest: { ...largest, recorded_s: 0 } }, run);
  assert.equal(early.start, 0);
});

test("the message of an import says what the views show", () => {
  const imported = {
    file: "a.csv",
    part: null,
    isRecorded: true,
    hasBaseline: false,
    replies: undefined,
    isShort: false,
    own: " Undo.",
  };
  assert.equal(texts.importedText(imported), "Opened a.csv. The views show the recording. Undo.");
  const bytes = (list, unknown = 0) => ({ bytes: new Uint8Array(list), unknown });
  assert.match(texts.importedText({ ...imported, replies: bytes([]) }), /TX has no bytes/);
  assert.match(
    texts.importedText({ ...imported, replies: bytes([1], 2) }),
    /recorded replies.* 2 packets on TX have no known/,
  );
  assert.match(texts.importedText({ ...imported, isRecorded: false, hasBaseline: true }), /simulation\..*baseline/);
  const part = { from_s: 1, to_s: 2, end_s: 9, records: 10, of: 90 };
  assert.match(
    texts.importedText({ ...imported, part, isShort: true }),
    /^Opened a\.csv\. Shown: 1 s to 2 s of 9 s, 10 of 90 changes;/,
  );
});

test("packets are listed up to a maximum", () => {
  assert.match(texts.packetsText({ total: 1, replies: 0, rows: [1] }), /^1 packet, 0 complete frames of the device: $/);
  assert.match(texts.packetsText({ total: 9, replies: 4, rows: [1, 2] }), /; the first 2: $/);
  const packet = {
    line: "RX",
    kind: "packet",
    start_cycle: 50,
    bytes: Array(40).fill(10),
    meaning: "",
    outcome: "taken",
  };
  const [name, at, hex, text] = texts.packetCells(packet, 100);
  assert.deepEqual([name, at, text], ["RX packet", "500 ms", "taken"]);
  assert.match(hex, /^(0a ){31}0a …$/);
  assert.equal(texts.packetsFile("take.1.vcd"), "take.1-packets.csv");
});

test("bytes go to the controllers of an experiment with the same clock", () => {
  const base = {
    clock_hz: 16e6,
    line: { baud: 1, address: 3 },
    controllers: [{ axes: [1], packets: [2], address: 4 }],
    bus: {},
  };
  const made = JSON.stringify({
    source: { line: {} },
    clock_hz: 16e6,
    line: { baud: 9600 },
    title: "t",
    note: "",
    run_cycles: 5,
  });
  const own = JSON.parse(texts.withControllers(made, base));
  assert.deepEqual(own.line, { baud: 9600, address: 3, noise: {} });
  assert.deepEqual(own.controllers, [{ axes: [], packets: [], address: 4 }]);
  assert.equal(texts.withControllers(made, { ...base, clock_hz: 8e6 }), made);
});

test("a note is cut at its maximum length, by characters", () => {
  assert.equal(texts.extendedNote("é".repeat(1998), "abcdef"), `${"é".repeat(1998)} a`);
  assert.equal(texts.sentence("the file is empty."), "The file is empty.");
});

test("figures of steps state peaks only if there are any", () => {
  const figures = { steps: 1, right: 1, left: 0, first_s: 0, last_s: 0, shortest_at_s: null };
  const none = { ...figures, greatest_rate_steps_s: null, greatest_acceleration_steps_s2: null };
  assert.equal(
    texts.stepsText({ channel: 2, figures: none }),
    "Channel 2: 1 step, 1 right and 0 left, from 0 s to 0 s.",
  );
  const some = { ...figures, greatest_rate_steps_s: 500, greatest_acceleration_steps_s2: 9 };
  assert.match(
    texts.stepsText({ channel: 2, figures: some }),
    /; maximum rate 500 steps\/s at 0 s, maximum acceleration 9 steps\/s²\.$/,
  );
});
