/** Ramps of a shape that is chosen: so many steps in so much time. */
import { choice, DISTANCE, number, quantity } from "../field.js";

/** @type {import("../field.js").Kind} */
export const ramps = {
  label: "Ramps of a shape",
  about: {
    text: "As the cosine S-curve, so many steps in exactly so much time, with ramps of another shape: what each costs in peak rate, acceleration and jerk shows beside it. The document weighs sigmoid and Bezier curves against the cosine.",
    from: "song",
  },
  terms: {
    shape: {
      name: "Shape",
      text: "How the speed goes from nothing to its top. Straight is uniform acceleration: least peak acceleration, but it jumps. An exponential is steep at first, where a motor has most torque, and needs the lowest peak rate. Sigmoid and Bezier curves start and end gently, as a cosine does.",
      from: "song",
    },
    sigmoid_range: {
      name: "Sigmoid's range",
      text: "1/(1 + e⁻ˣ) has no end; this is where it is cut off on both sides. A cut one would never reach its full speed, which the document holds against it, so what is left is stretched to do so. A small range is nearly straight, a great one crowds all acceleration into the middle.",
      from: "song",
    },
    time_constants: {
      name: "Time constants",
      text: "How many time constants of the exponential a ramp has. More of them are steeper at the start and flatter at the top; few are nearly straight.",
    },
  },
  fields: [
    quantity(
      "distance",
      "Distance",
      DISTANCE,
      "Negative is left. Rounded to whole steps, and these are reached exactly.",
    ),
    number("duration_s", "Duration", "s", "Time of the whole move, above 0. Kept exactly."),
    number("ramp_s", "Ramp", "s", "Time of each ramp, at most half of the duration."),
    choice(
      "shape",
      "Shape",
      { sigmoid: "sigmoid", bezier: "Bezier", straight: "straight", exponential: "exponential" },
      "Slowing down is speeding up, mirrored in time.",
    ),
    {
      ...number("sigmoid_range", "Sigmoid's range", "", "x of 1/(1 + e⁻ˣ) goes from minus to plus this, 0.1 to 20."),
      when: { key: "shape", is: "sigmoid" },
    },
    {
      ...number("time_constants", "Time constants", "", "Of the exponential within a ramp, 0.1 to 20."),
      when: { key: "shape", is: "exponential" },
    },
  ],
};
