/** Offers the guide (guide_steps.js) to new visitors, and loads it on demand. */
import { byId } from "../dom.js";
import { loadGuided, loadScenario, saveGuided } from "../shell/storage.js";

/** @param {import("../state/types.js").Page} page */
export function createGuide(page) {
  byId("guide-start").addEventListener("click", async () => (await import("./guide_steps.js")).startGuide(page));
}

/** Offers the guide to a new visitor. */
export function offerGuide() {
  const welcome = byId("welcome");
  if (loadGuided() || loadScenario() !== null) return;
  // On a narrow screen the form is folded away, with all that is in it.
  if (matchMedia("(max-width: 899px)").matches) byId("sheet").before(welcome);
  welcome.hidden = false;
  byId("welcome-start").addEventListener("click", () => byId("guide-start").click());
  byId("welcome-never").addEventListener("click", () => {
    saveGuided();
    welcome.hidden = true;
    byId("guide-start").focus();
  });
}
