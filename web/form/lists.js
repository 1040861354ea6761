/** Fields with lists: whole numbers, segments and points. */
import { button, element } from "../dom.js";
import { WHOLE, whole } from "../state/json.js";
import { parseNumber } from "../state/parse_number.js";
import { printPoints, readPoints } from "./points.js";
import { printSegments, readSegments } from "./segments.js";

/**
 * @typedef {object} List
 * @property {(value: any) => string} print
 * @property {(text: string) => {value: any} | {message: string}} read
 * @property {(label: string, setText: (text: string) => void, showError: (message: string) => void) => Node[]} [tools]  Buttons next to the field.
 * @typedef {{[kind: string]: List}} Lists
 */

/** @type {Lists} */
export const LISTS = {
  wholes: { print: (value) => value.join("\n"), read: readWholes },
  segments: { print: printSegments, read: readSegments },
  points: { print: printPoints, read: readPoints, tools: fileChooser },
};

/** Maximum bytes of a file whose text goes into a field. */
const MAX_FILE = 1 << 20;

/** A button that puts a file's text into a field. @param {string} label @param {(text: string) => void} setText @param {(message: string) => void} showError */
function fileChooser(label, setText, showError) {
  const file = element("input", { type: "file", accept: ".csv,.txt,.tsv,text/csv,text/plain", hidden: "" });
  file.addEventListener("change", async () => {
    const [selected] = file.files ?? [];
    file.value = "";
    if (!selected) return;
    if (selected.size > MAX_FILE)
      return showError(`${selected.name} has ${selected.size} bytes; use at most ${MAX_FILE}.`);
    try {
      setText(await selected.text());
    } catch {
      showError(`${selected.name} cannot be read; choose another file.`);
    }
  });
  return [button("Choose CSV…", `Choose a CSV for ${label}`, () => file.click()), file];
}

/** Reads one whole number per line, with all digits. @param {string} text @returns {{value: (number | bigint)[]} | {message: string}} */
function readWholes(text) {
  const results = text
    .split("\n")
    .filter((line) => line.trim() !== "")
    .map((line) =>
      WHOLE.test(line.trim()) ? { value: whole(line.trim()) } : parseNumber(line, "", { integer: true }),
    );
  const wrong = results.find((each) => "message" in each);
  return wrong ?? { value: results.map((each) => ("value" in each ? each.value : 0)) };
}
