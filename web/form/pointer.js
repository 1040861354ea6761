/** Keeps fields under the focus and the pointer at their positions. */
import { byId, setText } from "../dom.js";

/** Maximum time between the clicks of a double-click, in ms. */
const DOUBLE_CLICK_MS = 500;

/** Shows the hint of the focused field below the form, in a line of constant height, so that no field moves. @param {HTMLElement[]} roots */
export function showHints(roots) {
  const hint = byId("field-hint");
  const hasKeys = matchMedia("(hover: hover)").matches;
  const general = `Drag a label sideways to change its number${hasKeys ? ", or press ↑ or ↓ in the field; with Shift, ten steps" : ""}.`;
  const show = (/** @type {string} */ text) => {
    setText(hint, text || general);
    hint.classList.toggle("general", !text);
    hint.scrollTop = 0;
  };
  show("");
  for (const root of roots) {
    root.addEventListener("focusin", ({ target }) => {
      const field = /** @type {Element} */ (target).closest(".field:not(.wide)");
      show(field?.querySelector(".hint")?.textContent ?? "");
    });
    root.addEventListener("focusout", () => show(""));
  }
}

/** Keeps the focused field visible when messages below the form reduce its height. @param {HTMLElement} scroller */
export function keepFocusVisible(scroller) {
  let height = scroller.clientHeight;
  let pressed = -DOUBLE_CLICK_MS;
  scroller.addEventListener("pointerdown", ({ timeStamp }) => {
    pressed = timeStamp;
  });
  new ResizeObserver(() => {
    const before = height;
    height = scroller.clientHeight;
    const active = document.activeElement;
    const shrank = height < before && scroller.scrollHeight > height;
    if (!shrank || !active || !scroller.contains(active)) return;
    const [field, visible] = [active.getBoundingClientRect(), scroller.getBoundingClientRect()];
    // Unless the user has scrolled the field out of view.
    if (field.top < visible.top || field.bottom > visible.top + before) return;
    // Nothing moves between the clicks of a double-click.
    const wait = pressed + DOUBLE_CLICK_MS - performance.now();
    setTimeout(() => document.activeElement === active && active.scrollIntoView({ block: "nearest" }), wait);
  }).observe(scroller);
}

/**
 * Delays drawing while the pointer is pressed on the form, so that nothing moves between press and release. A select opens at
 * the press and the right button opens a menu; browsers do not always report their end, so they do not count.
 * @param {HTMLElement[]} roots @param {() => void} draw  Called after the release.
 */
export function createPointerHold(roots, draw) {
  let isPressed = false;
  /** Callbacks that wait for the release. @type {(() => void)[]} */
  const waiting = [];
  for (const root of roots)
    root.addEventListener("pointerdown", ({ target, button }) => {
      isPressed = button === 0 && !(/** @type {Element} */ (target).closest("select"));
    });
  // Only after the click event, which follows the release.
  const release = () =>
    setTimeout(() => {
      if (!isPressed) return;
      isPressed = false;
      draw();
      for (const resolve of waiting.splice(0)) resolve();
    });
  for (const event of ["pointerup", "pointercancel", "blur"]) window.addEventListener(event, release);
  const released = async () => {
    if (isPressed) await new Promise((/** @type {(value?: any) => void} */ resolve) => waiting.push(resolve));
  };
  return { isPressed: () => isPressed, released };
}
