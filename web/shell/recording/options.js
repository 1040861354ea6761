/** Options of the dialog of a recording: channel map, rates, visible part, comparison. */
import { button, element, setText } from "../../dom.js";
import { createChannelTable } from "./channel_table.js";
import { choiceField, numberField, timeField } from "./fields.js";
import { createOverview } from "./overview.js";
import { emptyBaud, FORMATS, hasMap, needsRate, requestOf, shownFields } from "./request.js";

/** @typedef {import("../../engine/capture.js").Facts} Facts */
/** @typedef {import("../../engine/capture.js").Preview} Preview */
/** @typedef {import("./request.js").Values} Values */

/**
 * @param {Facts} facts @param {Parameters<typeof createOverview>[0]} capture
 * @param {boolean} hasPlan  Whether there is a run to compare with. @param {() => void} onChange
 */
export function createOptions(facts, capture, hasPlan, onChange) {
  const table = createChannelTable(facts.channels);
  const mapError = element("p", { class: "error", "aria-live": "polite" });
  const rate = numberField("Sample rate", "Hz", "required");
  const baud = numberField("Bit rate", "baud", emptyBaud(facts));
  const uart = choiceField("Serial format", FORMATS);
  const clock = numberField("Clock", "Hz", "from the file");
  const from = timeField("Show from", "its start");
  const to = timeField("Show up to", "maximum length");
  const align = numberField("Aligned by step", "", "0, the first", 0);
  const fields = [rate, baud, uart, clock];
  rate.label.hidden = !needsRate(facts);
  const compares = element("input", { id: "recording-compare", type: "checkbox", ...(hasPlan ? { checked: "" } : {}) });
  const compare = element("label", { class: "check" }, compares, ` Compare with this experiment`);
  let choosesPart = false;
  const choosePart = button("Show a part…", "Show a part: enter its start and end", () => {
    choosesPart = true;
    show();
    from.label.querySelector("input")?.focus();
  });
  const overview = createOverview(capture, (part) => {
    from.set(part?.from_s ?? null);
    to.set(part?.to_s ?? null);
    onChange();
  });
  /** How to show an error, by the name of its field. @type {{[field: string]: (message: string) => void}} */
  const errors = {
    map: (text) => setText(mapError, text),
    clock_hz: clock.fail,
    sample_rate_hz: rate.fail,
    baud: baud.fail,
    uart: uart.fail,
  };
  /** The preview with these options. @type {Preview | null} */
  let preview = null;

  function show() {
    const isPart = Boolean(preview?.part) || from.value() !== null || to.value() !== null;
    const hasLine = table.has("RX", "TX");
    const shown = shownFields(facts, { hasLine, hasPlan, isPart, choosesPart, isCompared: compares.checked });
    for (const { label } of [from, to]) label.hidden = !shown.part;
    choosePart.hidden = overview.node.hidden || !shown.choosePart;
    compare.hidden = !shown.compare;
    align.label.hidden = !shown.align;
    baud.label.hidden = !shown.baud;
    uart.label.hidden = !shown.uart;
  }

  /** @returns {Values} */
  const values = () => ({
    map: table.map(),
    clock: clock.value(),
    rate: rate.value(),
    baud: baud.value(),
    uart: uart.value(),
    from_s: from.value(),
    to_s: to.value(),
  });

  return {
    nodes: [
      ...(hasMap(facts) ? [table.node, mapError] : []),
      element("div", { class: "fields" }, ...fields.map(({ label }) => label)),
      overview.node,
      choosePart,
      from.label,
      to.label,
      compare,
      align.label,
    ],
    show,
    values,
    request: () =>
      requestOf(values(), {
        map: hasMap(facts),
        rate: !rate.label.hidden,
        baud: !baud.label.hidden,
        uart: !uart.label.hidden,
      }),
    isInvalid: () =>
      table.isInvalid() || [...fields, from, to, align].some(({ label, isInvalid }) => !label.hidden && isInvalid()),
    /** Whether a channel has to be selected first. */
    needsMap: () => facts.has_levels && table.map() === "",
    /** The step or byte by which both are aligned; null if they are not compared. */
    alignedStep: () => (align.label.hidden ? null : align.value()),
    /** @param {number} hz */
    setClock: (hz) => clock.set(hz),
    /** @param {string} map */
    setMap: (map) => table.setMap(map),
    /** @param {Values} earlier */
    restore(earlier) {
      for (const [field, value] of /** @type {[typeof clock, number][]} */ ([
        [clock, earlier.clock],
        [rate, earlier.rate],
        [baud, earlier.baud],
      ]))
        if (value) field.set(value);
      uart.set(earlier.uart);
      from.set(earlier.from_s);
      to.set(earlier.to_s);
    },
    /** Shows a preview; null clears it. @param {Preview | null} found */
    render(found) {
      preview = found;
      overview.render(facts.has_levels ? found : null);
      show();
    },
    clearErrors() {
      for (const fail of Object.values(errors)) fail("");
    },
    /** Shows an error at its field. Returns whether there is such a field. @param {string} field @param {string} text */
    fail(field, text) {
      if (field === "sample_rate_hz") rate.label.hidden = false;
      errors[field]?.(text);
      return field in errors;
    },
    /** The field to fill in first, if any. @param {HTMLElement} body */
    missing: (body) =>
      facts.has_levels && table.map() === ""
        ? table.first
        : /** @type {HTMLElement | null} */ (body.querySelector(".fields [aria-invalid=true]")),
  };
}
