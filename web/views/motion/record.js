/** The data table of the motion charts, fifty rows per page. */
import { button, byId, element, fill, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { short, time } from "../../state/number.js";
import { shown } from "../../state/time_window.js";
import { bandsOf, QUANTITIES, unitFor } from "./bands.js";
import { requestColumns } from "./request_columns.js";

/** @typedef {import("../../state/types.js").State} State */

const ROWS = 50;
const PAGES = 10;

/** @param {{engine: import("../../engine/engine.js").Engine, now: () => State}} page */
export function createRecord({ engine, now }) {
  const fold = /** @type {HTMLDetailsElement} */ (byId("motion-data"));
  let at = 0;
  const go = (/** @type {number} */ by) => {
    at = Math.min(PAGES - 1, Math.max(0, at + by));
    void show(now());
  };
  const [previous, next] = [button("⇤", "Earlier rows", () => go(-1)), button("⇥", "Later rows", () => go(1))];
  byId("record-buttons").append(previous, next);
  fold.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !fold.open) return;
    fold.open = false;
    fold.querySelector("summary")?.focus();
  });

  /** @param {State} state */
  async function show(state) {
    if (!fold.open || !state.result) return;
    const { start, end } = shown(state);
    const page = (end - start) / PAGES;
    const span = { start: start + at * page, end: start + (at + 1) * page };
    const seen = await requestColumns(engine, { ...state, difference: false }, span, ROWS, "record").catch(
      unlessDropped,
    );
    if (!seen) return;
    const bands = QUANTITIES.flatMap((quantity) =>
      bandsOf(state, { ...seen, apart: null }, quantity)
        .reverse()
        .map((band) => ({ ...band, quantity })),
    );
    const head = ["time", ...bands.map(({ name, quantity }) => `${quantity}, ${name}, ${unitFor(state, quantity)}`)];
    fill(byId("record-head"), ...head.map((text) => element("th", { scope: "col", class: "number" }, text)));
    fill(
      byId("record-rows"),
      ...[...seen.columns.x].map((seconds, row) =>
        element(
          "tr",
          {},
          element("th", { scope: "row", class: "number" }, time(seconds)),
          ...bands.map(({ min, max }) =>
            element(
              "td",
              { class: "number" },
              min[row] === max[row] ? short(min[row]) : `${short(min[row])} … ${short(max[row])}`,
            ),
          ),
        ),
      ),
    );
    say(
      byId("record-page"),
      `Rows ${at * ROWS + 1} to ${(at + 1) * ROWS} of ${ROWS * PAGES}; each row is a 500th of the visible time, with its minimum and maximum.`,
    );
    previous.disabled = at === 0;
    next.disabled = at === PAGES - 1;
  }

  return { render: (/** @type {State} */ state) => void show(state) };
}
