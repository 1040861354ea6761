/** The messages below the header: about links and files, and whether the run is that of the sender of a link. */
import { button, byId, element, fill } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").TraceLocation} TraceLocation */
/** @typedef {import("../state/types.js").SenderComparison} SenderComparison */

/** Shows a time in the pulses. @param {import("../state/types.js").Page} page @param {TraceLocation} location */
export function showLocation({ dispatch, now }, { start, end, controller, cycle }) {
  if (now().result?.controller !== controller) dispatch({ type: "controller", controller });
  dispatch({ type: "window", window: { start, end } });
  dispatch({ type: "cursor", which: "a", cycle });
  dispatch({ type: "view", view: "pulses" });
  byId("pulses").focus();
}

/** @param {{engine: import("../engine/engine.js").Engine} & import("../state/types.js").Page} page */
export function createNotices(page) {
  const { engine, dispatch, now } = page;
  /** Loaded with the first comparison. @type {typeof import("./sender_comparison.js").comparisonText | null} */
  let comparisonText = null;

  /** @param {string} text */
  async function compare(text) {
    const { result } = now();
    const comparison = await engine.request("verify", text).catch(unlessDropped);
    comparisonText ??= (await import("./sender_comparison.js").catch(() => null))?.comparisonText ?? null;
    if (!comparisonText)
      return showLine(
        "seen-message",
        "This part of the page could not be loaded. Check the network and try again.",
        null,
      );
    if (comparison && now().result?.summary === result?.summary) dispatch({ type: "compared", text, comparison });
  }

  /** @param {string} id @param {string} text @param {TraceLocation | null} [location] @param {NonNullable<State["notice"]>["offer"]} [offer] */
  function showLine(id, text, location, offer) {
    const line = byId(id);
    const known = line.dataset.text;
    const key = JSON.stringify([text, location, offer?.label]);
    if (known === key) return;
    line.dataset.text = key;
    line.hidden = text === "";
    fill(line, element("span", {}, text));
    if (location) line.append(button("Go to this time", "Go to this time", () => showLocation(page, location)));
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
    const { notice, sender, result, revision } = state;
    if (before?.notice !== notice) {
      showLine("link-message", notice?.text ?? "", notice?.location, notice?.offer);
      byId("link-message").classList.toggle("error", notice?.kind === "error");
    }
    const current = result?.revision === revision;
    const due = current && sender && !sender.comparison;
    const isCompared = before?.sender?.text === sender?.text && before?.result?.summary === result?.summary;
    if (due && !isCompared) compare(sender.text);
    if (before?.sender !== sender || before?.result !== result) {
      const comparison = current ? sender?.comparison : null;
      const found = comparison && comparisonText ? comparisonText(comparison, state) : null;
      showLine("seen-message", found?.text ?? "", found?.location);
      byId("seen-message").classList.toggle("warning", Boolean(comparison) && !comparison?.same);
    }
  }
  return { render };
}
