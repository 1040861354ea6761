/** The pane of the motor: asks what its plant did while it is on show. What draws it (motor.js) loads when it is first opened. */
import { createLater } from "../later.js";

/** @typedef {import("../later.js").Page} Page */

/** @param {Page} page */
export const createMotorPane = (page) =>
  createLater(page, "motor", async (page) => (await import("./motor.js")).createMotor(page));
