/** The list of rows in their panel, and the keys of the selected row. */
import { button, byId, element, fill, say } from "../../dom.js";
import {
  AS_THEY_ARE,
  hidden,
  MAX_LETTERS,
  MAX_PX,
  MIN_PX,
  moved,
  named,
  rowPx,
  taller,
} from "../../state/row_choices.js";
import { calledBy, groupsOf, rowsOf, shownGroups, shows } from "./rows.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./rows.js").Group} Group */
/** @typedef {{line: HTMLElement, box: HTMLInputElement, field: HTMLInputElement, up: HTMLButtonElement, down: HTMLButtonElement, put: (group: Group) => void}} Line */

/** A key makes the rows this many CSS pixels taller or lower. */
const STEP_PX = 3;

/** @param {{speak: (text: string) => void} & import("../../state/types.js").Page} page */
export function createRowList({ speak, dispatch, now }) {
  const list = byId("rows-list");
  const height = /** @type {HTMLInputElement} */ (byId("rows-height"));
  const panel = byId("rows-panel");
  /** Lines of the panel by their groups: one that stays keeps its elements. @type {Map<string, Line>} */
  const lines = new Map();
  /** Whether a key opens the panel: the focus goes to the selected row's name. */
  let byKey = false;
  const choices = () => now().panes.pulses;
  /** @param {Partial<import("../../state/row_choices.js").RowChoices>} rows */
  const choose = (rows) => dispatch({ type: "rows", rows });

  [height.min, height.max] = [String(MIN_PX), String(MAX_PX)];
  height.addEventListener("input", () => choose(taller(choices(), Number(height.value) - rowPx(choices()))));
  byId("rows-reset").addEventListener("click", () => {
    choose(AS_THEY_ARE);
    speak("The rows are reset.");
  });

  /** The group of the selected signal. */
  function selectedGroup() {
    return groupsOf(now()).find(({ rows }) => rows.some((row) => shows(row, now().row)));
  }

  /** @param {number} by */
  function stretch(by) {
    choose(taller(choices(), by));
    speak(`Row height: ${rowPx(choices())} pixels.`);
  }

  /** By one among some groups; those between stay where they are. @param {Group | undefined} what @param {number} by @param {Group[]} among */
  function move(what, by, among) {
    if (!what) return;
    const names = among.map(({ group }) => group);
    const beside = names[names.indexOf(what.group) + by];
    if (beside === undefined) return speak(`${nameOf(what)} is the ${by < 0 ? "first" : "last"} row.`);
    const all = groupsOf(now()).map(({ group }) => group);
    choose(moved(all, what.group, all.indexOf(beside) - all.indexOf(what.group)));
    speak(`${nameOf(what)} is row ${names.indexOf(beside) + 1} of ${names.length}.`);
  }

  /** Another signal is selected where the selected one goes; the last one stays. @param {Group | undefined} what @param {boolean} away */
  function hide(what, away) {
    if (!what) return;
    if (away && what.group === selectedGroup()?.group) {
      const rows = rowsOf(now());
      const from = rows.findIndex((row) => what.rows.some((own) => own.name === row.name && own.kind === row.kind));
      const others = rows.flatMap((row, at) =>
        "bit" in row && !what.rows.some((own) => shows(own, row.bit))
          ? [{ bit: row.bit, far: Math.abs(at - from) }]
          : [],
      );
      const [next] = others.sort((one, other) => one.far - other.far);
      if (!next) {
        paint(now());
        return speak("At least one signal must be visible.");
      }
      dispatch({ type: "row", row: next.bit });
    }
    choose(hidden(choices(), what.group, away));
    speak(`${nameOf(what)} is ${away ? "hidden; use the list of rows to show it" : "visible"}.`);
  }

  /** @param {Group} what */
  function nameOf({ group, own }) {
    return calledBy(now(), group, own);
  }

  /** Opens the panel for the keyboard. */
  function open() {
    byKey = true;
    if (panel.matches(":popover-open")) onOpen();
    else panel.showPopover({ source: byId("rows-open") });
  }

  function onOpen() {
    paint(now());
    if (byKey) lines.get(selectedGroup()?.group ?? "")?.field.focus();
    byKey = false;
  }

  /** @param {Group} first @returns {Line} */
  function lineOf(first) {
    let what = first;
    const box = element("input", { type: "checkbox" });
    const field = element("input", { type: "text", maxlength: String(MAX_LETTERS), spellcheck: "false" });
    box.addEventListener("change", () => hide(what, !box.checked));
    field.addEventListener("input", () => choose(named(choices(), what.group, field.value, what.own)));
    const press = (/** @type {number} */ by) => {
      move(what, by, groupsOf(now()));
      const { up, down } = made;
      // At an end the button that was pressed is switched off.
      (by < 0 ? (up.disabled ? down : up) : down.disabled ? up : down).focus();
    };
    const [up, down] = [button("↑", "", () => press(-1)), button("↓", "", () => press(1))];
    const line = element("li", {}, element("label", { class: "check" }, box), field, up, down);
    const made = {
      line,
      box,
      field,
      up,
      down,
      put: (/** @type {Group} */ group) => {
        what = group;
        const { own } = group;
        box.setAttribute("aria-label", `Show ${own}`);
        field.setAttribute("aria-label", `Name of ${own}`);
        field.placeholder = own;
        for (const [node, way] of /** @type {[HTMLElement, string][]} */ ([
          [up, "up"],
          [down, "down"],
        ])) {
          node.title = `Move ${own} ${way}`;
          node.setAttribute("aria-label", node.title);
        }
      },
    };
    return made;
  }

  /** @param {State} state */
  function paint(state) {
    const px = rowPx(state.panes.pulses);
    height.value = String(px);
    say(byId("rows-height-px"), `${px} px`);
    const groups = groupsOf(state);
    const shown = shownGroups(state).map(({ group }) => group);
    const all = groups.map((what, at) => {
      const line = lines.get(what.group) ?? lineOf(what);
      lines.set(what.group, line);
      line.put(what);
      line.box.checked = shown.includes(what.group);
      if (document.activeElement !== line.field) line.field.value = state.panes.pulses.names[what.group] ?? "";
      line.up.disabled = at === 0;
      line.down.disabled = at === groups.length - 1;
      return line.line;
    });
    if (all.some((line, at) => list.children[at] !== line) || list.children.length !== all.length) fill(list, ...all);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (!panel.matches(":popover-open")) return;
    const same =
      before?.panes.pulses === state.panes.pulses &&
      before?.result === state.result &&
      before?.row === state.row &&
      before?.allSignals === state.allSignals;
    if (!same) paint(state);
  }
  return {
    onOpen,
    render,
    open,
    /** By one among those visible. @param {number} by */
    move: (by) => move(selectedGroup(), by, shownGroups(now())),
    hide: () => hide(selectedGroup(), true),
    /** @param {number} steps */
    stretch: (steps) => stretch(steps * STEP_PX),
  };
}
