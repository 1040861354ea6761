/**
 * The dialog of devices (LIVE H4): the experiment's ticks go to a real one, or the page is one for a real host. Nothing opens
 * without a press. While it sends it stands aside: the replies come in the packets view, and STOP, first of all, stays in
 * sight. It loads when it is first opened.
 */
import { button, element, fill, say, style } from "../../dom.js";
import { openLive, serial } from "../../engine/live.js";
import { message } from "../link.js";
import { carryInto } from "./carried_button.js";
import { deviceRows } from "./device_rows.js";
import { positionCurves } from "./position_curves.js";
import { openRecorded, saveTimes } from "./recorded.js";
import { outcome, reportText, servedText, twinOf } from "./report.js";
import { about as aboutOf, NAMES, ROLES, stopTitle, usbOf, whyNone, whyNoPort } from "./roles.js";

/** @typedef {import("../../engine/live.js").Facts} Facts */
/** @typedef {import("../../engine/live.js").Told} Told */
/** @typedef {import("./roles.js").Role} Role */

/** @typedef {{json: string, title: string, baud: number, raw: boolean, port: any}} Sent  An experiment as it goes on a port. */

/** Of a port that the browser does not give back. */
const STUCK = "The port could not be closed: load this page again before it is used by anyone.";
/** Of a device that nobody sends to any more. */
const RUNS_DRY =
  "The device does what is in its queue, and then it runs dry (UNDERRUN). Cut its power if it must not move.";

/** The port that was chosen: it stays when the dialog goes. @type {any} */
let port = null;
/** What a device has answered to and is not known to have ended: STOP goes as it went, also from the next dialog. @type {Sent | null} */
let unsettled = null;
/** Ports that the browser did not give back. */
const stuck = new WeakSet();
/** Brings the dialog that there is in front. @type {(() => void) | null} */
let bring = null;

