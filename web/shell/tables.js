/** CSV of tables, with plain numbers. */

/** @typedef {import("../state/types.js").Spectra} Spectra */
/** @typedef {import("../state/types.js").Timing} Timing */

/** Rows as CSV; a text that holds a separator or a quote is quoted. @param {(string | number | null | undefined)[][]} rows */
export function csv(rows) {
  const field = (/** @type {string} */ text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  return rows.map((row) => `${row.map((value) => field(String(value ?? ""))).join(",")}\n`).join("");
}

/** Amplitudes of the harmonics (peak), and the total distortion to the highest one in the row `thd`, and what a sensor feels of it in the row `thd_filtered`. @param {Spectra} spectra */
export function harmonicsTable({ ideal, pulses }) {
  const some = ideal ?? pulses;
  const names = /** @type {const} */ (["position", "speed", "acceleration"]);
  const kinds = [ideal, pulses];
  const head = [
    "harmonic",
    "frequency_hz",
    ...["ideal", "pulses"].flatMap((kind) => names.map((name) => `${kind}_${name}`)),
  ];
  if (!some) return csv([head]);
  const rows = Array.from(some.position, (_, i) => [
    i + 1,
    (i + 1) * some.fundamental_hz,
    ...kinds.flatMap((kind) => names.map((name) => kind?.[name][i])),
  ]);
  const total = kinds.flatMap((kind) => [kind?.thd_position, kind?.thd_speed, kind?.thd_acceleration]);
  const filtered = kinds.flatMap((kind) => [null, null, kind?.thd_acceleration_filtered]);
  return csv([
    head,
    ...rows,
    ["thd", "", ...total],
    ...(filtered.some((part) => part) ? [["thd_filtered", "", ...filtered]] : []),
  ]);
}

/** @param {Timing | null} timing */
export function marginsTable(timing) {
  const head = [
    "rule",
    "required_ns",
    "required_cycles",
    "least_cycles",
    "least_at_cycle",
    "least_on_channel",
    "violations",
  ];
  return csv([
    head,
    ...(timing?.rules ?? []).map(({ rule, required_ns, required_cycles, least, violations }) => [
      rule,
      required_ns,
      required_cycles,
      least?.measured_cycles,
      least?.cycle,
      least?.channel,
      violations,
    ]),
  ]);
}

/** The violations that the page knows of: the first 1000. @param {Timing | null} timing @param {number} clockHz */
export function violationsTable(timing, clockHz) {
  const head = ["cycle", "time_s", "channel", "rule", "measured_cycles", "required_cycles"];
  return csv([
    head,
    ...(timing?.violations ?? []).map(({ cycle, channel, rule, measured_cycles, required_cycles }) => [
      cycle,
      cycle / clockHz,
      channel,
      rule,
      measured_cycles,
      required_cycles,
    ]),
  ]);
}
