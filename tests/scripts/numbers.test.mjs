import assert from "node:assert/strict";
import { test } from "node:test";
import { plain } from "../../web/state/number.js";
import { parseNumber, parseQuantity } from "../../web/state/parse_number.js";

const SPEED = { steps_s: "steps/s", mm_s: "mm/s", deg_s: "°/s", rpm: "rpm" };
const DISTANCE = { steps: "steps", mm: "mm", deg: "°" };

test("numbers are read as people type them", () => {
  const rows = [
    ["9600 bps", "baud", 9600],
    ["9600 baud", "baud", 9600],
    ["9600Baud", "baud", 9600],
    ["115.2 kbps", "baud", 115_200],
    ["1 Mbit/s", "baud", 1e6],
    ["0,5", "s", 0.5],
    ["0,500", "s", 0.5],
    ["500ms", "s", 0.5],
    ["500 ms", "s", 0.5],
    ["2.5us", "s", 2.5e-6],
    ["2.5 µs", "s", 2.5e-6],
    ["1e3", "", 1000],
    ["1e3 Hz", "Hz", 1000],
    ["16 MHz", "Hz", 16e6],
    ["−3", "", -3],
    ["1 000 000", "", 1e6],
    ["1.2k", "Hz", 1200],
    ["3 m", "mm", 3000],
    ["2,5 cm", "mm", 25],
    ["3 mm", "mm", 3],
    ["1.9 us", "ns", 1900],
    ["0.1 ms", "µs", 100],
    ["2 s", "ms", 2000],
    ["300 mNm", "mN·m", 300],
    ["0.3 N*m", "mN·m", 300],
    ["45 g cm2", "g·cm²", 45],
    ["100 uF", "µF", 100],
    ["0.1 ohm", "Ω", 0.1],
    ["90 deg", "°", 90],
    ["3 Hz/s", "Hz/s", 3],
  ];
  for (const [text, unit, expected] of rows) assert.deepEqual(parseNumber(text, unit), { value: expected }, text);
});

test("a field of cycles takes a time", () => {
  const options = { integer: true, clockHz: 16e6 };
  for (const [text, expected] of [
    ["40", 40],
    ["40 cycles", 40],
    ["2.5us", 40],
    ["500 ms", 8e6],
  ])
    assert.deepEqual(parseNumber(text, "cycles", options), { value: expected }, text);
});

test("errors state the text and what is allowed", () => {
  const rows = [
    ["", "s", /^Enter a number, such as 0\.4 or 400 ms\.$/],
    ["x", "Hz", /^“x” is not a number; enter one such as/],
    ["3 Mm", "mm", /^“Mm” is not a unit of this field; use mm\.$/],
    ["3 kg", "", /^“kg” is not a unit of this field; use a number without a unit\.$/],
    ["3 V", "cycles", /^“V” is not a unit of this field; use cycles or a time, such as 2\.5 us\.$/],
    ["1,200", "Hz", /^“1,200” can mean 1200 or 1\.200; use a number without a comma\.$/],
    ["1e999", "", /too large/],
  ];
  for (const [text, unit, expected] of rows) assert.match(parseNumber(text, unit).message, expected, text);
  const whole = parseNumber("0.4", "", { integer: true, least: 1, most: 9 });
  assert.match(whole.message, /^0\.4 is not a whole number; use 0 or 1\.$/);
});

test("a time in a field of cycles is checked like cycles", () => {
  const options = { integer: true, clockHz: 16e6 };
  assert.match(parseNumber("1e305 s", "cycles", options).message, /too large/);
});

test("several comma groups are thousands", () => {
  assert.deepEqual(parseNumber("1,234,567", "Hz"), { value: 1_234_567 });
  assert.deepEqual(parseNumber("-1,234,567.5 mm", "mm"), { value: -1_234_567.5 });
});

test("only groups of three digits are joined", () => {
  assert.deepEqual(parseNumber("12 000 Hz", "Hz"), { value: 12_000 });
  assert.match(parseNumber("5 10", "Hz").message, /^“10” is not a unit of this field; use Hz\.$/);
});

test("both code points of ohm and micro are units", () => {
  for (const ohm of ["\u03a9", "\u2126"]) assert.deepEqual(parseNumber(`5 ${ohm}`, "\u03a9"), { value: 5 });
  for (const micro of ["\u00b5", "\u03bc"]) assert.deepEqual(parseNumber(`5 ${micro}s`, "\u00b5s"), { value: 5 });
});

test("a typed unit is selected", () => {
  const rows = [
    ["10 mm/s", SPEED, "steps_s", { unit: "mm_s", value: 10 }],
    ["10mm/s", SPEED, "mm_s", { unit: "mm_s", value: 10 }],
    ["1e3 mm/s", SPEED, "steps_s", { unit: "mm_s", value: 1000 }],
    ["90 deg/s", SPEED, "steps_s", { unit: "deg_s", value: 90 }],
    ["60 rpm", SPEED, "steps_s", { unit: "rpm", value: 60 }],
    ["5 kHz", SPEED, "steps_s", { unit: "steps_s", value: 5000 }],
    ["5k", SPEED, "steps_s", { unit: "steps_s", value: 5000 }],
    ["3 m", DISTANCE, "steps", { unit: "mm", value: 3000 }],
    ["200 steps", DISTANCE, "mm", { unit: "steps", value: 200 }],
    ["90°", DISTANCE, "mm", { unit: "deg", value: 90 }],
    ["7", DISTANCE, "mm", { unit: "mm", value: 7 }],
  ];
  for (const [text, units, current, expected] of rows)
    assert.deepEqual(parseQuantity(text, units, current), expected, text);
  assert.match(
    parseQuantity("3 kg", DISTANCE, "mm").message,
    /^“kg” is not a unit of this field; use steps, mm or °\.$/,
  );
});

test("large numbers have groups of three digits, up to 1e12", () => {
  const rows = [
    [999_999_999, "999\u202f999\u202f999 steps"],
    [23_394_567_890, "23\u202f395\u202f000\u202f000 steps"],
    [-1e9, "−1\u202f000\u202f000\u202f000 steps"],
    [1.5e12, "1.5e12 steps"],
  ];
  for (const [value, text] of rows) assert.equal(plain(value, "steps"), text);
});
