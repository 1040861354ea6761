/** Copies bytes as hex; if the browser refuses, shows them as selected text. */
import { byId, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count } from "../../state/number.js";

/** More than this is for a file, in characters. */
const MOST = 8_000_000;
/** Rows per request. */
const ROWS = 20_000;

byId("packets-copied-close").addEventListener("click", () => {
  byId("packets-copied").hidden = true;
});

/** @param {string} hex @param {string} what */
export async function copyHex(hex, what) {
  try {
    await navigator.clipboard.writeText(hex);
    byId("packets-copied").hidden = true;
    say(byId("packets-note"), `${what}: copied as hex.`);
  } catch {
    const text = /** @type {HTMLTextAreaElement} */ (byId("packets-copied-text"));
    byId("packets-copied").hidden = false;
    text.value = hex;
    text.focus();
    text.select();
  }
}

/** All visible rows, one per line. @param {import("../../engine/engine.js").Engine} engine */
export async function copyAll(engine) {
  let hex = "";
  for (let from = 0; from !== undefined; ) {
    const reply = await engine.request("packet_file", "hex", true, from, ROWS).catch(unlessDropped);
    if (!reply) return say(byId("packets-note"), "Nothing was copied: the engine was restarted; copy again.");
    hex += reply.part;
    from = reply.next;
    if (hex.length > MOST)
      return say(
        byId("packets-note"),
        "This is too much for the clipboard: save the packets as a file, or filter them first.",
      );
  }
  return copyHex(hex, `${count(hex.split("\n").length - 1)} rows`);
}
