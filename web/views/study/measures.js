/** The tab Measures of the study: how good the looked-at axis is. What a tab is, says study.js. */

/** @param {import("./study.js").StudyPage} page @returns {import("./study.js").StudyTab} */
export function createMeasures({ panel }) {
  panel.replaceChildren();

  /** @param {import("../../state/types.js").State} state @param {import("../../state/types.js").State | undefined} before */
  function render(state, before) {
    return before?.result === state.result ? undefined : null;
  }
  return { render };
}
