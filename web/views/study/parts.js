/** Building blocks of the study: fields, tables, and long work with progress. */
import { element, fill, say } from "../../dom.js";
import { Dropped } from "../../engine/request_slots.js";
import { parseNumber } from "../../state/parse_number.js";

/** Work that is done within this time, in ms, says nothing of its progress. */
const PATIENCE_MS = 100;
/** Rest after a change before work begins, in ms: typing a number is one piece of work. */
const REST_MS = 120;

let made = 0;

/**
 * A number that a tab requests; `change` hears it once it is one in its range.
 * @param {string} label @param {string} unit @param {number} start @param {{least: number, most: number, integer?: boolean}} range @param {() => void} change
 */
export function field(label, unit, start, { least, most, integer = false }, change) {
  const id = `study-field-${made++}`;
  const input = element("input", {
    id,
    inputmode: "decimal",
    spellcheck: "false",
    autocomplete: "off",
    value: String(start),
    "aria-describedby": `${id}-error`,
  });
  const error = element("span", { id: `${id}-error`, class: "error" });
  const root = element(
    "span",
    { class: "study-field" },
    element("label", { for: id }, unit ? `${label}, ${unit}` : label),
    input,
    error,
  );
  let value = start;
  /** What is wrong with what is typed; and with its value, beside others. */
  let [wrong, invalid] = ["", ""];
  const showError = () => {
    say(error, wrong || invalid);
    if (wrong || invalid) input.setAttribute("aria-invalid", "true");
    else input.removeAttribute("aria-invalid");
  };
  input.addEventListener("change", () => {
    const read = parseNumber(input.value, unit, { integer, least, most });
    wrong =
      "message" in read
        ? read.message
        : read.value >= least && read.value <= most
          ? ""
          : `${input.value.trim()} is out of range; use ${least} to ${most}.`;
    showError();
    if (wrong || !("value" in read) || read.value === value) return;
    value = read.value;
    change();
  });
  /** @param {number} next */
  const set = (next) => {
    // What is being typed stays where nothing changes.
    if (next === value) return;
    value = next;
    input.value = String(next);
    [wrong, invalid] = ["", ""];
    showError();
  };
  /** @param {string} message */
  const fail = (message) => {
    invalid = message;
    showError();
  };
  return { root, value: () => value, set, fail };
}

/** A choice. @param {string} label @param {{[value: string]: string}} choices @param {() => void} change */
export function choice(label, choices, change) {
  const select = element(
    "select",
    {},
    ...Object.entries(choices).map(([value, text]) => element("option", { value }, text)),
  );
  select.addEventListener("change", change);
  return { root: element("label", {}, `${label} `, select), value: () => select.value };
}

/** Puts the focus on a row of a table: what had it in there has gone, or is of no use now. @param {HTMLElement | null} row */
export function focusRow(row) {
  row?.setAttribute("tabindex", "-1");
  row?.focus({ preventScroll: true });
}

/** A table that scrolls, and keeps the focus in its row when it is filled anew; a column whose head begins with `#` has numbers, one with `~` before it is left out on a narrow screen. @param {string} label @param {string[]} head */
export function table(label, head) {
  const kinds = head.map((text) =>
    `${text.includes("#") ? "number" : ""} ${text.startsWith("~") ? "wide-only" : ""}`.trim(),
  );
  const body = element("tbody");
  const root = element(
    "div",
    { class: "study-scroll", tabindex: "0", role: "group", "aria-label": label },
    element(
      "table",
      { "aria-label": label },
      element(
        "thead",
        {},
        element(
          "tr",
          {},
          ...head.map((text, at) =>
            element(
              text ? "th" : "td",
              { ...(text ? { scope: "col" } : {}), class: kinds[at] },
              text.replace(/^~?#?/, ""),
            ),
          ),
        ),
      ),
      body,
    ),
  );
  /** A row; its first cell is its head. @param {(string | Node)[]} cells */
  const row = (cells) =>
    element(
      "tr",
      {},
      ...cells.map((cell, at) =>
        element(at === 0 ? "th" : "td", { ...(at === 0 ? { scope: "row" } : {}), class: kinds[at] }, cell),
      ),
    );
  /** @param {(string | Node)[][]} rows */
  const show = (rows) => {
    const had = document.activeElement;
    const at = [...body.children].findIndex((each) => each.contains(had));
    const onRow = had === body.children[at];
    fill(body, ...rows.map(row));
    if (at < 0) return;
    const same = /** @type {HTMLElement | undefined} */ (body.children[at]);
    const control = /** @type {HTMLElement | null | undefined} */ (onRow ? null : same?.querySelector("button, input"));
    if (control) control.focus({ preventScroll: true });
    else if (same) focusRow(same);
    else root.focus({ preventScroll: true });
  };
  return { root, body, show };
}

/**
 * Long work of a tab, one at a time: newer work ends the older. After a moment it says how far it is, and it can be left off and begun anew.
 * @param {string} label @param {() => string} [left]  Text about what stays without it.
 */
export function createJob(label, left = () => "") {
  const bar = element("progress", { max: "1", value: "0", "aria-label": label });
  const text = element("span");
  const press = element("button", { type: "button" });
  const root = element("p", { class: "study-job", role: "group", "aria-label": label }, text, bar, press);
  root.hidden = true;
  /** @type {AbortController | null} */
  let going = null;
  /** @type {() => void} */
  let again = () => {};
  press.addEventListener("click", () => {
    if (!going) return again();
    going.abort();
    going = null;
    bar.hidden = true;
    say(text, `Canceled: ${text.textContent}.${left()}`);
    say(press, "Start again");
  });

  /**
   * @template T
   * @param {(signal: AbortSignal, tell: (part: number, text: string) => void) => Promise<T>} work
   * @param {(result: T) => void} done  Hears what it came to, where nothing newer took its place.
   */
  async function run(work, done) {
    going?.abort();
    const own = new AbortController();
    going = own;
    again = () => run(work, done);
    await new Promise((resolve) => setTimeout(resolve, REST_MS));
    if (going !== own) return;
    say(text, "");
    text.classList.remove("error");
    const timer = setTimeout(() => {
      root.hidden = bar.hidden = false;
      say(press, "Cancel");
    }, PATIENCE_MS);
    try {
      const result = await work(own.signal, (part, status) => {
        if (going !== own) return;
        bar.value = part;
        say(text, status);
      });
      if (going !== own) return;
      going = null;
      // The button that has the focus goes: its tab takes it.
      if (root.contains(document.activeElement)) {
        const panel = /** @type {HTMLElement | null} */ (root.closest("[role=tabpanel]"));
        panel?.setAttribute("tabindex", "-1");
        panel?.focus({ preventScroll: true });
      }
      root.hidden = true;
      done(result);
    } catch (error) {
      if (going !== own || error instanceof Dropped) return;
      going = null;
      root.hidden = false;
      bar.hidden = true;
      text.classList.add("error");
      say(text, error instanceof Error ? error.message : String(error));
      say(press, "Try again");
    } finally {
      clearTimeout(timer);
    }
  }
  return { root, run };
}
