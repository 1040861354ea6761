/** Copies bytes as hex; if the browser blocks that, shows them as selected text. */
import { byId, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count } from "../../state/number.js";

/** Maximum copied characters. */
const MAX_LENGTH = 8_000_000;
/** Rows per request. */
const ROWS = 20_000;

byId("packets-copied-close").addEventListener("click", () => {
  byId("packets-copied").hidden = true;
});

/** @param {string} hex @param {string} name */
export async function copyHex(hex, name) {
  try {
    await navigator.clipboard.writeText(hex);
    byId("packets-copied").hidden = true;
    setText(byId("packets-note"), `${name}: copied as hex.`);
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
    if (!reply) return setText(byId("packets-note"), "Nothing was copied: the engine was restarted; copy again.");
    hex += reply.part;
    from = reply.next;
    if (hex.length > MAX_LENGTH)
      return setText(
        byId("packets-note"),
        "The bytes exceed the clipboard limit; save the packets as a file, or filter them first.",
      );
  }
  return copyHex(hex, `${count(hex.split("\n").length - 1)} rows`);
}
