/**
 * The dialog of devices (LIVE H4): the experiment's ticks go to a real one, confirmed to the end, or the page is one for a real
 * host. Nothing opens without a press; STOP comes first of all. It loads when it is first opened.
 */
import { button, element, fill, say, style } from "../dom.js";
import { movesStreams, openLive, serial } from "../engine/live.js";
import { readJson } from "../state/json.js";
import { counted } from "../state/number.js";
import { message } from "./link.js";
import { exchangeTable, outcome, reportText, servedText, twinOf } from "./live_report.js";
import { ownIsKept } from "./storage.js";

/** @typedef {import("../engine/live.js").Facts} Facts */
/** @typedef {import("../engine/live.js").Told} Told */
/** @typedef {"stream" | "serve"} Role */

/** Rows of replies that stay on show. */
const MOST_ROWS = 300;
/** How long a recorded session may run before it is said that it has not, in ms, and how often that is looked at. */
const PATIENCE_MS = 60_000;
const LOOK_MS = 100;

/** A page on a busy desktop is sometimes so late, in ms. */
const LATE_MS = 50;

/** @type {{[role in Role]: {label: string, about: string, start: string}}} */
const ROLES = {
  stream: {
    label: "Stream to a device",
    about: "Sends the ticks of this experiment, each frame confirmed, and verifies the end. The motors move.",
    start: "Start: the motors move",
  },
  serve: {
    label: "Be a soft device",
    about:
      "Answers a host on the port as the controllers of this experiment would, in real time. At the end the session opens as a scenario.",
    start: "Start answering",
  },
};
/** @type {Role[]} */
const NAMES = ["stream", "serve"];

const OTHERS =
  "take Chrome or Edge 89 or newer, or Firefox 151 or newer, on a desktop; or the command, stepscope send.";

/** Why this page gets no port; empty where it may. */
function whyNoPort() {
  if (!globalThis.isSecureContext)
    return "The browser gives ports to secure pages alone: open this page by https, or from http://localhost.";
  if (!serial()) return `This browser has no Web Serial: ${OTHERS}`;
  if (!movesStreams())
    return `This browser cannot hand a port's streams to a worker, where this page uses them: ${OTHERS}`;
  return "";
}

/** What a port tells of itself; empty where it is none of USB. @param {any} port */
function usbOf(port) {
  const { usbVendorId, usbProductId } = port.getInfo?.() ?? {};
  const hex = (/** @type {number} */ id) => id.toString(16).padStart(4, "0");
  return usbVendorId === undefined ? "" : ` (USB ${hex(usbVendorId)}:${hex(usbProductId ?? 0)})`;
}

/** What a role comes to. @param {Role} name @param {import("../engine/live.js").Role} found */
function aboutOf(name, { baud, margin_ms, state }) {
  if (name === "serve") return `${ROLES.serve.about} ${baud} baud.`;
  const tight =
    margin_ms < LATE_MS
      ? ` The queue gives the page ${margin_ms.toFixed(0)} ms: a busy desktop is later at times, and then it runs dry (UNDERRUN); longer ticks give more.`
      : "";
  return `${ROLES.stream.about} ${counted(state.ticks, "tick")}, ${baud} baud.${tight}`;
}

