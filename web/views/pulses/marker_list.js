/** The table of markers. */
import { button, byId, element, fill } from "../../dom.js";
import { count, time } from "../../state/number.js";
import { goToMarker } from "../../time/timeline.js";

/** @param {Element} body  Of the table. @param {import("../../state/types.js").Page} page */
export function listMarkers(body, { dispatch, now }) {
  const { markers, cursors, result } = now();
  const clock = result?.summary.clock_hz ?? 1;
  const set = markers
    .flatMap((cycle, digit) => (cycle === null ? [] : [{ digit, cycle }]))
    .sort((one, other) => one.cycle - other.cycle);
  const timeSince = (/** @type {number | undefined | null} */ from, /** @type {number} */ to) =>
    from === null || from === undefined ? "–" : time((to - from) / clock);
  const remove = (/** @type {number} */ digit) => {
    dispatch({ type: "marker", digit, cycle: null });
    const next = body.querySelector("button");
    (next ?? byId("marker-set")).focus();
  };
  fill(
    body,
    ...set.map(({ digit, cycle }, index) =>
      element(
        "tr",
        {},
        element(
          "td",
          {},
          button(String(digit), `Show marker ${digit}`, () => goToMarker({ dispatch, now }, digit)),
        ),
        ...[
          time(cycle / clock),
          count(cycle),
          timeSince(set[index - 1]?.cycle, cycle),
          timeSince(cursors.a, cycle),
        ].map((text) => element("td", { class: "number" }, text)),
        element(
          "td",
          {},
          button("×", `Remove marker ${digit}`, () => remove(digit)),
        ),
      ),
    ),
  );
}
