/** The help in the page: every key (key_list.js), and the way to the rest. */
import { byId, say } from "../dom.js";
import { listen } from "../shell/commands.js";
import { explain } from "./card.js";

/** @param {() => Promise<unknown>} load  Loads what has keys of its own and may not be there yet. */
export function createKeys(load) {
  const dialog = /** @type {HTMLDialogElement} */ (byId("keys"));
  const list = async () => {
    try {
      (await import("./key_list.js")).listKeys();
    } catch {
      say(byId("keys-list"), "The keys could not be loaded; open this again when the network is there.");
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
  // The ground around it is the dialog itself.
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close();
  });
  listen(document, "Help", [
    {
      keys: ["F1"],
      text: "explain the field with the focus, or show this help",
      run: () => {
        const active = document.activeElement;
        if (!active || !explain(active)) open();
      },
    },
  ]);
  listen(byId("views"), "Any view", [
    {
      keys: ["?"],
      text: "show this help",
      run: (event) => (/** @type {Element} */ (event.target).matches("input, textarea") ? false : open()),
    },
  ]);
}
