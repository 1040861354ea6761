/** What became of a stream to a device, or of a session with a host, in words. Nothing is said to be done that is not known. */
import { element } from "../../dom.js";
import { count, counted, time } from "../../state/number.js";

/** @typedef {import("../../engine/live.js").Reported} Reported */
/** @typedef {import("../../engine/live.js").ReportedFramed} ReportedFramed */
/** @typedef {import("../../engine/live.js").RawReport} RawReport */
/** @typedef {import("../../engine/live.js").Ended} Ended */
/** @typedef {import("../../engine/live.js").Recorded} Recorded */
/** @typedef {import("../../engine/live.js").Served} Served */
/** @typedef {import("../../engine/live.js").End} End */

const ms = (/** @type {number | null} */ value) => (value === null ? "–" : `${value.toFixed(2)} ms`);

/** What is known, in a sentence, and whether it is good. @param {Reported} reported @returns {{said: string, good: boolean}} */
export function outcome(reported) {
  if (reported.raw) return outcomeOfRaw(reported.raw, reported);
  const { verified, why, stop_acknowledged, stopped, lost } = reported;
  if (stopped) {
    const confirmed = stop_acknowledged
      ? "STOP is confirmed: the device has acknowledged it."
      : "STOP is not confirmed: nobody knows whether the device has stopped. Cut its power if it must not move.";
    return {
      said: lost ? `${confirmed} The port is lost: ${lost.replace(/\.$/, "")}.` : confirmed,
      good: stop_acknowledged,
    };
  }
  if (verified)
    return { said: "Verified: READY, every tick is done, the positions are their sums, and no new fault.", good: true };
  return { said: `Not verified: ${why?.replace(/\.$/, "")}.`, good: false };
}

/** Of packets that nobody answers. @param {RawReport} raw @param {Ended} ended @returns {{said: string, good: boolean}} */
function outcomeOfRaw({ sent, packets, stood, left_ms }, { stopped, lost }) {
  const queued = `the device does what is in its queue, about ${left_ms.toFixed(0)} ms more`;
  if (lost) return { said: `Not verified: the port is lost: ${lost.replace(/\.$/, "")}; ${queued}.`, good: false };
  if (stopped)
    return {
      said: `Stopped sending after ${count(sent)} of ${counted(packets, "packet")}: a raw line has no STOP, and ${queued}. Cut its power if it must not move.`,
      good: false,
    };
  const dry = stood > 0 ? ` The motor must have stood before ${counted(stood, "tick")}.` : "";
  return {
    said: `Not verified: raw packets are not answered. All ${counted(packets, "packet")} are sent.${dry}`,
    good: stood === 0,
  };
}

/** Of all delays. @param {number[]} delays */
function median(delays) {
  const sorted = delays.toSorted((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)] ?? 0;
}

/** The report as a text to copy. @param {string} title @param {string} began @param {Reported} reported @param {{own: number[], model: number[]}} delays */
export function reportText(title, began, reported, { own, model }) {
  const lines = [
    `Stepscope: ${title || "an experiment"} to a device, ${began}, ${time(reported.ms / 1000)}`,
    outcome(reported).said,
  ];
  if (reported.raw) return `${[...lines, reported.raw.text].join("\n")}`;
  const { text, difference } = reported;
  lines.push(
    text.trimEnd(),
    difference ? `first difference to the model: ${difference}` : "no reply differs from the model's",
  );
  if (own.length > 0)
    lines.push(
      `delay of ${counted(own.length, "reply").replace("replys", "replies")}: median ${ms(median(own))}, longest ${ms(own.reduce((most, each) => Math.max(most, each), 0))}; the model's median ${ms(median(model))}`,
    );
  return `${lines.join("\n")}\n`;
}

/** @param {End | null} end */
const endTexts = (end) => [
  end?.state ?? "not told",
  end === null || end.ticks_done === null ? "not told" : count(end.ticks_done),
  end?.went?.map((steps) => count(steps)).join("  ") ?? "not told",
];

/** The device's end beside the model's. @param {ReportedFramed} reported @returns {Node[]} */
export function twinOf({ beside, difference, stopped, verified }) {
  const rows = beside.flatMap(({ controller, device, model }) =>
    ["state", "ticks done", "steps gone"].map((name, index) => {
      const [own, its] = [endTexts(device)[index], endTexts(model)[index]];
      return element(
        "tr",
        own === its || device === null || (stopped && index > 0) ? {} : { class: "differs" },
        element("th", { scope: "row" }, beside.length > 1 ? `controller ${controller}, ${name}` : name),
        element("td", {}, own),
        element("td", {}, its),
      );
    }),
  );
  const heads = ["since it was opened", "device", "model"].map((name) => element("th", { scope: "col" }, name));
  const first = difference ? `The first difference to the model: ${difference}.` : "No reply differs from the model's.";
  const why =
    stopped || !verified ? " How far a tick came that was cut short depends on when each heard what it was told." : "";
  return [
    element("p", {}, `${first}${why}`),
    element(
      "table",
      { "aria-label": "The device beside the model" },
      element("thead", {}, element("tr", {}, ...heads)),
      element("tbody", {}, ...rows),
    ),
  ];
}

/** How a soft device stands. @param {Served} served */
export function servedText({ seconds, heard, replies, latest_ms, set_backs, set_back_ms, missed, controllers }) {
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
      ? ` Not real time: set back ${counted(set_backs, "time")}, ${set_back_ms.toFixed(0)} ms in all.`
      : ` Replies at most ${ms(latest_ms)} late.`;
  const lost = missed > 0 ? ` ${counted(missed, "byte")} of replies not read.` : "";
  return `${seconds.toFixed(1)} s: ${counted(heard, "byte")} heard, ${counted(replies, "reply").replace("replys", "replies")}; ${each.join("; ")}.${lag}${lost}`;
}
