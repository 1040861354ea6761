/** A line between two panes, moved by pointer and keys. */
import { element } from "../dom.js";
import { registerCommands } from "./commands.js";

/** @typedef {import("./pane_layout.js").Edge} Edge */

/** Movement per key press in CSS pixels; with Shift five times as far. */
const STEP_PX = 16;

/**
 * @param {Edge} edge
 * @param {{resize: (px: number, before: number, after: number) => void, reset: (byKey: boolean) => void}} actions  `resize`: the new size of the pane before the edge, and the current sizes of both panes.
 */
export function createEdge(edge, { resize, reset }) {
  const { pane, label, upright, place } = edge;
  const node = element("div", {
    class: `edge ${upright ? "upright" : "level"}`,
    id: `edge-${pane}`,
    role: "separator",
    tabindex: "0",
    "aria-orientation": upright ? "vertical" : "horizontal",
    "aria-label": label,
    "aria-controls": pane === "form" ? "sheet" : `view-${pane}`,
    "aria-valuemin": "0",
    "aria-valuemax": "100",
    "aria-valuenow": "50",
    title: `${label}: drag, or use arrow keys; Enter or double-click: reset`,
  });
  document.querySelector(edge.after)?.before(node);
  if (place) node.style.gridArea = upright ? place.area : `${place.area} / 1 / ${place.area} / -1`;

  /** The box of the first visible element of a selector. @param {string} css */
  const boxOf = (css) =>
    [...document.querySelectorAll(css)].map((each) => each.getBoundingClientRect()).find(({ width }) => width > 0) ??
    new DOMRect();
  /** @param {DOMRect} box */
  const sizeOf = ({ width, height }) => (upright ? width : height);
  /** @param {number} px */
  const moveTo = (px) => resize(px, sizeOf(boxOf(edge.before)), sizeOf(boxOf(edge.after)));
  /** @param {number} px */
  const moveBy = (px) => moveTo(sizeOf(boxOf(edge.before)) + px);

  node.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    event.preventDefault();
    node.focus();
    node.setPointerCapture(event.pointerId);
  });
  node.addEventListener("pointermove", (event) => {
    if (!node.hasPointerCapture(event.pointerId)) return;
    const { left, top } = boxOf(edge.before);
    moveTo((upright ? event.clientX - left : event.clientY - top) - 4);
  });
  node.addEventListener("dblclick", () => reset(false));
  registerCommands(node, "Line between two panes", [
    { keys: ["ArrowLeft", "ArrowUp"], text: "make the previous pane smaller", run: () => moveBy(-STEP_PX) },
    { keys: ["ArrowRight", "ArrowDown"], text: "make the previous pane larger", run: () => moveBy(STEP_PX) },
    { keys: ["Shift+ArrowLeft", "Shift+ArrowUp"], text: "make it much smaller", run: () => moveBy(-5 * STEP_PX) },
    { keys: ["Shift+ArrowRight", "Shift+ArrowDown"], text: "make it much larger", run: () => moveBy(5 * STEP_PX) },
    { keys: ["Home"], text: "minimum size", run: () => moveTo(0) },
    { keys: ["End"], text: "maximum size", run: () => moveTo(1e6) },
    { keys: ["Enter"], text: "reset; fold or unfold the form", run: () => reset(true) },
  ]);

  /** Updates its visibility and position. @param {(css: string) => boolean} isHiddenBy  Whether a pane hides it. */
  function render(isHiddenBy) {
    node.hidden = isHiddenBy(edge.before) || isHiddenBy(edge.after);
    const [before, after] = [sizeOf(boxOf(edge.before)), sizeOf(boxOf(edge.after))];
    if (before + after > 0) node.setAttribute("aria-valuenow", String(Math.round((100 * before) / (before + after))));
  }
  return { render };
}
