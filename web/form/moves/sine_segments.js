/** A sine as segments of fixed rate. */
import { DISTANCE, integer, number, quantity } from "../field.js";

/** @type {import("../field.js").Kind} */
export const sine_segments = {
  label: "Sine in segments",
  about: {
    text: "A sine made of straight segments, each with one fixed rate: a few numbers in place of one interval for every step. Where the segments break is worked out from the largest deviation d1.",
    from: "sine",
  },
  terms: {
    amplitude: {
      name: "Amplitude",
      text: "From the middle of the swing to one end; the carriage of a calibration rig swings by twice this.",
      from: "sine",
    },
    period_s: { name: "Period", text: "Time T_k of one swing to and fro; one over it is the frequency.", from: "sine" },
    periods: {
      name: "Periods",
      text: "How often the swing is repeated. The spectrum is taken over whole periods.",
      from: "sine",
    },
    max_deviation: {
      name: "Deviation d1",
      text: "How far a segment may lie from the sine, in parts of the amplitude. A smaller d1 makes more segments; the distortion does not simply fall with it.",
      from: "sine",
    },
  },
  fields: [
    quantity("amplitude", "Amplitude", DISTANCE, "From the middle to an extreme, above 0."),
    number("period_s", "Period", "s", "Time of one period, above 0."),
    integer("periods", "Periods", "", "How many whole periods, from 1."),
    number(
      "max_deviation",
      "Deviation d1",
      "× A",
      "Largest distance of a segment from the sine, d1; 0.002 to 0.015 in the document.",
    ),
  ],
};
