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
 * @property {(label: string, put: (text: string) => void, refuse: (message: string) => void) => Node[]} [tools]  Buttons next to the field.
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

/** A button that puts a file's text into a field. @param {string} label @param {(text: string) => void} put @param {(message: string) => void} refuse */
function fileChooser(label, put, refuse) {
  const file = element("input", { type: "file", accept: ".csv,.txt,.tsv,text/csv,text/plain", hidden: "" });
  file.addEventListener("change", async () => {
    const [selected] = file.files ?? [];
    file.value = "";
    if (!selected) return;
    if (selected.size > MAX_FILE)
      return refuse(`${selected.name} has ${selected.size} bytes; give at most ${MAX_FILE}.`);
    try {
      put(await selected.text());
    } catch {
      refuse(`${selected.name} cannot be read.`);
    }
  });
  return [button("Choose CSV…", `Choose a CSV for ${label}`, () => file.click()), file];
}

/** One whole number a line, with every digit. @param {string} text @returns {{value: (number | bigint)[]} | {message: string}} */
function readWholes(text) {
  const read = text
    .split("\n")
    .filter((line) => line.trim() !== "")
    .map((line) =>
      WHOLE.test(line.trim()) ? { value: whole(line.trim()) } : parseNumber(line, "", { integer: true }),
    );
  const wrong = read.find((each) => "message" in each);
  return wrong ?? { value: read.map((each) => ("value" in each ? each.value : 0)) };
}
