/**
 * The form: built from the tables of `fields.js`. It is built anew only when the scenario's shape changes
 * (kinds, numbers of axes, moves, rows); else values are put into the fields that stand.
 */
import { GLITCH, MECHANICS, MOVES, PACKET_LINES, SECTIONS, SEND, SOURCES } from "./fields.js";
import { button, element, fill } from "./dom.js";
import { control } from "./control.js";
import { MOST_CHANNELS, get, held } from "./state.js";
import { showAbout, showDerived, showProblems } from "./judgement.js";

/** @typedef {import("./types.js").State} State */
/** @typedef {import("./types.js").Scenario} Scenario */
/** @typedef {import("./fields.js").Field} Field */
/** @typedef {import("./control.js").Control} Control */
/** @typedef {{moves: {[kind: string]: any}, mechanics: {[kind: string]: any}, sources: {[kind: string]: any}, glitch: any, send: any}} Samples */

/**
 * @param {{root: HTMLElement, samples: Samples, dispatch: (message: import("./state.js").Message) => void}} given
 */
export function createForm({ root, samples, dispatch }) {
  /** @type {Map<string, Control>} */
  let controls = new Map();
  /** @type {Map<string, HTMLElement>} Errors of whole axes and moves. */
  let groups = new Map();
  let shape = "";
  /** @type {State} */
  let state;
  /** @type {Map<string, boolean>} Which sections stand open. */
  const open = new Map();

  /** @param {string} path @param {any} value */
  const put = (path, value) => dispatch({ type: "edit", path, value });

  /** @param {string} path @param {Field} field */
  function row(path, field) {
    const made = control(path, field, { dispatch, now: () => state });
    controls.set(path, made);
    return made.root;
  }

  /** @param {string} title @param {boolean} isOpen @param {Node[]} children */
  function part(title, isOpen, children) {
    const details = element("details", { class: "part" }, element("summary", {}, title), element("div", { class: "part-body" }, ...children));
    details.open = open.get(title) ?? isOpen;
    details.addEventListener("toggle", () => open.set(title, details.open));
    return details;
  }

  /** A fieldset that can be moved out. @param {string} legend @param {string | null} path @param {Node[]} children */
  function item(legend, path, children) {
    const error = element("p", { class: "error" });
    if (path !== null) groups.set(path, error);
    return element("fieldset", { class: "item" }, element("legend", {}, legend), error, element("div", { class: "item-body" }, ...children));
  }

  /** A choice of kinds; the new kind comes with its defaults. @param {string} label @param {string} path @param {string} kind @param {{[kind: string]: string}} kinds @param {(kind: string) => any} fresh */
  function kindSelect(label, path, kind, kinds, fresh) {
    const select = element("select", { "aria-label": label, "data-path": `${path}#kind` });
    for (const [value, text] of Object.entries(kinds)) select.append(element("option", { value }, text));
    select.value = kind;
    select.addEventListener("change", () => put(path, fresh(select.value)));
    return select;
  }

  /** @param {{[kind: string]: {label: string}}} kinds */
  const labels = (kinds) => Object.fromEntries(Object.entries(kinds).map(([kind, { label }]) => [kind, label]));

  /** @param {any} move @param {string} path @param {number} index @param {any[]} moves @param {string} list */
  function moveItem(move, path, index, moves, list) {
    const kind = Object.keys(move)[0];
    const head = element("div", { class: "item-head" },
      kindSelect(`Kind of move ${index + 1}`, path, kind, labels(MOVES), (chosen) => ({ [chosen]: samples.moves[chosen] })),
      button("↑", `Move ${index + 1} earlier`, () => put(list, swapped(moves, index - 1)), index === 0),
      button("✕", `Remove move ${index + 1}`, () => put(list, moves.toSpliced(index, 1)), moves.length === 1));
    const fields = (MOVES[kind]?.fields ?? []).map((field) => row(`${path}.${kind}.${field.key}`, field));
    const note = element("p", { class: "item-note", "data-note": path });
    return item(`Move ${index + 1}`, path, [head, ...fields, note]);
  }

  /** @param {any} axis @param {number} index @param {any[]} axes */
  function axisItem(axis, index, axes) {
    const path = `source.motion.axes[${index}]`;
    const kind = Object.keys(axis.mechanics)[0];
    const list = `${path}.moves`;
    const head = element("div", { class: "item-head" },
      kindSelect(`Mechanics of axis ${index}`, `${path}.mechanics`, kind, labels(MECHANICS), (chosen) => ({ [chosen]: samples.mechanics[chosen] })),
      button("Copy", `Copy axis ${index}`, () => addAxis(axes, structuredClone(axis)), axes.length >= MOST_CHANNELS),
      button("✕", `Remove axis ${index}`, () => removeAxis(axes, index), axes.length === 1));
    const fields = (MECHANICS[kind]?.fields ?? []).map((field) => row(`${path}.mechanics.${kind}.${field.key}`, field));
    const moves = axis.moves.map((/** @type {any} */ move, /** @type {number} */ i) => moveItem(move, `${list}[${i}]`, i, axis.moves, list));
    const last = axis.moves[axis.moves.length - 1];
    const add = button("Add move", `Add move to axis ${index}`, () => put(list, [...axis.moves, structuredClone(last ?? { cosine: samples.moves.cosine })]), axis.moves.length >= 64);
    return item(`Axis ${index} · channel ${index}`, path, [head, ...fields, ...moves, add]);
  }

  /** An axis needs its channel: the bus grows with it. @param {any[]} axes @param {any} axis */
  function addAxis(axes, axis) {
    const { scenario } = state;
    const grown = [...axes, axis];
    const channels = Math.max(Number(scenario.bus.channels) || 1, grown.length);
    put("", { ...scenario, bus: { ...scenario.bus, channels }, source: { motion: { axes: grown } } });
  }

  /** The spectrum stays with its axis, or goes to a neighbour of the one that is removed. @param {any[]} axes @param {number} index */
  function removeAxis(axes, index) {
    const { scenario } = state;
    const left = axes.toSpliced(index, 1);
    const looked = scenario.analysis.axis;
    const axis = Math.min(looked > index ? looked - 1 : looked, left.length - 1);
    put("", { ...scenario, analysis: { ...scenario.analysis, axis }, source: { motion: { axes: left } } });
  }

  /** @param {Scenario} scenario @returns {Node[]} */
  function source(scenario) {
    const kind = Object.keys(scenario.source)[0];
    const head = element("div", { class: "item-head" },
      kindSelect("What the host sends", "source", kind, SOURCES, (chosen) => ({ [chosen]: chosen === "motion" ? samples.sources.motion : example(chosen, scenario) })));
    if (kind === "packets") return [head, row("source.packets.packets", PACKET_LINES)];
    if (kind === "line") {
      return [head, ...rows("source.line.sends", scenario.source.line.sends, SEND, "Send", samples.send)];
    }
    const { axes } = scenario.source.motion;
    const fresh = () => ({ mechanics: { rotary: samples.mechanics.rotary }, moves: [{ cosine: samples.moves.cosine }] });
    return [head, ...axes.map((/** @type {any} */ axis, /** @type {number} */ i) => axisItem(axis, i, axes)),
      button("Add axis", "Add axis", () => addAxis(axes, structuredClone(axes[axes.length - 1] ?? fresh())), axes.length >= MOST_CHANNELS)];
  }

  /** A list of equal rows. @param {string} path @param {any[]} values @param {Field[]} fields @param {string} name @param {any} sample */
  function rows(path, values, fields, name, sample) {
    const items = values.map((_, index) => item(`${name} ${index + 1}`, `${path}[${index}]`, [
      ...fields.map((field) => row(`${path}[${index}].${field.key}`, field)),
      button("Remove", `Remove ${name.toLowerCase()} ${index + 1}`, () => put(path, values.toSpliced(index, 1))),
    ]));
    const fresh = () => (values.length ? { ...values[values.length - 1], start_cycle: after(values[values.length - 1], state.scenario) } : structuredClone(sample));
    return [...items, button(`Add ${name.toLowerCase()}`, `Add ${name.toLowerCase()}`, () => put(path, [...values, fresh()]))];
  }

  /** @param {Scenario} scenario */
  function build(scenario) {
    controls = new Map();
    groups = new Map();
    const focus = /** @type {HTMLElement | null} */ (document.activeElement)?.dataset?.path;
    const sections = SECTIONS.map((section) => part(section.title, section.open, [
      ...section.fields.map((field) => row(field.key, field)),
      ...(section.list === "glitches" ? rows("line.glitches", scenario.line.glitches, GLITCH, "Glitch", samples.glitch) : []),
    ]));
    fill(root, part("Source", true, source(scenario)), ...sections);
    if (focus) /** @type {HTMLElement | null} */ (root.querySelector(`[data-path="${CSS.escape(focus)}"]`))?.focus();
  }

  /** @param {State} next */
  function render(next) {
    const before = state;
    state = next;
    const nextShape = shapeOf(next.scenario);
    if (nextShape !== shape) {
      shape = nextShape;
      build(next.scenario);
    }
    if (before?.scenario !== next.scenario || before?.drafts !== next.drafts || before?.derived !== next.derived) {
      for (const [path, made] of controls) made.show(get(next.scenario, path), next);
    }
    if (before?.scenario !== next.scenario) showAbout(next);
    // Another experiment begins with what it is about.
    if (before && before.origin !== next.origin && next.origin !== "own") /** @type {Element} */ (root.closest(".sheet")).scrollTop = 0;
    const judged = held(next) !== "unjudged";
    if (judged && (before?.judgement !== next.judgement || before?.drafts !== next.drafts)) {
      showProblems(next, controls, groups);
      showDerived(next, root);
    }
  }

  return { render };
}

