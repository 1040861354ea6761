/** The help in the page: every key, from the list of commands itself, and the way to the rest. */
import { byId, element, fill } from "../dom.js";
import { listed, listen } from "../shell/commands.js";
import { explain } from "./card.js";

/** How keys are called on keycaps. @type {{[key: string]: string}} */
const CAPS = {
  arrowleft: "←",
  arrowright: "→",
  arrowup: "↑",
  arrowdown: "↓",
  escape: "Esc",
  pageup: "Page up",
  pagedown: "Page down",
};

/** @param {() => Promise<unknown>} load  Loads what has keys of its own and may not be there yet. */
export function createKeys(load) {
  const dialog = /** @type {HTMLDialogElement} */ (byId("keys"));
  const list = () =>
    fill(
      byId("keys-list"),
      ...listed().flatMap(({ title, commands }) => [
        element("h3", {}, title),
        element(
          "dl",
          { class: "keys" },
          ...commands.flatMap(({ keys, text }) => [
            element("dt", {}, ...keys.flatMap((key, index) => [...(index ? [" or "] : []), ...caps(key)])),
            element("dd", {}, text),
          ]),
        ),
      ]),
    );
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

/** @param {string} key */
function caps(key) {
  const parts = key.split(/\+(?=.)/);
  return parts.flatMap((part, index) => [
    ...(index ? ["+"] : []),
    element("kbd", {}, CAPS[part.toLowerCase()] ?? (part.length === 1 ? part.toUpperCase() : part)),
  ]);
}
