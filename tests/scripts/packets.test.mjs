import assert from "node:assert/strict";
import { test } from "node:test";
import { COLUMNS, columnWidths, isHighlighted, meaningOf } from "../../web/views/packets/columns.js";
import { bitsText, rangeText } from "../../web/views/packets/packet_texts.js";

const widest = { index: 30, time: 80, gap: 60, outcome: 90, bytes: 400, meaning: 300 };

test("a wide table shows all bytes and the gap", () => {
  assert.deepEqual(columnWidths(widest, 1200, false), { isTight: false, bytes: 400, outcome: 90 });
});

test("the bytes of a frame get the space left by its meaning", () => {
  assert.equal(columnWidths(widest, 800, true).bytes, 800 - 30 - 80 - 60 - 90 - 300);
  assert.equal(columnWidths(widest, 800, false).bytes, (800 - 30 - 80 - 60 - 90) / 2);
});

test("in a narrow table the gap is hidden first, and the outcome shrinks last", () => {
  const narrow = columnWidths(widest, 360, false);
  assert.ok(narrow.isTight);
  assert.deepEqual([narrow.bytes, narrow.outcome], [96, 90]);
  const least = columnWidths(widest, 260, false);
  assert.deepEqual([least.bytes, least.outcome], [80, 52]);
});

test("a row is highlighted by its packet or by its time", () => {
  const row = { index: 4, start_cycle: 100, line_end_cycle: 200 };
  const rows = [
    [null, false],
    [{ packet: 4, start: 0, end: 0 }, true],
    [{ packet: 5, start: 150, end: 160 }, false],
    [{ packet: null, start: 150, end: 160 }, true],
    [{ packet: null, start: 200, end: 300 }, false],
    [{ packet: null, start: 50, end: 100 }, false],
  ];
  for (const [highlighted, expected] of rows) assert.equal(isHighlighted(row, highlighted), expected);
});

test("cells state the kind of a row, and the tooltip the reason", () => {
  const row = {
    index: 1234,
    start: "5",
    hex: "0a",
    kind: "frame",
    fields: "",
    short: "bad",
    outcome: "dropped",
    why: "CRC",
    gap: "",
  };
  const cells = COLUMNS.map((column) => column(row));
  assert.deepEqual(cells, [["1\u202f234"], ["5"], ["0a"], ["→ frame"], ["bad", "dropped: CRC"], ["–"]]);
  assert.equal(meaningOf({ kind: "packet", fields: "ch0 +7" }), "ch0 +7");
  assert.equal(meaningOf({ kind: "reply", fields: "ACK" }), "← ACK");
});

test("bits of a field are explained, also where the pointer is", () => {
  const bits = [
    { high: 7, low: 7, levels: "1", name: "direction", value: "right" },
    { high: 6, low: 0, levels: "0000101", name: "steps", value: "5" },
  ];
  const [address, command] = [
    { name: "address", from: 0, until: 1, value: "1", bits: [] },
    { name: "ch0", from: 1, until: 2, value: "+5", bits },
  ];
  const meaning = "bit 7 = 1: direction right, bits 6–0 = 0000101: steps 5";
  assert.equal(bitsText(command), meaning);
  assert.equal(bitsText(address), "");
  const row = { hex: "01 85", layout: [address, command], byte_cycles: [0, 10], byte_length: 10 };
  assert.equal(rangeText(row, 1, 1, 1e6), `byte 1 · 85 · ${meaning} · 10 µs to 20 µs`);
  assert.equal(rangeText(row, 0, 0, 1e6), "byte 0 · 01 · bits 0000\u20090001 · 0 s to 10 µs");
});
