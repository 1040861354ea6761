/** The summary of a run: outcome of the host, faults and timing violations, with buttons to their times. */
import { byId, element, fill } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";
import { count } from "../state/number.js";
import { selected } from "../state/queries.js";
import { hostText } from "./run_texts.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Summary} Summary */
/** @typedef {{name: string, times: number, cycle: number, row: number | null}} FirstFault  The first cycle and packet row of a fault. */
/** @typedef {{text: string, bad?: boolean, press?: () => void}} Piece */

/** Time that is shown before and after a fault, in s. */
const AROUND_S = 0.001;

/** @param {{engine: import("../engine/engine.js").Engine} & import("../state/types.js").Page} page */
export function createHealth({ engine, dispatch, now }) {
  const line = byId("health");

  /** Shows where a fault was raised first. @param {string} name */
  async function showFault(name) {
    /** @type {FirstFault[] | null} */
    const faults = await engine.request("first_faults").catch(unlessDropped);
    const fault = faults?.find((each) => each.name === name);
    if (!fault) return;
    open(fault.row === null ? "pulses" : "packets");
    const around = AROUND_S * (now().result?.summary.clock_hz ?? 1);
    dispatch({ type: "window", window: { start: fault.cycle - around, end: fault.cycle + around } });
    dispatch({ type: "cursor", which: "a", cycle: fault.cycle });
    if (fault.row !== null) dispatch({ type: "packet", packet: fault.row });
  }

  /** Shows a view: opens its tab on a narrow screen, or scrolls to it on a wide one. @param {string} view */
  function open(view) {
    if (now().panes.largest) dispatch({ type: "pane", panes: { largest: null } });
    dispatch({ type: "view", view });
    byId(`view-${view}`).scrollIntoView({ block: "nearest" });
  }

  function violations() {
    dispatch({ type: "side", area: "spectrum", side: "timing" });
    open("timing");
  }

  /** @param {State} state @returns {Piece[]} */
  function pieces(state) {
    const controller = selected(state);
    if (!state.result || !controller) return [];
    const { faults, violations: violationCount } = controller;
    const { host } = state.result.summary;
    const lost = host?.jobs.some(({ progress }) => progress !== "done");
    /** @type {Piece[][]} */
    const groups = [host ? [{ text: hostText(state.result.summary), bad: lost }] : []];
    // On a framed line faults are repaired by repeated frames.
    const bad = !host || lost;
    groups.push(
      faults.names.flatMap((name, index) => [
        { text: index === 0 ? "faults: " : ", ", bad },
        { text: name, bad, press: () => showFault(name) },
      ]),
    );
    const counted = `${count(violationCount ?? 0)} timing ${violationCount === 1 ? "violation" : "violations"}`;
    if (violationCount === 0) groups.push([{ text: "driver timing OK" }]);
    else if (violationCount !== null) groups.push([{ text: counted, bad: true, press: violations }]);
    return groups
      .filter((group) => group.length > 0)
      .flatMap((group, index) => (index === 0 ? group : [{ text: " · " }, ...group]));
  }

  /** @param {State} state */
  function render(state) {
    const all = pieces(state);
    const text = all.map(({ text }) => text).join("");
    line.classList.toggle(
      "error",
      all.some(({ bad }) => bad),
    );
    if (line.textContent === text) return;
    line.title = text;
    const made = all.map(({ text, bad, press }) => {
      const kind = { class: bad ? "bad" : "" };
      if (!press) return element("span", kind, text);
      const link = element("button", { type: "button", title: `Show where: ${text}`, ...kind }, text);
      link.addEventListener("click", press);
      return link;
    });
    fill(line, ...made);
  }

  return { render };
}
