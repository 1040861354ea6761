/**
 * The edits of one gesture: one step of undo. The page draws an edit before it takes the next one, and the last one at the end;
 * otherwise a fast gesture would replace every run before its picture.
 */

/** @param {(message: import("../state/message.js").Message) => void} dispatch */
export function createLiveEdit(dispatch) {
  /** The newest edit that has not been made. @type {(() => void) | null} */
  let next = null;
  let frame = 0;

  function take() {
    const edit = next;
    next = null;
    edit?.();
  }

  function follow() {
    if (document.documentElement.dataset.state === "ready") take();
    frame = requestAnimationFrame(follow);
  }

  return {
    /** Makes an edit as soon as the page is ready; the first one starts the gesture. @param {() => void} edit */
    edit(edit) {
      next = edit;
      if (frame) return;
      dispatch({ type: "committed" });
      follow();
    },
    end() {
      if (!frame) return;
      cancelAnimationFrame(frame);
      frame = 0;
      take();
      dispatch({ type: "committed" });
    },
  };
}
