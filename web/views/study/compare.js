/** The tab Compare of the study: all S-curves side by side. What a tab is, says study.js. */

/** @param {import("./study.js").StudyPage} page @returns {import("./study.js").StudyTab} */
export function createCompare({ panel }) {
  panel.replaceChildren();

  /** @param {import("../../state/types.js").State} state @param {import("../../state/types.js").State | undefined} before */
  function render(state, before) {
    return before?.result === state.result ? undefined : null;
  }
  return { render };
}
