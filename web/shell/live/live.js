/** The device dialog (LIVE H4): streams the experiment to a device, or acts as a device for a host. */
import { loadStyle, setText } from "../../dom.js";
import { openLive, PortLeft } from "../../engine/live.js";
import { errorMessage } from "../../state/error_message.js";
import { carryInto } from "./carried_button.js";
import { beginText, controlsOf, unsettledText } from "./controls.js";
import { deviceRows } from "./device_rows.js";
import { guardPage } from "./guards.js";
import { createLayout } from "./layout.js";
import { createOutcomes } from "./outcomes.js";
import { createPorts, STUCK } from "./ports.js";

import { whyNoPort } from "./roles.js";
import { LiveSession, RUNS_DRY } from "./session.js";

/** @typedef {import("../../engine/live.js").LiveEvent} LiveEvent */

/** @type {import("./session.js").Device} */
const device = { port: null, unsettled: null };
/** Brings the open dialog to the front. @type {(() => void) | null} */
let bringToFront = null;

/** @param {import("../open_file.js").Given} page */
export async function openDevice(page) {
  if (bringToFront) return bringToFront();
  bringToFront = () => {};
  await loadStyle("live");
  bringToFront = createDialog(page);
  return bringToFront();
}

/** Opens the dialog; returns how to bring it to the front. @param {import("../open_file.js").Given} page */
function createDialog(page) {
  const { dispatch, now } = page;
  const session = new LiveSession(device);
  const view = createLayout();
  const { dialog, start, stop } = view;
  const rows = deviceRows();
  const live = openLive(receive);
  const noPort = whyNoPort();
  let { scenario } = now();
  /** Messages of this dialog in the notice of the page. */
  let noticeText = "";
  const ports = createPorts(device, view.allowed, { report, onSelect: show, focus: () => start.focus() });
  const role = () => view.roles.find(({ input }) => input.checked)?.name ?? "stream";
  const isInFront = () => dialog.matches(":modal");

  for (const { input } of view.roles) input.addEventListener("change", show);
  view.choose.addEventListener("click", ports.choose);
  // Ignores the second click of a double click, and repeated keys.
  start.addEventListener("click", ({ detail }) => void (detail < 2 && begin(false)));
  start.addEventListener("keydown", (event) => event.repeat && event.preventDefault());
  stop.addEventListener("click", pressStop);
  view.end.addEventListener("click", () => live.end());
  view.close.addEventListener("click", () => dialog.close());
  view.aside.addEventListener("click", () => (isInFront() ? setInFront(false) : front()));
  const endGuards = guardPage(session, dialog, { isInFront, pressStop, stop: () => live.stop() });
  dialog.addEventListener("close", () => {
    // It only moved aside or to the front.
    if (dialog.open) return;
    bringToFront = null;
    endGuards();
    carrier.end();
    live.close().then(({ inTime, free }) => {
      if (!inTime && device.unsettled) notify("error", `STOP is not confirmed. ${RUNS_DRY}`);
      if (free) return;
      ports.exclude(session.sent.port);
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
  const outcomes = createOutcomes(view, session, { page, report, notify });
  const unsettled = unsettledText(device);
  if (unsettled) report(unsettled);
  if (!noPort) void ports.offer();
  return front;

  /** Brings the dialog to the front, and validates the current experiment. */
  function front() {
    if (!dialog.isConnected) return;
    if (!isInFront()) setInFront(true);
    if (session.running === null) validate();
  }

  /** Moves the dialog in front of the page, or aside, where the page stays usable. @param {boolean} isModal */
  function setInFront(isModal) {
    dialog.close();
    dialog.classList.toggle("aside", !isModal);
    if (isModal) dialog.showModal();
    else dialog.show();
    show();
  }

  /** Requests the available roles for the current experiment. */
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
    setText(view.about, controls.about.text);
    view.about.classList.toggle("error", controls.about.isError);
    for (const { input } of view.roles) input.disabled = controls.areRolesDisabled;
    for (const name of /** @type {const} */ (["choose", "start", "aside", "stop", "close"])) {
      const { text, ...properties } = /** @type {{text?: string}} */ (controls[name]);
      if (text !== undefined) setText(view[name], text);
      Object.assign(view[name], properties);
    }
    view.allowed.hidden = controls.isAllowedHidden;
    view.end.hidden = controls.isEndHidden;
    carrier.update();
  }

  /** @param {string} text @param {boolean} [isError] */
  function report(text, isError = false) {
    setText(view.status, text);
    view.status.classList.toggle("error", isError);
  }

  /** Reports on the page, if the dialog is closed. @param {"info" | "error"} kind @param {string} text */
  function notify(kind, text) {
    noticeText = `${noticeText} ${text}`.trimStart();
    dispatch({ type: "notice", notice: { kind, text: noticeText, location: null } });
  }

  /** @param {boolean} isStop  Whether only STOP is sent. */
  async function begin(isStop) {
    if (!isStop && JSON.stringify(now().scenario) !== session.json) {
      validate();
      return report("The experiment has changed. Press start again to use the new one.");
    }
    const warning = isStop ? "" : session.warning();
    if (warning) return report(warning, true);
    const name = isStop ? "stream" : role();
    session.begin(name, isStop, scenario.title);
    outcomes.clear(name);
    if (name === "stream") rows.begin(session.sent.raw);
    if (name === "stream" && !isStop) {
      setInFront(false);
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
        report(
          error instanceof PortLeft
            ? error.message
            : `The port cannot be opened: ${errorMessage(error)} Close other programs that use it.`,
          true,
        );
      show();
      if (sendDueStop()) return;
      front();
    }
  }

  /** Sends a STOP that was pressed while the port was not available. Returns whether there was one. */
  function sendDueStop() {
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
    if (event.state) outcomes.showState(event.state);
    if (event.rows) {
      session.exchanged(event.rows);
      rows.add(event.rows);
    }
    if (event.reported) outcomes.showReport(event.reported);
    if (event.recorded) outcomes.showRecorded(event.recorded);
    if (event.closed) closed(event.stuck ?? false);
    if (!event.state) show();
  }

  /** @param {boolean} isStuck  Whether the browser does not release the port. */
  function closed(isStuck) {
    const hasFailed = session.closed();
    if (isStuck) {
      ports.exclude(session.sent.port);
      const stopText = session.stopPressed ? `STOP was not sent. ${RUNS_DRY}` : view.status.textContent;
      report(`${stopText} ${STUCK}`, true);
      if (!dialog.isConnected) notify("error", STUCK);
    }
    if (sendDueStop()) return;
    if (hasFailed || isInFront()) front();
  }
}
