/** The pane of the motor view; loads motor.js on demand. */
import { createLater } from "../later.js";

/** @typedef {import("../later.js").Page} Page */

/** @param {Page} page */
export const createMotorPane = (page) =>
  createLater(page, "motor", async (page) => (await import("./motor.js")).createMotor(page));
