/** The data table of the motion charts, fifty rows per page. */
import { button, byId, element, fill, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { short, time } from "../../state/number.js";
import { shown } from "../../state/time_window.js";
import { unitFor } from "./axis_units.js";
import { bandsOf, QUANTITIES } from "./bands.js";
import { requestColumns } from "./request_columns.js";

/** @typedef {import("../../state/types.js").State} State */

const ROWS_PER_PAGE = 50;
const PAGES = 10;

/** @param {{engine: import("../../engine/engine.js").Engine, now: () => State}} page */
export function createRecord({ engine, now }) {
  const fold = /** @type {HTMLDetailsElement} */ (byId("motion-data"));
  let page = 0;
  const go = (/** @type {number} */ by) => {
    page = Math.min(PAGES - 1, Math.max(0, page + by));
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
    const length = (end - start) / PAGES;
    const span = { start: start + page * length, end: start + (page + 1) * length };
    const request = requestColumns(engine, { ...state, difference: false }, span, ROWS_PER_PAGE, "record", false);
    const data = await request.catch(unlessDropped);
    if (!data) return;
    const bands = QUANTITIES.flatMap((quantity) =>
      bandsOf(state, { ...data, difference: null }, quantity)
        .reverse()
        .map((band) => ({ ...band, quantity })),
    );
    const head = ["time", ...bands.map(({ name, quantity }) => `${quantity}, ${name}, ${unitFor(state, quantity)}`)];
    fill(byId("record-head"), ...head.map((text) => element("th", { scope: "col", class: "number" }, text)));
    fill(
      byId("record-rows"),
      ...[...data.columns.x].map((seconds, row) =>
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
    setText(
      byId("record-page"),
      `Rows ${page * ROWS_PER_PAGE + 1} to ${(page + 1) * ROWS_PER_PAGE} of ${ROWS_PER_PAGE * PAGES}; each row covers 1/500 of the visible time, with minimum and maximum.`,
    );
    previous.disabled = page === 0;
    next.disabled = page === PAGES - 1;
  }

  return { render: (/** @type {State} */ state) => void show(state) };
}
