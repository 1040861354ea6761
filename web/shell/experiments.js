/** The panel of experiments that are saved on this device. */
import { button, byId, element, fill, setText } from "../dom.js";
import { Dropped } from "../engine/request_slots.js";
import { errorMessage } from "../state/error_message.js";
import { MAX_TITLE } from "../state/history.js";
import { readJson } from "../state/json.js";
import { counted, si } from "../state/number.js";
import { save } from "./save.js";
import { loadExperiments, saveExperiments } from "./storage.js";

/** @typedef {import("../state/types.js").Scenario} Scenario */

/** Key that marks a file of experiments. */
const FILE = "stepscope_experiments";
const FILE_NAME = "stepscope-experiments.json";
/** Maximum bytes of such a file. */
const MAX_FILE = 32 << 20;

/** @typedef {{newExperiment: string, engine: import("../engine/engine.js").Engine, problemText: import("./open_file.js").ProblemText} & import("../state/types.js").Page} Given  `newExperiment` is JSON. */

/** @param {Given} page @param {{close: () => void, open: (saved: Scenario) => void}} panel */
export function createExperiments({ newExperiment, engine, problemText, dispatch, now }, { close, open }) {
  const name = /** @type {HTMLInputElement} */ (byId("experiment-name"));
  const saveButton = /** @type {HTMLButtonElement} */ (byId("experiment-save"));
  const list = byId("experiment-list");
  const about = byId("experiment-about");
  const exportAll = /** @type {HTMLButtonElement} */ (byId("experiments-export"));
  const chooser = /** @type {HTMLInputElement} */ (byId("experiments-file"));

  name.addEventListener("input", show);
  name.addEventListener("keydown", (event) => {
    if (event.key === "Enter") saveAs();
  });
  saveButton.addEventListener("click", saveAs);
  byId("experiment-new").addEventListener("click", () => {
    dispatch({ type: "replace", scenario: readJson(newExperiment), origin: "own" });
    close();
  });
  exportAll.addEventListener("click", exportFile);
  byId("experiments-import").addEventListener("click", () => chooser.click());
  chooser.addEventListener("change", async () => {
    const [file] = chooser.files ?? [];
    chooser.value = "";
    if (!file) return;
    setText(
      about,
      file.size > MAX_FILE
        ? `${file.name} has ${si(file.size, "B", 3)}; use at most ${si(MAX_FILE, "B", 3)}.`
        : await importExperiments(await file.text(), engine, problemText),
    );
    show();
  });

  function saveAs() {
    const title = name.value.trim();
    if (title === "") {
      setText(about, "The name is missing; enter one.");
      return name.focus();
    }
    const scenario = { ...now().scenario, title };
    if (now().scenario.title !== title) dispatch({ type: "edit", path: "title", value: title });
    if (!saveExperiments([...loadExperiments().filter((each) => each.title !== title), scenario]))
      return setText(about, "The browser cannot save here (private window or no space left). Export it as a file.");
    setText(about, `Saved on this device as “${title}”.`);
    return show();
  }

  /** @param {Scenario} removed */
  function remove(removed) {
    const { title } = removed;
    saveExperiments(loadExperiments().filter((each) => each.title !== title));
    const back = button("Restore", `Restore ${title}`, () => {
      saveExperiments([...loadExperiments().filter((each) => each.title !== title), removed]);
      setText(about, `“${title}” is restored.`);
      show();
      name.focus();
    });
    fill(about, `“${title}” is removed. `, back);
    show();
    back.focus();
  }

  function exportFile() {
    save(FILE_NAME, "application/json", [JSON.stringify({ [FILE]: 1, experiments: loadExperiments() }, null, 1)]);
    setText(about, `Saved ${FILE_NAME}.`);
  }

  function show() {
    const saved = loadExperiments();
    const title = name.value.trim();
    setText(saveButton, saved.some((each) => each.title === title) ? "Replace" : "Save");
    exportAll.disabled = saved.length === 0;
    fill(
      list,
      ...saved.map((each) =>
        element(
          "li",
          {},
          button(each.title, `Open ${each.title}`, () => {
            open(each);
            close();
          }),
          button("✕", `Remove ${each.title}`, () => remove(each)),
        ),
      ),
    );
  }

  function onOpen() {
    saveButton.disabled = false;
    setText(about, "");
    show();
  }

  return { onOpen };
}

/** Adds the experiments of a file to the saved ones; duplicate names get a number. @param {string} text @param {import("../engine/engine.js").Engine} engine @param {Given["problemText"]} problemText @returns {Promise<string>}  The result as text. */
async function importExperiments(text, engine, problemText) {
  try {
    const file = readJson(text);
    if (!Array.isArray(file?.experiments) || !(FILE in file))
      return "This is not a file of experiments; choose one from “Export all”. Use “Open…” for a single experiment.";
    const saved = loadExperiments();
    const invalid = [];
    for (const each of file.experiments) {
      const { problems, scenario } = await engine.request("check", JSON.stringify(each));
      const read = readJson(scenario);
      if (problems.length > 0) invalid.push(`“${read.title}” (${problemText(problems[0])})`);
      else if (!saved.some((known) => JSON.stringify(known) === JSON.stringify(read)))
        saved.push({ ...read, title: freeName(read.title || "experiment", saved) });
    }
    if (!saveExperiments(saved)) return "The browser cannot save here (private window or no space left).";
    const not = invalid.length > 0 ? ` Not imported: ${invalid.join("; ")}.` : "";
    return `${counted(file.experiments.length - invalid.length, "experiment")} imported.${not}`;
  } catch (error) {
    if (error instanceof Dropped) return "The engine was restarted; import the file again.";
    return `This file cannot be read: ${errorMessage(error)}`;
  }
}

/** @param {string} title @param {Scenario[]} saved */
function freeName(title, saved) {
  const isUsed = (/** @type {string} */ name) => saved.some((each) => each.title === name);
  let name = title;
  for (let number = 2; isUsed(name); number++) {
    const tail = ` (${number})`;
    name = [...title].slice(0, MAX_TITLE - tail.length).join("") + tail;
  }
  return name;
}