/** @param {import("../opened.js").Given} page */
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
  /** What has the port. @type {Role | null} */
  let running = null;
  /** Whether it was told how that ended: the port is being given back. */
  let ended = false;
  /** Whether STOP was pressed meanwhile. */
  let again = false;
  /** What goes on the port. @type {Sent} */
  let going = { json: "", title: "", baud: 0, raw: false, port };
  /** Whether it was told that STOP should come before another start. */
  let warned = false;
  /** Whether it was told once what can be done. */
  let judged = false;
  /** Why nothing can be asked at all. */
  let broken = "";
  /** What is told on the page of a dialog that is gone. */
  let noticed = "";
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
  // One press is one start: not the second of two, and not a key that is held.
  start.addEventListener("click", ({ detail }) => void (detail < 2 && begin(false)));
  start.addEventListener("keydown", (event) => event.repeat && event.preventDefault());
  stop.addEventListener("click", stopAll);
  end.addEventListener("click", () => live.end());
  close.addEventListener("click", () => dialog.close());
  aside.addEventListener("click", () => (inFront() ? lay(false) : bring?.()));
  // Escape stops what moves before it closes anything: while it sends wherever it is pressed.
  const stopByKey = (/** @type {KeyboardEvent} */ event) => {
    if (event.key !== "Escape" || !(running === "stream" || (mayMove() && inFront()))) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    stopAll();
  };
  dialog.addEventListener("cancel", (event) => {
    if (running === null && !mayMove()) return;
    event.preventDefault();
    if (mayMove()) stopAll();
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
    live.close().then(({ inTime, free }) => {
      if (!inTime && unsettled) notify("error", `STOP is not confirmed. ${RUNS_DRY}`);
      if (free) return;
      keep(going.port);
      notify("error", STUCK);
    });
    dialog.remove();
  });
  document.body.append(dialog);
  const carrier = carryInto(mayMove, stop, () => actions.append(stop));
  bring = front;
  front();
  if (unsettled) {
    const where = port ? "" : "choose its port, then ";
    tell(`It is not known whether what was sent has ended: ${where}STOP goes as it went, at ${unsettled.baud} baud.`);
  }
  void offerAllowed();

  function inFront() {
    return dialog.matches(":modal");
  }

  /** In front, and about the experiment as it is now. */
  function front() {
    if (!dialog.isConnected) return;
    if (!inFront()) lay(true);
    if (running === null) judge();
  }

  /** Whether a device may move by what was sent, and can be told to stop. */
  function mayMove() {
    return running === "stream" || (running === null && unsettled !== null && port !== null);
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
    const isInFront = inFront();
    const why = noPort || broken || whyNone(scenario, found);
    say(about, why || aboutOf(name, /** @type {import("../../engine/live.js").Role} */ (found)));
    about.classList.toggle("error", why !== "" && (facts !== null || broken !== ""));
    say(choose, port ? "Choose another port…" : "Choose a port…");
    say(start, ROLES[name].start);
    for (const { input } of radios) input.disabled = running !== null;
    choose.disabled = (why !== "" && unsettled === null) || running !== null;
    choose.title = choose.disabled ? why : "";
    start.disabled = why !== "" || running !== null || port === null;
    start.title = why || (port ? "" : "Choose a port first");
    start.hidden = choose.hidden = running !== null || !isInFront;
    allowed.hidden = choose.disabled || choose.hidden;
    end.hidden = running !== "serve";
    aside.hidden = isInFront && running === null;
    say(aside, isInFront ? "Put aside" : "Bring to front");
    // Without a device that answers there is nothing to confirm: packets that nobody answers can only be sent no more.
    const raw = running === null ? unsettled === null && isRaw() : going.raw;
    stop.hidden = running === "serve" || (name === "serve" && unsettled === null);
    stop.disabled = running === null && !mayMove() && (why !== "" || port === null || raw);
    stop.title = stopTitle(raw, running === "stream" || (mayMove() && isInFront));
    close.disabled = running !== null;
    close.title = running === null ? "" : "First STOP, or end";
    carrier.look();
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
    const offers = ports
      .filter((each) => !stuck.has(each))
      .map((each, index) => {
        const name = `${ports.length > 1 ? `Port ${index + 1}` : "Port"} allowed before${usbOf(each)}`;
        const offer = element("button", { type: "button", title: "Take it without the browser's list of ports" }, name);
        offer.addEventListener("click", () => take(each));
        return offer;
      });
    fill(allowed, ...offers);
  }

  /** A port that the browser keeps is nobody's. @param {any} kept */
  function keep(kept) {
    stuck.add(kept);
    if (port === kept) port = null;
    void offerAllowed();
  }

  /** @param {any} chosen */
  function take(chosen) {
    if (stuck.has(chosen)) return tell(STUCK, true);
    port = chosen;
    tell(`A port is chosen${usbOf(chosen)}. It is not open yet.`);
    show();
    start.focus();
  }

  /** @param {boolean} stopping  Whether STOP is all that is sent. */
  async function begin(stopping) {
    if (!stopping && JSON.stringify(now().scenario) !== json) {
      judge();
      return tell("The experiment has changed: this is about the new one now. Start it if it is meant.");
    }
    if (!stopping && unsettled && !warned) {
      warned = true;
      return tell("It is not known whether what was sent has ended: press STOP first, or start once more.", true);
    }
    const name = stopping ? "stream" : role();
    const { title } = scenario;
    const own = { json, title, baud: facts?.[name].baud ?? 0, raw: name === "stream" && isRaw() };
    going = { ...((stopping && unsettled) || own), port };
    [running, ended, again, warned] = [name, false, false, false];
    began = new Date().toISOString();
    delays = { own: [], model: [] };
    fill(twin);
    say(standing, "");
    progress.value = 0;
    progress.hidden = name === "serve";
    progress.ariaLabel = going.raw ? "Packets sent" : "Ticks done";
    reported.hidden = curves.node.hidden = times.hidden = true;
    if (name === "stream") rows.begin(going.raw);
    if (name === "stream" && !stopping) {
      lay(false);
      dispatch({ type: "view", view: "packets" });
    }
    tell(stopping ? "STOP is sent…" : name === "serve" ? "Answering…" : "Sending…");
    show();
    if (name === "stream") stop.focus();
    try {
      const { json: sent, baud } = going;
      await (name === "serve" ? live.serve(port, baud, sent) : live.stream(port, baud, sent, stopping));
    } catch (error) {
      running = null;
      if (!ended) tell(`The port cannot be opened: ${message(error)} Is it taken by another program?`, true);
      show();
      if (again && port && dialog.isConnected) return void begin(true);
      front();
    }
  }

  /** Whether what would be sent are packets that nobody answers. */
  function isRaw() {
    return facts?.stream.state?.lead !== undefined;
  }

  function stopAll() {
    if (running === "serve" || port === null) return;
    if (running === null) return void begin(true);
    if (going.raw) {
      if (ended) return;
      live.stop();
      return tell("Nothing more is sent; the device does what is in its queue…", true);
    }
    again = true;
    live.stop();
    tell(
      ended
        ? "STOP goes as soon as the port is given back…"
        : "STOP: no further ticks. It is sent until the device confirms it…",
      true,
    );
  }

  /** Tells it on the page, where the dialog is gone. @param {"info" | "error"} kind @param {string} text */
  function notify(kind, text) {
    noticed = `${noticed} ${text}`.trimStart();
    dispatch({ type: "notice", notice: { kind, text: noticed, place: null } });
  }

  /** What the worker tells. @param {Told} told */
  function hear(told) {
    if (told.error) broke(told.error);
    if (told.facts) {
      // What cannot be is not offered first.
      if (!judged && told.facts.stream.why && !told.facts.serve.why)
        for (const { name, input } of radios) input.checked = name === "serve";
      facts = told.facts;
      judged = true;
    }
    if (told.state) stand(told.state);
    if (told.rows) {
      for (const { delay_ms, model_ms, reply } of told.rows) {
        if (delay_ms !== null) delays.own.push(delay_ms);
        if (model_ms !== null) delays.model.push(model_ms);
        // No tick goes to who has not answered.
        if (reply !== null) unsettled = going;
      }
      rows.add(told.rows);
    }
    if (told.reported) {
      const { said: text, good } = outcome(told.reported);
      // What was pressed too late for it goes as soon as the port is given back.
      if (!ended) again &&= !good && !told.reported.stopped;
      ended = true;
      if (good) unsettled = null;
      tell(text, !good);
      if (!dialog.open)
        notify(good ? "info" : "error", `The dialog of devices was closed while it was sending. ${text}`);
      fill(twin, ...(told.reported.raw ? [] : twinOf(told.reported)));
      report.value = reportText(going.title, began, told.reported, delays);
      reported.hidden = false;
    }
    if (told.recorded) recorded(told.recorded);
    if (told.closed) closed(told.stuck ?? false);
    if (!told.state) show();
  }

  /** What had the port has given it back, or the browser keeps it. @param {boolean} isStuck */
  function closed(isStuck) {
    const hasFailed = facts === null;
    running = null;
    ended = true;
    if (isStuck) {
      keep(going.port);
      const lost = again ? `STOP was not sent. ${RUNS_DRY}` : said.textContent;
      tell(`${lost} ${STUCK}`, true);
      if (!dialog.isConnected) notify("error", STUCK);
    }
    if (again && port && dialog.isConnected) return void begin(true);
    if (hasFailed || inFront()) front();
  }

  /** The part of the page that had the port is gone, and with it what it knew. @param {string} why */
  function broke(why) {
    facts = null;
    json = "";
    if (running === null) {
      broken = `A part of this page failed: ${why}. Close this dialog and open it again.`;
      return;
    }
    ended = true;
    // Its last replies may not have been told.
    if (running === "stream" && !going.raw) unsettled ??= going;
    tell(`This failed: ${why}.${running === "stream" ? ` ${RUNS_DRY}` : ""}`, true);
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

  /** @param {import("../../engine/live.js").Recorded} session */
  function recorded(session) {
    const { why, lost, heard, times: clock } = session;
    ended = true;
    const gone = lost ? ` The port is lost: ${lost}.` : "";
    if (heard === 0) return tell(`Nothing was heard: there is nothing to record.${gone}`, lost !== "");
    if (why !== null) {
      times.onclick = () => saveTimes(now(), clock);
      times.hidden = false;
      return tell(`Not recorded: ${why}.${gone}`, true);
    }
    dialog.close();
    void openRecorded(page, session, gone);
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
