/**
 * The link: the whole scenario behind the address's '#'. It follows the scenario without a history entry,
 * is heard when it changes, and never overwrites the visitor's own work.
 */
import { byId, say } from "../dom.js";
import { Dropped } from "../engine/engine.js";
import { readJson } from "../state/json.js";
import { held } from "../state/state.js";

/** @typedef {import("../state/types.js").State} State */

/** How long the scenario must stand before the address follows, in ms. */
const SETTLE_MS = 300;
/** The view: start and end of the shown time, in cycles. */
const VIEW = /^(\d{1,16})-(\d{1,16})$/;

/** The shown time as a link writes it; empty for the whole run. @param {State} state */
function viewOf({ window, awaited }) {
  const span = window ?? awaited;
  return span ? `${span.start}-${span.end}` : "";
}

/** The time that a link asks to be shown; none where that cannot be read. @param {string | undefined} text @returns {import("../state/types.js").Span | null} */
export function spanOf(text) {
  const [, start, end] = (VIEW.exec(text ?? "") ?? []).map(Number);
  return Number.isSafeInteger(end) && start < end ? { start, end } : null;
}

/** @param {{engine: import("../engine/engine.js").Engine} & import("../time/timeline.js").Page} page */
export function createLink({ engine, dispatch, now }) {
  /** Fragment that this page wrote or read last. */
  let written = location.hash;
  let timer = 0;
  const text = /** @type {HTMLInputElement} */ (byId("link-text"));
  const fallback = byId("copy-fallback");

  byId("copy-link").addEventListener("click", copy);
  byId("link-close").addEventListener("click", () => { fallback.hidden = true; });
  window.addEventListener("hashchange", () => { if (location.hash !== written) read(); });

  /** @returns {Promise<string>} The page's address with the scenario and the view in it. */
  async function address() {
    const scenario = await engine.ask("encode_link", JSON.stringify(now().scenario));
    const view = viewOf(now());
    const fragment = [scenario, ...(view ? [`v=${view}`] : [])].join("&");
    return `${location.origin}${location.pathname}${location.search}#${fragment}`;
  }

  /** @param {string} full */
  function place(full) {
    // The mark tells a reload that the address only repeats the visitor's own work.
    history.replaceState({ own: now().origin === "own" }, "", full);
    written = location.hash;
  }

  async function write() {
    const { revision } = now();
    if (held(now()) === "problems") return;
    if (held(now()) === "unjudged") {
      timer = window.setTimeout(write, SETTLE_MS);
      return;
    }
    try {
      const full = await address();
      if (now().revision === revision) place(full);
    } catch {
      // A scenario that cannot be a link yet; its problems are shown where they are.
    }
  }

  async function copy() {
    if (held(now()) === "problems") {
      return dispatch({ type: "notice", notice: { kind: "error", text: "No link yet: fields of the form need other values; mend them, then copy." } });
    }
    try {
      const full = await address();
      place(full);
      try {
        await navigator.clipboard.writeText(full);
        flash();
      } catch {
        fallback.hidden = false;
        text.value = full;
        text.focus();
        text.select();
      }
    } catch (error) {
      dispatch({ type: "notice", notice: { kind: "error", text: `No link: ${message(error)}` } });
    }
  }

  function flash() {
    const button = byId("copy-link");
    say(button, "Copied");
    setTimeout(() => say(button, "Copy link"), 1500);
  }

  /** The address at the page's start; after a reload it may only repeat the visitor's own work. @param {boolean} saved */
  async function start(saved) {
    if (!saved || history.state?.own !== true) return read();
    written = location.hash;
    await open(location.hash.replace(/^#/, ""));
  }

  /** Shows the time that a fragment asks for. @param {string} fragment */
  async function open(fragment) {
    const window = spanOf(await engine.ask("link_part", fragment, "v"));
    if (window) dispatch({ type: "open", window });
  }

  /** Reads the address; shows what it holds as a shared scenario, or says why it cannot. */
  async function read() {
    const fragment = location.hash.replace(/^#/, "");
    written = location.hash;
    if (fragment === "") return;
    // A place in the page is no link; the address takes the scenario back.
    if (document.getElementById(fragment)) return write();
    try {
      const answer = await engine.ask("decode_link", fragment);
      if ("error" in answer) return refuse(answer.error);
      const scenario = readJson(answer.scenario);
      if (JSON.stringify(scenario) !== JSON.stringify(now().scenario)) {
        dispatch({ type: "replace", scenario, origin: "shared" });
        const name = scenario.title ? `“${scenario.title}”` : "a scenario";
        dispatch({ type: "notice", notice: { kind: "info", text: `Shared with you: ${name}. Your own work is kept; Undo brings it back.` } });
      }
      await open(fragment);
    } catch (error) {
      if (!(error instanceof Dropped)) refuse(message(error));
    }
  }

  /** @param {string} why */
  function refuse(why) {
    dispatch({ type: "notice", notice: { kind: "error", text: `This link cannot be opened: ${why}` } });
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (before?.notice !== state.notice) {
      const line = byId("link-message");
      line.hidden = state.notice === null;
      line.classList.toggle("error", state.notice?.kind === "error");
      say(line, state.notice?.text ?? "");
    }
    const changed = before?.scenario !== state.scenario;
    if (!changed && viewOf(before) === viewOf(state)) return;
    if (changed) fallback.hidden = true;
    clearTimeout(timer);
    // Standing by until the visitor changes something: an address without a link stays as it is.
    if (state.revision > 0 || written !== "" || viewOf(state) !== "") timer = window.setTimeout(write, SETTLE_MS);
  }
  return { render, start };
}

/** @param {unknown} error */
function message(error) {
  return error instanceof Error ? error.message : String(error);
}
