/** The share panel with the link. */
import { byId, setText } from "../dom.js";
import { errorMessage } from "../state/error_message.js";
import { count } from "../state/number.js";
import { blockedBy, isStale } from "../state/queries.js";
import { viewOf } from "./view_part.js";

/** @typedef {import("../state/types.js").State} State */

/** @param {{engine: import("../engine/engine.js").Engine, address: (digests: string | undefined) => Promise<string>} & import("../state/types.js").Page} page @param {import("./lazy_popover.js").Popover} popover @returns {import("./lazy_popover.js").Content} */
export function createShare({ engine, address, now }, { isOpen }) {
  const text = /** @type {HTMLTextAreaElement} */ (byId("link-text"));
  const copy = /** @type {HTMLButtonElement} */ (byId("copy-link"));
  const about = byId("link-about");
  let timer = 0;
  /** Number of the last requested link; older ones are dropped. */
  let request = 0;
  copy.addEventListener("click", toClipboard);

  /** The link to share, and whether the digests of the visible run are in it. */
  async function shared() {
    // A link of a recording opens as a simulation, whose digests differ.
    const isRun = !isStale(now()) && !now().result?.summary.recorded;
    const digests = isRun ? await engine.request("fingerprint") : null;
    const full = await address(digests ?? undefined);
    return { full, digests: digests !== null && full.endsWith(digests) };
  }

  async function createLink() {
    const own = ++request;
    setText(copy, "Copy link");
    copy.disabled = true;
    text.value = "";
    setText(about, "Making the link…");
    if (blockedBy(now()) === "problems") return setText(about, "No link: the form has errors; fix them first.");
    try {
      const { full, digests } = await shared();
      if (own !== request) return;
      text.value = full;
      copy.disabled = false;
      setText(about, `${count(full.length)} characters: ${contents(now(), digests)}. Nothing is stored on a server.`);
    } catch (error) {
      if (own === request) setText(about, `No link: ${errorMessage(error)}`);
    }
  }

  async function toClipboard() {
    try {
      await navigator.clipboard.writeText(text.value);
      setText(copy, "Copied");
      clearTimeout(timer);
      timer = window.setTimeout(() => setText(copy, "Copy link"), 1500);
    } catch {
      text.focus();
      text.select();
      setText(about, "The browser blocked copying. The link is selected: copy it with Ctrl+C, or Command+C on a Mac.");
    }
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (
      isOpen() &&
      before &&
      (before.scenario !== state.scenario || before.result !== state.result || viewOf(before) !== viewOf(state))
    )
      createLink();
  }
  return { onOpen: createLink, render };
}

/** The content of the link as text. @param {State} state @param {boolean} digests */
function contents(state, digests) {
  const edges = state.result?.summary.controllers.reduce((sum, { edges }) => sum + edges, 0) ?? 0;
  const digestText = digests
    ? `the digest of this run (${count(edges)} edges), which is checked when the link is opened`
    : "";
  const noDigest = isStale(state)
    ? "no digest, because the experiment has not run"
    : state.result?.summary.recorded
      ? "no digest, because it is a recording: the link shows a simulation of its steps or bytes"
      : "no digest, because the link would be too long";
  const parts = ["the whole experiment", viewOf(state) ? "the current view" : "", digestText || noDigest].filter(
    Boolean,
  );
  return parts.length > 1 ? `${parts.slice(0, -1).join(", ")} and ${parts[parts.length - 1]}` : parts[0];
}
