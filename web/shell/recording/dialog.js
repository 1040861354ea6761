/** The modal dialog of a recording: its body, its buttons and how it closes. */
import { button, element } from "../../dom.js";

/** @typedef {ReturnType<typeof openDialog>} Dialog */

/** @param {() => void} release  Called when the dialog closes, unless its file is still needed. */
export function openDialog(release) {
  const close = (isNeeded = false) => {
    if (!isNeeded) release();
    dialog.close();
    dialog.remove();
  };
  const body = element("div", {});
  const cancel = button("Cancel", "Cancel: do not open the file", () => close());
  const foot = element("p", { class: "named" }, cancel);
  const dialog = element("dialog", { class: "recording", "aria-label": "Recording" }, body, foot);
  dialog.addEventListener("cancel", () => close());
  document.body.append(dialog);
  dialog.showModal();
  return { body, foot, close, isOpen: () => dialog.open };
}
