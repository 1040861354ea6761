/** A cosine S-curve: so many steps in so much time. */
import { choice, DISTANCE, number, quantity } from "../field.js";

/** @type {import("../field.js").Kind} */
export const cosine = {
  label: "Cosine S-curve",
  about: {
    text: "Speed rises as half a wave of a cosine, stays, and falls the same way: no jump of acceleration at the top. So many steps are made in exactly so much time.",
    from: "song",
  },
  terms: {
    ramp_s: {
      name: "Ramp",
      text: "Time t_s in which speed rises to its peak, and again falls from it. Peak rate = steps / (duration − ramp): a longer ramp is gentler but needs a higher peak.",
      from: "song",
    },
    cosine_method: {
      name: "Step times",
      text: "A small controller looks at the curve once a slice and makes whole steps in it: too few, so the document asks for more steps than there are until the sum is right, and then shortens the plateau. The move ends early by that, up to 0.8 % in the document. Exact times have no such error.",
      from: "song",
    },
    slice_s: {
      name: "Slice",
      text: "Time TS for which the document's controller keeps a rate, 1 ms there. Each slice has the whole steps of the rate at its start.",
      from: "song",
    },
  },
  fields: [
    quantity(
      "distance",
      "Distance",
      DISTANCE,
      "Negative is left. Rounded to whole steps, and these are reached exactly.",
    ),
    number(
      "duration_s",
      "Duration",
      "s",
      "Time of the whole move, above 0. Kept exactly but by slices with a plateau.",
    ),
    number("ramp_s", "Ramp", "s", "Time of each ramp, at most half of the duration."),
    {
      ...choice(
        "method",
        "Step times",
        { exact: "exact", sliced: "in slices" },
        "Each step where the curve has it; or whole steps in slices of time, as in the document, with its time error.",
      ),
      term: "cosine_method",
    },
    {
      ...number("slice_s", "Slice", "s", "0.00001 to 0.1; the document has 0.001."),
      when: { key: "method", is: "sliced" },
    },
  ],
};
