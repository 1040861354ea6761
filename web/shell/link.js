/**
 * The link in the address. It follows the scenario, and never overwrites own work. Opening another scenario adds a history entry, so
 * that Back returns to the one before; edits add none.
 */
import { Dropped } from "../engine/request_slots.js";
import { errorMessage } from "../state/error_message.js";
import { DEPTH } from "../state/history.js";
import { readJson } from "../state/json.js";
import { blockedBy } from "../state/queries.js";
import { undoHint } from "./storage.js";
import { parseView, viewOf } from "./view_part.js";

/** @typedef {import("../state/types.js").State} State */

/** Delay after a change before the address is updated, in ms. */
const UPDATE_DELAY_MS = 300;

/** @param {{engine: import("../engine/engine.js").Engine} & import("../state/types.js").Page} page */
export function createLink({ engine, dispatch, now }) {
  /** The fragment that this page last wrote or read. */
  let written = location.hash;
  let timer = 0;
  /** The scenarios and views of the latest history entries. @type {Map<number, {scenario: import("../state/types.js").Scenario, origin: import("../state/types.js").Origin, view: string}>} */
  const entries = new Map();
  let entry = history.state?.entry ?? 0;
  let lastEntry = entry;
  /** Whether the browser has made the history entry of the scenario that is being opened. */
  let isNavigation = false;

  window.addEventListener("hashchange", () => {
    if (location.hash !== written) read();
  });
  window.addEventListener("popstate", ({ state: to }) => {
    const known = entries.get(to?.entry);
    // After a reload the link in the address is read instead.
    if (!known) return;
    written = location.hash;
    entry = to.entry;
    if (known.scenario !== now().scenario) open(known.scenario, known.origin, true);
    dispatch({ type: "open", view: { view: "motion", ...parseView(known.view) } });
  });

  /** @param {import("../state/types.js").Scenario} scenario @param {import("../state/types.js").Origin} origin @param {boolean} isNavigated */
  function open(scenario, origin, isNavigated) {
    isNavigation = isNavigated;
    dispatch({ type: "replace", scenario, origin });
    isNavigation = false;
  }

  /** Adds a history entry for the scenario that was opened. @param {State} before */
  function addEntry(before) {
    if (history.state?.entry === undefined) history.replaceState({ own: before.origin === "own", entry }, "");
    lastEntry += 1;
    entry = lastEntry;
    entries.delete(entry - DEPTH);
    history.pushState({ own: now().origin === "own", entry }, "");
  }

  /** The address of the page with the scenario, the view and the digests of a run. @param {string | undefined} digests @returns {Promise<string>} */
  async function address(digests) {
    let fragment = await engine.request("encode_link", JSON.stringify(now().scenario));
    for (const [name, part] of [
      ["v", viewOf(now())],
      ["d", digests],
    ])
      if (part) fragment = await engine.request("link_with", fragment, name, part);
    return `${location.origin}${location.pathname}${location.search}#${fragment}`;
  }

  async function write() {
    const { revision } = now();
    const before = location.hash;
    if (blockedBy(now()) === "problems") return;
    if (blockedBy(now()) === "unvalidated") {
      timer = window.setTimeout(write, UPDATE_DELAY_MS);
      return;
    }
    try {
      // A received link keeps the digests of its sender until the scenario changes.
      const full = await address(now().sender?.text);
      // The user may have entered another address meanwhile.
      if (now().revision !== revision || location.hash !== before) return;
      // After a reload the state tells that the address only repeats the user's work.
      history.replaceState({ own: now().origin === "own", entry }, "", full);
      written = location.hash;
    } catch {
      // The scenario is too long for a link; the share panel reports it.
    }
  }

  /** Opens the link in the address, unless the address only repeats the saved work of this tab. @param {boolean} saved  Whether there is saved work. */
  async function start(saved) {
    // A link that this page wrote before a reload needs no message.
    if (!saved || history.state?.own !== true) return read(history.state !== null);
    written = location.hash;
    await applyParts(location.hash.replace(/^#/, ""));
  }

  /** Applies the view and the sender's digests of a link. @param {string} fragment */
  async function applyParts(fragment) {
    const [view, sender] = await Promise.all(["v", "d"].map((name) => engine.request("link_part", fragment, name)));
    const parsed = parseView(view);
    if (Object.keys(parsed).length > 0) dispatch({ type: "open", view: parsed });
    if (sender) dispatch({ type: "sender", text: sender });
  }

  /** Opens the link in the address. @param {boolean} [isKnown]  Whether the link needs no message. */
  async function read(isKnown = false) {
    const fragment = location.hash.replace(/^#/, "");
    written = location.hash;
    const { own = false, entry: known = lastEntry + 1 } = history.state ?? {};
    entry = known;
    lastEntry = Math.max(lastEntry, entry);
    if (fragment === "") return;
    // A fragment of the page itself, such as `#views`, is not a link.
    if (document.getElementById(fragment)) return write();
    await openLink(fragment, { isKnown: isKnown || own, origin: own ? "own" : "shared", isNavigated: true });
  }

  /**
   * Opens a link, by default as a shared scenario, and reports that or an error.
   * @param {string} fragment @param {{isKnown?: boolean, origin?: import("../state/types.js").Origin, isNavigated?: boolean}} [how]
   */
  async function openLink(fragment, { isKnown = false, origin = "shared", isNavigated = false } = {}) {
    try {
      const reply = await engine.request("decode_link", fragment);
      if ("error" in reply) return refuse(reply.error);
      const scenario = readJson(reply.scenario);
      if (JSON.stringify(scenario) !== JSON.stringify(now().scenario)) {
        open(scenario, origin, isNavigated);
        const name = scenario.title ? `“${scenario.title}”` : "a scenario";
        const text = `Shared with you: ${name}.${undoHint()}`;
        if (!isKnown) dispatch({ type: "notice", notice: { kind: "info", text } });
      }
      await applyParts(fragment);
    } catch (error) {
      if (!(error instanceof Dropped)) refuse(errorMessage(error));
    }
  }

  /** @param {string} why */
  function refuse(why) {
    dispatch({ type: "notice", notice: { kind: "error", text: `This link cannot be opened: ${why}` } });
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (before && before.opened !== state.opened && !isNavigation) addEntry(before);
    entries.set(entry, { scenario: state.scenario, origin: state.origin, view: viewOf(state) });
    if (
      viewOf(before) === viewOf(state) &&
      before?.scenario === state.scenario &&
      before?.sender?.text === state.sender?.text
    )
      return;
    clearTimeout(timer);
    // An address without a link stays as it is until the user changes something.
    if (state.revision > 0 || written !== "" || viewOf(state) !== "") timer = window.setTimeout(write, UPDATE_DELAY_MS);
  }
  return { render, start, address, openLink };
}
