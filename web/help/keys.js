/** The dialog of keys (key_list.js), and the F1 key. */
import { byId, setText } from "../dom.js";
import { registerCommands } from "../shell/commands.js";
import { explain } from "./card.js";

/** @param {() => Promise<unknown>} load  Loads parts of the page that have keys. */
export function createKeys(load) {
  const dialog = /** @type {HTMLDialogElement} */ (byId("keys"));
  const list = async () => {
    try {
      (await import("./key_list.js")).listKeys();
    } catch {
      setText(byId("keys-list"), "The keys could not be loaded. Check the network and open this again.");
    }
  };
  const open = () => {
    if (dialog.open) return;
    list();
    dialog.showModal();
    load().then(list, () => {});
  };
  byId("help").addEventListener("click", open);
  byId("keys-close").addEventListener("click", () => dialog.close());
  // The button that opened it is in a closed menu.
  dialog.addEventListener("close", () => {
    if (document.activeElement === document.body) byId("more").focus();
  });
  // A click outside the content has the dialog as its target.
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close();
  });
  registerCommands(document, "Help", [
    {
      keys: ["F1"],
      text: "explain the focused field, or show this help",
      run: () => {
        const active = document.activeElement;
        if (!active || !explain(active)) open();
      },
    },
  ]);
  registerCommands(byId("views"), "Any view", [
    {
      keys: ["?"],
      text: "show this help",
      run: (event) => (/** @type {Element} */ (event.target).matches("input, textarea") ? false : open()),
    },
  ]);
}
