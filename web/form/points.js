/** Reads and prints points of a curve: one pair per line, separated by comma, semicolon, tab or spaces. */

import { mostOf } from "./schema.js";

/** @typedef {[number, number]} Point */

/** @param {Point[]} points */
export function printPoints(points) {
  return points.map((point) => point.join(", ")).join("\n");
}

/** @param {string} text @returns {{value: Point[]} | {message: string}} */
export function readPoints(text) {
  const lines = text.replace(/^\ufeff/, "").split(/\r\n|\r|\n/);
  const first = lines.find((line) => line.trim() !== "") ?? "";
  const mark = [";", "\t", ","].find((mark) => first.includes(mark)) ?? /\s+/;
  const rows = lines
    .map((line) => line.trim())
    .map((line) => (line === "" ? [] : line.split(mark).map((cell) => bare(cell, mark))));
  const most = mostOf("Points", "points");
  /** @type {Point[]} */
  const value = [];
  let [time, position] = [0, 1];
  let names = true;
  for (const [index, cells] of rows.entries()) {
    if (cells.length === 0) continue;
    const head = names && cells.every((cell) => numberIn(cell) === null);
    names = false;
    if (head) {
      const named = ["time_s", "position"].map((name) => cells.findIndex((cell) => cell.toLowerCase() === name));
      if (named.every((place) => place >= 0)) [time, position] = named;
      continue;
    }
    const point = [numberIn(cells[time] ?? ""), numberIn(cells[position] ?? "")];
    if (point[0] === null || point[1] === null)
      return {
        message: `Line ${index + 1}: “${lines[index].trim().slice(0, 40)}” is not a point; give time in s and position, such as 0.25, 12.5.`,
      };
    value.push([point[0], point[1]]);
    if (value.length > most) return { message: `Line ${index + 1}: more than ${most} points; give at most ${most}.` };
  }
  return { value };
}

/** A cell without quotes; beside semicolons and tabs a number may have a decimal comma. @param {string} cell @param {string | RegExp} mark */
function bare(cell, mark) {
  const text = cell
    .trim()
    .replace(/^"(.*)"$/, "$1")
    .trim()
    .replace("−", "-");
  return mark === "," ? text : text.replace(",", ".");
}

/** @param {string} text @returns {number | null} */
function numberIn(text) {
  return /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(text) && Number.isFinite(Number(text)) ? Number(text) : null;
}
