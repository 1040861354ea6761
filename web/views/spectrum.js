/** The spectrum view: harmonics of the ideal motion beside those of the pulses that make it, and the distortion. */
import { byId, element, fill, say } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";
import { short, si } from "../state/number.js";
import { color, draw, watch } from "../time/plot.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Spectrum} Spectrum */
/** @typedef {import("../state/types.js").Spectra} Spectra */
/** @typedef {"position" | "speed" | "acceleration"} Quantity */

/** Lowest level of the dB scale. */
const FLOOR_DB = -120;
/** Width of the tick labels in CSS pixels. */
const GUTTER = 58;
/** Below this part of the fundamental a harmonic is the arithmetic's own noise. */
const NOISE = 1e-11;
/** And so it is below this many steps, steps/s or steps/s². */
const LEAST = 1e-9;

/** @param {{engine: import("../engine/engine.js").Engine} & import("../time/timeline.js").Page} page */
export function createSpectrum({ engine, now }) {
  const canvas = /** @type {HTMLCanvasElement} */ (byId("spectrum-chart"));
  const quantitySelect = /** @type {HTMLSelectElement} */ (byId("spectrum-quantity"));
  const scaleSelect = /** @type {HTMLSelectElement} */ (byId("spectrum-scale"));
  /** @type {Spectra | null} */
  let spectra = null;

  quantitySelect.addEventListener("change", paint);
  scaleSelect.addEventListener("change", paint);
  watch(canvas, paint);

  /** @param {State} state */
  async function refresh(state) {
    if (!state.result) return;
    const answer = await engine.latest("spectrum", "spectrum").catch(unlessDropped);
    if (answer === undefined) return;
    spectra = answer;
    paint();
  }

  function paint() {
    const quantity = /** @type {Quantity} */ (quantitySelect.value);
    const db = scaleSelect.value === "db";
    const some = spectra?.ideal ?? spectra?.pulses ?? null;
    say(byId("thd"), spectra && some?.periodic ? distortion(spectra, quantity) : "");
    say(byId("spectrum-note"), spectra && some ? `${method(some)} ${spectra.note}`.trim() : spectra?.note ?? "");
    /** @type {HTMLElement} */ (canvas.parentElement).hidden = !some;
    if (!spectra || !some) return table([]);
    table(harmonics(spectra, quantity));
    chart(spectra, some, quantity, db);
  }

  /** @param {Spectra} spectra @param {Spectrum} some @param {Quantity} quantity @param {boolean} db */
  function chart({ ideal, pulses }, some, quantity, db) {
    const shownOrder = some[quantity].length;
    const x = Array.from({ length: shownOrder }, (_, i) => i + 1);
    const level = (/** @type {Spectrum} */ spectrum) => (db
      ? spectrum[quantity].map((value) => 20 * Math.log10(heard(value) / reference(spectrum, quantity)))
      : spectrum[quantity]);
    const top = Math.max(...[ideal, pulses].flatMap((spectrum) => (spectrum ? [...spectrum[quantity]] : [])), 1e-12);
    const width = Math.max(1.5, Math.min(5, (canvas.clientWidth - GUTTER) / shownOrder / 3));
    const stems = [ideal ? { spectrum: ideal, ink: "--ideal", shift: -width / 2 - 0.5 } : null, pulses ? { spectrum: pulses, ink: "--made", shift: width / 2 + 0.5 } : null];
    draw(canvas, {
      x: { min: 0, max: shownOrder + 1, unit: "", prefix: false, label_px: 20 },
      y: db ? { min: FLOOR_DB, max: 10, unit: "dB", prefix: false, label_px: GUTTER } : { min: 0, max: top * 1.1, unit: "", prefix: true, label_px: GUTTER },
      series: stems.flatMap((stem) => (stem ? [{ color: color(stem.ink), opacity: 1, width, x, shape: { stems: { y: level(stem.spectrum), shift: stem.shift } } }] : [])),
    });
    canvas.setAttribute("aria-label", `Spectrum of ${quantity}, harmonics 1 to ${shownOrder} of ${si(some.fundamental_hz, "Hz")}; the table beside it has the numbers`);
  }

  /** @param {{n: number, hz: number, cells: string[]}[]} rows */
  function table(rows) {
    byId("harmonics").hidden = rows.length === 0;
    const names = spectra?.ideal && spectra?.pulses ? ["ideal", "pulses"] : [spectra?.ideal ? "ideal" : "pulses"];
    const head = ["n", "frequency", ...names.flatMap((name) => [name, "%"])];
    fill(/** @type {Element} */ (byId("harmonics").querySelector("thead")), element("tr", {}, ...head.map((text) => element("th", { scope: "col", class: "number" }, text))));
    fill(/** @type {Element} */ (byId("harmonics").querySelector("tbody")), ...rows.map(({ n, hz, cells }) =>
      element("tr", {}, ...[String(n), si(hz, "Hz"), ...cells].map((text) => element("td", { class: "number" }, text)))));
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (before?.result !== state.result) return refresh(state);
    if (before?.view !== state.view) paint();
    return undefined;
  }
  return { render };
}

/** What the parts are parts of: the fundamental, or the greatest line where there is no fundamental. @param {Spectrum} spectrum @param {Quantity} quantity */
function reference(spectrum, quantity) {
  return Math.max(LEAST, spectrum.periodic ? spectrum[quantity][0] : Math.max(...spectrum[quantity]));
}

/** @param {number} amplitude */
function heard(amplitude) {
  return amplitude < LEAST ? 0 : amplitude;
}

/** @param {Spectra} spectra @param {Quantity} quantity */
function harmonics({ ideal, pulses }, quantity) {
  const given = [ideal, pulses].flatMap((spectrum) => (spectrum ? [spectrum] : []));
  const length = Math.max(...given.map((spectrum) => spectrum[quantity].length));
  return Array.from({ length }, (_, i) => ({
    n: i + 1,
    hz: given[0].fundamental_hz * (i + 1),
    cells: given.flatMap((spectrum) => {
      const values = spectrum[quantity];
      const part = heard(values[i]) / reference(spectrum, quantity);
      return !(part >= NOISE) ? ["0", "0"] : [short(values[i], 4), short(100 * part, 3)];
    }),
  }));
}

/** @param {Spectra} spectra @param {Quantity} quantity */
function distortion({ axis, ideal, pulses }, quantity) {
  const thd = (/** @type {Spectrum} */ spectrum) => {
    const value = spectrum[/** @type {const} */ (`thd_${quantity}`)];
    return value === null ? "none" : `${short(value * 100, 5)} %`;
  };
  const parts = [];
  if (ideal) parts.push(`ideal ${thd(ideal)}`);
  if (pulses) parts.push(`pulses ${thd(pulses)}`);
  return `THD of ${quantity}, axis ${axis}: ${parts.join(", ")}`;
}

/** How the distortion is defined. @param {Spectrum} some */
function method(some) {
  if (!some.periodic) return `Lines at multiples of ${si(some.fundamental_hz, "Hz", 5)}, the run taken as one period, no window.`;
  const periods = some.periods === 1 ? "one whole period" : `${some.periods} whole periods`;
  return `Harmonics 2 to ${some.order} over the fundamental of ${si(some.fundamental_hz, "Hz", 5)}; no window, ${periods}.`;
}
