/** While the device dialog is open: Escape stops the device, and the browser asks before the user leaves the page. */

/**
 * @param {import("./session.js").LiveSession} session @param {HTMLDialogElement} dialog
 * @param {{isInFront: () => boolean, pressStop: () => void, stop: () => void}} actions  `stop` only ends the stream: a page that is being left has no time for more.
 * @returns {() => void}  Removes the guards.
 */
export function guardPage(session, dialog, { isInFront, pressStop, stop }) {
  const listening = new AbortController();
  const { signal } = listening;
  // Escape stops a moving device before it closes any dialog; while streaming, wherever the focus is.
  window.addEventListener(
    "keydown",
    (event) => {
      if (event.key !== "Escape" || !(session.running === "stream" || (session.mayMove && isInFront()))) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      pressStop();
    },
    { capture: true, signal },
  );
  window.addEventListener(
    "beforeunload",
    (event) => {
      if (session.running !== null) event.preventDefault();
    },
    { signal },
  );
  window.addEventListener(
    "pagehide",
    () => {
      if (session.running === "stream") stop();
    },
    { signal },
  );
  dialog.addEventListener("cancel", (event) => {
    if (session.running === null && !session.mayMove) return;
    event.preventDefault();
    if (session.mayMove) pressStop();
  });
  return () => listening.abort();
}
