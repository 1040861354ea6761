/** Loads the guide (guide_steps.js) on demand. */
import { byId } from "../dom.js";

/** @param {import("../state/types.js").Page} page */
export function createGuide(page) {
  byId("guide-start").addEventListener("click", async () => (await import("./guide_steps.js")).startGuide(page));
}
