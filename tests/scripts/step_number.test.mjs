import assert from "node:assert/strict";
import { test } from "node:test";
import { hasSlider, limitsIn, limitsOf, sliderStep } from "../../web/form/limits.js";
import { added, placeAt, scrubPlace, stepped } from "../../web/state/step_number.js";

/** A text with `|` for its caret after one step. */
function step(marked, by) {
  const caret = marked.indexOf("|");
  const next = stepped(marked.replace("|", ""), caret, by);
  return next && `${next.text.slice(0, next.caret)}|${next.text.slice(next.caret)}`;
}

test("the digit before the cursor is stepped, and the unit stays", () => {
  const rows = [
    ["12.5| mm", 1, "12.6| mm"],
    ["12|.5 mm", 1, "13|.5 mm"],
    ["12.|5 mm", -1, "11|.5 mm"],
    ["1|2.5 mm", 1, "2|2.5 mm"],
    ["|12.5 mm", 1, "2|2.5 mm"],
    ["12.5 mm|", 10, "13.5| mm"],
    ["1.2k|", 1, "1.3|k"],
    ["1|.2k", 10, "11|.2k"],
    ["500ms|", 1, "501|ms"],
    ["5|00ms", -1, "4|00ms"],
    ["-0.05|", 1, "-0.04|"],
    ["-0.05|", -10, "-0.15|"],
    ["-0.05|", 10, "0.05|"],
    ["−1|", 2, "1|"],
    ["0.9|", 1, "1.0|"],
    ["99|", 1, "100|"],
    ["2,5|", 1, "2,6|"],
    [".5|", 1, "0.6|"],
    ["3\u202f200|", 1, "3201|"],
    ["3| 200", 1, "4|200"],
    ["1e3|", 1, "2|e3"],
    ["0.1|", 2, "0.3|"],
  ];
  for (const [text, by, expected] of rows) assert.equal(step(text, by), expected, `${text} by ${by}`);
  for (const text of ["|", "mm|", "1,234,567|", `${"9".repeat(41)}|`]) assert.equal(step(text, 1), null, text);
});

test("a step keeps its place when the digit disappears", () => {
  const zero = stepped("100", 1, -1);
  assert.deepEqual(zero, { text: "0", caret: 1, place: 2 });
  assert.equal(stepped(zero.text, zero.caret, 1, zero.place).text, "100");
});

test("scrubbing steps by one to ten percent of the value", () => {
  const rows = [
    ["3200", false, 2],
    ["0.4", false, -2],
    ["12.5 mm", false, 0],
    ["1.2k", false, -1],
    ["500ms", false, 1],
    ["-0.05", false, -3],
    ["0", false, -1],
    ["5", true, 0],
    ["0", true, 0],
  ];
  for (const [text, integer, expected] of rows) assert.equal(scrubPlace(text, integer), expected, text);
  assert.equal(added("0.4", -2, 3), "0.43");
  assert.equal(added("500ms", 1, -7), "430ms");
  assert.equal(added("0", -1, -3), "-0.3");
  assert.equal(placeAt("none", 1), null);
});

test("limits follow from the range of a field, and a short range has a slider", () => {
  assert.deepEqual(limitsIn("10^-6 to 86400"), { min: 1e-6, max: 86400 });
  assert.deepEqual(limitsIn("-360 to 360"), { min: -360, max: 360 });
  for (const text of ["", "1 to `clock_hz`", "up to 16", "10 to 10^7, limited by the pulse times"])
    assert.deepEqual(limitsIn(text), {}, text);
  const ramp = { key: "ramp_s", kind: "number", range: "0 to half of the duration; below 10^-9 it counts as 0" };
  const scenario = { move: { duration_s: 0.4, ramp_s: 0.1 } };
  assert.deepEqual(limitsOf(ramp, "move.ramp_s", scenario), { min: 0, max: 0.2 });
  assert.equal(limitsOf(ramp, "move.ramp_s", {}).max, Infinity);
  const rows = [
    [ramp, true],
    [{ kind: "integer", range: "1 to 127" }, true],
    [{ kind: "integer", range: "0 to 1" }, false],
    [{ kind: "integer", range: "0 to 254" }, false],
    [{ kind: "number", range: "0 to 1" }, true],
    [{ kind: "number", range: "10^-6 to 86400" }, false],
    [{ kind: "text", range: "up to 120 characters" }, false],
    [{ kind: "quantity" }, false],
  ];
  for (const [field, expected] of rows) assert.equal(hasSlider({ key: "", ...field }), expected, JSON.stringify(field));
  assert.deepEqual([sliderStep({ min: 0, max: 0.2 }, false), sliderStep({ min: 1, max: 9 }, true)], [0.001, 1]);
});
