/** The summary of a run: outcome of the host, faults and timing violations, with buttons to their times. */
import { byId, element, fill } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";
import { count } from "../state/number.js";
import { selected } from "../state/queries.js";
import { hostText } from "./run_texts.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Summary} Summary */
/** @typedef {{name: string, times: number, cycle: number, row: number | null}} FaultPlace  Where a fault was raised first. */
/** @typedef {{text: string, bad?: boolean, press?: () => void}} Piece */

/** Shown around a fault, in s. */
const AROUND_S = 0.001;

/** @param {{engine: import("../engine/engine.js").Engine} & import("../state/types.js").Page} page */
export function createHealth({ engine, dispatch, now }) {
  const line = byId("health");

  /** Shows where a fault was raised first. @param {string} name */
  async function lead(name) {
    /** @type {FaultPlace[] | null} */
    const places = await engine.request("fault_places").catch(unlessDropped);
    const place = places?.find((each) => each.name === name);
    if (!place) return;
    open(place.row === null ? "pulses" : "packets");
    const around = AROUND_S * (now().result?.summary.clock_hz ?? 1);
    dispatch({ type: "window", window: { start: place.cycle - around, end: place.cycle + around } });
    dispatch({ type: "cursor", which: "a", cycle: place.cycle });
    if (place.row !== null) dispatch({ type: "packet", packet: place.row });
  }

  /** Brings a view into sight: on a narrow screen its tab, on a wide one its place. @param {string} view */
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
    const { faults, violations: broken } = controller;
    const { host } = state.result.summary;
    const lost = host?.jobs.some(({ progress }) => progress !== "done");
    /** @type {Piece[][]} */
    const groups = [host ? [{ text: hostText(state.result.summary), bad: lost }] : []];
    // A framed line mends what noise does to it.
    const bad = !host || lost;
    groups.push(
      faults.names.flatMap((name, place) => [
        { text: place === 0 ? "faults: " : ", ", bad },
        { text: name, bad, press: () => lead(name) },
      ]),
    );
    const counted = `${count(broken ?? 0)} timing ${broken === 1 ? "violation" : "violations"}`;
    if (broken === 0) groups.push([{ text: "driver timing OK" }]);
    else if (broken !== null) groups.push([{ text: counted, bad: true, press: violations }]);
    return groups
      .filter((group) => group.length > 0)
      .flatMap((group, place) => (place === 0 ? group : [{ text: " · " }, ...group]));
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
