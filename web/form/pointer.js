/** Keeps fields under the focus and the pointer at their positions. */
import { byId, setText } from "../dom.js";

/** Shows the hint of the focused field below the form, so that no field moves. @param {HTMLElement} root */
export function showHints(root) {
  const hint = byId("field-hint");
  root.addEventListener("focusin", ({ target }) => {
    const field = /** @type {Element} */ (target).closest(".field:not(.wide)");
    setText(hint, field?.querySelector(".hint")?.textContent ?? "");
  });
  root.addEventListener("focusout", () => setText(hint, ""));
}

/** Keeps the focused field visible when messages below the form reduce its height. @param {HTMLElement} scroller */
export function keepFocusVisible(scroller) {
  let height = scroller.clientHeight;
  new ResizeObserver(() => {
    const before = height;
    height = scroller.clientHeight;
    const active = document.activeElement;
    const shrank = height < before && scroller.scrollHeight > height;
    if (!shrank || !active || !scroller.contains(active)) return;
    const [field, visible] = [active.getBoundingClientRect(), scroller.getBoundingClientRect()];
    // Unless the user has scrolled the field out of view.
    if (field.top >= visible.top && field.bottom <= visible.top + before) active.scrollIntoView({ block: "nearest" });
  }).observe(scroller);
}

/**
 * Delays drawing while the pointer is pressed on the form, so that nothing moves between press and release. A select opens at
 * the press, and browsers do not always report its end, so it does not count.
 * @param {HTMLElement} root @param {() => void} draw  Called after the release.
 */
export function createPointerHold(root, draw) {
  let isPressed = false;
  /** Callbacks that wait for the release. @type {(() => void)[]} */
  const waiting = [];
  root.addEventListener("pointerdown", ({ target }) => {
    isPressed = !(/** @type {Element} */ (target).closest("select"));
  });
  // Only after the click event, which follows the release.
  const release = () =>
    setTimeout(() => {
      if (!isPressed) return;
      isPressed = false;
      draw();
      for (const resolve of waiting.splice(0)) resolve();
    });
  for (const event of ["pointerup", "pointercancel", "keydown", "blur"]) window.addEventListener(event, release);
  const released = async () => {
    if (isPressed) await new Promise((/** @type {(value?: any) => void} */ resolve) => waiting.push(resolve));
  };
  return { isPressed: () => isPressed, released };
}
