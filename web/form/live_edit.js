/**
 * The edits of one gesture: one step of undo. The page draws an edit before it takes the next one, and the last one at the end;
 * otherwise a fast gesture would replace every run before its picture.
 */

/**
 * @param {Node} owner  If it is removed, the gesture ends.
 * @param {Pick<import("../state/types.js").Page, "dispatch" | "now">} page
 * @param {{commits?: boolean}} [options]  `commits`: false if the caller ends the step of undo.
 */
export function createLiveEdit(owner, { dispatch, now }, { commits = true } = {}) {
  /** The pending edit. @type {(() => void) | null} */
  let pending = null;
  /** The steps of redo before the gesture. @type {import("../state/types.js").State["future"]} */
  let future = [];
  let frame = 0;

  function take() {
    const edit = pending;
    pending = null;
    edit?.();
  }

  function follow() {
    if (!owner.isConnected) return end();
    if (document.documentElement.dataset.state === "ready") take();
    frame = requestAnimationFrame(follow);
    return undefined;
  }

  function stop() {
    cancelAnimationFrame(frame);
    frame = 0;
  }

  function end() {
    if (!frame) return;
    stop();
    take();
    if (commits) dispatch({ type: "committed" });
  }

  return {
    isActive: () => frame !== 0,
    /** Makes an edit as soon as the page is ready; the first one starts the gesture. @param {() => void} edit */
    edit(edit) {
      pending = edit;
      if (frame) return;
      if (commits) dispatch({ type: "committed" });
      ({ future } = now());
      follow();
    },
    end,
    /** Ends the gesture without its edits. */
    cancel() {
      if (!frame) return;
      stop();
      pending = null;
      dispatch({ type: "canceled", future });
    },
  };
}
