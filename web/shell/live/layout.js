/** The elements of the device dialog. */
import { element } from "../../dom.js";
import { positionCurves } from "./position_curves.js";
import { NAMES, ROLES } from "./roles.js";

export function createLayout() {
  const roles = NAMES.map((name) => {
    const input = element("input", { type: "radio", name: "live-role", value: name });
    input.checked = name === "stream";
    return { name, input, label: element("label", { class: "check" }, input, ` ${ROLES[name].label}`) };
  });
  const about = element("p", { id: "live-about" });
  const choose = element("button", { type: "button", id: "live-choose", "aria-describedby": "live-about" });
  const allowed = element("span", { id: "live-allowed", class: "live-allowed" });
  const start = element("button", { type: "button", id: "live-start", class: "main" });
  const end = element("button", { type: "button", id: "live-end" }, "End and open the recording");
  const aside = element("button", { type: "button", id: "live-aside" });
  const stop = element("button", { type: "button", id: "live-stop", class: "live-stop" }, "STOP");
  const actions = element("div", { class: "live-actions" }, choose, allowed, start, end, aside, stop);
  const status = element("p", { id: "live-status", class: "live-status", role: "status" });
  const progressText = element("p", { id: "live-standing", class: "live-standing" });
  const progress = element("progress", { max: "1", value: "0" });
  const curves = positionCurves();
  const comparison = element("div", { id: "live-twin" });
  const report = element("textarea", {
    id: "live-report",
    readonly: "",
    rows: "9",
    "aria-label": "Report",
    spellcheck: "false",
  });
  const copy = element("button", {
    type: "button",
    "aria-label": "Copy the report as text",
    title: "Copy the report as text",
  });
  copy.textContent = "Copy the report";
  const reported = element("div", { id: "live-reported" }, report, copy);
  /** Only for a session that could not be recorded. */
  const times = element("button", { type: "button", id: "live-times" }, "Save wall-clock times");
  for (const part of [progress, curves.node, reported, times]) part.hidden = true;
  const close = element("button", { type: "button", id: "live-close" }, "Close");
  const dialog = element(
    "dialog",
    { class: "recording live", "aria-labelledby": "live-title" },
    element(
      "div",
      {},
      element("h2", { id: "live-title" }, "Device"),
      element("fieldset", {}, element("legend", {}, "Mode"), ...roles.map(({ label }) => label)),
      about,
      actions,
      status,
      times,
      progress,
      progressText,
      curves.node,
      comparison,
      reported,
      element(
        "p",
        { class: "note" },
        "If you leave the page or the port is lost, sending ends. The device then executes its queue and stops with UNDERRUN.",
      ),
      element("p", { class: "named" }, close),
    ),
  );
  return {
    dialog,
    roles,
    about,
    choose,
    allowed,
    start,
    end,
    aside,
    stop,
    actions,
    status,
    progressText,
    progress,
    curves,
    comparison,
    report,
    copy,
    reported,
    times,
    close,
  };
}
