/** The spectrum view: harmonics of the ideal and the actual motion as chart and table, and the distortion. */
import { button, byId, element, say } from "../../dom.js";
import { listen } from "../../shell/commands.js";
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

/** Of the harmonics within this many CSS pixels of the pointer the strongest is meant. */
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
    soon();
  };
  /** The selected harmonic's place, if it is visible. */
  const anchor = () => {
    const { start, end } = frequency.shown();
    const at = frequency.place(rows[(now().harmonic ?? 0) - 1]?.hz ?? Number.NaN);
    return at >= start && at <= end ? at : undefined;
  };
  const actions = {
    zoom: (/** @type {number} */ factor) => show(zoomed(frequency.shown(), factor, anchor()), "zoom"),
    fit: () => show(null, ""),
    back: () => {
      frequency.back();
      soon();
    },
    log: () => {
      frequency.setLog(!frequency.isLog());
      soon();
    },
    changed: soon,
  };
  const fields = createFields(byId("spectrum-tools"), actions);
  const tableButton = button("Table", "Show the harmonics as a table", () => {
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
  watch(canvas, soon);
  gestures(slider, () => plot ?? { left: 0, right: 1 }, {
    shown: frequency.shown,
    show: (window, joins) => show(window, joins ?? ""),
    boxing: () => now().box,
    picked: () => picked,
    pick: (span) => {
      picked = span;
      mark(now());
    },
    hover: (at) => at !== null && choose(at),
    click: (_, at) => choose(at),
  });

  /** Chooses the harmonic that is meant by a place. @param {number} at */
  function choose(at) {
    if (!plot || rows.length === 0) return;
    const { start, end } = frequency.shown();
    const reach = (NEAR_PX * (end - start)) / (plot.right - plot.left);
    const strength = (/** @type {number} */ n) => Math.max(...rows[n - 1].parts.map(({ part }) => part));
    let best = Math.round((frequency.isLog() ? 10 ** at : at) / rows[0].hz);
    best = Math.min(rows.length, Math.max(1, best));
    const near = (/** @type {number} */ n) => rows[n - 1] && Math.abs(frequency.place(rows[n - 1].hz) - at) <= reach;
    for (const by of [-1, 1]) for (let n = best + by; near(n); n += by) if (strength(n) > strength(best)) best = n;
    point(best);
  }

  /** @param {number} n */
  function go(n) {
    const to = Math.min(rows.length, Math.max(1, n));
    if (rows.length === 0) return;
    point(to);
    const { start, end } = frequency.shown();
    const at = frequency.place(rows[to - 1].hz);
    if (at < start || at > end) show({ start: at - (end - start) / 2, end: at + (end - start) / 2 }, "follow");
  }
  const step = (/** @type {number} */ by) => go((now().harmonic ?? (by > 0 ? 0 : 2)) + by);
  for (const target of [slider, byId("harmonics-scroll")]) {
    const upright = target === slider;
    listen(target, "Spectrum", [
      { keys: upright ? ["ArrowRight", "ArrowUp"] : ["ArrowRight"], text: "next harmonic", run: () => step(1) },
      { keys: upright ? ["ArrowLeft", "ArrowDown"] : ["ArrowLeft"], text: "previous harmonic", run: () => step(-1) },
      { keys: ["Home"], text: "the fundamental", run: () => go(1) },
      { keys: ["End"], text: "highest harmonic", run: () => go(rows.length) },
      { keys: ["+", "="], text: "zoom in around the selected harmonic", run: () => actions.zoom(0.5) },
      { keys: ["-", "−"], text: "zoom out", run: () => actions.zoom(2) },
      {
        keys: ["Shift+ArrowLeft"],
        text: "lower frequencies",
        run: () => show(moved(frequency.shown(), -0.1), "pan"),
      },
      {
        keys: ["Shift+ArrowRight"],
        text: "higher frequencies",
        run: () => show(moved(frequency.shown(), 0.1), "pan"),
      },
      { keys: ["0"], text: "show the whole spectrum", run: actions.fit },
      { keys: ["Backspace"], text: "back to the previous view", run: actions.back },
      { keys: ["l"], text: "logarithmic or linear frequencies", run: actions.log },
      { keys: ["b"], text: "turn box zoom on or off", run: () => dispatch({ type: "box", on: !now().box }) },
      { keys: ["Escape"], text: "no harmonic", run: () => point(null) },
    ]);
  }

  /** Draws in the next frame, however much has changed until then. */
  function soon() {
    frame ||= requestAnimationFrame(drawChart);
  }

  /** Draws other spectra, once the curves and pulses are on the screen: a key that is pressed meanwhile waits for one of them, not for all. @param {Spectra} found */
  async function take(found) {
    spectra = found;
    await new Promise((shown) => requestAnimationFrame(() => setTimeout(shown)));
    paint();
  }

  /** What follows from the spectra and from what is selected of them. */
  function paint() {
    const { quantity, db } = selectedSpectrum();
    const some = spectra?.ideal ?? spectra?.pulses ?? null;
    const note = byId("spectrum-note");
    say(byId("thd"), spectra && some?.periodic ? distortion(spectra, quantity) : "");
    say(note, `${spectra?.note ?? ""} ${some ? method(some) : ""}`.trim());
    note.title = note.textContent ?? "";
    byId("spectrum-split").hidden = !some;
    byId("spectrum-reading").hidden = !some;
    say(amplitudes, db ? "dB of the fundamental" : UNITS[quantity]);
    say(frequencies, some ? overFrequency(some) : "");
    rows = spectra && some ? harmonics(spectra, quantity) : [];
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

  /** Highlights the harmonic that is pointed at, stem and row, and draws the box. @param {State} state */
  function mark({ harmonic }) {
    const row = harmonic === null ? undefined : rows[harmonic - 1];
    const { quantity, db } = selectedSpectrum();
    const some = spectra?.ideal ?? spectra?.pulses;
    const text = row ? describe(row, quantity, some?.periodic ?? false) : "";
    const reading = (/** @type {string} */ of) => {
      const part = row?.parts.find(({ name }) => name === of);
      return part ? `${of} ${value(part, quantity, db)}` : of;
    };
    say(byId("spectrum-at"), row ? `n ${row.n} · ${si(row.hz, "Hz", 5)}` : "");
    say(byId("spectrum-ideal"), reading("ideal"));
    say(byId("spectrum-pulses"), reading("pulses"));
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
    const at = row ? frequency.place(row.hz) : Number.NaN;
    if (!(at >= start && at <= end)) return;
    const half = Math.max(4, Math.min(12, px(frequency.place((row?.hz ?? 0) + rows[0].hz)) - px(at)) / 2);
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
  return { take, render };
}
