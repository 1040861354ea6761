/**
 * Changes of the scenario's structure: parts are added, moved, removed, or become another kind. Each applies to the current
 * scenario, not to the one for which the form was built. Drafts move with their parts.
 */
import { get, movedTo } from "../state/paths.js";
import { fieldsOfKind } from "./schema.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/paths.js").Moved} Moved */
/** @typedef {import("./field.js").Field} Field */

/** @param {{now: () => State, dispatch: (message: import("../state/message.js").Message) => void}} page */
export function createStructure({ now, dispatch }) {
  /**
   * Values of parts before they became another kind, by path, so that selecting the former kind restores them. Valid only
   * while the part has this `kind`.
   * @type {Map<string, {kind: string, others: {[kind: string]: any}}>}
   */
  let formerKinds = new Map();

  /** Changes the value at a path; `moved` has the new paths of its parts. @param {string} path @param {(value: any) => any} next @param {Moved} [moved] */
  function change(path, next, moved = []) {
    formerKinds = new Map(
      [...formerKinds].flatMap(([at, known]) => {
        const to = movedTo(at, moved);
        return to === null ? [] : [/** @type {const} */ ([to, known])];
      }),
    );
    dispatch({ type: "edit", path, value: next(get(now().scenario, path)), moved });
  }

  return {
    change,

    /** Adds an item to a list. @param {string} path @param {(last: any) => any} create */
    append: (path, create) => change(path, (list = []) => [...list, create(list[list.length - 1])]),

    /** @param {string} path @param {number} index */
    remove: (path, index) => change(path, (list) => list.toSpliced(index, 1), removed(path, index, now())),

    /** Exchanges an item with the previous one. @param {string} path @param {number} index */
    raise: (path, index) =>
      change(path, (list) => list.toSpliced(index - 1, 2, list[index], list[index - 1]), [
        [`${path}[${index}]`, `${path}[${index - 1}]`],
        [`${path}[${index - 1}]`, `${path}[${index}]`],
      ]),

    /**
     * Changes the kind of a part; fields that both kinds have keep their values.
     * @param {string} path @param {string} group  Of the schema. @param {string} kind @param {any} sample  Defaults of the kind.
     */
    become(path, group, kind, sample) {
      const part = get(now().scenario, path);
      const [old] = Object.keys(part);
      if (old === kind) return;
      const known = formerKinds.get(path);
      const others = { ...(known?.kind === old ? known.others : {}), [old]: part[old] };
      const shared = sharedFields(fieldsOfKind(group, old), fieldsOfKind(group, kind));
      const values = structuredClone(others[kind] ?? sample);
      for (const { key, units } of shared) if (fits(part[old][key], units)) values[key] = part[old][key];
      change(path, () => ({ [kind]: values }), [
        ...shared.map(
          ({ key }) => /** @type {[string, string]} */ ([`${path}.${old}.${key}`, `${path}.${kind}.${key}`]),
        ),
        [path, null],
      ]);
      formerKinds.set(path, { kind, others });
    },
  };
}

/** The new paths of the items of a list when one is removed. @param {string} path @param {number} index @param {State} state @returns {Moved} */
export function removed(path, index, { scenario }) {
  const length = get(scenario, path).length;
  const later = Array.from({ length: length - index - 1 }, (_, i) => index + 1 + i);
  return [
    [`${path}[${index}]`, null],
    ...later.map((i) => /** @type {[string, string]} */ ([`${path}[${i}]`, `${path}[${i - 1}]`])),
  ];
}

/** Fields that two kinds share: with the same name, kind of value and unit. A field that is empty at first stays so. @param {Field[]} one @param {Field[]} other */
function sharedFields(one, other) {
  const kindOf = (/** @type {Field} */ { kind }) => kind.replace("optional-q", "q");
  return other.filter(
    (to) =>
      to.initial !== null &&
      one.some((from) => from.key === to.key && kindOf(from) === kindOf(to) && from.unit === to.unit),
  );
}

/** Whether a value has one of these units. @param {any} value @param {Field["units"]} units */
function fits(value, units) {
  return value != null && (!units || Object.keys(value)[0] in units);
}
