/** The pane of the motor view; loads motor.js on demand. */
import { createLazyView } from "../later.js";

/** @typedef {import("../later.js").Page} Page */

/** @param {Page} page */
export const createMotorPane = (page) =>
  createLazyView(page, "motor", async (page) => (await import("./motor.js")).createMotor(page));
