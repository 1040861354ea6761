/** The chart of a spectrum. */
import { byId } from "../../dom.js";
import { si } from "../../state/number.js";
import { color } from "../../time/plot.js";
import { frequency } from "./frequency.js";
import { aboveNoise, amplitudesOf, FLOOR_DB, namedSpectra, reference } from "./harmonics.js";

/** @typedef {import("../../state/types.js").Spectra} Spectra */
/** @typedef {import("./harmonics.js").Quantity} Quantity */

/** Width of the tick labels in CSS pixels. */
const GUTTER = 58;
/** Height of the frequency labels below the chart. */
const TICKS_PX = 20;
/** Width of a frequency label, in CSS pixels. */
const LABEL_PX = 56;

/** The quantity and scale that are selected in the header. @returns {{quantity: Quantity, db: boolean}} */
export function selectedSpectrum() {
  const value = (/** @type {string} */ id) => /** @type {HTMLSelectElement} */ (byId(id)).value;
  return { quantity: /** @type {Quantity} */ (value("spectrum-quantity")), db: value("spectrum-scale") === "db" };
}

/**
 * The strongest harmonic of each pixel; others would be invisible, but cost time.
 * @param {ArrayLike<number>} amplitudes  The first harmonic first.
 * @param {(n: number) => number} pixel
 * @param {number} from @param {number} to  The visible harmonics.
 */
function strongest(amplitudes, pixel, from, to) {
  /** @type {Map<number, number>} */
  const columns = new Map();
  for (let n = from; n <= to; n++) {
    const column = Math.floor(pixel(n));
    const other = columns.get(column);
    if (other === undefined || amplitudes[n - 1] > amplitudes[other - 1]) columns.set(column, n);
  }
  return [...columns.values()];
}

/**
 * Ticks of a logarithmic axis and their labels, one per line. They are 1, 2 and 5 times powers of ten, or powers of ten, or every
 * second, third, … power of ten. If fewer than three of these are visible, they are round numbers as on a linear axis.
 * @param {number} min @param {number} max  Hz. @param {number} maxTicks
 */
function logarithmicTicks(min, max, maxTicks) {
  const powers = Array.from({ length: 19 }, (_, at) => at - 9);
  const multiples = (/** @type {number} */ every, /** @type {number[]} */ times) =>
    powers
      .filter((power) => power % every === 0)
      .flatMap((power) => times.map((time) => Number(`${time}e${power}`)))
      .filter((hz) => hz >= min && hz <= max);
  const candidates = [multiples(1, [1, 2, 5]), ...powers.slice(10).map((every) => multiples(every, [1]))];
  let ticks = candidates.find(({ length }) => length <= Math.max(2, maxTicks)) ?? [];
  if (ticks.length < 3) {
    const power = 10 ** Math.floor(Math.log10((max - min) / 2));
    const step = power * ([5, 2, 1].find((time) => (max - min) / (time * power) >= 2) ?? 1);
    const first = Math.ceil(min / step);
    ticks = Array.from({ length: Math.floor(max / step) - first + 1 }, (_, at) => (first + at) * step);
  }
  return { ticks: ticks.map(frequency.toPosition), labels: ticks.map((hz) => si(hz, "Hz", 6)).join("\n") };
}

/** @param {Spectra} spectra @param {Quantity} quantity @param {boolean} db @param {number} width  CSS pixels. */
export function spectrumChart(spectra, quantity, db, width) {
  const all = namedSpectra(spectra);
  const [, { fundamental_hz }] = all[0];
  const order = Math.max(...all.map(([, spectrum]) => amplitudesOf(spectrum, quantity).length));
  frequency.setLines(fundamental_hz, order);
  const { start: min, end: max } = frequency.hertz();
  const from = Math.max(1, Math.ceil(min / fundamental_hz));
  const to = Math.min(order, Math.floor(max / fundamental_hz));
  const { start, end } = frequency.shown();
  const across = Math.max(1, width - GUTTER - 26);
  const pixel = (/** @type {number} */ n) =>
    ((frequency.toPosition(n * fundamental_hz) - start) / (end - start)) * across;
  const spacing = to > from ? pixel(to) - pixel(to - 1) : across;
  const stemWidth = Math.max(1.5, Math.min(5, spacing / 3));
  const stems = all.map(([name, spectrum]) => ({
    name,
    spectrum,
    amplitudes: amplitudesOf(spectrum, quantity),
    shown: strongest(amplitudesOf(spectrum, quantity), pixel, from, to),
  }));
  const top = Math.max(1e-12, ...stems.flatMap(({ amplitudes, shown }) => shown.map((n) => amplitudes[n - 1])));
  return {
    x: {
      min: start,
      max: end,
      unit: "Hz",
      prefix: true,
      label_px: TICKS_PX,
      ...(frequency.isLog() ? logarithmicTicks(min, max, across / LABEL_PX) : {}),
    },
    y: db
      ? { min: FLOOR_DB, max: 10, unit: "dB", prefix: false, label_px: GUTTER }
      : { min: 0, max: top * 1.1, unit: "", prefix: true, label_px: GUTTER },
    series: stems.map(({ name, spectrum, amplitudes, shown }) => ({
      color: color(name === "ideal" ? "--ideal" : "--actual"),
      opacity: 1,
      width: stemWidth,
      x: shown.map((n) => frequency.toPosition(n * fundamental_hz)),
      shape: {
        stems: {
          shift: all.length === 1 ? 0 : (name === "ideal" ? -1 : 1) * (stemWidth / 2 + 0.5),
          y: shown.map((n) => {
            const amplitude = amplitudes[n - 1];
            return db ? 20 * Math.log10(aboveNoise(amplitude) / reference(spectrum, quantity)) : amplitude;
          }),
        },
      },
    })),
  };
}
