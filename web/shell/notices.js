/** The messages below the header: about links and files, and whether the run is that of the sender of a link. */
import { button, byId, element, fill } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Place} Place */
/** @typedef {import("../state/types.js").Verdict} Verdict */

/** Shows a time in the pulses. @param {import("../state/types.js").Page} page @param {Place} place */
export function showPlace({ dispatch, now }, { start, end, controller, cycle }) {
  if (now().result?.controller !== controller) dispatch({ type: "controller", controller });
  dispatch({ type: "window", window: { start, end } });
  dispatch({ type: "cursor", which: "a", cycle });
  dispatch({ type: "view", view: "pulses" });
  byId("pulses").focus();
}

/** @param {{engine: import("../engine/engine.js").Engine} & import("../state/types.js").Page} page */
export function createNotices(page) {
  const { engine, dispatch, now } = page;
  /** Loaded with the first verdict. @type {typeof import("./verdict.js").verdictText | null} */
  let verdictText = null;

  /** @param {string} text */
  async function compare(text) {
    const { result } = now();
    const verdict = await engine.request("verify", text).catch(unlessDropped);
    verdictText ??= (await import("./verdict.js").catch(() => null))?.verdictText ?? null;
    if (!verdictText)
      return showLine(
        "seen-message",
        "This part of the page could not be loaded. Check the network and try again.",
        null,
      );
    if (verdict && now().result?.summary === result?.summary) dispatch({ type: "compared", text, verdict });
  }

  /** @param {string} id @param {string} text @param {Place | null} [place] @param {NonNullable<State["notice"]>["offer"]} [offer] */
  function showLine(id, text, place, offer) {
    const line = byId(id);
    const known = line.dataset.text;
    const key = JSON.stringify([text, place, offer?.label]);
    if (known === key) return;
    line.dataset.text = key;
    line.hidden = text === "";
    fill(line, element("span", {}, text));
    if (place) line.append(button("Go to this time", "Go to this time", () => showPlace(page, place)));
    if (offer) {
      const { label, scenario } = offer;
      line.append(button(label, label, () => dispatch({ type: "replace", scenario, origin: "own" })));
    }
    const close = button("", "Close this message", () => {
      line.hidden = true;
      if (id === "link-message") dispatch({ type: "notice", notice: null });
      byId("views").focus({ preventScroll: true });
    });
    close.classList.add("close");
    line.append(close);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    const { notice, seen, result, revision } = state;
    if (before?.notice !== notice) {
      showLine("link-message", notice?.text ?? "", notice?.place, notice?.offer);
      byId("link-message").classList.toggle("error", notice?.kind === "error");
    }
    const current = result?.revision === revision;
    const due = current && seen && !seen.verdict;
    const isCompared = before?.seen?.text === seen?.text && before?.result?.summary === result?.summary;
    if (due && !isCompared) compare(seen.text);
    if (before?.seen !== seen || before?.result !== result) {
      const verdict = current ? seen?.verdict : null;
      const found = verdict && verdictText ? verdictText(verdict, state) : null;
      showLine("seen-message", found?.text ?? "", found?.place);
      byId("seen-message").classList.toggle("warning", Boolean(verdict) && !verdict?.same);
    }
  }
  return { render };
}
