/** The pane of the panel view; loads panel.js on demand. */
import { createLazyView } from "../later.js";

/** @typedef {import("../later.js").Page} Page */

/** @param {Page} page */
export const createPanelPane = (page) =>
  createLazyView(page, "panel", async (page) => (await import("./panel.js")).createPanel(page));
