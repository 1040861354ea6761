/** A trapezoid: uniform acceleration, by table or exact. */
import { ACCELERATION, choice, DISTANCE, integer, quantity, SPEED } from "../field.js";

/** @type {import("../field.js").Kind} */
export const trapezoid = {
  label: "Trapezoid",
  about: {
    text: "Speed rises evenly from the start speed to the top speed, stays, and falls evenly. After k steps v = √(v0² + 2·a·x), x the way of k steps.",
    from: "sonobe",
  },
  terms: {
    method: {
      name: "Step times",
      text: "A small controller keeps a table of pulse rates, one entry a step, and loads a timer with clock / rate: both are whole numbers, so each step comes a little early or late. Exact times show what is lost by that.",
      from: "sonobe",
    },
    timer_hz: {
      name: "Timer clock",
      text: "The timer that the controller reloads for every step counts this clock. A slow one makes coarse step times.",
      from: "sonobe",
    },
  },
  fields: [
    quantity("distance", "Distance", DISTANCE, "Negative is left."),
    quantity("start_speed", "Start speed", SPEED, "Speed of the first step, above 0."),
    quantity(
      "top_speed",
      "Top speed",
      SPEED,
      "Speed of the plateau, at least the start speed; short moves do not reach it.",
    ),
    quantity("acceleration", "Acceleration", ACCELERATION, "Above 0; also of the slowing down."),
    choice(
      "method",
      "Step times",
      { table: "table and timer", exact: "exact" },
      "Whole rates from a table and a timer's whole reloads, as the document has them; or the ideal curve's own times.",
    ),
    {
      ...integer("timer_hz", "Timer clock", "Hz", "Counts the table's reloads."),
      when: { key: "method", is: "table" },
    },
  ],
};
