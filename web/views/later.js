/** A view whose code loads when it is first visible. */
import { byId, setText } from "../dom.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {{engine: import("../engine/engine.js").Engine} & import("../state/types.js").Page} Page */
/** @typedef {{render: (state: State, before: State | undefined) => any}} View */

/** @param {Page} page @param {string} name @param {(page: Page) => Promise<View>} load  Creates the view. */
export function createLazyView(page, name, load) {
  const view = byId(`view-${name}`);
  /** @type {View | null} */
  let created = null;
  /** @type {Promise<View> | null} */
  let loading = null;
  /** The last drawn state. @type {State | undefined} */
  let drawn;
  let isObserved = false;
  const observer = new ResizeObserver(() => void refresh());

  async function refresh() {
    if (!view.checkVisibility()) return;
    try {
      loading ??= load(page);
      // Without `await` once it is loaded, so that it draws in the same task.
      created ??= await loading;
    } catch {
      loading = null;
      return setText(
        byId(`${name}-note`),
        "This view could not be loaded. Check the network, then fold and unfold it.",
      );
    }
    if (drawn === page.now()) return;
    const before = drawn;
    drawn = page.now();
    await created.render(drawn, before);
  }

  return {
    render() {
      // Only after the first state: before it, all views may be visible for a moment.
      if (!isObserved) observer.observe(view);
      isObserved = true;
      return refresh();
    },
  };
}