/** @param {import("./opened.js").Given} page */
export async function openDevice(page) {
  const { dispatch, now } = page;
  await style("live");
  const { scenario } = now();
  const json = JSON.stringify(scenario);
  const noPort = whyNoPort();
  const notHere = scenario.source?.standalone
    ? "Not with this experiment: a stand-alone controller has no line; its buttons are in the view Panel, or served by the command, stepscope serve."
    : "";
  /** @type {Facts | null} */
  let facts = null;
  /** @type {any} */
  let port = null;
  /** What has the port. @type {Role | null} */
  let running = null;
  let began = "";
  /** Delays in ms. @type {{own: number[], model: number[]}} */
  let delays = { own: [], model: [] };

  const live = openLive(hear);
  const radios = NAMES.map((name) => {
    const input = element("input", { type: "radio", name: "live-role", value: name });
    input.checked = name === "stream";
    input.addEventListener("change", show);
    return { name, input, label: element("label", { class: "check" }, input, ` ${ROLES[name].label}`) };
  });
  const role = () => radios.find(({ input }) => input.checked)?.name ?? "stream";
  const about = element("p", { id: "live-about" });
  const choose = element("button", { type: "button", id: "live-choose", "aria-describedby": "live-about" });
  const allowed = element("span", { id: "live-allowed", class: "live-allowed" });
  const start = element("button", { type: "button", id: "live-start", class: "main" });
  const end = element("button", { type: "button", id: "live-end" }, "End and open the recording");
  const stop = element(
    "button",
    {
      type: "button",
      id: "live-stop",
      class: "live-stop",
      title: "STOP: no further ticks, the device stops at once (Esc)",
    },
    "STOP",
  );
  const said = element("p", { id: "live-said", class: "live-said", role: "status" });
  const standing = element("p", { id: "live-standing", class: "live-standing" });
  const progress = element("progress", { max: "1", value: "0", "aria-label": "Ticks done" });
  const exchanges = exchangeTable(MOST_ROWS);
  const replies = element(
    "div",
    { class: "live-replies", tabindex: "0", role: "group", "aria-label": "Replies" },
    exchanges.table,
  );
  const twin = element("div", { id: "live-twin" });
  const report = element("textarea", {
    id: "live-report",
    readonly: "",
    rows: "9",
    "aria-label": "Report",
    spellcheck: "false",
  });
  const copy = button("Copy the report", "Copy the report as text", toClipboard);
  const reported = element("div", { id: "live-reported" }, report, copy);
  for (const part of [progress, replies, reported]) part.hidden = true;
  const close = element("button", { type: "button", id: "live-close" }, "Close");
  const dialog = element(
    "dialog",
    { class: "recording live", "aria-labelledby": "live-title" },
    element(
      "div",
      {},
      element("h2", { id: "live-title" }, "Device"),
      element("fieldset", {}, element("legend", {}, "This page is to"), ...radios.map(({ label }) => label)),
      about,
      element("div", { class: "live-actions" }, choose, allowed, start, end, stop),
      said,
      progress,
      standing,
      replies,
      twin,
      reported,
      element(
        "p",
        { class: "note" },
        "Leaving the page, or losing the port, ends the sending: the device does what is in its queue, and then it runs dry (UNDERRUN). Raw packets go by the command: stepscope send.",
      ),
      element("p", { class: "named" }, close),
    ),
  );

  choose.addEventListener("click", choosePort);
  start.addEventListener("click", () => void begin(false));
  stop.addEventListener("click", stopAll);
  end.addEventListener("click", () => live.end());
  close.addEventListener("click", () => dialog.close());
  // Escape stops what moves before it closes anything.
  dialog.addEventListener("cancel", (event) => {
    if (running === null) return;
    event.preventDefault();
    if (running === "stream") stopAll();
  });
  const leave = (/** @type {Event} */ event) => {
    if (running !== null) event.preventDefault();
  };
  const hide = () => running === "stream" && live.stop();
  window.addEventListener("beforeunload", leave);
  window.addEventListener("pagehide", hide);
  dialog.addEventListener("close", () => {
    window.removeEventListener("beforeunload", leave);
    window.removeEventListener("pagehide", hide);
    void live.close();
    dialog.remove();
  });
  document.body.append(dialog);
  live.judge(json);
  show();
  dialog.showModal();
  void offerAllowed();

  /** Buttons and texts as things stand. */
  function show() {
    const name = role();
    const found = facts?.[name];
    const why =
      noPort || notHere || (facts === null ? "Loading…" : found?.why ? `Not with this experiment: ${found.why}.` : "");
    say(about, why || aboutOf(name, /** @type {import("../engine/live.js").Role} */ (found)));
    about.classList.toggle("error", why !== "" && facts !== null);
    say(choose, port ? "Choose another port…" : "Choose a port…");
    say(start, ROLES[name].start);
    for (const { input } of radios) input.disabled = running !== null;
    choose.disabled = why !== "" || running !== null;
    choose.title = why;
    start.disabled = why !== "" || running !== null || port === null;
    start.title = why || (port ? "" : "Choose a port first");
    start.hidden = running !== null;
    choose.hidden = running !== null;
    allowed.hidden = why !== "" || running !== null;
    end.hidden = running !== "serve";
    stop.hidden = name === "serve";
    stop.disabled = why !== "" || port === null;
    close.disabled = running !== null;
    close.title = running === null ? "" : "First STOP, or end";
  }

  /** @param {string} text @param {boolean} [bad] */
  function tell(text, bad = false) {
    say(said, text);
    said.classList.toggle("error", bad);
  }

  async function choosePort() {
    try {
      take(await serial().requestPort());
    } catch (error) {
      // No port was chosen, or this page may have none.
      const chosen = error instanceof DOMException && error.name === "NotFoundError";
      tell(chosen ? "No port was chosen." : `No port: ${message(error)}.`, !chosen);
      if (port) start.focus();
    }
  }

  /** Ports that the visitor, or who manages the browser, allowed before need no chooser. None is opened. */
  async function offerAllowed() {
    /** @type {any[]} */
    const ports = noPort
      ? []
      : await serial()
          .getPorts()
          .catch(() => []);
    const offers = ports.map((each, index) => {
      const name = `${ports.length > 1 ? `Port ${index + 1}` : "Port"} allowed before${usbOf(each)}`;
      const offer = element("button", { type: "button", title: "Take it without the browser's list of ports" }, name);
      offer.addEventListener("click", () => take(each));
      return offer;
    });
    fill(allowed, ...offers);
  }

  /** @param {any} chosen */
  function take(chosen) {
    port = chosen;
    tell(`A port is chosen${usbOf(chosen)}. It is not open yet.`);
    show();
    start.focus();
  }

  /** @param {boolean} stopping  Whether STOP is all that is sent. */
  async function begin(stopping) {
    const name = role();
    const baud = facts?.[name].baud ?? 0;
    running = name;
    began = new Date().toISOString();
    delays = { own: [], model: [] };
    exchanges.clear();
    fill(twin);
    say(standing, "");
    progress.value = 0;
    progress.hidden = replies.hidden = name === "serve";
    reported.hidden = true;
    tell(stopping ? "STOP is sent…" : name === "serve" ? "Answering…" : "Sending…");
    show();
    if (name === "stream") stop.focus();
    try {
      await (name === "serve" ? live.serve(port, baud, json) : live.stream(port, baud, json, stopping));
    } catch (error) {
      failed(`The port cannot be opened: ${message(error)} Is it taken by another program?`);
    }
  }

  function stopAll() {
    if (running === null) return void begin(true);
    tell("STOP: no further ticks. It is sent until the device confirms it…", true);
    live.stop();
  }

  /** @param {string} text */
  function failed(text) {
    running = null;
    tell(text, true);
    show();
  }

  /** Tells it on the page, where the dialog is gone. @param {"info" | "error"} kind @param {string} text */
  function notify(kind, text) {
    dispatch({ type: "notice", notice: { kind, text, place: null } });
  }

  /** What the worker tells. @param {Told} told */
  function hear(told) {
    if (told.error) return failed(told.error);
    if (told.facts) {
      facts = told.facts;
      // What cannot be is not offered first.
      if (facts.stream.why && !facts.serve.why) for (const { name, input } of radios) input.checked = name === "serve";
    }
    if (told.state) stand(told.state);
    if (told.rows) {
      for (const { delay_ms, model_ms } of told.rows) {
        if (delay_ms !== null) delays.own.push(delay_ms);
        if (model_ms !== null) delays.model.push(model_ms);
      }
      exchanges.add(told.rows);
    }
    if (told.reported) {
      const { said: text, good } = outcome(told.reported);
      tell(text, !good);
      if (!dialog.open)
        notify(good ? "info" : "error", `The dialog of devices was closed while it was sending. ${text}`);
      fill(twin, ...twinOf(told.reported));
      report.value = reportText(scenario.title, began, told.reported, delays);
      reported.hidden = false;
    }
    if (told.recorded) void recorded(told.recorded);
    if (told.closed) running = null;
    if (!told.state || told.closed) show();
  }

  /** @param {any} state */
  function stand(state) {
    if (running === "serve") return say(standing, servedText(state));
    say(standing, state.text.replaceAll("_", " "));
    progress.value = state.ticks > 0 ? state.done / state.ticks : 0;
  }

  /** The session opens as a scenario, if it is the session. @param {import("../engine/live.js").Recorded} session */
  async function recorded({ scenario: text, digests, why, whole, lost, set_backs, heard }) {
    const gone = lost ? ` The port is lost: ${lost}.` : "";
    if (heard === 0) return tell(`Nothing was heard: there is nothing to record.${gone}`, lost !== "");
    if (why !== null) return tell(`Not recorded: ${why}.${gone}`, true);
    dialog.close();
    dispatch({ type: "replace", scenario: readJson(text), origin: "shared" });
    const { revision } = now();
    const part = whole ? "" : " It holds as much as a recording may.";
    const paced = set_backs > 0 ? ` It was not in real time: set back ${counted(set_backs, "time")}.` : "";
    const found = await digestOf(revision);
    const same = found === digests[now().result?.controller ?? 0];
    const verdict = same
      ? `Recorded: run again, the session has the digest ${found}, as it had live.`
      : found
        ? `The session had the digest ${digests[0]}, and as a scenario it has ${found}.`
        : `Recorded with the digest ${digests[0]}.`;
    notify(same ? "info" : "error", `${verdict}${part}${paced}${gone}${ownIsKept()}`);
  }

  /** Of a revision, once it has run; empty where it has not. @param {number} revision */
  async function digestOf(revision) {
    for (let waited = 0; waited < PATIENCE_MS && now().revision === revision; waited += LOOK_MS) {
      const { result } = now();
      if (result?.revision === revision) return result.summary.controllers[result.controller]?.digest ?? "";
      await new Promise((rested) => setTimeout(rested, LOOK_MS));
    }
    return "";
  }

  async function toClipboard() {
    try {
      await navigator.clipboard.writeText(report.value);
      say(copy, "Copied");
    } catch {
      report.focus();
      report.select();
      say(copy, "Selected: copy it with Ctrl+C");
    }
  }
}
