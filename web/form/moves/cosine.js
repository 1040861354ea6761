/** A cosine S-curve: so many steps in so much time. */
import { DISTANCE, number, quantity } from "../field.js";

/** @type {import("../field.js").Kind} */
export const cosine = {
  label: "Cosine S-curve",
  about: { text: "Speed rises as half a wave of a cosine, stays, and falls the same way: no jump of acceleration at the top. So many steps are made in exactly so much time.", from: "song" },
  terms: { ramp_s: { name: "Ramp", text: "Time t_s in which speed rises to its peak, and again falls from it. Peak rate = steps / (duration − ramp): a longer ramp is gentler but needs a higher peak.", from: "song" } },
  fields: [
    quantity("distance", "Distance", DISTANCE, "Negative is left. Rounded to whole steps, and these are reached exactly."),
    number("duration_s", "Duration", "s", "Time of the whole move, above 0. Kept exactly."),
    number("ramp_s", "Ramp", "s", "Time of each ramp, at most half of the duration."),
  ],
};
