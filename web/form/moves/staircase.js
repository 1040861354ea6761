/** A fixed length by a staircase of rates. */
import { choice, DISTANCE, integer, quantity, SPEED } from "../field.js";

/** @type {import("../field.js").Kind} */
export const staircase = {
  label: "Staircase of rates",
  about: {
    text: "Speed climbs a staircase of whole rates, each held for some steps (30, later 60, 90, …), so that a short table is enough for a long ramp; then a plateau, and down the same stairs.",
    from: "zhang",
  },
  terms: {
    acceleration_level: {
      name: "Acceleration level",
      text: "One of five accelerations that the controller offers: level times 1000 steps/s².",
      from: "zhang",
    },
    short_move: {
      name: "Short moves",
      text: "A move with less way than both ramps need never reaches its top speed. The document makes the whole of it at the start speed; reversing on the way up is quicker.",
      from: "zhang",
    },
    max_speed: {
      name: "Table ends above",
      text: "The rates of the table are worked out once, up to the first one above this.",
      from: "zhang",
    },
  },
  fields: [
    quantity("distance", "Distance", DISTANCE, "Negative is left."),
    quantity(
      "top_speed",
      "Top speed",
      SPEED,
      "Speed of the plateau; at or below the start speed that of the whole move.",
    ),
    { ...integer("level", "Acceleration level", "", "1 to 5: 1000 to 5000 steps/s²."), term: "acceleration_level" },
    choice(
      "short_move",
      "Short moves",
      { document: "at start speed", reverse: "reverse at the highest row" },
      "What becomes of a move that is too short for its top speed: the whole of it at the start speed, as in the document, or up as many rows as there is room for and down again.",
    ),
    quantity("start_speed", "Start speed", SPEED, "First rate of the table."),
    quantity(
      "max_speed",
      "Table ends above",
      SPEED,
      "The table ends with the first rate above this; no top speed may be above it.",
    ),
  ],
};
