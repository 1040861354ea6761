/**
 * The dialog of devices (LIVE H4): the experiment's ticks go to a real one, or the page is one for a real host. Nothing opens
 * without a press. While it sends it stands aside: the replies come in the packets view, and STOP, first of all, stays in
 * sight. It loads when it is first opened.
 */
import { button, byId, element, fill, say, style } from "../dom.js";
import { openLive, serial } from "../engine/live.js";
import { readJson } from "../state/json.js";
import { counted } from "../state/number.js";
import { message } from "./link.js";
import { carryInto } from "./live_carry.js";
import { positionCurves } from "./live_curves.js";
import { outcome, reportText, servedText, twinOf } from "./live_report.js";
import { about as aboutOf, NAMES, ROLES, stopTitle, usbOf, whyNone, whyNoPort } from "./live_roles.js";
import { deviceRows } from "./live_rows.js";
import { baseName } from "./offers.js";
import { save } from "./save.js";
import { ownIsKept } from "./storage.js";

/** @typedef {import("../engine/live.js").Facts} Facts */
/** @typedef {import("../engine/live.js").Told} Told */
/** @typedef {import("./live_roles.js").Role} Role */

/** How long a recorded session may run before it is said that it has not, in ms, and how often that is looked at. */
const PATIENCE_MS = 60_000;
const LOOK_MS = 100;
/** Of a port that the browser does not give back. */
const STUCK = "The port could not be closed: load this page again before it is used by anyone.";

/** Brings the dialog that there is in front. @type {(() => void) | null} */
let bring = null;

