/** The list of all keys. */
import { byId, element, fill } from "../dom.js";
import { listed } from "../shell/commands.js";

/** Names on keycaps. @type {{[key: string]: string}} */
const CAPS = {
  arrowleft: "←",
  arrowright: "→",
  arrowup: "↑",
  arrowdown: "↓",
  escape: "Esc",
  pageup: "Page up",
  pagedown: "Page down",
};

/** Fills the list. */
export function listKeys() {
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
}

/** @param {string} key */
function caps(key) {
  const parts = key.split(/\+(?=.)/);
  return parts.flatMap((part, index) => [
    ...(index ? ["+"] : []),
    element("kbd", {}, CAPS[part.toLowerCase()] ?? (part.length === 1 ? part.toUpperCase() : part)),
  ]);
}
