import assert from "node:assert/strict";
import { test } from "node:test";
import { ALL, choicesOf, entriesOf, groupsOf, isFirstVisit, PAPERS } from "../../web/state/gallery.js";

const preset = (id, task, paper, note = "One. Two.\nTry it.", extra = {}) => ({
  id,
  task,
  paper,
  view: "tmotion",
  title: `Title of ${id}`,
  scenario: JSON.stringify({ note, ...extra }),
});
const presets = [
  preset("turn", "Motion", "Song 2021: exact S-curve"),
  preset("noise", "Packets", null, "Noise of 1.5 % on the line. More.\nTry it."),
  preset("stall", "Motor", "Song 2021: exact S-curve", "It stalls", { plant: { threshold_a: 2 } }),
  preset("chip", "Driver timing", null, "A DRV8825.\nTry"),
];
const entries = entriesOf(presets, [{ title: "Rig", note: "" }]);
const ids = (groups) => groups.map(({ title, entries }) => [title, ...entries.map(({ id }) => id)]);

test("one line is the first sentence, which a number does not end", () => {
  assert.deepEqual(
    entries.slice(1, 5).map(({ text }) => text),
    ["One.", "Noise of 1.5 % on the line.", "It stalls", "A DRV8825."],
  );
});

test("saved experiments come first, recordings last and say that they are imported", () => {
  assert.equal(entries[0].id, "own:Rig");
  const recordings = entries.slice(-2);
  assert.ok(recordings.every(({ task, text }) => task === "Recordings" && text.includes("import dialog")));
});

test("the choices are all groups, then the papers", () => {
  assert.deepEqual(choicesOf(entries), [
    ALL,
    "My experiments",
    "Motion",
    "Packets",
    "Motor",
    "Driver timing",
    "Recordings",
    PAPERS,
  ]);
});

/** @type {[string, string, any[]][]} choice, search, groups with the ids of their entries */
const rows = [
  [ALL, "noise", [["Packets", "noise"]]],
  [ALL, "SONG  turn", [["Motion", "turn"]]],
  [ALL, "threshold_a", [["Motor", "stall"]]],
  [ALL, "rig", [["My experiments", "own:Rig"]]],
  [ALL, "no such thing", []],
  ["Motion", "", [["Motion", "turn"]]],
  ["Motion", "stall", []],
  [PAPERS, "", [["Song 2021: exact S-curve", "turn", "stall"]]],
];
for (const [choice, search, expected] of rows)
  test(`${choice}, searched for "${search}"`, () => assert.deepEqual(ids(groupsOf(entries, choice, search)), expected));

test("every entry is in one group of all", () => {
  const all = groupsOf(entries, ALL, "").flatMap((group) => group.entries);
  assert.deepEqual(all.map(({ id }) => id).sort(), entries.map(({ id }) => id).sort());
});

test("a first visit has no saved work, no guide and no link", () => {
  const first = { guided: false, saved: false, fragment: "" };
  assert.ok(isFirstVisit(first));
  assert.ok(isFirstVisit({ ...first, fragment: "#views" }));
  for (const other of [{ guided: true }, { saved: true }, { fragment: "#c=3.z.abc" }])
    assert.ok(!isFirstVisit({ ...first, ...other }), JSON.stringify(other));
});
