/** Building blocks of the form: fields, parts, fieldsets, lists and selects of kinds. */

import { button, element, setText } from "../dom.js";
import { control } from "./control.js";
import { createStructure } from "./structure.js";
import { termButton } from "./term_button.js";
import { isList, setLists } from "./values.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("./control.js").Control} Control */
/**
 * @typedef {{moves: {[kind: string]: any}, targets: {[kind: string]: any}, shapers: {[kind: string]: any},
 *   motion_groups: {[kind: string]: any}, mechanics: {[kind: string]: any}, sources: {[kind: string]: any},
 *   glitch: any, send: any, controller: any, rules: any, motor: any,
 *   plant: any, protection: any, plant_motor: any,
 *   groups: {[kind: string]: any}, until: any, homing: any, soft_limits: any, axis: any, input: any}} Samples  One item of each kind with its defaults.
 */
/** @typedef {ReturnType<typeof createKit>} Kit */
/** @typedef {typeof import("./additional_parts.js").ADDITIONAL_PARTS} AdditionalParts */

/** @param {{samples: Samples, now: () => State, dispatch: (message: import("../state/message.js").Message) => void,
 *   rebuild: () => void}} form */
export function createKit({ samples, now, dispatch, rebuild }) {
  /** @type {Map<string, Control>} */
  const controls = new Map();
  /** Error elements of axes, moves and controllers, by path. @type {Map<string, HTMLElement>} */
  const groups = new Map();
  /** Whether a part is open, by its title. @type {Map<string, boolean>} */
  const open = new Map();

  const structure = createStructure({ now, dispatch });

  /** Parts that few experiments need, loaded on demand. @type {AdditionalParts | null} */
  let parts = null;
  /** @type {Promise<void> | null} */
  let loading = null;

  /** Items of an additional part. While it loads they are a note, and afterwards the form is rebuilt. @param {(parts: AdditionalParts) => Node[]} make */
  function loadItems(make) {
    if (parts) return make(parts);
    const note = element("p", { class: "item-note" }, "Loading fields…");
    loading ??= import("./additional_parts.js")
      .then((loaded) => {
        parts = loaded.ADDITIONAL_PARTS;
        setLists(parts.lists);
      })
      .finally(() => {
        loading = null;
      });
    const showError = () =>
      setText(note, "The fields could not be loaded. Check the network, then undo or reload the page.");
    // A rebuilt form no longer has the note.
    loading.then(() => note.isConnected && rebuild(), showError);
    return [note];
  }

  /** @param {string} path @param {Field} field @returns {Node} */
  function row(path, field) {
    const make = () => {
      const created = control(path, field, { dispatch, now });
      controls.set(path, created);
      return created.root;
    };
    return isList(field) ? loadItems(() => [make()])[0] : make();
  }

  /** The fields below a path. @param {string} path @param {Field[]} fields */
  const block = (path, fields) => fields.map((field) => row(path ? `${path}.${field.key}` : field.key, field));

  /** @param {string} path */
  function errorOf(path) {
    const error = element("p", { class: "error" });
    groups.set(path, error);
    return error;
  }

  /** A part that can be folded. @param {string} title @param {boolean} isOpen @param {Node[]} children */
  function part(title, isOpen, children) {
    const details = element(
      "details",
      { class: "part" },
      element("summary", {}, title),
      element("div", { class: "part-body" }, ...children),
    );
    details.open = open.get(title) ?? isOpen;
    details.addEventListener("toggle", () => open.set(title, details.open));
    return details;
  }

  /** A fieldset with an error and a help term. @param {string} legend @param {string} path @param {Node[]} children @param {string} term  Id of its help text. */
  function item(legend, path, children, term) {
    return element(
      "fieldset",
      { class: "item" },
      element("legend", {}, termButton(legend, term, { tabindex: "-1" })),
      errorOf(path),
      element("div", { class: "item-body" }, ...children),
    );
  }

  /** A select of kinds. @param {string} label @param {string} path @param {string} kind @param {{[kind: string]: string}} kinds @param {(kind: string) => void} choose */
  function kindSelect(label, path, kind, kinds, choose) {
    const select = element("select", { "aria-label": label, "aria-keyshortcuts": "F1", "data-path": `${path}#kind` });
    for (const [value, text] of Object.entries(kinds)) select.append(element("option", { value }, text));
    select.value = kind;
    select.addEventListener("change", () => choose(select.value));
    return select;
  }

  /** A checkbox for an optional part of the scenario. @param {string} path @param {string} label @param {boolean} on @param {any} sample */
  function toggle(path, label, on, sample) {
    const check = element("input", { type: "checkbox", "data-path": `${path}#kind` });
    check.checked = on;
    check.addEventListener("change", () =>
      structure.change(path, () => (check.checked ? structuredClone(sample) : null), [[path, null]]),
    );
    return element("label", { class: "check" }, check, label);
  }

  /** A list of rows with the same fields. @param {string} path @param {any[]} values @param {Field[]} fields @param {string} name @param {(last: any) => any} createRow  Creates the row after the last one, or the first. @param {string} term */
  function rows(path, values, fields, name, createRow, term) {
    const items = values.map((_, index) =>
      item(
        `${name} ${index + 1}`,
        `${path}[${index}]`,
        [
          ...block(`${path}[${index}]`, fields),
          button("Remove", `Remove ${name.toLowerCase()} ${index + 1}`, () => structure.remove(path, index)),
        ],
        term,
      ),
    );
    return [
      ...items,
      button(`Add ${name.toLowerCase()}`, `Add ${name.toLowerCase()}`, () => structure.append(path, createRow)),
    ];
  }

  /** Forgets all controls before the form is rebuilt. */
  function clear() {
    controls.clear();
    groups.clear();
  }

  return {
    samples,
    now,
    dispatch,
    ...structure,
    row,
    block,
    errorOf,
    part,
    item,
    kindSelect,
    toggle,
    rows,
    clear,
    loadItems,
    /** The promise of the parts that are loading, if any. */
    loading: () => loading,
    rebuild,
    controls,
    groups,
  };
}
