/** The share panel with the link. */
import { byId, say } from "../dom.js";
import { count } from "../state/number.js";
import { blockedBy, isStale } from "../state/queries.js";
import { message } from "./link.js";
import { viewOf } from "./view_part.js";

/** @typedef {import("../state/types.js").State} State */

/** @param {{engine: import("../engine/engine.js").Engine, address: (digests: string | undefined) => Promise<string>} & import("../state/types.js").Page} page @param {import("./lazy_popover.js").Popover} popover @returns {import("./lazy_popover.js").Content} */
export function createShare({ engine, address, now }, { isOpen }) {
  const text = /** @type {HTMLTextAreaElement} */ (byId("link-text"));
  const copy = /** @type {HTMLButtonElement} */ (byId("copy-link"));
  const about = byId("link-about");
  let timer = 0;
  /** Counts the links that were requested: an older one comes too late. */
  let request = 0;
  copy.addEventListener("click", toClipboard);

  /** The link to share, and whether the digests of the visible run are in it. */
  async function shared() {
    // A recording's digests are no run's: whoever opens the link sees what the model makes of it.
    const isRun = !isStale(now()) && !now().result?.summary.recorded;
    const digests = isRun ? await engine.request("fingerprint") : null;
    const full = await address(digests ?? undefined);
    return { full, digests: digests !== null && full.endsWith(digests) };
  }

  async function make() {
    const mine = ++request;
    say(copy, "Copy link");
    copy.disabled = true;
    text.value = "";
    say(about, "Making the link…");
    if (blockedBy(now()) === "problems") return say(about, "No link: the form has errors; fix them first.");
    try {
      const { full, digests } = await shared();
      if (mine !== request) return;
      text.value = full;
      copy.disabled = false;
      say(about, `${count(full.length)} characters: ${contents(now(), digests)}. Nothing is stored on a server.`);
    } catch (error) {
      if (mine === request) say(about, `No link: ${message(error)}`);
    }
  }

  async function toClipboard() {
    try {
      await navigator.clipboard.writeText(text.value);
      say(copy, "Copied");
      clearTimeout(timer);
      timer = window.setTimeout(() => say(copy, "Copy link"), 1500);
    } catch {
      text.focus();
      text.select();
      say(about, "The browser blocked copying. The link is selected: copy it with Ctrl+C, or Command+C on a Mac.");
    }
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (
      isOpen() &&
      before &&
      (before.scenario !== state.scenario || before.result !== state.result || viewOf(before) !== viewOf(state))
    )
      make();
  }
  return { onOpen: make, render };
}

/** What is in the link, as text. @param {State} state @param {boolean} digests */
function contents(state, digests) {
  const edges = state.result?.summary.controllers.reduce((sum, { edges }) => sum + edges, 0) ?? 0;
  const seen = digests
    ? `the digest of this run (${count(edges)} edges), which is checked when the link is opened`
    : "";
  const why = isStale(state)
    ? "no digest, because it has not run"
    : state.result?.summary.recorded
      ? "no digest, because it is a recording: the link shows a simulation of its steps or bytes"
      : "no digest, because it would be too long";
  const parts = ["the whole experiment", viewOf(state) ? "the current view" : "", seen || why].filter(Boolean);
  return parts.length > 1 ? `${parts.slice(0, -1).join(", ")} and ${parts[parts.length - 1]}` : parts[0];
}
