/** Harmonics and distortion of a spectrum, and their texts. */
import { short, si } from "../../state/number.js";

/** @typedef {import("../../state/types.js").Spectrum} Spectrum */
/** @typedef {import("../../state/types.js").Spectra} Spectra */
/** @typedef {"position" | "speed" | "acceleration" | "acceleration_filtered"} Quantity */
/** @typedef {{name: string, amplitude: number, ratio: number}} Line  `ratio`: relative to the fundamental; 0 if there is only rounding noise. */

/** Lowest level of the dB scale. */
export const FLOOR_DB = -120;
/** A harmonic below this ratio to the fundamental is rounding noise. */
const NOISE = 1e-11;
/** An amplitude below this is rounding noise, in steps, steps/s or steps/s². */
const MIN_AMPLITUDE = 1e-9;

export const UNITS = {
  position: "steps",
  speed: "steps/s",
  acceleration: "steps/s²",
  acceleration_filtered: "steps/s²",
};

/** A quantity as text. @param {Quantity} quantity */
export function nameOf(quantity) {
  return quantity === "acceleration_filtered" ? "acceleration, filtered by the sensor" : quantity;
}

/** Amplitudes of a quantity that the spectrum has. @param {Spectrum} spectrum @param {Quantity} quantity */
export function amplitudesOf(spectrum, quantity) {
  return /** @type {Float64Array} */ (spectrum[quantity]);
}

/** The reference of ratios: the fundamental, or the strongest line of a motion that is not periodic. @param {Spectrum} spectrum @param {Quantity} quantity */
export function reference(spectrum, quantity) {
  const amplitudes = amplitudesOf(spectrum, quantity);
  return Math.max(MIN_AMPLITUDE, spectrum.periodic ? amplitudes[0] : Math.max(...amplitudes));
}

/** @param {number} amplitude */
export function aboveNoise(amplitude) {
  return amplitude < MIN_AMPLITUDE ? 0 : amplitude;
}

/** The available spectra with their names. @param {Spectra} spectra @returns {[string, Spectrum][]} */
export function namedSpectra({ ideal, pulses }) {
  return [
    .../** @type {[string, Spectrum][]} */ (ideal ? [["ideal", ideal]] : []),
    .../** @type {[string, Spectrum][]} */ (pulses ? [["actual", pulses]] : []),
  ];
}

/** @param {Spectra} spectra @param {Quantity} quantity @returns {{n: number, hz: number, parts: Line[]}[]} */
export function harmonics(spectra, quantity) {
  const all = namedSpectra(spectra);
  const length = Math.max(0, ...all.map(([, spectrum]) => amplitudesOf(spectrum, quantity).length));
  return Array.from({ length }, (_, i) => ({
    n: i + 1,
    hz: all[0][1].fundamental_hz * (i + 1),
    parts: all.map(([name, spectrum]) => {
      const amplitude = amplitudesOf(spectrum, quantity)[i];
      const ratio = aboveNoise(amplitude) / reference(spectrum, quantity);
      return ratio >= NOISE ? { name, amplitude, ratio } : { name, amplitude: 0, ratio: 0 };
    }),
  }));
}

/** @param {number} ratio */
function decibels(ratio) {
  return ratio > 0 ? `${short(20 * Math.log10(ratio), 4)} dB` : "0";
}

/** A harmonic on the selected scale. @param {Line} line @param {Quantity} quantity @param {boolean} db */
export function value({ amplitude, ratio }, quantity, db) {
  return db ? decibels(ratio) : `${short(amplitude, 4)} ${UNITS[quantity]}`;
}

/** One harmonic as text. @param {ReturnType<typeof harmonics>[number]} row @param {Quantity} quantity @param {boolean} periodic */
export function describe({ n, hz, parts }, quantity, periodic) {
  const each = parts.map(
    ({ name, amplitude, ratio }) =>
      `${name} ${short(amplitude, 4)} ${UNITS[quantity]}, ${short(100 * ratio, 3)} %, ${decibels(ratio)}`,
  );
  return `${periodic ? "harmonic" : "line"} ${n} · ${si(hz, "Hz", 5)} · ${each.join(" · ")}`;
}

/** A distortion in percent, without rounding noise. @param {number} ratio */
const percent = (ratio) => `${ratio < 1e-9 ? 0 : short(ratio * 100, 5)}\u00a0%`;

/** @param {Spectra} spectra @param {Quantity} quantity */
export function distortion(spectra, quantity) {
  const values = namedSpectra(spectra).map(([name, spectrum]) => {
    const value = spectrum[/** @type {const} */ (`thd_${quantity}`)];
    return `${name} ${value === null ? "none" : percent(value)}`;
  });
  const filtered =
    quantity === "acceleration"
      ? namedSpectra(spectra).filter(([, spectrum]) => spectrum.thd_acceleration_filtered !== null)
      : [];
  const filteredText = filtered
    .map(([name, spectrum]) => `${name} ${percent(Number(spectrum.thd_acceleration_filtered))}`)
    .join(", ");
  const [first] = namedSpectra(spectra);
  const to = first ? ` to harmonic ${first[1].order}` : "";
  return `THD of ${nameOf(quantity)}${to}, axis ${spectra.axis}: ${values.join(", ")}${filteredText && `; filtered by the sensor: ${filteredText}`}`;
}

/** The label of the frequency axis. @param {Spectrum} spectrum */
export function overFrequency({ fundamental_hz, periodic }) {
  return `frequency, ${periodic ? "harmonics" : "lines"} at multiples of ${si(fundamental_hz, "Hz", 5)}`;
}

/** The definition of the distortion. @param {Spectrum} spectrum */
export function method(spectrum) {
  if (!spectrum.periodic)
    return `Lines at multiples of ${si(spectrum.fundamental_hz, "Hz", 5)}; the whole run is one period (not coherent), no window.`;
  const periods = spectrum.periods === 1 ? "one whole period" : `${spectrum.periods} whole periods`;
  return `THD is the root of the sum of squares of harmonics 2 to ${spectrum.order} over the fundamental of ${si(spectrum.fundamental_hz, "Hz", 5)}; coherent: ${periods}, no window.`;
}
