/**
 * What a move can be, in the order of the menu: a file a kind. All that the page knows of a kind stands in its
 * file; docs/adding_a_motion.md has the way to a new one.
 */
import { constant } from "./constant.js";
import { cosine } from "./cosine.js";
import { dwell } from "./dwell.js";
import { jerk_limited } from "./jerk_limited.js";
import { points } from "./points.js";
import { ramps } from "./ramps.js";
import { sine } from "./sine.js";
import { sine_segments } from "./sine_segments.js";
import { staircase } from "./staircase.js";
import { trapezoid } from "./trapezoid.js";

/** By their names in the scenario. @type {{[kind: string]: import("../field.js").Kind}} */
export const MOVES = {
  cosine,
  ramps,
  jerk_limited,
  trapezoid,
  staircase,
  sine_segments,
  sine,
  points,
  constant,
  dwell,
};
