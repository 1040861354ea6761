/** The spectrum view: harmonics of the ideal and the actual motion as chart and table, and the distortion. */
import { button, byId, element, iconOf, setText } from "../../dom.js";
import { registerCommands } from "../../shell/commands.js";
import { si } from "../../state/number.js";
import { gestures, moved, zoomed } from "../../time/gestures.js";
import { cleared, color, draw, fit, watch } from "../../time/plot.js";
import { selectedSpectrum, spectrumChart } from "./chart.js";
import { createFields } from "./fields.js";
import { frequency } from "./frequency.js";
import { describe, distortion, harmonics, method, nameOf, overFrequency, UNITS, value } from "./harmonics.js";
import { createHarmonicsTable } from "./table.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").Spectra} Spectra */

/** The pointer selects the strongest harmonic within this distance, in CSS pixels. */
const NEAR_PX = 2;

/** @param {import("../../state/types.js").Page} page */
export function createSpectrumView({ dispatch, now }) {
  const canvas = /** @type {HTMLCanvasElement} */ (byId("spectrum-chart"));
  const overlay = /** @type {HTMLCanvasElement} */ (byId("spectrum-cursor"));
  const slider = byId("spectrum-pane");
  const view = byId("view-spectrum");
  /** @type {Spectra | null} */
  let spectra = null;
  /** @type {ReturnType<typeof harmonics>} */
  let rows = [];
  /** @type {import("../../state/types.js").Plot | null} */
  let plot = null;
  /** @type {import("../../state/types.js").Span | null} */
  let picked = null;
  let frame = 0;

  const point = (/** @type {number | null} */ harmonic) => dispatch({ type: "harmonic", harmonic });
  const table = createHarmonicsTable(point);
  const show = (/** @type {import("../../state/types.js").Span | null} */ window, /** @type {string} */ joins) => {
    frequency.show(window, joins);
    drawSoon();
  };
  /** Position of the selected harmonic, if it is visible. */
  const anchor = () => {
    const { start, end } = frequency.shown();
    const at = frequency.toPosition(rows[(now().harmonic ?? 0) - 1]?.hz ?? Number.NaN);
    return at >= start && at <= end ? at : undefined;
  };
  const actions = {
    zoom: (/** @type {number} */ factor) => show(zoomed(frequency.shown(), factor, anchor()), "zoom"),
    fit: () => show(null, ""),
    back: () => {
      frequency.back();
      drawSoon();
    },
    toggleLog: () => {
      frequency.setLog(!frequency.isLog());
      drawSoon();
    },
    redraw: drawSoon,
  };
  const fields = createFields(byId("spectrum-tools"), actions);
  const tableButton = button(iconOf("#motion-data > summary"), "Show the harmonics as a table", () => {
    tableButton.setAttribute("aria-pressed", String(view.classList.toggle("tabled")));
  });
  const [amplitudes, frequencies] = ["of-amplitudes", "of-frequencies"].map((name) =>
    element("p", { class: `axis-name ${name}` }),
  );
  slider.append(amplitudes, frequencies);
  tableButton.id = "spectrum-table";
  tableButton.setAttribute("aria-pressed", "false");
  byId("spectrum-log").after(tableButton);

  for (const id of ["spectrum-quantity", "spectrum-scale"]) byId(id).addEventListener("change", paint);
  watch(canvas, drawSoon);
  gestures(slider, () => plot ?? { left: 0, right: 1 }, {
    shown: frequency.shown,
    show: (window, joins) => show(window, joins ?? ""),
    boxing: () => now().box,
    picked: () => picked,
    pick: (span) => {
      picked = span;
      mark(now());
    },
    hover: (at) => at !== null && select(at),
    click: (_, at) => select(at),
  });

  /** Selects the strongest harmonic near a position. @param {number} at */
  function select(at) {
    if (!plot || rows.length === 0) return;
    const { start, end } = frequency.shown();
    const reach = (NEAR_PX * (end - start)) / (plot.right - plot.left);
    const strength = (/** @type {number} */ n) => Math.max(...rows[n - 1].parts.map(({ ratio }) => ratio));
    let best = Math.round((frequency.isLog() ? 10 ** at : at) / rows[0].hz);
    best = Math.min(rows.length, Math.max(1, best));
    const near = (/** @type {number} */ n) =>
      rows[n - 1] && Math.abs(frequency.toPosition(rows[n - 1].hz) - at) <= reach;
    for (const by of [-1, 1]) for (let n = best + by; near(n); n += by) if (strength(n) > strength(best)) best = n;
    point(best);
  }

  /** Selects a harmonic and brings it into view. @param {number} n */
  function goTo(n) {
    const to = Math.min(rows.length, Math.max(1, n));
    if (rows.length === 0) return;
    point(to);
    const { start, end } = frequency.shown();
    const at = frequency.toPosition(rows[to - 1].hz);
    if (at < start || at > end) show({ start: at - (end - start) / 2, end: at + (end - start) / 2 }, "follow");
  }
  const step = (/** @type {number} */ by) => goTo((now().harmonic ?? (by > 0 ? 0 : 2)) + by);
  for (const target of [slider, byId("harmonics-scroll")]) {
    const hasVerticalKeys = target === slider;
    registerCommands(target, "Spectrum", [
      { keys: hasVerticalKeys ? ["ArrowRight", "ArrowUp"] : ["ArrowRight"], text: "next harmonic", run: () => step(1) },
      {
        keys: hasVerticalKeys ? ["ArrowLeft", "ArrowDown"] : ["ArrowLeft"],
        text: "previous harmonic",
        run: () => step(-1),
      },
      { keys: ["Home"], text: "select the fundamental", run: () => goTo(1) },
      { keys: ["End"], text: "select the highest harmonic", run: () => goTo(rows.length) },
      { keys: ["+", "="], text: "zoom in around the selected harmonic", run: () => actions.zoom(0.5) },
      { keys: ["-", "−"], text: "zoom out", run: () => actions.zoom(2) },
      {
        keys: ["Shift+ArrowLeft"],
        text: "show lower frequencies",
        run: () => show(moved(frequency.shown(), -0.1), "pan"),
      },
      {
        keys: ["Shift+ArrowRight"],
        text: "show higher frequencies",
        run: () => show(moved(frequency.shown(), 0.1), "pan"),
      },
      { keys: ["0"], text: "show the whole spectrum", run: actions.fit },
      { keys: ["Backspace"], text: "back to the previous view", run: actions.back },
      { keys: ["l"], text: "switch between logarithmic and linear frequencies", run: actions.toggleLog },
      { keys: ["b"], text: "turn box zoom on or off", run: () => dispatch({ type: "box", on: !now().box }) },
      { keys: ["Escape"], text: "clear the selection", run: () => point(null) },
    ]);
  }

  /** Draws once in the next frame. */
  function drawSoon() {
    frame ||= requestAnimationFrame(drawChart);
  }

  /** Draws new spectra after the other views, so that a key pressed meanwhile does not wait for all of them. @param {Spectra} found */
  async function setSpectra(found) {
    spectra = found;
    await new Promise((shown) => requestAnimationFrame(() => setTimeout(shown)));
    paint();
  }

  /** Updates texts, table and chart after a change of the spectra or of the selection. */
  function paint() {
    const { quantity, db } = selectedSpectrum();
    const first = spectra?.ideal ?? spectra?.pulses ?? null;
    const note = byId("spectrum-note");
    setText(byId("thd"), spectra && first?.periodic ? distortion(spectra, quantity) : "");
    setText(note, `${spectra?.note ?? ""} ${first ? method(first) : ""}`.trim());
    note.title = note.textContent ?? "";
    byId("spectrum-split").hidden = !first;
    byId("spectrum-reading").hidden = !first;
    setText(amplitudes, db ? "dB of the fundamental" : UNITS[quantity]);
    setText(frequencies, first ? overFrequency(first) : "");
    rows = spectra && first ? harmonics(spectra, quantity) : [];
    table.show(rows);
    drawChart();
  }

  function drawChart() {
    cancelAnimationFrame(frame);
    frame = 0;
    const { quantity, db } = selectedSpectrum();
    if (spectra && rows.length > 0 && canvas.clientWidth > 0) {
      plot = draw(canvas, spectrumChart(spectra, quantity, db, canvas.clientWidth));
      fit(overlay);
      const { start, end } = frequency.hertz();
      canvas.setAttribute(
        "aria-label",
        `Spectrum of ${nameOf(quantity)} in ${db ? "dB" : "plain amplitudes"}, ${si(start, "Hz")} to ${si(end, "Hz")}, ${rows.length} harmonics of ${si(rows[0].hz, "Hz")}; the table has the numbers`,
      );
      fields.render(frequency.hertz());
    }
    mark(now());
  }

  /** Highlights the selected harmonic and draws the zoom box. @param {State} state */
  function mark({ harmonic }) {
    const row = harmonic === null ? undefined : rows[harmonic - 1];
    const { quantity, db } = selectedSpectrum();
    const first = spectra?.ideal ?? spectra?.pulses;
    const text = row ? describe(row, quantity, first?.periodic ?? false) : "";
    const reading = (/** @type {string} */ spectrum) => {
      const line = row?.parts.find(({ name }) => name === spectrum);
      return line ? `${spectrum} ${value(line, quantity, db)}` : spectrum;
    };
    setText(byId("spectrum-at"), row ? `n ${row.n} · ${si(row.hz, "Hz", 5)}` : "");
    setText(byId("spectrum-ideal"), reading("ideal"));
    setText(byId("spectrum-pulses"), reading("actual"));
    slider.setAttribute("aria-valuemax", String(Math.max(1, rows.length)));
    slider.setAttribute("aria-valuenow", String(row?.n ?? 1));
    slider.setAttribute("aria-valuetext", text || "no harmonic selected");
    table.mark(row?.n ?? null);
    const layer = cleared(overlay);
    if (!layer || !plot) return;
    const { left, right, top, bottom } = plot;
    const { start, end } = frequency.shown();
    const px = (/** @type {number} */ at) =>
      Math.min(right, Math.max(left, left + ((at - start) / (end - start)) * (right - left)));
    layer.context.fillStyle = color("--mark");
    if (picked) {
      layer.context.globalAlpha = 0.3;
      layer.context.fillRect(px(picked.start), top, px(picked.end) - px(picked.start), bottom - top);
    }
    const at = row ? frequency.toPosition(row.hz) : Number.NaN;
    if (!(at >= start && at <= end)) return;
    const half = Math.max(4, Math.min(12, px(frequency.toPosition((row?.hz ?? 0) + rows[0].hz)) - px(at)) / 2);
    layer.context.globalAlpha = 0.3;
    layer.context.fillRect(px(at) - half, top, 2 * half, bottom - top);
    layer.context.globalAlpha = 1;
    layer.context.strokeStyle = color("--axis");
    layer.context.strokeRect(px(at) - half + 0.5, top + 0.5, 2 * half - 1, bottom - top - 1);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (before?.harmonic !== state.harmonic) mark(state);
  }
  return { setSpectra, render };
}
