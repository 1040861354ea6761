/** One rate from the first step to the last. */
import { DISTANCE, quantity, SPEED } from "../field.js";

/** @type {import("../field.js").Kind} */
export const constant = {
  label: "Constant rate",
  about: {
    text: "One rate from the first step to the last, with no ramp. A motor follows this only up to its start-stop rate.",
  },
  terms: { speed: { name: "Speed", text: "Rate of all steps of the move." } },
  fields: [
    quantity("distance", "Distance", DISTANCE, "Negative is left."),
    quantity("speed", "Speed", SPEED, "From the first step to the last, above 0."),
  ],
};
