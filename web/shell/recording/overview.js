/** The overview of a recording in its dialog. Dragging selects the visible part. */
import { element, fill } from "../../dom.js";
import { errorMessage } from "../../state/error_message.js";
import { plain, time } from "../../state/number.js";

/** @typedef {import("../../engine/capture.js").Preview} Preview */
/** @typedef {import("../../engine/capture.js").Columns} Columns */

/** Heights of the position band, the speed band and the gap between them, in CSS pixels. */
const [POSITION_PX, SPEED_PX, BETWEEN_PX] = [64, 40, 6];
/** Minimum length of a drag, in CSS pixels. */
const MIN_DRAG_PX = 4;
/** Opacity of the cover over the parts that are not selected. */
const COVER_OPACITY = 0.7;
/** Delay after a change of the width before new columns are requested, in ms. */
const RESIZE_DELAY_MS = 200;

/**
 * @param {{overview: (channel: number, columns: number) => Promise<Columns | null>}} capture
 * @param {(part: {from_s: number, to_s: number} | null) => void} choose  Selects a part; null selects all.
 */
export function createOverview(capture, choose) {
  const canvas = element("canvas", { role: "img" });
  Object.assign(canvas.style, { display: "block", width: "100%", cursor: "col-resize", touchAction: "pan-y" });
  canvas.style.height = `${POSITION_PX + BETWEEN_PX + SPEED_PX}px`;
  const caption = element("p", {});
  const channel = element("select", { "aria-label": "Channel overview" });
  const node = element("div", { class: "whole" }, channel, canvas, caption);
  node.hidden = true;
  /** @type {Preview | null} */
  let preview = null;
  /** Key and canvas width of the last requested columns. */
  let [requestedKey, requestedWidth] = ["", 0];
  /** @type {Columns | null} */
  let columns = null;
  let timer = 0;
  /** Start and current end of a drag, in s. @type {[number, number] | null} */
  let drag = null;

  const endTime = () => preview?.part?.end_s ?? preview?.end_s ?? 0;
  /** The time under a pointer, rounded to the resolution of a pixel. @param {PointerEvent} event */
  const timeAt = ({ clientX }) => {
    const { left, width } = canvas.getBoundingClientRect();
    const secondsPerPixel = endTime() / width;
    const decimals = Math.min(9, Math.max(0, Math.ceil(-Math.log10(secondsPerPixel))));
    const ratio = Math.min(1, Math.max(0, (clientX - left) / width));
    return Number((ratio * endTime()).toFixed(decimals));
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (!columns || event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    drag = [timeAt(event), timeAt(event)];
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!drag) return;
    drag[1] = timeAt(event);
    draw();
  });
  canvas.addEventListener("pointerup", () => {
    if (!drag) return;
    const [from_s, to_s] = drag.sort((a, b) => a - b);
    drag = null;
    const isClick = ((to_s - from_s) / endTime()) * canvas.clientWidth < MIN_DRAG_PX;
    // A click selects everything.
    choose(isClick ? null : { from_s, to_s });
  });
  canvas.addEventListener("pointercancel", () => {
    drag = null;
    draw();
  });
  channel.addEventListener("input", (event) => {
    // It changes only the drawing, not the options of the preview.
    event.stopPropagation();
    void refresh();
  });
  new ResizeObserver(() => {
    draw();
    clearTimeout(timer);
    timer = window.setTimeout(() => void refresh(), RESIZE_DELAY_MS);
  }).observe(canvas);

  /** Requests the columns again if they have changed. */
  async function refresh() {
    const width = canvas.clientWidth;
    if (!preview || width === 0) return;
    // A change of the sample rate changes the end time.
    const key = [preview.map, preview.clock_hz, endTime(), channel.value].join();
    if (key === requestedKey && width === requestedWidth) return draw();
    // Until they arrive, columns of another width are shown, but none of another channel or map.
    if (key !== requestedKey) [columns, caption.textContent] = [null, "…"];
    [requestedKey, requestedWidth] = [key, width];
    draw();
    const isCurrent = () => key === requestedKey && width === requestedWidth;
    try {
      const found = await capture.overview(Number(channel.value), width);
      if (!isCurrent()) return;
      columns = found;
      draw();
      describe();
    } catch (error) {
      if (!isCurrent()) return;
      [columns, requestedKey] = [null, ""];
      draw();
      showCaption(`The overview of channel ${channel.value} cannot be loaded: ${errorMessage(error)}.`, true);
    }
  }

  /** @param {string} text @param {boolean} isError */
  function showCaption(text, isError) {
    canvas.setAttribute("aria-label", text);
    caption.classList.toggle("error", isError);
    caption.textContent = columns ? `${text} Drag to select a part.` : text;
  }

  function describe() {
    if (!columns) return showCaption(`Channel ${channel.value} has no steps.`, false);
    const [min, max] = rangeOf([columns.position_min, columns.position_max]);
    const speeds = rangeOf([columns.speed_min, columns.speed_max]).map(Math.abs);
    const text = `Channel ${channel.value}, ${time(endTime())}: position ${plain(min, "").trim()} to ${plain(max, "steps")}, maximum speed ${plain(Math.max(...speeds), "steps/s")}.`;
    showCaption(text, false);
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
    band(pen, columns.position_min, columns.position_max, { width, top: 0, height: POSITION_PX, ink: ink("--actual") });
    const top = POSITION_PX + BETWEEN_PX;
    band(pen, columns.speed_min, columns.speed_max, { width, top, height: SPEED_PX, ink: ink("--ideal") });
    const part = drag
      ? [Math.min(...drag), Math.max(...drag)]
      : preview?.part && [preview.part.from_s, preview.part.to_s];
    if (!part) return;
    const [from, to] = part.map((at_s) => (at_s / endTime()) * width);
    pen.globalAlpha = COVER_OPACITY;
    pen.fillStyle = ink("--pane");
    pen.fillRect(0, 0, from, height);
    pen.fillRect(to, 0, width - to, height);
    pen.globalAlpha = 1;
    pen.fillStyle = ink("--ink");
    for (const x of [from, to]) pen.fillRect(x - 0.5, 0, 1, height);
  }

  return {
    node,
    /** @param {Preview | null} found  Without a preview or steps the overview is hidden. */
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

/** Minimum and maximum of all values and 0. @param {number[][]} lists @returns {number[]} */
function rangeOf(lists) {
  const values = lists.flat().filter(Number.isFinite);
  return [values.reduce((a, b) => Math.min(a, b), 0), values.reduce((a, b) => Math.max(a, b), 0)];
}

/**
 * Draws columns from their minimum to their maximum.
 * @param {CanvasRenderingContext2D} pen @param {number[]} minima @param {number[]} maxima
 * @param {{width: number, top: number, height: number, ink: string}} place
 */
function band(pen, minima, maxima, { width, top, height, ink }) {
  const [min, max] = rangeOf([minima, maxima]);
  const y = (/** @type {number} */ value) => top + (height - 1) * (1 - (value - min) / (max - min || 1));
  const columnWidth = width / maxima.length;
  pen.fillStyle = ink;
  for (const [index, value] of maxima.entries()) {
    if (!Number.isFinite(value)) continue;
    pen.fillRect(index * columnWidth, y(value), Math.max(1, columnWidth), Math.max(1, y(minima[index]) - y(value) + 1));
  }
}
