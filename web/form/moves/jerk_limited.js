/** A jerk-limited move: seven phases from rest to rest. */
import { ACCELERATION, DISTANCE, JERK, quantity, SPEED } from "../field.js";

/** @type {import("../field.js").Kind} */
export const jerk_limited = {
  label: "Jerk-limited S-curve",
  about: {
    text: "As fast as three limits allow: acceleration rises evenly by the jerk, stays at its limit, and falls again before the top speed is reached; then the same to slow down. Seven phases, of which a short move leaves some out. Without a jump of acceleration a machine shakes less.",
    from: "own",
  },
  terms: {
    greatest_speed: {
      name: "Greatest speed",
      text: "Speed of the plateau, where the move is long enough to have one.",
    },
    max_acceleration: {
      name: "Greatest acceleration",
      text: "The acceleration never passes this; a short move may not reach it.",
    },
    max_jerk: {
      name: "Greatest jerk",
      text: "How much the acceleration changes in a second, at most. An infinite jerk would be a trapezoid.",
    },
  },
  fields: [
    quantity("distance", "Distance", DISTANCE, "Negative is left."),
    {
      ...quantity("max_speed", "Greatest speed", SPEED, "Above 0; short moves do not reach it."),
      term: "greatest_speed",
    },
    quantity("max_acceleration", "Greatest acceleration", ACCELERATION, "Above 0; also of the slowing down."),
    quantity("max_jerk", "Greatest jerk", JERK, "Above 0; how fast the acceleration may change."),
  ],
};
