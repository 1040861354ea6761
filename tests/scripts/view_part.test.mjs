import assert from "node:assert/strict";
import { test } from "node:test";
import { parseView, writeView } from "../../web/shell/view_part.js";

const WHOLE = "120-4500.k1.x2.a300.b900.tpackets.stiming.umm.omotor.qphases-supply";
const SIGNS = ["0", "9", "a", "k", "Z", ".", "-", "_", "%", " ", "\u00e9", ""];

/** The whole view, each of its truncations, and each change of one character. */
function views() {
  const given = [WHOLE];
  for (let at = 0; at < WHOLE.length; at++) {
    given.push(WHOLE.slice(0, at));
    for (const sign of SIGNS) given.push(WHOLE.slice(0, at) + sign + WHOLE.slice(at + 1));
  }
  return given;
}

const isWord = (value) => /^[a-z]+$/.test(value);

/** Whether the page can show a part of a view. */
function isSound(name, value) {
  if (name === "window") return value.start < value.end && Number.isSafeInteger(value.end);
  if (name === "quantities") return value.length > 0 && value.every(isWord);
  if (name === "sides") return Object.values(value).every(isWord);
  return ["view", "unit"].includes(name) ? isWord(value) : Number.isSafeInteger(value) && value >= 0;
}

test("parsing and writing a view are inverses", () => {
  assert.equal(writeView(parseView(WHOLE)), WHOLE);
});

test("truncated and changed views only lose parts", () => {
  const given = views();
  assert.ok(given.length > 500);
  for (const text of given) {
    const view = parseView(text);
    for (const [name, value] of Object.entries(view)) assert.ok(isSound(name, value), text);
    assert.equal(writeView(parseView(writeView(view))), writeView(view), text);
  }
});

test("the charts of the motor view are words", () => {
  assert.deepEqual(parseView("qphases-supply").quantities, ["phases", "supply"]);
  for (const text of ["q", "q-", "qa--b", "qA", "q1-2"]) assert.deepEqual(parseView(text), {}, text);
});

test("an invalid view is an empty one", () => {
  const none = [undefined, "", "broken", "5-4", "1-2-3", "__proto__", "constructor", ".".repeat(9999)];
  for (const text of [...none, "99999999999999999999-1"]) assert.deepEqual(parseView(text), {}, text);
});
