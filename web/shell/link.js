/** The link in the address. It follows the scenario without history entries, and never overwrites own work. */
import { Dropped } from "../engine/request_slots.js";
import { readJson } from "../state/json.js";
import { blockedBy } from "../state/queries.js";
import { undoHint } from "./storage.js";
import { parseView, viewOf } from "./view_part.js";

/** @typedef {import("../state/types.js").State} State */

/** How long the scenario must stand before the address follows, in ms. */
const SETTLE_MS = 300;

/** @param {{engine: import("../engine/engine.js").Engine} & import("../state/types.js").Page} page */
export function createLink({ engine, dispatch, now }) {
  /** Fragment that this page wrote or read last. */
  let written = location.hash;
  let timer = 0;

  window.addEventListener("hashchange", () => {
    if (location.hash !== written) read();
  });

  /** The page's address with the scenario, the view and a run's digests in it. @param {string | undefined} digests @returns {Promise<string>} */
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
      timer = window.setTimeout(write, SETTLE_MS);
      return;
    }
    try {
      // What its sender saw goes with a link as long as it stands.
      const full = await address(now().seen?.text);
      // An address that came meanwhile is read, not written over.
      if (now().revision !== revision || location.hash !== before) return;
      // The mark tells a reload that the address only repeats the user's work.
      history.replaceState({ own: now().origin === "own" }, "", full);
      written = location.hash;
    } catch {
      // A scenario that cannot be a link yet; its problems are shown where they are.
    }
  }

  /** The address at the page's start; after a reload it may only repeat the work that this tab kept. @param {boolean} saved */
  async function start(saved) {
    // An address that this page wrote before a reload is no news.
    if (!saved || history.state?.own !== true) return read(history.state !== null);
    written = location.hash;
    await open(location.hash.replace(/^#/, ""));
  }

  /** Shows what a fragment asks to be shown, and keeps what its sender saw. @param {string} fragment */
  async function open(fragment) {
    const [view, seen] = await Promise.all(["v", "d"].map((name) => engine.request("link_part", fragment, name)));
    const part = parseView(view);
    if (Object.keys(part).length > 0) dispatch({ type: "open", view: part });
    if (seen) dispatch({ type: "seen", text: seen });
  }

  /** Reads the address; shows what it holds as a shared scenario, or says why it cannot. @param {boolean} [isKnown] */
  async function read(isKnown = false) {
    const fragment = location.hash.replace(/^#/, "");
    written = location.hash;
    if (fragment === "") return;
    // A place in the page is no link; the address takes the scenario back.
    if (document.getElementById(fragment)) return write();
    await openLink(fragment, isKnown);
  }

  /** Shows the scenario of a link as a shared one and says so unless it is known, or says why it cannot. @param {string} fragment @param {boolean} [isKnown] */
  async function openLink(fragment, isKnown = false) {
    try {
      const reply = await engine.request("decode_link", fragment);
      if ("error" in reply) return refuse(reply.error);
      const scenario = readJson(reply.scenario);
      if (JSON.stringify(scenario) !== JSON.stringify(now().scenario)) {
        dispatch({ type: "replace", scenario, origin: "shared" });
        const name = scenario.title ? `“${scenario.title}”` : "a scenario";
        const text = `Shared with you: ${name}.${undoHint()}`;
        if (!isKnown) dispatch({ type: "notice", notice: { kind: "info", text } });
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
    if (
      viewOf(before) === viewOf(state) &&
      before?.scenario === state.scenario &&
      before?.seen?.text === state.seen?.text
    )
      return;
    clearTimeout(timer);
    // Standing by until the user changes something: an address without a link stays as it is.
    if (state.revision > 0 || written !== "" || viewOf(state) !== "") timer = window.setTimeout(write, SETTLE_MS);
  }
  return { render, start, address, openLink };
}

/** @param {unknown} error */
export function message(error) {
  return error instanceof Error ? error.message : String(error);
}
