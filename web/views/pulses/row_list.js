/** The list of rows in their panel, and the keys of the selected row. */
import { button, byId, element, fill, setText } from "../../dom.js";
import {
  DEFAULT_ROWS,
  hidden,
  MAX_LETTERS,
  MAX_PX,
  MIN_PX,
  moved,
  named,
  rowPx,
  taller,
} from "../../state/row_choices.js";
import { groupName, groupsOf, rowsOf, shownGroups, shows } from "./rows.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./rows.js").Group} Group */
/** @typedef {{line: HTMLElement, box: HTMLInputElement, field: HTMLInputElement, up: HTMLButtonElement, down: HTMLButtonElement, setGroup: (group: Group) => void}} Line */

/** A key makes the rows this many CSS pixels taller or lower. */
const STEP_PX = 3;

/** @param {{speak: (text: string) => void} & import("../../state/types.js").Page} page */
export function createRowList({ speak, dispatch, now }) {
  const list = byId("rows-list");
  const height = /** @type {HTMLInputElement} */ (byId("rows-height"));
  const panel = byId("rows-panel");
  /** Lines of the panel by group; a line keeps its elements. @type {Map<string, Line>} */
  const lines = new Map();
  /** Whether a key opens the panel; then the name of the selected row gets the focus. */
  let isOpenedByKey = false;
  const choices = () => now().panes.pulses;
  /** @param {Partial<import("../../state/row_choices.js").RowChoices>} rows */
  const change = (rows) => dispatch({ type: "rows", rows });

  [height.min, height.max] = [String(MIN_PX), String(MAX_PX)];
  height.addEventListener("input", () => change(taller(choices(), Number(height.value) - rowPx(choices()))));
  byId("rows-reset").addEventListener("click", () => {
    change(DEFAULT_ROWS);
    speak("The rows are reset.");
  });

  /** The group of the selected signal. */
  function selectedGroup() {
    return groupsOf(now()).find(({ rows }) => rows.some((row) => shows(row, now().row)));
  }

  /** @param {number} by */
  function changeHeight(by) {
    change(taller(choices(), by));
    speak(`Row height: ${rowPx(choices())} pixels.`);
  }

  /** Moves a group by one position among some groups. @param {Group | undefined} target @param {number} by @param {Group[]} among */
  function move(target, by, among) {
    if (!target) return;
    const names = among.map(({ group }) => group);
    const neighbor = names[names.indexOf(target.group) + by];
    if (neighbor === undefined) return speak(`${nameOf(target)} is the ${by < 0 ? "first" : "last"} row.`);
    const all = groupsOf(now()).map(({ group }) => group);
    change(moved(all, target.group, all.indexOf(neighbor) - all.indexOf(target.group)));
    speak(`${nameOf(target)} is row ${names.indexOf(neighbor) + 1} of ${names.length}.`);
  }

  /** Hides or shows a group. If it contains the selected signal, another signal is selected; the last one cannot be hidden. @param {Group | undefined} target @param {boolean} isHidden */
  function hide(target, isHidden) {
    if (!target) return;
    if (isHidden && target.group === selectedGroup()?.group) {
      const rows = rowsOf(now());
      const from = rows.findIndex((row) => target.rows.some((own) => own.name === row.name && own.kind === row.kind));
      const others = rows.flatMap((row, at) =>
        "bit" in row && !target.rows.some((own) => shows(own, row.bit))
          ? [{ bit: row.bit, distance: Math.abs(at - from) }]
          : [],
      );
      const [next] = others.sort((one, other) => one.distance - other.distance);
      if (!next) {
        paint(now());
        return speak("At least one signal must be visible.");
      }
      dispatch({ type: "row", row: next.bit });
    }
    change(hidden(choices(), target.group, isHidden));
    speak(`${nameOf(target)} is ${isHidden ? "hidden; use the list of rows to show it" : "visible"}.`);
  }

  /** @param {Group} target */
  function nameOf({ group, own }) {
    return groupName(now(), group, own);
  }

  /** Opens the panel for the keyboard. */
  function open() {
    isOpenedByKey = true;
    if (panel.matches(":popover-open")) onOpen();
    else panel.showPopover({ source: byId("rows-open") });
  }

  function onOpen() {
    paint(now());
    if (isOpenedByKey) lines.get(selectedGroup()?.group ?? "")?.field.focus();
    isOpenedByKey = false;
  }

  /** @param {Group} first @returns {Line} */
  function lineOf(first) {
    let target = first;
    const box = element("input", { type: "checkbox" });
    const field = element("input", { type: "text", maxlength: String(MAX_LETTERS), spellcheck: "false" });
    box.addEventListener("change", () => hide(target, !box.checked));
    field.addEventListener("input", () => change(named(choices(), target.group, field.value, target.own)));
    const press = (/** @type {number} */ by) => {
      move(target, by, groupsOf(now()));
      const { up, down } = made;
      // The pressed button may now be disabled, at the first or last position.
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
      setGroup: (/** @type {Group} */ group) => {
        target = group;
        const { own } = group;
        box.setAttribute("aria-label", `Show ${own}`);
        field.setAttribute("aria-label", `Name of ${own}`);
        field.placeholder = own;
        for (const [node, direction] of /** @type {[HTMLElement, string][]} */ ([
          [up, "up"],
          [down, "down"],
        ])) {
          node.title = `Move ${own} ${direction}`;
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
    setText(byId("rows-height-px"), `${px} px`);
    const groups = groupsOf(state);
    const shown = shownGroups(state).map(({ group }) => group);
    const all = groups.map((target, at) => {
      const line = lines.get(target.group) ?? lineOf(target);
      lines.set(target.group, line);
      line.setGroup(target);
      line.box.checked = shown.includes(target.group);
      if (document.activeElement !== line.field) line.field.value = state.panes.pulses.names[target.group] ?? "";
      line.up.disabled = at === 0;
      line.down.disabled = at === groups.length - 1;
      return line.line;
    });
    if (all.some((line, at) => list.children[at] !== line) || list.children.length !== all.length) fill(list, ...all);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (!panel.matches(":popover-open")) return;
    const isSame =
      before?.panes.pulses === state.panes.pulses &&
      before?.result === state.result &&
      before?.row === state.row &&
      before?.allSignals === state.allSignals;
    if (!isSame) paint(state);
  }
  return {
    onOpen,
    render,
    open,
    /** Moves the selected group among the visible ones. @param {number} by */
    move: (by) => move(selectedGroup(), by, shownGroups(now())),
    hide: () => hide(selectedGroup(), true),
    /** @param {number} steps */
    stretch: (steps) => changeHeight(steps * STEP_PX),
  };
}
