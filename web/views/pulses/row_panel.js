/** The panel of rows; loads row_list.js on demand. */
import { registerCommands } from "../../shell/commands.js";
import { createLazyPopover } from "../../shell/lazy_popover.js";

/** @typedef {ReturnType<typeof import("./row_list.js").createRowList>} RowList */

/** @param {{canvas: HTMLElement, speak: (text: string) => void} & import("../../state/types.js").Page} page */
export function createRowPanel({ canvas, ...page }) {
  /** @type {Promise<RowList> | null} */
  let loading = null;
  const load = () => {
    loading ??= import("./row_list.js").then(({ createRowList }) => createRowList(page));
    loading.catch(() => {
      loading = null;
    });
    return loading;
  };
  const showError = () => page.speak("This part of the page could not be loaded. Check the network and try again.");
  const key = (/** @type {(list: RowList) => void} */ work) => () => void load().then(work, showError);
  registerCommands(canvas, "Pulses", [
    { keys: ["Shift+ArrowUp"], text: "move the selected row up", run: key(({ move }) => move(-1)) },
    { keys: ["Shift+ArrowDown"], text: "move the selected row down", run: key(({ move }) => move(1)) },
    { keys: ["h"], text: "hide the selected row", run: key(({ hide }) => hide()) },
    { keys: ["Alt+ArrowDown"], text: "taller rows", run: key(({ stretch }) => stretch(1)) },
    { keys: ["Alt+ArrowUp"], text: "lower rows", run: key(({ stretch }) => stretch(-1)) },
    { keys: ["r"], text: "open the list of rows: height, order, names", run: key(({ open }) => open()) },
  ]);
  return createLazyPopover("rows-open", "rows-panel", load, "rows-about");
}
