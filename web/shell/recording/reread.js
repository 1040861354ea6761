/** Of a file with more than 64 channels: the channels that are read first, and how to read it again for others. */
import { button, element } from "../../dom.js";
import { textField } from "./fields.js";
import { sentence } from "./texts.js";

/** @typedef {{map?: string, again?: (map: string) => Promise<void>}} Reading  The map that a file was read for, and how to read it for another one. */

/** @param {import("../../engine/capture.js").Facts} facts @param {Reading} reading @param {(error: unknown) => void} refuse @returns {Node[]} */
export function rereadParts({ left_out, map_error }, { map, again }, refuse) {
  if (!again || left_out === 0) return [];
  const wanted = textField("Channel map", "STEP0=top.motor.STEP,DIR0=top.motor.DIR");
  const press = button("Read again", "Read the file again: the channels of the map first", () => {
    if (wanted.value() === "") return wanted.fail("The map is missing; name the channels to read.");
    void again(wanted.value()).catch(refuse);
  });
  wanted.set(map ?? "");
  if (map_error) wanted.fail(sentence(map_error));
  return [wanted.label, element("p", {}, press)];
}
