/** Handles of the visible cursors A and B and flags of markers, in a strip above the chart. */
import { byId, element, fill } from "../dom.js";
import { registerCommands } from "../shell/commands.js";
import { exactTime } from "../state/number.js";
import { endOf, shown } from "../state/time_window.js";
import { cycleAt, nudge, pixelOf } from "./timeline.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Page} Page */

/** A press that moves less than this many CSS pixels is a click. */
const CLICK_PX = 4;
/** A cursor that is dragged this far left of the plotting area is removed, in CSS pixels. */
const REMOVE_PX = 14;
/** Columns of pixels of a fast movement. */
const FAST = 10;

/**
 * @param {HTMLElement} strip
 * @param {() => {left: number, right: number}} plot  Plotting area in the strip's CSS pixels.
 * @param {Page & {snap?: (cycle: number) => Promise<number>}} page  `snap` returns the cycle to which a released cursor moves.
 */
export function createHandles(strip, plot, page) {
  const { dispatch, now } = page;
  const flags = element("div", { "aria-hidden": "true" });
  const handles = /** @type {const} */ (["a", "b"]).map((which) => ({ which, node: handle(which) }));
  strip.append(flags, ...handles.map(({ node }) => node));
  let flagged = "";

  /** @param {"a" | "b"} which */
  function handle(which) {
    const name = which.toUpperCase();
    const node = element(
      "div",
      {
        class: `handle ${which}`,
        role: "slider",
        "aria-valuenow": "0",
        tabindex: "0",
        "aria-label": `Cursor ${name}`,
        "aria-valuemin": "0",
        title: `Cursor ${name}: drag it, or use the arrow keys; Delete removes it`,
      },
      element("span", {}, name),
    );
    node.style.visibility = "hidden";
    const move = (/** @type {number | null} */ cycle) => dispatch({ type: "cursor", which, cycle });
    /** Start of the press, its distance from the line of the cursor, and whether it has moved. @type {{x: number, by: number, moved: boolean} | null} */
    let drag = null;
    const xOf = (/** @type {PointerEvent} */ event) => event.clientX - strip.getBoundingClientRect().left;
    const remove = () => {
      move(null);
      // A handle without a cursor cannot have the focus.
      /** @type {HTMLElement} */ (strip.closest('[tabindex="0"]') ?? byId("pulses")).focus();
    };

    node.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      // The view below must not be dragged.
      event.stopPropagation();
      event.preventDefault();
      node.focus();
      node.setPointerCapture(event.pointerId);
      const x = xOf(event);
      drag = { x, by: x - pixelOf(now(), plot(), now().cursors[which] ?? 0), moved: false };
    });
    node.addEventListener("pointermove", (event) => {
      event.stopPropagation();
      if (!drag) return;
      const { left, right } = plot();
      const x = xOf(event) - drag.by;
      if (!drag.moved && Math.abs(xOf(event) - drag.x) < CLICK_PX) return;
      drag.moved = true;
      const cycle = x < left - REMOVE_PX ? null : cycleAt(now(), plot(), Math.min(right, Math.max(left, x)));
      move(cycle);
      dispatch({ type: "hover", cycle });
    });
    node.addEventListener("pointerup", async (event) => {
      event.stopPropagation();
      const { moved = false } = drag ?? {};
      drag = null;
      if (!moved) return;
      dispatch({ type: "hover", cycle: null });
      const cycle = now().cursors[which];
      const snapped = cycle === null ? null : await page.snap?.(cycle);
      if (typeof snapped === "number" && now().cursors[which] === cycle) move(snapped);
    });
    node.addEventListener("pointercancel", () => {
      drag = null;
      dispatch({ type: "hover", cycle: null });
    });
    const by = (/** @type {number} */ columns) => () => nudge(page, plot(), which, columns);
    registerCommands(node, "Handle of a cursor", [
      { keys: ["ArrowLeft", "ArrowDown"], text: "move the cursor left", run: by(-1) },
      { keys: ["ArrowRight", "ArrowUp"], text: "move the cursor right", run: by(1) },
      { keys: ["Shift+ArrowLeft", "PageDown"], text: "move it far to the left", run: by(-FAST) },
      { keys: ["Shift+ArrowRight", "PageUp"], text: "move it far to the right", run: by(FAST) },
      { keys: ["Home"], text: "move to the start of the visible time", run: () => move(Math.ceil(shown(now()).start)) },
      { keys: ["End"], text: "move to its end", run: () => move(Math.floor(shown(now()).end)) },
      { keys: ["Delete", "Backspace"], text: "remove it", run: remove },
    ]);
    return node;
  }

  /** @param {State} state */
  function render(state) {
    const { start, end } = shown(state);
    const clock = state.result?.summary.clock_hz ?? 1;
    const { a, b } = state.cursors;
    for (const { which, node } of handles) {
      const cycle = state.cursors[which];
      const isVisible = cycle !== null && cycle >= start && cycle <= end;
      // The handle of the earlier cursor is left of its line, so that both can be dragged when they are close.
      const left = which === "a" ? b === null || (a ?? 0) <= b : a !== null && (b ?? 0) < a;
      // Not `hidden`: a handle that is dragged out of sight keeps the pointer.
      node.style.visibility = isVisible ? "" : "hidden";
      node.classList.toggle("left", left);
      if (isVisible) node.style.left = `${pixelOf(state, plot(), cycle).toFixed(1)}px`;
      node.setAttribute("aria-valuemax", String(Math.round(endOf(state))));
      node.setAttribute("aria-valuenow", String(cycle ?? 0));
      node.setAttribute("aria-valuetext", cycle === null ? "not set" : `${exactTime(cycle, clock)}, cycle ${cycle}`);
    }
    strip.classList.toggle("empty", a === null && b === null && state.markers.every((cycle) => cycle === null));
    const marks = state.markers.flatMap((cycle, digit) =>
      cycle === null || cycle < start || cycle > end
        ? []
        : [[String(digit), `${pixelOf(state, plot(), cycle).toFixed(1)}px`]],
    );
    if (flagged === String(marks)) return;
    flagged = String(marks);
    fill(
      flags,
      ...marks.map(([digit, left]) => {
        const flag = element("span", { class: "flag" }, digit);
        flag.style.left = left;
        return flag;
      }),
    );
  }
  return { render };
}
