/** Options of the dialog of a recording: channel map, rates, visible part, comparison. */
import { button, element, say } from "../../dom.js";
import { createChannelTable } from "./channel_table.js";
import { choiceField, numberField, timeField } from "./fields.js";
import { createOverview } from "./overview.js";
import { emptyBaud, FORMATS, hasMap, needsRate, requestOf, shownFields } from "./request.js";

/** @typedef {import("../../engine/capture.js").Facts} Facts */
/** @typedef {import("../../engine/capture.js").Preview} Preview */
/** @typedef {import("./request.js").Values} Values */

/**
 * @param {Facts} facts @param {Parameters<typeof createOverview>[0]} capture
 * @param {boolean} hasPlan  Whether the experiment can be compared with. @param {() => void} changed
 */
export function createOptions(facts, capture, hasPlan, changed) {
  const table = createChannelTable(facts.channels);
  const mapError = element("p", { class: "error", "aria-live": "polite" });
  const rate = numberField("Sample rate", "Hz", "required");
  const baud = numberField("Bit rate", "baud", emptyBaud(facts));
  const uart = choiceField("Serial format", FORMATS);
  const clock = numberField("Clock", "Hz", "from the file");
  const from = timeField("Show from", "its beginning");
  const to = timeField("Show up to", "maximum length");
  const align = numberField("Aligned by step", "", "0, the first", 0);
  const fields = [rate, baud, uart, clock];
  rate.label.hidden = !needsRate(facts);
  const compares = element("input", { id: "recording-compare", type: "checkbox", ...(hasPlan ? { checked: "" } : {}) });
  const compare = element("label", { class: "check" }, compares, ` Compare with this experiment`);
  let choosesPart = false;
  const choosePart = button("Show a part…", "Show a part, from one time to another", () => {
    choosesPart = true;
    show();
    from.label.querySelector("input")?.focus();
  });
  const overview = createOverview(capture, (part) => {
    from.set(part?.from_s ?? null);
    to.set(part?.to_s ?? null);
    changed();
  });
  /** Where an error is shown, by the field that it names. @type {{[field: string]: (message: string) => void}} */
  const errors = {
    map: (text) => say(mapError, text),
    clock_hz: clock.fail,
    sample_rate_hz: rate.fail,
    baud: baud.fail,
    uart: uart.fail,
  };
  /** The preview that the options are of. @type {Preview | null} */
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
    isWrong: () =>
      table.isWrong() || [...fields, from, to, align].some(({ label, isWrong }) => !label.hidden && isWrong()),
    /** Whether a channel has to be selected first. */
    needsMap: () => facts.has_levels && table.map() === "",
    /** The step that both have at one time; null where the experiment is not compared. */
    alignedStep: () => (align.label.hidden ? null : align.value()),
    /** @param {number} hz */
    setClock: (hz) => clock.set(hz),
    /** @param {string} map */
    setMap: (map) => table.put(map),
    /** @param {Values} given */
    restore(given) {
      for (const [field, value] of /** @type {[typeof clock, number][]} */ ([
        [clock, given.clock],
        [rate, given.rate],
        [baud, given.baud],
      ]))
        if (value) field.set(value);
      uart.set(given.uart);
      from.set(given.from_s);
      to.set(given.to_s);
    },
    /** Shows a preview, or none. @param {Preview | null} found */
    render(found) {
      preview = found;
      overview.render(facts.has_levels ? found : null);
      show();
    },
    clearErrors() {
      for (const fail of Object.values(errors)) fail("");
    },
    /** Whether there is a field for the error. @param {string} field @param {string} text */
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
