/** Draws the strip: position, bands, inputs and script. */
import { shortInputLabel } from "./names.js";
import { paintBand, paintCurve, paintEntry, paintIgnored, paintLevel, paintName, paintTime, xOf } from "./paint.js";
import { BANDS, PUSH, ROW_PX, rowOf } from "./strip_layout.js";

/** @typedef {import("./script.js").Placed} Placed */
/** @typedef {import("./paint.js").Ground} Ground */

/** Entries that are closer together, in CSS pixels, are drawn as one. */
const SAME_PX = 0.05;

/**
 * @param {Ground} ground
 * @param {{story: import("./story.js").Story, curve: import("./paint.js").Curve | null, rows: string[], entries: Placed[], selected: Placed | null,
 *   clock: number, curvePx: number, height: number, print: (steps: number) => string}} strip
 */
export function paintStrip(ground, { story, curve, rows, entries, selected, clock, curvePx, height, print }) {
  const { context, plot } = ground;
  const isShown = (/** @type {number} */ cycle) => cycle >= ground.start && cycle <= ground.end;
  const topOf = (/** @type {number} */ row) => curvePx + row * ROW_PX;
  paintTime(ground, clock, 0, height);
  if (curve) paintCurve(ground, curve, curvePx, print);
  for (const [at, band] of BANDS.entries()) {
    paintName(context, band, plot.left, topOf(at), false);
    paintBand(ground, story.records, band, topOf(at));
  }
  const selectedRow = selected && rowOf(rows, selected.entry);
  for (const [at, input] of rows.entries()) {
    const top = topOf(BANDS.length + at);
    paintName(
      context,
      input === PUSH ? input : shortInputLabel(input),
      plot.left,
      top,
      BANDS.length + at === selectedRow,
    );
    if (input !== PUSH) paintLevel(ground, story.inputs.get(input), input === "power" ? 1 : 0, top);
    for (const press of story.ignored)
      if (press.input === input && isShown(press.cycle)) paintIgnored(context, xOf(ground, press.cycle), top);
  }
  /** Pixel of the last drawn entry of each row. @type {Map<number, number>} */
  const last = new Map();
  for (const { entry, owner, index } of entries) {
    if (!isShown(entry.cycle)) continue;
    const isSelected = owner === selected?.owner && index === selected.index;
    const x = xOf(ground, entry.cycle);
    const row = rowOf(rows, entry);
    if (!isSelected && Math.abs(x - (last.get(row) ?? -Infinity)) < SAME_PX) continue;
    last.set(row, x);
    paintEntry(context, x, topOf(row), isSelected);
  }
}
