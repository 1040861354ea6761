/** The device dialog (LIVE H4): streams the ticks of the experiment to a device, or is a soft device for a host. */
import { fill, say, style } from "../../dom.js";
import { openLive } from "../../engine/live.js";
import { message } from "../link.js";
import { carryInto } from "./carried_button.js";
import { beginText, controlsOf, unsettledText } from "./controls.js";
import { deviceRows } from "./device_rows.js";
import { guardPage } from "./guards.js";
import { createLayout } from "./layout.js";
import { createPorts, STUCK } from "./ports.js";
import { openRecorded, saveTimes } from "./recorded.js";
import { reportText, servedText, twinOf } from "./report.js";
import { whyNoPort } from "./roles.js";
import { LiveSession, RUNS_DRY } from "./session.js";

/** @typedef {import("../../engine/live.js").LiveEvent} LiveEvent */

/** @type {import("./session.js").Device} */
const device = { port: null, unsettled: null };
/** Brings the open dialog to the front. @type {(() => void) | null} */
let bring = null;

/** @param {import("../open_file.js").Given} page */
export async function openDevice(page) {
  if (bring) return bring();
  bring = () => {};
  await style("live");
  bring = createDialog(page);
  return bring();
}

/** Returns how to bring it to the front. @param {import("../open_file.js").Given} page */
function createDialog(page) {
  const { dispatch, now } = page;
  const session = new LiveSession(device);
  const view = createLayout();
  const { dialog, start, stop } = view;
  const rows = deviceRows();
  const live = openLive(receive);
  const noPort = whyNoPort();
  let { scenario } = now();
  /** When the stream began. */
  let began = "";
  /** The notice of a dialog that is gone. */
  let noticed = "";
  const ports = createPorts(device, view.allowed, { report, onSelect: show, focus: () => start.focus() });
  const role = () => view.roles.find(({ input }) => input.checked)?.name ?? "stream";
  const isInFront = () => dialog.matches(":modal");

  for (const { input } of view.roles) input.addEventListener("change", show);
  view.choose.addEventListener("click", ports.choose);
  // One press is one start: not the second of a double click, and not a key that repeats.
  start.addEventListener("click", ({ detail }) => void (detail < 2 && begin(false)));
  start.addEventListener("keydown", (event) => event.repeat && event.preventDefault());
  stop.addEventListener("click", pressStop);
  view.end.addEventListener("click", () => live.end());
  view.close.addEventListener("click", () => dialog.close());
  view.aside.addEventListener("click", () => (isInFront() ? lay(false) : front()));
  view.copy.addEventListener("click", copyReport);
  const endGuards = guardPage(session, dialog, { isInFront, pressStop, stop: () => live.stop() });
  dialog.addEventListener("close", () => {
    // It was only laid aside, or brought to the front.
    if (dialog.open) return;
    bring = null;
    endGuards();
    carrier.end();
    live.close().then(({ inTime, free }) => {
      if (!inTime && device.unsettled) notify("error", `STOP is not confirmed. ${RUNS_DRY}`);
      if (free) return;
      ports.giveUp(session.sent.port);
      notify("error", STUCK);
    });
    dialog.remove();
  });
  document.body.append(dialog);
  const carrier = carryInto(
    () => session.mayMove,
    stop,
    () => view.actions.append(stop),
  );
  const first = unsettledText(device);
  if (first) report(first);
  if (!noPort) void ports.offer();
  return front;

  /** To the front, with the experiment as it is now. */
  function front() {
    if (!dialog.isConnected) return;
    if (!isInFront()) lay(true);
    if (session.running === null) validate();
  }

  /** In front of the page, or aside, where the page can be used. @param {boolean} front */
  function lay(front) {
    dialog.close();
    dialog.classList.toggle("aside", !front);
    if (front) dialog.showModal();
    else dialog.show();
    show();
  }

  /** Asks the worker what can be done with the experiment as it is now. */
  function validate() {
    ({ scenario } = now());
    const json = JSON.stringify(scenario);
    if (json === session.json) return;
    session.json = json;
    session.facts = null;
    session.broken = "";
    live.validate(json);
    show();
  }

  function show() {
    const controls = controlsOf(session, { role: role(), scenario, noPort, isInFront: isInFront() });
    say(view.about, controls.about.text);
    view.about.classList.toggle("error", controls.about.isError);
    for (const { input } of view.roles) input.disabled = controls.areRolesDisabled;
    for (const name of /** @type {const} */ (["choose", "start", "aside", "stop", "close"])) {
      const { text, ...properties } = /** @type {{text?: string}} */ (controls[name]);
      if (text !== undefined) say(view[name], text);
      Object.assign(view[name], properties);
    }
    view.allowed.hidden = controls.isAllowedHidden;
    view.end.hidden = controls.isEndHidden;
    carrier.place();
  }

  /** @param {string} text @param {boolean} [isError] */
  function report(text, isError = false) {
    say(view.status, text);
    view.status.classList.toggle("error", isError);
  }

  /** Reports on the page, where the dialog is gone. @param {"info" | "error"} kind @param {string} text */
  function notify(kind, text) {
    noticed = `${noticed} ${text}`.trimStart();
    dispatch({ type: "notice", notice: { kind, text: noticed, place: null } });
  }

  /** @param {boolean} isStop  Whether STOP is all that is sent. */
  async function begin(isStop) {
    if (!isStop && JSON.stringify(now().scenario) !== session.json) {
      validate();
      return report("The experiment has changed. Press start again to use the new one.");
    }
    const warning = isStop ? "" : session.warning();
    if (warning) return report(warning, true);
    const name = isStop ? "stream" : role();
    session.begin(name, isStop, scenario.title);
    began = new Date().toISOString();
    fill(view.twin);
    say(view.standing, "");
    view.progress.value = 0;
    view.progress.hidden = name === "serve";
    view.progress.ariaLabel = session.sent.raw ? "Packets sent" : "Ticks done";
    view.reported.hidden = view.curves.node.hidden = view.times.hidden = true;
    if (name === "stream") rows.begin(session.sent.raw);
    if (name === "stream" && !isStop) {
      lay(false);
      dispatch({ type: "view", view: "packets" });
    }
    report(beginText(name, isStop));
    show();
    if (name === "stream") stop.focus();
    const { port, baud, json } = session.sent;
    try {
      await (name === "serve" ? live.serve(port, baud, json) : live.stream(port, baud, json, isStop));
    } catch (error) {
      session.running = null;
      if (!session.ended)
        report(`The port cannot be opened: ${message(error)} Close other programs that use it.`, true);
      show();
      if (stopAgain()) return;
      front();
    }
  }

  /** Sends the STOP that was pressed while the port was not free. */
  function stopAgain() {
    const isDue = session.stopPressed && device.port && dialog.isConnected;
    if (isDue) void begin(true);
    return isDue;
  }

  function pressStop() {
    const { action, text } = session.pressStop();
    if (action === "none") return;
    if (action === "begin") return void begin(true);
    live.stop();
    report(text, true);
  }

  /** @param {LiveEvent} event  From the worker. */
  function receive(event) {
    if (event.error) {
      const text = session.failed(event.error);
      if (text) report(text, true);
    }
    if (event.facts) {
      const other = session.setFacts(event.facts);
      if (other) for (const { name, input } of view.roles) input.checked = name === other;
    }
    if (event.state) showState(event.state);
    if (event.rows) {
      session.exchanged(event.rows);
      rows.add(event.rows);
    }
    if (event.reported) showReport(event.reported);
    if (event.recorded) showRecorded(event.recorded);
    if (event.closed) closed(event.stuck ?? false);
    if (!event.state) show();
  }

  /** @param {any} state */
  function showState(state) {
    if (session.running === "serve") {
      view.curves.draw(state);
      return say(view.standing, servedText(state));
    }
    say(view.standing, state.text.replaceAll("_", " "));
    view.progress.value = state.ticks > 0 ? state.done / state.ticks : 0;
  }

  /** @param {import("../../engine/live.js").Reported} reported */
  function showReport(reported) {
    const { text, good } = session.reported(reported);
    report(text, !good);
    if (!dialog.open) notify(good ? "info" : "error", `The device dialog was closed while sending. ${text}`);
    fill(view.twin, ...(reported.raw ? [] : twinOf(reported)));
    view.report.value = reportText(session.sent.title, began, reported, session.delays);
    view.reported.hidden = false;
  }

  /** @param {boolean} isStuck  Whether the browser keeps the port. */
  function closed(isStuck) {
    const hasFailed = session.closed();
    if (isStuck) {
      ports.giveUp(session.sent.port);
      const lost = session.stopPressed ? `STOP was not sent. ${RUNS_DRY}` : view.status.textContent;
      report(`${lost} ${STUCK}`, true);
      if (!dialog.isConnected) notify("error", STUCK);
    }
    if (stopAgain()) return;
    if (hasFailed || isInFront()) front();
  }

  /** @param {import("../../engine/live.js").Recorded} recorded */
  function showRecorded(recorded) {
    const { why, lost, received, times } = recorded;
    session.ended = true;
    const gone = lost ? ` The port is lost: ${lost}.` : "";
    if (received === 0) return report(`Nothing was received, so there is no recording.${gone}`, lost !== "");
    if (why !== null) {
      view.times.onclick = () => saveTimes(now(), times);
      view.times.hidden = false;
      return report(`Not recorded: ${why}.${gone}`, true);
    }
    dialog.close();
    void openRecorded(page, recorded, gone);
  }

  async function copyReport() {
    try {
      await navigator.clipboard.writeText(view.report.value);
      say(view.copy, "Copied");
    } catch {
      view.report.focus();
      view.report.select();
      say(view.copy, "Selected: copy with Ctrl+C");
    }
  }
}
