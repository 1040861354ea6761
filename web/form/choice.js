/** A value of the scenario that is one of several kinds: a select, and the fields of the selected kind. */
import { element } from "../dom.js";
import { get } from "../state/paths.js";
import { kindFields, labels } from "./schema.js";

/**
 * @param {import("./kit.js").Kit} kit @param {string} path @param {string} label
 * @param {{group: string, samples: {[kind: string]: any}, term: string, empty?: string}} choice  `empty`: its label if there may be
 *   none.
 */
export function choiceItem(kit, path, label, { group, samples, term, empty }) {
  const [kind = ""] = Object.keys(get(kit.now().scenario, path) ?? {});
  const kinds = { ...(empty ? { "": empty } : {}), ...labels(group) };
  const select = kit.kindSelect(label, path, kind, kinds, (selected) => {
    if (kind && selected) kit.become(path, group, selected, samples[selected]);
    else kit.change(path, () => (selected ? { [selected]: structuredClone(samples[selected]) } : null), [[path, null]]);
  });
  const { path: at, fields } = kind ? kindFields(group, kind) : { path: "", fields: [] };
  return kit.item(label, path, [element("div", { class: "item-head" }, select), ...kit.block(path + at, fields)], term);
}
