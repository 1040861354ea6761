/** The tab Sine of the study: figure 4. What a tab is, says study.js. */

/** @param {import("./study.js").StudyPage} page @returns {import("./study.js").StudyTab} */
export function createSine({ panel }) {
  panel.replaceChildren();

  /** @param {import("../../state/types.js").State} state @param {import("../../state/types.js").State | undefined} before */
  function render(state, before) {
    return before?.result === state.result ? undefined : null;
  }
  return { render };
}
