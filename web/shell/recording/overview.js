/** The overview of a recording in its dialog. Dragging selects the visible part. */
import { element, fill } from "../../dom.js";
import { plain, time } from "../../state/number.js";
import { message } from "../link.js";

/** @typedef {import("../../engine/capture.js").Preview} Preview */
/** @typedef {import("../../engine/capture.js").Columns} Columns */

/** Heights of the position's and the speed's band and of what is between, in CSS pixels. */
const [POSITION_PX, SPEED_PX, BETWEEN_PX] = [64, 40, 6];
/** A press that moves no further is no drag, in CSS pixels. */
const STILL_PX = 4;
/** How much of what is left out is seen through. */
const LEFT_OUT = 0.7;
/** Rest after a change of the width before other columns are requested, in ms. */
const REST_MS = 200;

/**
 * @param {{overview: (channel: number, columns: number) => Promise<Columns | null>}} capture
 * @param {(part: {from_s: number, to_s: number} | null) => void} choose  Null for all of it.
 */
export function createOverview(capture, choose) {
  const canvas = element("canvas", { role: "img" });
  Object.assign(canvas.style, { display: "block", width: "100%", cursor: "col-resize", touchAction: "pan-y" });
  canvas.style.height = `${POSITION_PX + BETWEEN_PX + SPEED_PX}px`;
  const caption = element("p", {});
  const channel = element("select", { "aria-label": "Channel overview" });
  const node = element("div", { class: "whole" }, channel, canvas, caption);
  node.hidden = true;
  /** What was looked at. @type {Preview | null} */
  let preview = null;
  /** What the columns are of, and how many were requested. */
  let [shown, askedColumns] = ["", 0];
  /** @type {Columns | null} */
  let columns = null;
  let timer = 0;
  /** Where a drag began and where it is, in s. @type {[number, number] | null} */
  let drag = null;

  const end = () => preview?.part?.end_s ?? preview?.end_s ?? 0;
  /** The time under a pointer, to a pixel's digits. @param {PointerEvent} event */
  const at = ({ clientX }) => {
    const { left, width } = canvas.getBoundingClientRect();
    const digits = Math.min(9, Math.max(0, Math.ceil(-Math.log10(end() / width))));
    return Number((Math.min(1, Math.max(0, (clientX - left) / width)) * end()).toFixed(digits));
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (!columns || event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    drag = [at(event), at(event)];
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!drag) return;
    drag[1] = at(event);
    draw();
  });
  canvas.addEventListener("pointerup", () => {
    if (!drag) return;
    const [from_s, to_s] = drag.sort((a, b) => a - b);
    drag = null;
    const isStill = ((to_s - from_s) / end()) * canvas.clientWidth < STILL_PX;
    choose(isStill ? null : { from_s, to_s });
  });
  canvas.addEventListener("pointercancel", () => {
    drag = null;
    draw();
  });
  channel.addEventListener("input", (event) => {
    // It changes what is drawn, not what is asked.
    event.stopPropagation();
    void refresh();
  });
  new ResizeObserver(() => {
    draw();
    clearTimeout(timer);
    timer = window.setTimeout(() => void refresh(), REST_MS);
  }).observe(canvas);

  /** Requests the columns, if these are others. */
  async function refresh() {
    const width = canvas.clientWidth;
    if (!preview || width === 0) return;
    // The sample rate and the end of the file are in the time of its end.
    const own = [preview.map, preview.clock_hz, end(), channel.value].join();
    if (own === shown && width === askedColumns) return draw();
    // Until they come, those of another width stand for them, but none of anything else.
    if (own !== shown) [columns, caption.textContent] = [null, "…"];
    [shown, askedColumns] = [own, width];
    draw();
    const isOwn = () => own === shown && width === askedColumns;
    try {
      const found = await capture.overview(Number(channel.value), width);
      if (!isOwn()) return;
      columns = found;
      draw();
      describe();
    } catch (error) {
      if (!isOwn()) return;
      [columns, shown] = [null, ""];
      draw();
      say(`The overview of channel ${channel.value} cannot be shown: ${message(error)}.`, true);
    }
  }

  /** @param {string} what @param {boolean} isWrong */
  function say(what, isWrong) {
    canvas.setAttribute("aria-label", what);
    caption.classList.toggle("error", isWrong);
    caption.textContent = isWrong ? what : `${what} Drag to select a part.`;
  }

  function describe() {
    if (!columns) return;
    const [low, high] = rangeOf([columns.position_min, columns.position_max]);
    const speeds = rangeOf([columns.speed_min, columns.speed_max]).map(Math.abs);
    const what = `Channel ${channel.value}, ${time(end())}: position ${plain(low, "").trim()} to ${plain(high, "steps")}, at most ${plain(Math.max(...speeds), "steps/s")}.`;
    say(what, false);
  }

  function draw() {
    const ratio = Math.min(2, Math.max(1, window.devicePixelRatio || 1));
    const { clientWidth: width, clientHeight: height } = canvas;
    [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    const pen = canvas.getContext("2d");
    if (!pen || !columns) return;
    pen.scale(ratio, ratio);
    const theme = getComputedStyle(canvas);
    const ink = (/** @type {string} */ name) => theme.getPropertyValue(name);
    band(pen, columns.position_min, columns.position_max, { width, top: 0, high: POSITION_PX, ink: ink("--actual") });
    const top = POSITION_PX + BETWEEN_PX;
    band(pen, columns.speed_min, columns.speed_max, { width, top, high: SPEED_PX, ink: ink("--ideal") });
    const part = drag
      ? [Math.min(...drag), Math.max(...drag)]
      : preview?.part && [preview.part.from_s, preview.part.to_s];
    if (!part) return;
    const [from, to] = part.map((at_s) => (at_s / end()) * width);
    pen.globalAlpha = LEFT_OUT;
    pen.fillStyle = ink("--pane");
    pen.fillRect(0, 0, from, height);
    pen.fillRect(to, 0, width - to, height);
    pen.globalAlpha = 1;
    pen.fillStyle = ink("--ink");
    for (const x of [from, to]) pen.fillRect(x - 0.5, 0, 1, height);
  }

  return {
    node,
    /** @param {Preview | null} found  What was looked at; none, or no step in it, leaves nothing to see. */
    render(found) {
      preview = found;
      node.hidden = !found || found.steps.length === 0;
      if (!found || node.hidden) return;
      const options = found.steps.map(({ channel: each }) =>
        element("option", { value: String(each) }, `channel ${each}`),
      );
      const selected = found.steps.some(({ channel: each }) => String(each) === channel.value) ? channel.value : "";
      fill(channel, ...options);
      channel.value = selected || String(found.steps[0].channel);
      channel.hidden = found.steps.length < 2;
      void refresh();
    },
  };
}

/** Minimum and maximum of all. @param {number[][]} all @returns {number[]} */
function rangeOf(all) {
  const values = all.flat().filter(Number.isFinite);
  return [values.reduce((a, b) => Math.min(a, b), 0), values.reduce((a, b) => Math.max(a, b), 0)];
}

/**
 * A column a pixel, from its least to its greatest value.
 * @param {CanvasRenderingContext2D} pen @param {number[]} min @param {number[]} max
 * @param {{width: number, top: number, high: number, ink: string}} place
 */
function band(pen, min, max, { width, top, high, ink }) {
  const [low, most] = rangeOf([min, max]);
  const y = (/** @type {number} */ value) => top + (high - 1) * (1 - (value - low) / (most - low || 1));
  pen.fillStyle = ink;
  for (const [at, value] of max.entries()) {
    if (!Number.isFinite(value)) continue;
    const each = width / max.length;
    pen.fillRect(at * each, y(value), Math.max(1, each), Math.max(1, y(min[at]) - y(value) + 1));
  }
}
