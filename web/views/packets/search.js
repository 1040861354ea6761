/** Search and filters of the packets; the worker finds the rows. */
import { byId, options, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { NO_FILTER } from "../../state/initial.js";
import { count } from "../../state/number.js";
import { isFiltering } from "../../state/queries.js";

/** @typedef {import("../../state/types.js").State} State */

/** A search that takes longer says so, in ms. */
const LONG_MS = 120;
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
 * @param {{place: () => {position: number, row: import("../../state/types.js").PacketRow | null}, reload: () => Promise<void>, moveTo: (position: number) => Promise<void>}} table
 */
export function createSearch({ engine, dispatch, now }, { place, reload, moveTo }) {
  const text = /** @type {HTMLInputElement} */ (byId("packets-search"));
  const only = /** @type {HTMLInputElement} */ (byId("packets-only"));
  const [kind, address, outcome] = ["kind", "address", "outcome"].map(
    (name) => /** @type {HTMLSelectElement} */ (byId(`packets-by-${name}`)),
  );
  const panel = byId("packets-filter");
  let matches = 0;
  let request = 0;
  options(outcome, OUTCOMES, "");

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

  /** Goes to the next row that the text finds. @param {boolean} forward */
  async function next(forward) {
    const position = await engine.request("next_match", place().position, forward).catch(unlessDropped);
    if (typeof position !== "number") return;
    await moveTo(position);
    found();
  }

  /** Which of the matches the current row is. */
  function found() {
    const { text: wanted } = now().filter;
    const rank = place().row?.rank ?? null;
    say(
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

  /** Another run: what there is to choose from, and the same filter over its rows. @param {State} state */
  async function start(state) {
    const own = ++request;
    const choices = await engine.request("packet_choices").catch(unlessDropped);
    if (choices) {
      const { framed } = state.result?.summary ?? {};
      options(
        kind,
        [
          ["", "any kind"],
          .../** @type {string[]} */ (choices.kinds).map(
            (name) => /** @type {[string, string]} */ ([name, KINDS[name] ?? name]),
          ),
        ],
        state.filter.kind,
      );
      options(
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
    found();
  }

  /** Has the worker look for the rows; a newer question ends an older one. @param {State} state */
  async function filter(state) {
    const own = ++request;
    const slow = setTimeout(() => say(byId("packets-found"), "searching…"), LONG_MS);
    const { text: wanted, kind: kindWanted, address: at, outcome: mark, only: alone } = state.filter;
    const row = place().row;
    const reply = await engine.request("filter", wanted, kindWanted, at, mark, alone).catch(unlessDropped);
    clearTimeout(slow);
    if (!reply || own !== request) return;
    matches = reply.matches;
    say(byId("packets-note"), reply.note);
    // The row that was the current one stays it; a search goes on from there.
    const there = row ? await engine.request("packet_position", row.index).catch(unlessDropped) : undefined;
    if (own === request) await reload();
    if (own !== request) return;
    if (typeof there === "number") await moveTo(there);
    if (matches > 0 && place().row?.rank === null) return next(true);
    found();
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
    const more = wanted.kind !== "" || wanted.address !== null || wanted.outcome !== "";
    byId("packets-filters").classList.toggle("active", more || (wanted.only && wanted.text !== ""));
    if (more && panel.hidden) open(true);
  }

  return { render, start, filter, next };
}
