/** Keeps fields in place under focus and pointer. */
import { byId, say } from "../dom.js";

/** The hint of the field that has the focus, where it moves nothing; to a screen reader the field itself describes it. @param {HTMLElement} root */
export function showHints(root) {
  const place = byId("field-hint");
  root.addEventListener("focusin", ({ target }) => {
    const field = /** @type {Element} */ (target).closest(".field:not(.wide)");
    say(place, field?.querySelector(".hint")?.textContent ?? "");
  });
  root.addEventListener("focusout", () => say(place, ""));
}

/** The field that has the focus stays in sight when what is said under the form takes room from it. @param {HTMLElement} scroller */
export function keepFocusInSight(scroller) {
  let height = scroller.clientHeight;
  new ResizeObserver(() => {
    const before = height;
    height = scroller.clientHeight;
    const active = document.activeElement;
    const becameLower = height < before && scroller.scrollHeight > height;
    if (!becameLower || !active || !scroller.contains(active)) return;
    const [field, sight] = [active.getBoundingClientRect(), scroller.getBoundingClientRect()];
    // What the user had scrolled away from stays away.
    if (field.top >= sight.top && field.bottom <= sight.top + before) active.scrollIntoView({ block: "nearest" });
  }).observe(scroller);
}

/**
 * Whether the pointer is pressed on the form: what is computed meanwhile is drawn when it is let go, so that nothing
 * moves between press and release. A select opens at the press, and what ends it is not always told.
 * @param {HTMLElement} root @param {() => void} draw
 */
export function createPointerHold(root, draw) {
  let holds = false;
  /** Who waits for the release. @type {(() => void)[]} */
  const waiting = [];
  root.addEventListener("pointerdown", ({ target }) => {
    holds = !(/** @type {Element} */ (target).closest("select"));
  });
  // A click comes after its release.
  const free = () =>
    setTimeout(() => {
      if (!holds) return;
      holds = false;
      draw();
      for (const go of waiting.splice(0)) go();
    });
  for (const event of ["pointerup", "pointercancel", "keydown", "blur"]) window.addEventListener(event, free);
  const released = async () => {
    if (holds) await new Promise((/** @type {(value?: any) => void} */ go) => waiting.push(go));
  };
  return { holds: () => holds, released };
}
