/** Position curves of the page as a device, one line per channel (LIVE H4). */
import { element, fill, setText } from "../../dom.js";
import { count } from "../../state/number.js";

/** @typedef {import("../../engine/live.js").Served} Served */

const SVG = "http://www.w3.org/2000/svg";
const [WIDTH, HEIGHT] = [1000, 100];
/** Lines with different colors; the following lines repeat them. */
const COLORS = 4;

/** @param {string} tag @param {{[name: string]: string}} attributes */
function svgElement(tag, attributes) {
  const node = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}

export function positionCurves() {
  const svg = svgElement("svg", {
    viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
    preserveAspectRatio: "none",
    "aria-hidden": "true",
  });
  const about = element("figcaption");
  const node = element("figure", { id: "live-curves", class: "live-curves" }, about);
  node.prepend(svg);
  return {
    node,
    /** @param {Served} served */
    draw({ seconds, curves_from, controllers }) {
      const lines = controllers.flatMap(({ curves }) => curves);
      node.hidden = lines.length === 0;
      const all = lines.flat();
      const [min, max] = all.reduce(
        ([low, high], value) => [Math.min(low, value), Math.max(high, value)],
        [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY],
      );
      const span = Math.max(1, max - min);
      const shapes = lines.map((line, index) => {
        const at = (/** @type {number} */ value, /** @type {number} */ point) =>
          `${((point * WIDTH) / (line.length - 1)).toFixed(1)},${(HEIGHT - ((value - min) * HEIGHT) / span).toFixed(1)}`;
        return svgElement("polyline", { points: line.map(at).join(" "), class: `line-${index % COLORS}` });
      });
      fill(svg, ...shapes);
      setText(
        about,
        `Positions of the last ${(seconds - curves_from).toFixed(0)} s, from ${count(min)} to ${count(max)} steps.`,
      );
    },
  };
}
