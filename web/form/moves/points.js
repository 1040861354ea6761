/** A curve through points, typed, pasted or chosen as a CSV. */
import { choice } from "../field.js";

/** @type {import("../field.js").Kind} */
export const points = {
  label: "Through points",
  about: {
    text: "A curve given as times and positions: a cam, a record of a real machine, the result of another program. Each step comes where the curve crosses half a step.",
    from: "own",
  },
  terms: {
    points: {
      name: "Points",
      text: "Times in s and positions, one pair a line. Both count from the first point, so a record may begin anywhere. The last position is rounded to a whole step.",
    },
    interpolation: {
      name: "Between them",
      text: "Straight: the speed jumps at every point. Smooth: cubics (Steffen 1990) that turn only where the points turn, so nothing overshoots; they start and end at rest.",
    },
    points_unit: { name: "Unit", text: "Of the positions; millimetres and degrees need mechanics that have them." },
  },
  fields: [
    {
      key: "points",
      label: "Points, one a line",
      kind: "points",
      rows: 8,
      hint: "Time in s and position: 0.25, 12.5. Paste a CSV or choose one; a first line of names is left out. 2 to 4096 points, rising in time.",
    },
    { ...choice("unit", "Unit", { steps: "steps", mm: "mm", deg: "°" }, "Of the positions."), term: "points_unit" },
    choice(
      "interpolation",
      "Between them",
      { smooth: "smooth", straight: "straight" },
      "Smooth, from rest to rest; or straight from point to point.",
    ),
  ],
};
