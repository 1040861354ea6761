/** Changes scripts and reports the results. No DOM. */
import { exactTime } from "../../state/number.js";
import { levelText, pressCycle, pressText, pushText, shortestPress, whyNoPush } from "./presses.js";
import { entriesOf, inputsOf, moved, nameOf, ownerOf, press, put, sameEntry } from "./script.js";

/** @typedef {import("./script.js").Placed} Placed */

/**
 * @param {{report: (text: string, isError?: boolean) => void, played: () => number | null} & import("../../state/types.js").Page} page
 *   `played`: the cycle of the playback, null while it is off.
 */
export function createScriptEditor({ report, played, dispatch, now }) {
  let isChanging = false;
  const clock = () => now().result?.summary.clock_hz ?? now().scenario.clock_hz;
  /** @returns {any[]} */
  const panels = () => now().scenario.source?.standalone ?? [];
  const index = () => Math.max(0, Math.min(now().axis, panels().length - 1));
  const panel = () => panels()[index()];
  const shortest = () => shortestPress(panel(), clock());
  const timeOf = (/** @type {number} */ cycle) => exactTime(cycle, clock());
  const target = () => pressCycle(now(), played(), clock());

  /** Replaces the script of a controller, or reports the error. @param {number} owner @param {import("./script.js").Changed} changed @param {boolean} [joins]  Whether it joins the last step of undo. */
  function apply(owner, changed, joins = false) {
    if ("refused" in changed) {
      report(changed.refused, true);
      return false;
    }
    isChanging = true;
    dispatch({ type: "edit", path: `source.standalone[${owner}].inputs`, value: changed.inputs, joins });
    isChanging = false;
    if (!joins) dispatch({ type: "committed" });
    return true;
  }

  /** Moves the cursor after a new press, so that its effect is visible and the next press follows it. @param {number} cycle @param {string} text */
  function moveCursorBehind(cycle, text) {
    if (now().cursors.a !== null) dispatch({ type: "cursor", which: "a", cycle: cycle + shortest() });
    report(text);
  }

  return {
    ...{ clock, panels, index, panel, shortest, timeOf, target },
    /** Whether an edit of this editor is being dispatched. */
    isChanging: () => isChanging,
    entries: () => entriesOf(panels(), index()),
    /** @param {Placed} placed */
    same: (placed) => sameEntry(panels(), placed),

    /** Adds a press of a button. @param {string} input @param {number} cycles */
    click(input, cycles) {
      const owner = ownerOf(index(), input);
      const from = target();
      const until = from + cycles;
      if (apply(owner, press(inputsOf(panels(), owner), input, from, until, panel()?.axis, timeOf)))
        moveCursorBehind(until, pressText(input, timeOf(from), cycles / clock()));
    },

    /** Sets a switch. @param {string} input @param {number} level */
    set(input, level) {
      const owner = ownerOf(index(), input);
      const cycle = target();
      if (apply(owner, put(inputsOf(panels(), owner), { cycle, input, level }, panel()?.axis, timeOf)))
        moveCursorBehind(cycle, levelText(input, level, timeOf(cycle)));
    },

    /** Adds a push of the axis by hand. @param {number} steps */
    push(steps) {
      const why = whyNoPush(steps);
      if (why) return report(why, true);
      const cycle = target();
      const entry = { cycle, input: null, level: 1, push_steps: steps };
      if (apply(index(), put(inputsOf(panels(), index()), entry, null, timeOf)))
        moveCursorBehind(cycle, pushText(steps, timeOf(cycle)));
      return undefined;
    },

    /** Adds a press during the playback, or moves its release. @param {string} input @param {number} from @param {number} until @param {number | null} before  The previous release. */
    hold(input, from, until, before) {
      const owner = ownerOf(index(), input);
      const inputs = inputsOf(panels(), owner);
      if (before === null) return apply(owner, press(inputs, input, from, until, panel()?.axis, timeOf), true);
      const place = inputs.findIndex((each) => each.input === input && each.level === 0 && each.cycle === before);
      return place >= 0 && apply(owner, moved(inputs, place, until, timeOf), true);
    },

    /** @param {Placed} placed @param {number} cycle @param {boolean} joins @returns {Placed | null}  The moved entry; null if it could not be moved. */
    move({ owner, index: from }, cycle, joins) {
      const to = moved(inputsOf(panels(), owner), from, cycle, timeOf);
      if (!apply(owner, to, joins) || "refused" in to) return null;
      const place = to.index ?? from;
      return { owner, index: place, entry: to.inputs[place] };
    },

    /** @param {Placed} placed */
    remove({ owner, index: from, entry }) {
      apply(owner, { inputs: inputsOf(panels(), owner).toSpliced(from, 1) });
      report(`${nameOf(entry)} at ${timeOf(entry.cycle)} is removed.`);
    },
  };
}
