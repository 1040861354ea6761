/** What the tabs of the study are built with: fields, tables, and long work that tells how far it is. */
import { element, fill, say } from "../../dom.js";
import { Dropped } from "../../engine/engine.js";
import { parseNumber } from "../../state/number.js";

/** Work that is done within this time, in ms, says nothing of its progress. */
const PATIENCE_MS = 100;
/** Rest after a change before work begins, in ms: typing a number is one piece of work. */
const REST_MS = 120;

let made = 0;

/**
 * A number that a tab asks for; `change` hears it once it is one in its range.
 * @param {string} label @param {string} unit @param {number} start @param {{least: number, most: number, integer?: boolean}} range @param {() => void} change
 */
export function field(label, unit, start, { least, most, integer = false }, change) {
  const id = `study-field-${made++}`;
  const input = element("input", { id, inputmode: "decimal", spellcheck: "false", autocomplete: "off", value: String(start), "aria-describedby": `${id}-error` });
  const error = element("span", { id: `${id}-error`, class: "error" });
  const root = element("span", { class: "study-field" }, element("label", { for: id }, unit ? `${label}, ${unit}` : label), input, error);
  let value = start;
  input.addEventListener("change", () => {
    const read = parseNumber(input.value, unit, { integer });
    const message = "message" in read ? read.message : read.value >= least && read.value <= most ? "" : `Give ${least} to ${most}.`;
    say(error, message);
    input.setAttribute("aria-invalid", String(message !== ""));
    if (message || !("value" in read) || read.value === value) return;
    value = read.value;
    change();
  });
  /** @param {number} next */
  const set = (next) => {
    value = next;
    input.value = String(next);
    say(error, "");
    input.removeAttribute("aria-invalid");
  };
  return { root, value: () => value, set };
}

/** A choice. @param {string} label @param {{[value: string]: string}} choices @param {() => void} change */
export function choice(label, choices, change) {
  const select = element("select", {}, ...Object.entries(choices).map(([value, text]) => element("option", { value }, text)));
  select.addEventListener("change", change);
  return { root: element("label", {}, `${label} `, select), value: () => select.value };
}

/** A table that scrolls; a column whose head begins with `#` has numbers, one with `~` before it is left out on a narrow screen. @param {string} label @param {string[]} head */
export function table(label, head) {
  const kinds = head.map((text) => `${text.includes("#") ? "number" : ""} ${text.startsWith("~") ? "roomy" : ""}`.trim());
  const body = element("tbody");
  const root = element("div", { class: "study-scroll", tabindex: "0", role: "group", "aria-label": label }, element("table", { "aria-label": label }, element("thead", {}, element("tr", {}, ...head.map((text, at) =>
    element(text ? "th" : "td", { ...(text ? { scope: "col" } : {}), class: kinds[at] }, text.replace(/^~?#?/, ""))))), body));
  /** A row; its first cell is its head. @param {(string | Node)[]} cells */
  const row = (cells) => element("tr", {}, ...cells.map((cell, at) => element(at === 0 ? "th" : "td", { ...(at === 0 ? { scope: "row" } : {}), class: kinds[at] }, cell)));
  /** @param {(string | Node)[][]} rows */
  const show = (rows) => fill(body, ...rows.map(row));
  return { root, body, show };
}

/**
 * Long work of a tab, one at a time: newer work ends the older. After a moment it says how far it is, and it can be left off and begun anew.
 * @param {string} label
 */
export function createJob(label) {
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
    say(text, `Left off: ${text.textContent}.`);
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
      const result = await work(own.signal, (part, said) => {
        if (going !== own) return;
        bar.value = part;
        say(text, said);
      });
      if (going !== own) return;
      going = null;
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
