/** Reads and prints points of a curve: one pair per line, separated by comma, semicolon, tab or spaces. */

import { maxLengthOf } from "./schema.js";

/** @typedef {[number, number]} Point */

/** @param {Point[]} points */
export function printPoints(points) {
  return points.map((point) => point.join(", ")).join("\n");
}

/** @param {string} text @returns {{value: Point[]} | {message: string}} */
export function readPoints(text) {
  const lines = text.replace(/^\ufeff/, "").split(/\r\n|\r|\n/);
  const first = lines.find((line) => line.trim() !== "") ?? "";
  const separator = [";", "\t", ","].find((each) => first.includes(each)) ?? /\s+/;
  const rows = lines
    .map((line) => line.trim())
    .map((line) => (line === "" ? [] : line.split(separator).map((cell) => normalized(cell, separator))));
  const maxPoints = maxLengthOf("Points", "points");
  /** @type {Point[]} */
  const value = [];
  let [time, position] = [0, 1];
  let isFirstRow = true;
  for (const [index, cells] of rows.entries()) {
    if (cells.length === 0) continue;
    const isHeader = isFirstRow && cells.every((cell) => numberIn(cell) === null);
    isFirstRow = false;
    if (isHeader) {
      const columns = ["time_s", "position"].map((name) => cells.findIndex((cell) => cell.toLowerCase() === name));
      if (columns.every((column) => column >= 0)) [time, position] = columns;
      continue;
    }
    const point = [numberIn(cells[time] ?? ""), numberIn(cells[position] ?? "")];
    if (point[0] === null || point[1] === null)
      return {
        message: `Line ${index + 1}: “${lines[index].trim().slice(0, 40)}” is not a point; use time in s and position, such as 0.25, 12.5.`,
      };
    value.push([point[0], point[1]]);
    if (value.length > maxPoints)
      return { message: `Line ${index + 1}: more than ${maxPoints} points; use at most ${maxPoints}.` };
  }
  return { value };
}

/** A cell without quotes and with a decimal point. Unless commas separate the cells, a number may have a decimal comma. @param {string} cell @param {string | RegExp} separator */
function normalized(cell, separator) {
  const text = cell
    .trim()
    .replace(/^"(.*)"$/, "$1")
    .trim()
    .replace("−", "-");
  return separator === "," ? text : text.replace(",", ".");
}

/** @param {string} text @returns {number | null} */
function numberIn(text) {
  return /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(text) && Number.isFinite(Number(text)) ? Number(text) : null;
}
