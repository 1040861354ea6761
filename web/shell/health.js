/**
 * How a run went, in a line: what became of the host's orders, faults, and what a driver could not have followed. Faults
 * and violations are buttons that lead to their place.
 */
import { byId, element, fill } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";
import { count } from "../state/number.js";
import { selected } from "../state/state.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Summary} Summary */
/** @typedef {{name: string, times: number, cycle: number, row: number | null}} FaultPlace  Where a fault was raised first. */
/** @typedef {string | {text: string, press: () => void}} Piece */

/** Shown around a fault, in s. */
const AROUND_S = 0.001;

/** @param {{engine: import("../engine/engine.js").Engine} & import("../state/types.js").Page} page */
export function createHealth({ engine, dispatch, now }) {
  const line = byId("health");

  /** Shows where a fault was raised first. @param {string} name */
  async function lead(name) {
    /** @type {FaultPlace[] | null} */
    const places = await engine.ask("fault_places").catch(unlessDropped);
    const place = places?.find((each) => each.name === name);
    if (!place) return;
    const around = AROUND_S * (now().result?.summary.clock_hz ?? 1);
    dispatch({ type: "window", window: { start: place.cycle - around, end: place.cycle + around } });
    dispatch({ type: "cursor", which: "a", cycle: place.cycle });
    if (place.row !== null) dispatch({ type: "packet", packet: place.row });
    open(place.row === null ? "pulses" : "packets");
  }

  /** Brings a view into sight: on a narrow screen its tab, on a wide one its place. @param {string} view */
  function open(view) {
    dispatch({ type: "view", view });
    byId(`view-${view}`).scrollIntoView({ block: "nearest" });
  }

  function violations() {
    dispatch({ type: "side", side: "timing" });
    open("timing");
  }

  /** @param {State} state @returns {Piece[]} */
  function pieces(state) {
    const controller = selected(state);
    if (!state.result || !controller) return [];
    const { faults, violations: broken } = controller;
    const said = state.result.summary.host ? outcome(state.result.summary) : "";
    /** @type {Piece[]} */
    const all = said ? [said, SEPARATOR] : [];
    for (const [place, name] of faults.names.entries())
      all.push(place === 0 ? "faults: " : ", ", { text: name, press: () => lead(name) });
    if (faults.names.length > 0) all.push(SEPARATOR);
    if (broken === 0) all.push("driver timing met");
    else if (broken !== null)
      all.push({ text: `${count(broken)} timing ${broken === 1 ? "violation" : "violations"}`, press: violations });
    return all.at(-1) === SEPARATOR ? all.slice(0, -1) : all;
  }

  /** @param {State} state */
  function render(state) {
    const all = pieces(state);
    const text = all.map((piece) => (typeof piece === "string" ? piece : piece.text)).join("");
    line.classList.toggle("error", ill(state));
    if (line.textContent === text) return;
    line.title = text;
    const made = all.map((piece) => {
      if (typeof piece === "string") return piece;
      const link = element("button", { type: "button", title: `Show where: ${piece.text}` }, piece.text);
      link.addEventListener("click", piece.press);
      return link;
    });
    fill(line, ...made);
  }

  return { render };
}

const SEPARATOR = " · ";

/** Whether something went wrong that nothing made good. A framed line mends what noise does to it. @param {State} state */
function ill(state) {
  const controller = selected(state);
  const host = state.result?.summary.host;
  const failed = host
    ? host.jobs.some(({ progress }) => progress !== "done")
    : Boolean(controller?.faults.names.length);
  return failed || Boolean(controller?.violations);
}

/** What became of the orders on a framed line. @param {Summary} summary */
function outcome({ host, controllers }) {
  if (!host) return "";
  const { jobs, repeated, crashes } = host;
  const sum = (/** @type {number[]} */ numbers) => numbers.reduce((a, b) => a + b, 0);
  const lost = jobs.filter(({ progress }) => progress === "given_up");
  const ticks = sum(jobs.map((job) => job.ticks));
  const acknowledged = sum(jobs.map((job) => job.acknowledged));
  const parts = [];
  if (lost.length > 0) {
    // The others' names would say nothing where there is one controller only.
    const names =
      controllers.length > 1
        ? lost.map(({ controller, why }) => `on controller ${controller + 1}: ${why}`)
        : [`: ${lost[0].why}`];
    parts.push(`gave up${controllers.length > 1 ? " " : ""}${names.join(", ")}`);
  }
  if (jobs.every(({ progress }) => progress === "done")) parts.push(`all ${count(ticks)} ticks done`);
  else parts.push(`${count(acknowledged)} of ${count(ticks)} ticks acknowledged`);
  if (repeated > 0) parts.push(`${count(repeated)} ${repeated === 1 ? "frame" : "frames"} repeated`);
  if (crashes > 0) parts.push(`the host crashed ${crashes === 1 ? "once" : `${count(crashes)} times`}`);
  return parts.join(", ");
}
