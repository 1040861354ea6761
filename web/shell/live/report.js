/** Texts about a stream to a device, or a session with a host. */
import { element } from "../../dom.js";
import { count, counted, time } from "../../state/number.js";

/** @typedef {import("../../engine/live.js").Reported} Reported */
/** @typedef {import("../../engine/live.js").ReportedFramed} ReportedFramed */
/** @typedef {import("../../engine/live.js").RawReport} RawReport */
/** @typedef {import("../../engine/live.js").Ended} Ended */
/** @typedef {import("../../engine/live.js").Recorded} Recorded */
/** @typedef {import("../../engine/live.js").Served} Served */
/** @typedef {import("../../engine/live.js").End} End */

const repliesText = (/** @type {number} */ number) => `${count(number)} ${number === 1 ? "reply" : "replies"}`;
const ms = (/** @type {number | null} */ value) => (value === null ? "–" : `${value.toFixed(2)} ms`);

/** The outcome as text, and whether it is good. @param {Reported} reported @returns {{text: string, good: boolean}} */
export function outcome(reported) {
  if (reported.raw) return outcomeOfRaw(reported.raw, reported);
  const { verified, why, stop_acknowledged, stopped, lost } = reported;
  if (stopped) {
    const confirmed = stop_acknowledged
      ? "STOP is confirmed by the device."
      : "STOP is not confirmed: the device may still move. Switch off its power if it must not move.";
    return {
      text: lost ? `${confirmed} The port is lost: ${lost.replace(/\.$/, "")}.` : confirmed,
      good: stop_acknowledged,
    };
  }
  if (verified) return { text: "Verified: READY, all ticks done, positions correct, no new fault.", good: true };
  return { text: `Not verified: ${why?.replace(/\.$/, "")}.`, good: false };
}

/** The same for raw packets. @param {RawReport} raw @param {Ended} ended @returns {{text: string, good: boolean}} */
function outcomeOfRaw({ sent, packets, stood: standstills, left_ms }, { stopped, lost }) {
  const queued = `the device still executes its queue, about ${left_ms.toFixed(0)} ms`;
  if (lost) return { text: `Not verified: the port is lost: ${lost.replace(/\.$/, "")}; ${queued}.`, good: false };
  if (stopped)
    return {
      text: `Stopped sending after ${count(sent)} of ${counted(packets, "packet")}: a raw line has no STOP, and ${queued}. Switch off its power if it must not move.`,
      good: false,
    };
  const standstillText = standstills > 0 ? ` The motor stopped before ${counted(standstills, "tick")}.` : "";
  return {
    text: `Not verified: raw packets get no reply. All ${counted(packets, "packet")} are sent.${standstillText}`,
    good: standstills === 0,
  };
}

/** The median of delays. @param {number[]} delays */
function median(delays) {
  const sorted = delays.toSorted((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)] ?? 0;
}

/** The report as a text to copy. @param {string} title @param {string} startTime @param {Reported} reported @param {{own: number[], model: number[]}} delays */
export function reportText(title, startTime, reported, { own, model }) {
  const lines = [
    `Stepscope: ${title || "an experiment"} to a device, ${startTime}, ${time(reported.ms / 1000)}`,
    outcome(reported).text,
  ];
  if (reported.raw) return `${[...lines, reported.raw.text].join("\n")}`;
  const { text, difference } = reported;
  lines.push(
    text.trimEnd(),
    difference ? `first difference from the model: ${difference}` : "all replies match the model",
  );
  if (own.length > 0)
    lines.push(
      `delay of ${repliesText(own.length)}: median ${ms(median(own))}, maximum ${ms(Math.max(0, ...own))}; median of the model ${ms(median(model))}`,
    );
  return `${lines.join("\n")}\n`;
}

/** @param {End | null} end */
const endTexts = (end) => [
  end?.state ?? "unknown",
  end === null || end.ticks_done === null ? "unknown" : count(end.ticks_done),
  end?.went?.map((steps) => count(steps)).join("  ") ?? "unknown",
];

/** The final states of device and model. @param {ReportedFramed} reported @returns {Node[]} */
export function finalStates({ ends, difference, stopped, verified }) {
  const rows = ends.flatMap(({ controller, device, model }) =>
    ["state", "ticks done", "steps moved"].map((name, index) => {
      const [own, expected] = [endTexts(device)[index], endTexts(model)[index]];
      return element(
        "tr",
        own === expected || device === null || (stopped && index > 0) ? {} : { class: "differs" },
        element("th", { scope: "row" }, ends.length > 1 ? `controller ${controller}, ${name}` : name),
        element("td", {}, own),
        element("td", {}, expected),
      );
    }),
  );
  const heads = ["since opening", "device", "model"].map((name) => element("th", { scope: "col" }, name));
  const first = difference ? `The first difference from the model: ${difference}.` : "All replies match the model.";
  const why = stopped || !verified ? " The progress of an interrupted tick depends on when STOP arrived." : "";
  return [
    element("p", {}, `${first}${why}`),
    element(
      "table",
      { "aria-label": "Device and model" },
      element("thead", {}, element("tr", {}, ...heads)),
      element("tbody", {}, ...rows),
    ),
  ];
}

/** The state of the page as a device. @param {Served} served */
export function servedText({ seconds, received, replies, max_delay_ms, set_backs, set_back_ms, missed, controllers }) {
  const each = controllers.map(({ state, queued, queue_depth, positions, faults }) =>
    [
      state ?? "raw",
      queued === null ? "" : `queue ${queued}/${queue_depth}`,
      `positions ${positions.slice(0, 8).join(" ")}`,
      faults.join(" "),
    ]
      .filter(Boolean)
      .join(", "),
  );
  const lag =
    set_backs > 0
      ? ` Not in real time: the clock was set back ${counted(set_backs, "time")}, ${set_back_ms.toFixed(0)} ms in total.`
      : ` Replies at most ${ms(max_delay_ms)} late.`;
  const lost = missed > 0 ? ` ${counted(missed, "byte")} of replies not read.` : "";
  return `${seconds.toFixed(1)} s: ${counted(received, "byte")} received, ${repliesText(replies)}; ${each.join("; ")}.${lag}${lost}`;
}
