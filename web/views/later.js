/** A view whose code loads when it is first visible. */
import { byId, say } from "../dom.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {{engine: import("../engine/engine.js").Engine} & import("../state/types.js").Page} Page */
/** @typedef {{render: (state: State, before: State | undefined) => any}} View */

/** @param {Page} page @param {string} name  Of the view. @param {(page: Page) => Promise<View>} load  Makes it. */
export function createLater(page, name, load) {
  const view = byId(`view-${name}`);
  /** @type {View | null} */
  let made = null;
  /** @type {Promise<View> | null} */
  let loading = null;
  /** What it has drawn. @type {State | undefined} */
  let drawn;
  let placed = false;
  const observer = new ResizeObserver(() => void refresh());

  async function refresh() {
    if (!view.checkVisibility()) return;
    try {
      loading ??= load(page);
      // Once it is there it draws at once, in the same change.
      made ??= await loading;
    } catch {
      loading = null;
      return say(byId(`${name}-note`), "This view could not be loaded. Check the network, then fold and unfold it.");
    }
    if (drawn === page.now()) return;
    const before = drawn;
    drawn = page.now();
    await made.render(drawn, before);
  }

  return {
    render() {
      // Before the first state has given each view its place, all of them may stand there for a moment.
      if (!placed) observer.observe(view);
      placed = true;
      return refresh();
    },
  };
}
