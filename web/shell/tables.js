/** CSV of tables, with plain numbers. */

/** @typedef {import("../state/types.js").Spectra} Spectra */
/** @typedef {import("../state/types.js").Timing} Timing */

/** Rows as CSV. @param {(string | number | null | undefined)[][]} rows */
export function csv(rows) {
  const field = (/** @type {string} */ text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  return rows.map((row) => `${row.map((value) => field(String(value ?? ""))).join(",")}\n`).join("");
}

/** Peak amplitudes of the harmonics; the row `thd` has the total distortion, and `thd_filtered` that of the filtered acceleration. @param {Spectra} spectra */
export function harmonicsTable({ ideal, pulses }) {
  const first = ideal ?? pulses;
  const names = /** @type {const} */ (["position", "speed", "acceleration"]);
  const kinds = [ideal, pulses];
  const head = [
    "harmonic",
    "frequency_hz",
    ...["ideal", "pulses"].flatMap((kind) => names.map((name) => `${kind}_${name}`)),
  ];
  if (!first) return csv([head]);
  const rows = Array.from(first.position, (_, i) => [
    i + 1,
    (i + 1) * first.fundamental_hz,
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
    ...(timing?.rules ?? []).map(({ rule, required_ns, required_cycles, shortest, violations }) => [
      rule,
      required_ns,
      required_cycles,
      shortest?.measured_cycles,
      shortest?.cycle,
      shortest?.channel,
      violations,
    ]),
  ]);
}

/** The first 1000 violations. @param {Timing | null} timing @param {number} clockHz */
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
