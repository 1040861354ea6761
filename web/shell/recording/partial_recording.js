/** Keeps the file of a partly shown recording open, so that another part can be shown. */
import { button, byId } from "../../dom.js";
import { openDialog } from "./dialog.js";
import { scenarioKey } from "./saved_recordings.js";

/** @typedef {import("../../state/types.js").Page} Page */

/** `drop` removes its button; `close` also closes the file. @type {{drop: () => void, close: () => void} | null} */
let open = null;

/** Calls back once when the experiment is replaced. Returns how to cancel that. @param {Page} page @param {() => void} onReplaced */
export function onceReplaced({ now }, onReplaced) {
  const own = scenarioKey(now().scenario);
  // The page updates this attribute whenever its experiment changes.
  const watch = new MutationObserver(() => {
    if (scenarioKey(now().scenario) === own) return;
    watch.disconnect();
    onReplaced();
  });
  watch.observe(document.documentElement, { attributeFilter: ["data-state"] });
  return () => watch.disconnect();
}

export function closeOpenFile() {
  open?.close();
  open = null;
}

/**
 * Keeps a file open until the experiment is replaced, with a button that opens its dialog again.
 * @param {Page} page @param {string} file  Its name. @param {{close: () => void}} capture @param {(dialog: import("./dialog.js").Dialog) => void} show
 */
export function holdOpen(page, file, capture, show) {
  open?.drop();
  let closeDialog = () => {};
  const again = button("Another part…", `Show another part of ${file}`, () => {
    const dialog = openDialog(() => {});
    closeDialog = dialog.close;
    show(dialog);
  });
  const stop = onceReplaced(page, closeOpenFile);
  const drop = () => {
    stop();
    again.remove();
  };
  const close = () => {
    drop();
    closeDialog();
    capture.close();
  };
  byId("on-show").append(" ", again);
  open = { drop, close };
}
