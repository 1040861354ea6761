/** Figures of a spectrum: harmonics and distortion, with their definitions. */
import { short, si } from "../../state/number.js";

/** @typedef {import("../../state/types.js").Spectrum} Spectrum */
/** @typedef {import("../../state/types.js").Spectra} Spectra */
/** @typedef {"position" | "speed" | "acceleration" | "acceleration_filtered"} Quantity */
/** @typedef {{name: string, amplitude: number, part: number}} Part  Part of the fundamental; 0 where there is nothing but rounding. */

/** Lowest level of the dB scale. */
export const FLOOR_DB = -120;
/** Below this part of the fundamental a harmonic is the arithmetic's own noise. */
const NOISE = 1e-11;
/** And so it is below this many steps, steps/s or steps/s². */
const LEAST = 1e-9;

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

/** Amplitudes of a quantity that is there. @param {Spectrum} spectrum @param {Quantity} quantity */
export function amplitudesOf(spectrum, quantity) {
  return /** @type {Float64Array} */ (spectrum[quantity]);
}

/** What the parts are parts of: the fundamental, or the greatest line where there is no fundamental. @param {Spectrum} spectrum @param {Quantity} quantity */
export function reference(spectrum, quantity) {
  const amplitudes = amplitudesOf(spectrum, quantity);
  return Math.max(LEAST, spectrum.periodic ? amplitudes[0] : Math.max(...amplitudes));
}

/** @param {number} amplitude */
export function aboveNoise(amplitude) {
  return amplitude < LEAST ? 0 : amplitude;
}

/** The spectra that there are, by name. @param {Spectra} spectra @returns {[string, Spectrum][]} */
export function namedSpectra({ ideal, pulses }) {
  return [
    .../** @type {[string, Spectrum][]} */ (ideal ? [["ideal", ideal]] : []),
    .../** @type {[string, Spectrum][]} */ (pulses ? [["pulses", pulses]] : []),
  ];
}

/** @param {Spectra} spectra @param {Quantity} quantity @returns {{n: number, hz: number, parts: Part[]}[]} */
export function harmonics(spectra, quantity) {
  const all = namedSpectra(spectra);
  const length = Math.max(0, ...all.map(([, spectrum]) => amplitudesOf(spectrum, quantity).length));
  return Array.from({ length }, (_, i) => ({
    n: i + 1,
    hz: all[0][1].fundamental_hz * (i + 1),
    parts: all.map(([name, spectrum]) => {
      const amplitude = amplitudesOf(spectrum, quantity)[i];
      const part = aboveNoise(amplitude) / reference(spectrum, quantity);
      return part >= NOISE ? { name, amplitude, part } : { name, amplitude: 0, part: 0 };
    }),
  }));
}

/** @param {number} part */
function decibels(part) {
  return part > 0 ? `${short(20 * Math.log10(part), 4)} dB` : "nothing";
}

/** A harmonic on the scale that is selected. @param {Part} part @param {Quantity} quantity @param {boolean} db */
export function value({ amplitude, part }, quantity, db) {
  return db ? decibels(part) : `${short(amplitude, 4)} ${UNITS[quantity]}`;
}

/** One harmonic as text. @param {ReturnType<typeof harmonics>[number]} row @param {Quantity} quantity @param {boolean} periodic */
export function describe({ n, hz, parts }, quantity, periodic) {
  const each = parts.map(
    ({ name, amplitude, part }) =>
      `${name} ${short(amplitude, 4)} ${UNITS[quantity]}, ${short(100 * part, 3)} %, ${decibels(part)}`,
  );
  return `${periodic ? "harmonic" : "line"} ${n} · ${si(hz, "Hz", 5)} · ${each.join(" · ")}`;
}

/** A distortion in percent; what is left of an exact sine is rounding. @param {number} ratio */
const percent = (ratio) => `${ratio < 1e-9 ? 0 : short(ratio * 100, 5)}\u00a0%`;

/** @param {Spectra} spectra @param {Quantity} quantity */
export function distortion(spectra, quantity) {
  const parts = namedSpectra(spectra).map(([name, spectrum]) => {
    const value = spectrum[/** @type {const} */ (`thd_${quantity}`)];
    return `${name} ${value === null ? "none" : percent(value)}`;
  });
  const filtered =
    quantity === "acceleration"
      ? namedSpectra(spectra).filter(([, spectrum]) => spectrum.thd_acceleration_filtered !== null)
      : [];
  const through = filtered
    .map(([name, spectrum]) => `${name} ${percent(Number(spectrum.thd_acceleration_filtered))}`)
    .join(", ");
  const [first] = namedSpectra(spectra);
  const to = first ? ` to harmonic ${first[1].order}` : "";
  return `THD of ${nameOf(quantity)}${to}, axis ${spectra.axis}: ${parts.join(", ")}${through && `; filtered by the sensor: ${through}`}`;
}

/** What the axis of frequencies is called. @param {Spectrum} some */
export function overFrequency({ fundamental_hz, periodic }) {
  return `frequency, ${periodic ? "harmonics" : "lines"} at multiples of ${si(fundamental_hz, "Hz", 5)}`;
}

/** How the distortion is defined. @param {Spectrum} some */
export function method(some) {
  if (!some.periodic)
    return `Lines at multiples of ${si(some.fundamental_hz, "Hz", 5)}; the whole run is one period (not coherent), no window.`;
  const periods = some.periods === 1 ? "one whole period" : `${some.periods} whole periods`;
  return `THD is the root of the sum of squares of harmonics 2 to ${some.order} over the fundamental of ${si(some.fundamental_hz, "Hz", 5)}; coherent: ${periods}, no window.`;
}