/** What decides which fields there are; values do not. @param {Scenario} scenario */
function shapeOf(scenario) {
  const kind = Object.keys(scenario.source)[0];
  const axes = scenario.source.motion?.axes?.map((/** @type {any} */ axis) =>
    [Object.keys(axis.mechanics)[0], ...axis.moves.map((/** @type {any} */ move) => Object.keys(move)[0])]);
  return JSON.stringify([kind, axes, scenario.source.line?.sends?.length, scenario.line.glitches.length]);
}

/** @param {any[]} list @param {number} index */
function swapped(list, index) {
  return list.toSpliced(index, 2, list[index + 1], list[index]);
}

/** Ten steps to the right and ten back on every channel: something to see and to change. @param {string} kind @param {Scenario} scenario */
function example(kind, { bus, line }) {
  const address = line.address === null ? "" : Number(line.address).toString(16).padStart(2, "0");
  const packets = ["8a", "0a"].map((order) => address + order.repeat(Number(bus.channels) || 1));
  if (kind === "packets") return { packets };
  const tick = bus.slots * bus.step_period_cycles;
  return { sends: packets.map((bytes, index) => ({ start_cycle: bus.boot_cycles + 1 + index * tick, bytes })) };
}

/** A start that lies behind a row: its bytes, or its length, have passed. @param {any} row @param {Scenario} scenario */
function after(row, scenario) {
  if ("length_cycles" in row) return row.start_cycle + 2 * row.length_cycles;
  const bits = 10 * (String(row.bytes).replace(/\s/g, "").length / 2 + 1);
  return row.start_cycle + Math.ceil((bits * scenario.clock_hz) / Math.max(1, scenario.line.baud));
}
