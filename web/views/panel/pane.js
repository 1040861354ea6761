/** The pane of the panel: what draws it (panel.js) and its style load when it is first opened. */
import { createLater } from "../later.js";

/** @typedef {import("../later.js").Page} Page */

/** @param {Page} page */
export const createPanelPane = (page) =>
  createLater(page, "panel", async (page) => (await import("./panel.js")).createPanel(page));
