/** Options that need the file to be read again: the channels to read of more than 64, and the base of bytes. */
import { button, element } from "../../dom.js";
import { choiceField, textField } from "./fields.js";
import { BASES } from "./request.js";
import { sentence } from "./texts.js";

/** @typedef {import("../../engine/capture.js").ReadOptions} ReadOptions */
/** @typedef {ReadOptions & {again?: (options: ReadOptions) => Promise<void>}} Reading  The current options, and how to read the file again. */

/** @param {import("../../engine/capture.js").Facts} facts @param {Reading} reading @param {(error: unknown) => void} showError @returns {Node[]} */
export function readOptions({ left_out, map_error, has_base }, { map = "", base = "", again }, showError) {
  const hasMap = left_out > 0;
  if (!again || !(hasMap || has_base)) return [];
  const channels = textField("Channel map", "STEP0=top.motor.STEP,DIR0=top.motor.DIR");
  const bases = choiceField("Base of bytes", BASES);
  const press = button("Read again", "Read the file again with these options", () => {
    if (hasMap && channels.value() === "")
      return channels.fail("The channel map is missing; enter the channels to read.");
    const options = { ...(hasMap ? { map: channels.value() } : {}), ...(bases.value() ? { base: bases.value() } : {}) };
    void again(options).catch(showError);
  });
  channels.set(map);
  bases.set(base);
  if (map_error) channels.fail(sentence(map_error));
  return [...(hasMap ? [channels.label] : []), ...(has_base ? [bases.label] : []), element("p", {}, press)];
}