/** @param {import("./opened.js").Given} page */
export async function openDevice(page) {
  if (bring) return bring();
  bring = () => {};
  const { dispatch, now } = page;
  await style("live");
  let { scenario } = now();
  let json = "";
  const noPort = whyNoPort();
  /** @type {Facts | null} */
  let facts = null;
  /** @type {any} */
  let port = null;
  /** What has the port. @type {Role | null} */
  let running = null;
  /** What was sent on the port and is not known to have ended: STOP goes as it went. @type {{json: string, baud: number, raw: boolean} | null} */
  let loose = null;
  /** Whether it was told once what can be done. */
  let judged = false;
  /** Why nothing can be asked at all. */
  let broken = "";
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
  const aside = element("button", { type: "button", id: "live-aside" });
  const stop = element("button", { type: "button", id: "live-stop", class: "live-stop" }, "STOP");
  const actions = element("div", { class: "live-actions" }, choose, allowed, start, end, aside, stop);
  const said = element("p", { id: "live-said", class: "live-said", role: "status" });
  const standing = element("p", { id: "live-standing", class: "live-standing" });
  const progress = element("progress", { max: "1", value: "0" });
  const rows = deviceRows();
  const curves = positionCurves();
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
  /** Of a session that could not be recorded. */
  const times = element("button", { type: "button", id: "live-times" }, "Save its wall-clock times");
  for (const part of [progress, curves.node, reported, times]) part.hidden = true;
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
      actions,
      said,
      times,
      progress,
      standing,
      curves.node,
      twin,
      reported,
      element(
        "p",
        { class: "note" },
        "Leaving the page, or losing the port, ends the sending: the device does what is in its queue, and then it runs dry (UNDERRUN).",
      ),
      element("p", { class: "named" }, close),
    ),
  );

  choose.addEventListener("click", choosePort);
  start.addEventListener("click", () => void begin(false));
  stop.addEventListener("click", stopAll);
  end.addEventListener("click", () => live.end());
  close.addEventListener("click", () => dialog.close());
  aside.addEventListener("click", () => (inFront() ? lay(false) : bring?.()));
  // Escape stops what moves before it closes anything, wherever it is pressed.
  const stopByKey = (/** @type {KeyboardEvent} */ event) => {
    if (event.key !== "Escape" || running !== "stream") return;
    event.preventDefault();
    event.stopImmediatePropagation();
    stopAll();
  };
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
  window.addEventListener("keydown", stopByKey, { capture: true });
  dialog.addEventListener("close", () => {
    // It changed its place.
    if (dialog.open) return;
    bring = null;
    window.removeEventListener("keydown", stopByKey, { capture: true });
    window.removeEventListener("beforeunload", leave);
    window.removeEventListener("pagehide", hide);
    carrier.end();
    live.close().then((free) => free || notify("error", STUCK));
    dialog.remove();
  });
  document.body.append(dialog);
  const carrier = carryInto(
    () => running === "stream",
    stop,
    () => actions.append(stop),
  );
  bring = () => {
    lay(true);
    if (running === null) judge();
  };
  bring();
  void offerAllowed();

  function inFront() {
    return dialog.matches(":modal");
  }

  /** In front of the page, or aside, where the page can be worked with. @param {boolean} front */
  function lay(front) {
    dialog.close();
    dialog.classList.toggle("aside", !front);
    if (front) dialog.showModal();
    else dialog.show();
    show();
  }

  /** Asks what can be done with the experiment as it is now. */
  function judge() {
    ({ scenario } = now());
    const next = JSON.stringify(scenario);
    if (next === json) return;
    json = next;
    facts = null;
    broken = "";
    live.judge(json);
    show();
  }

  /** Buttons and texts as things stand. */
  function show() {
    const name = role();
    const found = facts?.[name];
    const front = inFront();
    const why = noPort || broken || whyNone(scenario, found);
    say(about, why || aboutOf(name, /** @type {import("../engine/live.js").Role} */ (found)));
    about.classList.toggle("error", why !== "" && (facts !== null || broken !== ""));
    say(choose, port ? "Choose another port…" : "Choose a port…");
    say(start, ROLES[name].start);
    for (const { input } of radios) input.disabled = running !== null;
    choose.disabled = why !== "" || running !== null;
    choose.title = why;
    start.disabled = why !== "" || running !== null || port === null;
    start.title = why || (port ? "" : "Choose a port first");
    start.hidden = choose.hidden = running !== null || !front;
    allowed.hidden = why !== "" || choose.hidden;
    end.hidden = running !== "serve";
    aside.hidden = front && running === null;
    say(aside, front ? "Put aside" : "Bring to front");
    const raw = loose?.raw ?? isRaw();
    stop.hidden = name === "serve" && loose === null;
    stop.disabled = port === null || (loose === null && why !== "") || (raw && running === null);
    stop.title = stopTitle(raw);
    carrier.look();
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
    loose = null;
    tell(`A port is chosen${usbOf(chosen)}. It is not open yet.`);
    show();
    start.focus();
  }

  /** @param {boolean} stopping  Whether STOP is all that is sent. */
  async function begin(stopping) {
    const name = stopping ? "stream" : role();
    const sent = (stopping && loose) || { json, baud: facts?.[name].baud ?? 0, raw: isRaw() };
    if (name === "stream") loose = sent;
    running = name;
    began = new Date().toISOString();
    delays = { own: [], model: [] };
    fill(twin);
    say(standing, "");
    progress.value = 0;
    progress.hidden = name === "serve";
    progress.ariaLabel = sent.raw ? "Packets sent" : "Ticks done";
    reported.hidden = curves.node.hidden = times.hidden = true;
    if (name === "stream") rows.begin(sent.raw);
    if (name === "stream" && !stopping) {
      lay(false);
      dispatch({ type: "view", view: "packets" });
    }
    tell(stopping ? "STOP is sent…" : name === "serve" ? "Answering…" : "Sending…");
    show();
    if (name === "stream") stop.focus();
    try {
      await (name === "serve"
        ? live.serve(port, sent.baud, sent.json)
        : live.stream(port, sent.baud, sent.json, stopping));
    } catch (error) {
      failed(`The port cannot be opened: ${message(error)} Is it taken by another program?`);
      if (!inFront()) lay(true);
    }
  }

  /** Whether what would be sent are packets that nobody answers. */
  function isRaw() {
    return facts?.stream.state?.lead !== undefined;
  }

  function stopAll() {
    if (running === null) return void begin(true);
    live.stop();
    tell(
      loose?.raw
        ? "Nothing more is sent; the device does what is in its queue…"
        : "STOP: no further ticks. It is sent until the device confirms it…",
      true,
    );
  }

  /** @param {string} text */
  function failed(text) {
    running = null;
    tell(text, true);
    show();
  }

  /** The part of the page that has the port is gone, and with it what it knew. @param {string} why @param {boolean} [stuck] */
  function broke(why, stuck) {
    const had = running;
    facts = null;
    json = "";
    broken = `A part of this page failed: ${why}. Close this dialog and open it again.`;
    const moves =
      "The device does what is in its queue, and then it runs dry (UNDERRUN): press STOP, or cut its power.";
    failed([had && `This failed: ${why}.`, had === "stream" && moves, stuck && STUCK].filter(Boolean).join(" "));
    if (had === null) return;
    if (!inFront()) lay(true);
    judge();
  }

  /** Tells it on the page, where the dialog is gone. @param {"info" | "error"} kind @param {string} text */
  function notify(kind, text) {
    dispatch({ type: "notice", notice: { kind, text, place: null } });
  }

  /** What the worker tells. @param {Told} told */
  function hear(told) {
    if (told.stuck) {
      port = null;
      if (!dialog.isConnected) notify("error", STUCK);
    }
    if (told.error) return dialog.isConnected && broke(told.error, told.stuck);
    if (told.facts) {
      // What cannot be is not offered first.
      if (!judged && told.facts.stream.why && !told.facts.serve.why)
        for (const { name, input } of radios) input.checked = name === "serve";
      facts = told.facts;
      judged = true;
    }
    if (told.state) stand(told.state);
    if (told.rows) {
      for (const { delay_ms, model_ms } of told.rows) {
        if (delay_ms !== null) delays.own.push(delay_ms);
        if (model_ms !== null) delays.model.push(model_ms);
      }
      rows.add(told.rows);
    }
    if (told.reported) {
      const { said: text, good } = outcome(told.reported);
      tell(text, !good);
      if (good) loose = null;
      if (!dialog.open)
        notify(good ? "info" : "error", `The dialog of devices was closed while it was sending. ${text}`);
      fill(twin, ...(told.reported.raw ? [] : twinOf(told.reported)));
      report.value = reportText(scenario.title, began, told.reported, delays);
      reported.hidden = false;
    }
    if (told.recorded) void recorded(told.recorded);
    if (told.closed) running = null;
    if (told.stuck) tell(`${said.textContent} ${STUCK}`, true);
    if (!told.state || told.closed) show();
  }

  /** @param {any} state */
  function stand(state) {
    if (running === "serve") {
      curves.draw(state);
      return say(standing, servedText(state));
    }
    say(standing, state.text.replaceAll("_", " "));
    progress.value = state.ticks > 0 ? state.done / state.ticks : 0;
  }

  /** The session opens as a scenario, if it is the session. @param {import("../engine/live.js").Recorded} session */
  async function recorded({ scenario: text, digests, why, whole, lost, set_backs, heard, times: clock }) {
    const gone = lost ? ` The port is lost: ${lost}.` : "";
    if (heard === 0) return tell(`Nothing was heard: there is nothing to record.${gone}`, lost !== "");
    if (why !== null) {
      times.onclick = () => saveTimes(clock);
      times.hidden = false;
      return tell(`Not recorded: ${why}.${gone}`, true);
    }
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
    // The notice's line stands by now, and has the button until another one comes.
    byId("link-message")
      .querySelector(".close")
      ?.before(button("Save its wall-clock times", "Save its wall-clock times", () => saveTimes(clock)));
  }

  /** Beside the scenario, which the export has. @param {Blob} clock */
  function saveTimes(clock) {
    save(`${baseName(now())}.session.json`, clock.type, [clock]);
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
