/** Search and filters of the packets; the worker finds the rows. */
import { byId, setOptions, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { NO_FILTER } from "../../state/initial.js";
import { count } from "../../state/number.js";
import { isFiltering } from "../../state/queries.js";

/** @typedef {import("../../state/types.js").State} State */

/** A message appears during a search that takes longer than this, in ms. */
const MESSAGE_DELAY_MS = 120;
/** @type {[string, string][]} */
const OUTCOMES = [
  ["", "any outcome"],
  ["bad", "errors only"],
  ["repeated", "repeated"],
  ["foreign", "another address"],
  ["good", "done"],
];
/** @type {{[kind: string]: string}} */
const KINDS = { packet: "packets", frame: "frames", reply: "replies", collision: "collisions", NAK: "refusals (NAK)" };

/**
 * @param {import("./packets.js").Page} page
 * @param {{current: () => {position: number, row: import("../../state/types.js").PacketRow | null}, reload: () => Promise<void>, moveTo: (position: number) => Promise<void>}} table
 */
export function createSearch({ engine, dispatch, now }, { current, reload, moveTo }) {
  const text = /** @type {HTMLInputElement} */ (byId("packets-search"));
  const only = /** @type {HTMLInputElement} */ (byId("packets-only"));
  const [kind, address, outcome] = ["kind", "address", "outcome"].map(
    (name) => /** @type {HTMLSelectElement} */ (byId(`packets-by-${name}`)),
  );
  const panel = byId("packets-filter");
  let matches = 0;
  let request = 0;
  setOptions(outcome, OUTCOMES, "");

  /** @param {Partial<State["filter"]>} filter */
  const change = (filter) => dispatch({ type: "filter", filter });
  text.addEventListener("input", () => change({ text: text.value }));
  text.addEventListener("keydown", (event) => {
    if (event.key === "Enter") next(!event.shiftKey);
    else if (event.key === "Escape" && text.value !== "") change({ text: "" });
    else return;
    event.preventDefault();
  });
  only.addEventListener("change", () => change({ only: only.checked }));
  kind.addEventListener("change", () => change({ kind: kind.value }));
  address.addEventListener("change", () => change({ address: address.value === "" ? null : Number(address.value) }));
  outcome.addEventListener("change", () => change({ outcome: outcome.value }));
  for (const id of ["packets-clear", "packets-unmatched"])
    byId(id).addEventListener("click", () => {
      change(NO_FILTER);
      text.focus();
    });
  byId("packets-next").addEventListener("click", () => next(true));
  byId("packets-previous").addEventListener("click", () => next(false));
  byId("packets-filters").addEventListener("click", () => open(Boolean(panel.hidden)));

  /** @param {boolean} shown */
  function open(shown) {
    panel.hidden = !shown;
    byId("packets-filters").setAttribute("aria-expanded", String(shown));
  }

  /** Goes to the next or previous match. @param {boolean} forward */
  async function next(forward) {
    const position = await engine.request("next_match", current().position, forward).catch(unlessDropped);
    if (typeof position !== "number") return;
    await moveTo(position);
    showMatch();
  }

  /** Shows the rank of the current row among the matches. */
  function showMatch() {
    const { text: wanted } = now().filter;
    const rank = current().row?.rank ?? null;
    setText(
      byId("packets-found"),
      wanted.trim() === ""
        ? ""
        : matches === 0
          ? "no match"
          : rank === null
            ? `${count(matches)} found`
            : `${count(rank + 1)} of ${count(matches)}`,
    );
    for (const id of ["packets-next", "packets-previous"]) {
      /** @type {HTMLButtonElement} */ (byId(id)).disabled = matches === 0;
    }
  }

  /** Updates the choices for another run, and applies the filter to it. @param {State} state */
  async function setRun(state) {
    const own = ++request;
    const choices = await engine.request("packet_choices").catch(unlessDropped);
    if (choices) {
      const { framed } = state.result?.summary ?? {};
      setOptions(
        kind,
        [
          ["", "any kind"],
          .../** @type {string[]} */ (choices.kinds).map(
            (name) => /** @type {[string, string]} */ ([name, KINDS[name] ?? name]),
          ),
        ],
        state.filter.kind,
      );
      setOptions(
        address,
        [
          ["", "any address"],
          .../** @type {number[]} */ (choices.addresses).map(
            (at) => /** @type {[string, string]} */ ([String(at), at === 255 ? "255, all" : String(at)]),
          ),
        ],
        String(state.filter.address ?? ""),
      );
      kind.closest("label")?.toggleAttribute("hidden", !framed);
      address.closest("label")?.toggleAttribute("hidden", choices.addresses.length === 0);
    }
    if (own !== request) return;
    if (isFiltering(state.filter)) return filter(state);
    matches = 0;
    await reload();
    showMatch();
  }

  /** Filters the rows in the worker; a newer filter ends an older one. @param {State} state */
  async function filter(state) {
    const own = ++request;
    const messageTimer = setTimeout(() => setText(byId("packets-found"), "searching…"), MESSAGE_DELAY_MS);
    const {
      text: wanted,
      kind: wantedKind,
      address: wantedAddress,
      outcome: wantedOutcome,
      only: isOnlyMatches,
    } = state.filter;
    const row = current().row;
    const reply = await engine
      .request("filter", wanted, wantedKind, wantedAddress, wantedOutcome, isOnlyMatches)
      .catch(unlessDropped);
    clearTimeout(messageTimer);
    if (!reply || own !== request) return;
    matches = reply.matches;
    setText(byId("packets-note"), reply.note);
    // The current row stays; the search continues from it.
    const position = row ? await engine.request("packet_position", row.index).catch(unlessDropped) : undefined;
    if (own === request) await reload();
    if (own !== request) return;
    if (typeof position === "number") await moveTo(position);
    if (matches > 0 && current().row?.rank === null) return next(true);
    showMatch();
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (before?.filter === state.filter) return;
    const { filter: wanted } = state;
    if (text.value !== wanted.text) text.value = wanted.text;
    only.checked = wanted.only;
    kind.value = wanted.kind;
    address.value = String(wanted.address ?? "");
    outcome.value = wanted.outcome;
    const hasFilters = wanted.kind !== "" || wanted.address !== null || wanted.outcome !== "";
    byId("packets-filters").classList.toggle("active", hasFilters || (wanted.only && wanted.text !== ""));
    if (hasFilters && panel.hidden) open(true);
  }

  return { render, setRun, filter, next };
}
