/** The kinds of sources: which use the line, and the initial content of each. */

/** @typedef {import("../state/types.js").Scenario} Scenario */

/** Whether the controllers run segments or programs, so nothing is on the line and there are no ticks. @param {Scenario} scenario */
export function hasNoLine({ source }) {
  return "segments" in source || "standalone" in source || source.motion?.engine === "segments";
}

/** Initial segments: accelerating to the right, a pause, and back at a constant rate. */
export function sampleSegments() {
  const ms = 16_000 * 65_536;
  return {
    start_cycle: 1,
    segments: [
      { steps: { count: 20, interval_q16: ms, add_q16: -ms / 32, direction: "positive" } },
      { dwell: { length_q16: 5 * ms } },
      { steps: { count: 20, interval_q16: ms / 2, add_q16: 0, direction: "negative" } },
    ],
  };
}

/** Parts of the scenario that another kind of source replaces. @param {Scenario} scenario @returns {import("../state/paths.js").Moved} */
export function replacedBySource({ controllers }) {
  const parts = controllers.flatMap((/** @type {any} */ _, /** @type {number} */ index) =>
    ["axes", "packets"].map((key) => `controllers[${index}].${key}`),
  );
  return ["source", ...parts].map((path) => [path, null]);
}

/** @param {number} byte */
export function hex(byte) {
  return Number(byte).toString(16).padStart(2, "0");
}

/** Initial ticks: ten steps to the right and ten back on every channel. @param {any} bus */
function sampleTicks(bus) {
  return ["8a", "0a"].map((tick) => tick.repeat(Number(bus.channels) || 1));
}

/** The raw packets of the initial ticks. @param {Scenario} scenario @param {any} bus @param {number | null} address */
export function samplePackets({ line }, bus, address) {
  const prefix = line.protocol === "framed" || address === null ? "" : hex(address);
  return sampleTicks(bus).map((tick) => prefix + tick);
}

/** A line script that sends the initial ticks. @param {Scenario} scenario */
export function sampleSends(scenario) {
  const { bus, line } = scenario;
  const start = bus.self_test_cycles + 1;
  const tick = bus.slots * bus.step_period_cycles;
  if (line.protocol !== "framed") {
    return samplePackets(scenario, bus, line.address).map((bytes, index) => ({
      start_cycle: start + index * tick,
      bytes,
      frame: null,
    }));
  }
  // TICKS with sequence number 0 and three ticks, the last without steps; then STATUS.
  const to = hex(line.address ?? 0);
  const ticks = [...sampleTicks(bus), "00".repeat(Number(bus.channels) || 1)];
  return [`${to}0100${hex(ticks.length)}${ticks.join("")}`, `${to}04`].map((frame, index) => ({
    start_cycle: start + index * 4 * tick,
    bytes: "",
    frame,
  }));
}
