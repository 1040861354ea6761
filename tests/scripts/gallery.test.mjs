import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
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
  preset("stall", "Motor", "Song 2021: exact S-curve", "It stalls", {
    plant: { threshold_a: 2, sensor: "hall sensor" },
  }),
  preset("chip", "Driver timing", null, "A DRV8825.\nTry"),
];
const entries = entriesOf(presets, [{ title: "Rig", note: "" }]);
const ids = (groups) => groups.map(({ title, entries }) => [title, ...entries.map(({ id }) => id)]);

test("the line is the first sentence; a number does not end it", () => {
  assert.deepEqual(
    entries.slice(1, 5).map(({ text }) => text),
    ["One.", "Noise of 1.5 % on the line.", "It stalls", "A DRV8825."],
  );
});

test("saved experiments come first, recordings last, labeled as imported", () => {
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
  [ALL, "threshold_a", []],
  [ALL, "hall sensor", [["Motor", "stall"]]],
  [ALL, "rig", [["My experiments", "own:Rig"]]],
  [ALL, "no such thing", []],
  ["Motion", "", [["Motion", "turn"]]],
  ["Motion", "stall", []],
  [PAPERS, "", [["Song 2021: exact S-curve", "turn", "stall"]]],
];
for (const [choice, search, expected] of rows)
  test(`${choice}, searched for "${search}"`, () => assert.deepEqual(ids(groupsOf(entries, choice, search)), expected));

test("the search finds texts of the real scenarios, not their keys", () => {
  const folder = new URL("../../core/scenario/presets/", import.meta.url);
  const real = readdirSync(folder).map((file) => {
    const scenario = readFileSync(new URL(file, folder), "utf8");
    return {
      id: file.replace(".json", ""),
      task: "Motion",
      paper: null,
      view: "",
      title: JSON.parse(scenario).title,
      scenario,
    };
  });
  assert.ok(real.length >= 40);
  const all = entriesOf(real, []);
  const found = (search) => groupsOf(all, ALL, search).flatMap((group) => group.entries.map(({ id }) => id));
  for (const [search, max, ...some] of [
    ["noise", 6, "framed-noisy-line"],
    ["glitches", 4, "glitches-and-breaks"],
    ["drv8825", 2, "driver-timing-broken"],
    ["motor", 24, "song-2021-motor", "patent-2019-four-motors"],
    ["capture", 3, "recorded-step-table", "recorded-late-packet"],
  ]) {
    const ids = found(search);
    for (const id of some) assert.ok(ids.includes(id), `${search} does not find ${id}: ${ids}`);
    assert.ok(ids.length <= max, `${search} finds ${ids}`);
  }
});

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
