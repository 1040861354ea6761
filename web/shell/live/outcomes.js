/** Shows progress, report and recording in the device dialog. */
import { fill, setText } from "../../dom.js";
import { openRecorded, saveTimes } from "./recorded.js";
import { finalStates, reportText, servedText } from "./report.js";

/**
 * @param {ReturnType<typeof import("./layout.js").createLayout>} view @param {import("./session.js").LiveSession} session
 * @param {{page: import("../../state/types.js").Page, report: (text: string, isError?: boolean) => void, notify: (kind: "info" | "error", text: string) => void}} dialog
 */
export function createOutcomes(view, session, { page, report, notify }) {
  /** Start of the transfer, for the report. */
  let startTime = "";
  view.copy.addEventListener("click", copyReport);

  /** Clears everything before a role starts. @param {import("./roles.js").Role} role */
  function clear(role) {
    startTime = new Date().toISOString();
    fill(view.comparison);
    setText(view.progressText, "");
    view.progress.value = 0;
    view.progress.hidden = role === "serve";
    view.progress.ariaLabel = session.sent.raw ? "Packets sent" : "Ticks done";
    view.reported.hidden = view.curves.node.hidden = view.times.hidden = true;
  }

  /** @param {any} state */
  function showState(state) {
    if (session.running === "serve") {
      view.curves.draw(state);
      return setText(view.progressText, servedText(state));
    }
    setText(view.progressText, state.text.replaceAll("_", " "));
    view.progress.value = state.ticks > 0 ? state.done / state.ticks : 0;
  }

  /** @param {import("../../engine/live.js").Reported} reported */
  function showReport(reported) {
    const { text, good } = session.reported(reported);
    report(text, !good);
    if (!view.dialog.open) notify(good ? "info" : "error", `The device dialog was closed while sending. ${text}`);
    fill(view.comparison, ...(reported.raw ? [] : finalStates(reported)));
    view.report.value = reportText(session.sent.title, startTime, reported, session.delays);
    view.reported.hidden = false;
  }

  /** @param {import("../../engine/live.js").Recorded} recorded */
  function showRecorded(recorded) {
    const { why, lost, received, times } = recorded;
    session.ended = true;
    const portLost = lost ? ` The port is lost: ${lost}.` : "";
    if (received === 0) return report(`Nothing was received, so there is no recording.${portLost}`, lost !== "");
    if (why !== null) {
      view.times.onclick = () => saveTimes(page.now(), times);
      view.times.hidden = false;
      return report(`Not recorded: ${why}.${portLost}`, true);
    }
    view.dialog.close();
    void openRecorded(page, recorded, portLost);
  }

  async function copyReport() {
    try {
      await navigator.clipboard.writeText(view.report.value);
      setText(view.copy, "Copied");
    } catch {
      view.report.focus();
      view.report.select();
      setText(view.copy, "Selected: copy with Ctrl+C");
    }
  }
  return { clear, showState, showReport, showRecorded };
}
