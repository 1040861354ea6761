/** A sine with every step in its place. */
import { DISTANCE, integer, number, quantity } from "../field.js";

/** @type {import("../field.js").Kind} */
export const sine = {
  label: "Exact sine",
  about: {
    text: "Swings like a pendulum: each step comes when the sine itself is half way between two steps. The ideal that a sine made of segments is measured against; it needs an interval for every step.",
    from: "sine",
  },
  fields: [
    quantity("amplitude", "Amplitude", DISTANCE, "From the middle to an extreme; negative starts at the left one."),
    number("period_s", "Period", "s", "Time of one period, above 0."),
    integer("periods", "Periods", "", "How many whole periods, from 1."),
  ],
};
