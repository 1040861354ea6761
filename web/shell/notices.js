/**
 * The lines under the header: what there is to say of a link or a file, and whether the run is the one that a
 * link's sender saw, with a button that shows the place that is meant.
 */
import { button, byId, element, fill } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";
import { count, time } from "../state/number.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Place} Place */
/** @typedef {import("../state/types.js").Verdict} Verdict */

/** @param {{engine: import("../engine/engine.js").Engine} & import("../state/types.js").Page} page */
export function createNotices(page) {
  const { engine, dispatch, now } = page;

  /** @param {string} text */
  async function compare(text) {
    const { result } = now();
    const verdict = await engine.ask("verify", text).catch(unlessDropped);
    if (verdict && now().result?.summary === result?.summary) dispatch({ type: "compared", text, verdict });
  }

  /** @param {string} id @param {string} text @param {Place | null | undefined} place @param {NonNullable<State["notice"]>["offer"]} [offer] */
  function tell(id, text, place, offer) {
    const line = byId(id);
    const known = line.dataset.said;
    const key = JSON.stringify([text, place, offer?.label]);
    if (known === key) return;
    line.dataset.said = key;
    line.hidden = text === "";
    fill(line, element("span", {}, text));
    if (place) line.append(button("Show the place", "Show the place", () => show(place)));
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

  /** Shows a time in the pulses. @param {Place} place */
  function show({ start, end, controller, cycle }) {
    if (now().result?.controller !== controller) dispatch({ type: "controller", controller });
    dispatch({ type: "window", window: { start, end } });
    dispatch({ type: "cursor", which: "a", cycle });
    dispatch({ type: "view", view: "pulses" });
    byId("pulses").focus();
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    const { notice, seen, result, revision } = state;
    if (before?.notice !== notice) {
      tell("link-message", notice?.text ?? "", notice?.place, notice?.offer);
      byId("link-message").classList.toggle("error", notice?.kind === "error");
    }
    const current = result?.revision === revision;
    const due = current && seen && !seen.verdict;
    const asked = before?.seen?.text === seen?.text && before?.result?.summary === result?.summary;
    if (due && !asked) compare(seen.text);
    if (before?.seen !== seen || before?.result !== result) {
      const verdict = current ? seen?.verdict : null;
      const said = verdict ? words(verdict, state) : null;
      tell("seen-message", said?.text ?? "", said?.place);
      byId("seen-message").classList.toggle("warning", Boolean(verdict) && !verdict?.same);
    }
  }
  return { render };
}

/** @param {Verdict} verdict @param {State} state @returns {{text: string, place: Place | null}} */
function words(verdict, { result }) {
  if (!result) return { text: "", place: null };
  const { controllers, clock_hz, end_cycle } = result.summary;
  if (verdict.error) {
    // A sentence of the core's.
    return { text: `${verdict.error[0].toUpperCase()}${verdict.error.slice(1)}.`, place: null };
  }
  const { after, until, version, controller, shorter } = verdict;
  if (verdict.same || !after || !until) {
    const which = controllers.length > 1 ? `all ${controllers.length} controllers, ` : "";
    const made = version ? ` It was sent by version ${version}; this is ${verdict.own_version}.` : "";
    return {
      text: `Identical, bit for bit: ${which}${count(verdict.edges)} edges, digest ${controllers[result.controller].digest}.${made}`,
      place: null,
    };
  }
  const at = (/** @type {import("../state/types.js").Mark} */ mark) =>
    `edge ${count(mark.edge)} (${time(mark.cycle / clock_hz)})`;
  const which = controllers.length > 1 ? ` on controller ${controller + 1}` : "";
  const ends =
    shorter === "this" ? " This run ends there." : shorter === "other" ? " The sender's run ends there." : "";
  const made = version
    ? ` The link was made with version ${version}, this is ${verdict.own_version}: that may be why.`
    : "";
  const text = `Not the run that the sender saw: the first difference${which} lies between ${at(after)} and ${at(until)}.${ends}${made}`;
  return { text, place: around(after.cycle, until.cycle, end_cycle, controller) };
}

/** A stretch with some air around it. @param {number} from @param {number} to @param {number} last @param {number} controller @returns {Place} */
export function around(from, to, last, controller) {
  const air = Math.max(200, Math.round((to - from) / 20));
  return { start: Math.max(0, from - air), end: Math.min(last, to + air), controller, cycle: from };
}
