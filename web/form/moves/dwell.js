/** Standing still between two moves. */
import { number } from "../field.js";

/** @type {import("../field.js").Kind} */
export const dwell = {
  label: "Dwell",
  about: {
    text: "Standing still with the windings powered: a pause between two moves, such as in the programs of a fixed-length controller.",
    from: "zhang",
  },
  fields: [number("duration_s", "Duration", "s", "Standing still, from 0.")],
};
