/**
 * Changes of the scenario's structure: parts that are added, moved, removed, or become another kind. Each acts on the
 * scenario as it is when it is requested, not as it was when the form was built, and what is typed in a part and is no
 * value yet goes where the part goes.
 */
import { get, movedTo } from "../state/paths.js";
import { fieldsOfKind } from "./schema.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/paths.js").Moved} Moved */
/** @typedef {import("./field.js").Field} Field */

/** @param {{now: () => State, dispatch: (message: import("../state/message.js").Message) => void}} page */
export function createStructure({ now, dispatch }) {
  /**
   * What parts were before they became of another kind, by their paths: a kind that is selected again has its numbers
   * again. It is of use only while the part still is what it became then.
   * @type {Map<string, {kind: string, others: {[kind: string]: any}}>}
   */
  let before = new Map();

  /** Changes the value at a path; `moved` says where its parts go, if any goes. @param {string} path @param {(value: any) => any} next @param {Moved} [moved] */
  function change(path, next, moved = []) {
    before = new Map(
      [...before].flatMap(([at, known]) => {
        const to = movedTo(at, moved);
        return to === null ? [] : [/** @type {const} */ ([to, known])];
      }),
    );
    dispatch({ type: "edit", path, value: next(get(now().scenario, path)), moved });
  }

  return {
    change,

    /** Adds a part behind a list's last one. @param {string} path @param {(last: any) => any} fresh */
    append: (path, fresh) => change(path, (list = []) => [...list, fresh(list[list.length - 1])]),

    /** @param {string} path @param {number} index */
    remove: (path, index) => change(path, (list) => list.toSpliced(index, 1), removed(path, index, now())),

    /** Exchanges a part with the one before it. @param {string} path @param {number} index */
    raise: (path, index) =>
      change(path, (list) => list.toSpliced(index - 1, 2, list[index], list[index - 1]), [
        [`${path}[${index}]`, `${path}[${index - 1}]`],
        [`${path}[${index - 1}]`, `${path}[${index}]`],
      ]),

    /**
     * Makes another kind of a part: what both kinds have is carried over.
     * @param {string} path @param {string} group  Of the schema. @param {string} kind @param {any} sample  The kind's own numbers.
     */
    become(path, group, kind, sample) {
      const part = get(now().scenario, path);
      const [old] = Object.keys(part);
      if (old === kind) return;
      const known = before.get(path);
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
      before.set(path, { kind, others });
    },
  };
}

/** Where the parts of a list go when one is removed. @param {string} path @param {number} index @param {State} state @returns {Moved} */
export function removed(path, index, { scenario }) {
  const length = get(scenario, path).length;
  const later = Array.from({ length: length - index - 1 }, (_, i) => index + 1 + i);
  return [
    [`${path}[${index}]`, null],
    ...later.map((i) => /** @type {[string, string]} */ ([`${path}[${i}]`, `${path}[${i - 1}]`])),
  ];
}

/** Fields of one kind that another has, too: of the same name, typed the same way, in the same unit. @param {Field[]} one @param {Field[]} other */
function sharedFields(one, other) {
  return other.filter(({ key, kind, unit }) =>
    one.some((field) => field.key === key && field.kind === kind && field.unit === unit),
  );
}

/** Whether a value can be given in these units. @param {any} value @param {Field["units"]} units */
function fits(value, units) {
  return value !== undefined && (!units || Object.keys(value)[0] in units);
}
