/** The entries of the gallery: presets, recordings and saved experiments, their groups, and the search. */

/** @typedef {import("./types.js").Preset} Preset */
/**
 * @typedef {object} Entry
 * @property {string} id
 * @property {string} title
 * @property {string} text   One line about it.
 * @property {string} task   Its group.
 * @property {string | null} paper
 * @property {string} words  More text that the search finds.
 * @property {Preset} [preset]
 * @property {import("./types.js").Scenario} [saved]  A scenario that the user saved.
 *
 * @typedef {{title: string, entries: Entry[]}} Group
 */

/** Title of all groups, and of the groups by paper. */
export const ALL = "All";
export const PAPERS = "Papers";

const RECORDING_WORDS = "capture recording logic analyzer VCD sigrok CSV";
/** @type {Entry[]} */
const RECORDINGS = [
  {
    id: "recorded-step-table",
    title: "A step table on an ATmega328P",
    text: "Opens the import dialog: recorded pulses, compared with their plan.",
    task: "Recordings",
    paper: null,
    words: RECORDING_WORDS,
  },
  {
    id: "recorded-late-packet",
    title: "A packet that arrives too late",
    text: "Opens the import dialog: a recorded line with a pause.",
    task: "Recordings",
    paper: null,
    words: RECORDING_WORDS,
  },
];

/** The first sentence of a note. @param {string} note */
const firstSentence = (note) => /^[^\n]*?[.](?=\s|$)/.exec(note)?.[0] ?? note.split("\n")[0];

/** The strings in a JSON value, without its keys: those are the same in every scenario. @param {any} value @returns {string[]} */
function stringsOf(value) {
  if (typeof value === "string") return [value];
  return value !== null && typeof value === "object" ? Object.values(value).flatMap(stringsOf) : [];
}

/** @param {Preset[]} presets @param {import("./types.js").Scenario[]} saved @returns {Entry[]} */
export function entriesOf(presets, saved) {
  return [
    ...saved.map((each) => ({
      id: `own:${each.title}`,
      title: each.title,
      text: firstSentence(each.note ?? ""),
      task: "My experiments",
      paper: null,
      words: stringsOf(each).join(" "),
      saved: each,
    })),
    ...presets.map((preset) => {
      const { id, title, task, paper } = preset;
      const scenario = JSON.parse(preset.scenario);
      const words = stringsOf(scenario).join(" ");
      return { id, title, text: firstSentence(scenario.note), task, paper, words, preset };
    }),
    ...RECORDINGS,
  ];
}

/** The choices above the entries. @param {Entry[]} entries */
export const choicesOf = (entries) => [ALL, ...new Set(entries.map(({ task }) => task)), PAPERS];

/** The entries of a choice that contain all words of the search, in groups. @param {Entry[]} entries @param {string} choice @param {string} search @returns {Group[]} */
export function groupsOf(entries, choice, search) {
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  /** @type {Map<string, Entry[]>} */
  const groups = new Map();
  for (const entry of entries) {
    const group = choice === PAPERS ? entry.paper : entry.task;
    if (group === null || (choice !== PAPERS && choice !== ALL && choice !== group)) continue;
    const { id, title, text, task, paper, words: more } = entry;
    const content = [id, title, text, task, paper, more].join(" ").toLowerCase();
    if (words.every((word) => content.includes(word))) groups.set(group, [...(groups.get(group) ?? []), entry]);
  }
  return [...groups].map(([title, entries]) => ({ title, entries }));
}

/** Whether the starter cards are offered: nothing is saved, the guide was neither started nor declined, and no link is open. @param {{guided: boolean, saved: boolean, fragment: string}} visit */
export const isFirstVisit = ({ guided, saved, fragment }) => !guided && !saved && !/^#[^#]*=/.test(fragment);
