import assert from "node:assert/strict";
import { test } from "node:test";
import { hasSlider, limitsIn, limitsOf, sliderRange } from "../../web/form/limits.js";
import { createScrub, isDrag } from "../../web/state/drag.js";
import { added, placeAt, scrubPlace, stepped } from "../../web/state/step_number.js";

/** A text with `|` at its cursor, after one step. */
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

test("a step from a limit that is no whole step ends at one", () => {
  const rows = [
    ["0.000001", -1, 1, "0.1"],
    ["0.000001", -1, 10, "1.0"],
    ["0.000001 s", -1, 1, "0.1 s"],
    ["0.2145", -2, -1, "0.21"],
    ["-0.2145", -2, 1, "-0.21"],
    ["86400", 0, -1, "86399"],
    ["127", 1, -1, "120"],
  ];
  for (const [text, place, by, expected] of rows) assert.equal(added(text, place, by, true), expected, text);
});

test("a press becomes a drag after some pixels, and a finger that scrolls drags nothing", () => {
  const at = (clientX, clientY, pointerType = "mouse", shiftKey = false) => ({
    clientX,
    clientY,
    pointerType,
    shiftKey,
  });
  for (const [to, expected] of [
    [at(3, 0), false],
    [at(3, 3), true],
    [at(6, 6, "touch"), false],
    [at(0, 10, "touch"), true],
  ])
    assert.equal(isDrag(at(0, 0), to), expected, JSON.stringify(to));

  const mouse = createScrub(at(0, 0));
  assert.deepEqual([at(3, 0), at(0, 9), at(8, 0), at(-8, 0)].map(mouse.move), [null, null, 2, -2]);
  // A scroll that ends in a horizontal movement.
  const scroll = createScrub(at(0, 0));
  assert.deepEqual([at(4, 40, "touch"), at(90, 41, "touch")].map(scroll.move), [null, null]);
  // The movement up to the threshold does not count.
  const touch = createScrub(at(0, 0));
  assert.deepEqual([at(11, 3, "touch"), at(15, 3, "touch"), at(35, 60, "touch")].map(touch.move), [0, 1, 6]);
});

test("Shift multiplies the movement while it is pressed", () => {
  const at = (clientX, shiftKey) => ({ clientX, clientY: 0, pointerType: "mouse", shiftKey });
  const { move } = createScrub(at(0, false));
  assert.deepEqual(
    [at(240, false), at(241, true), at(248, true), at(249, false), at(240, false)].map(move),
    [60, 62, 80, 80, 78],
  );
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
  const ranges = [
    [{ min: 0, max: 0.2 }, false, { min: 0, max: 0.2, step: 0.001 }],
    [{ min: 1, max: 9 }, true, { min: 1, max: 9, step: 1 }],
    // The steps count from 0, not from the smallest value.
    [{ min: 0.00001, max: 0.1 }, false, { min: 0, max: 0.1, step: 0.0001 }],
    [{ min: 0.3, max: 0.7 }, false, { min: 0.3, max: 0.7, step: 0.001 }],
    [{ min: 0, max: 0.21455 }, false, { min: 0, max: 0.215, step: 0.001 }],
    [{ min: -20, max: 0.5 }, false, { min: -20, max: 0.5, step: 0.1 }],
  ];
  for (const [limits, integer, expected] of ranges) assert.deepEqual(sliderRange(limits, integer), expected);
});
