/** The export panel. The worker writes long files in pieces. */
import { byId, element, fill, setOptions, setText } from "../dom.js";
import { Dropped } from "../engine/request_slots.js";
import { errorMessage } from "../state/error_message.js";
import { si } from "../state/number.js";
import { exportOffers, partsOf, sizeOf, statusOf } from "./export_offers.js";
import { between } from "./offers.js";
import { save } from "./save.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../engine/engine.js").Engine} Engine */
/** @typedef {import("./offers.js").Offer} Offer */

class Canceled extends Error {}

/** @param {{engine: Engine} & import("../state/types.js").Page} page  @param {[string, (state: State, engine: Engine) => Offer[]][]} others  Files of other parts of the page, with their titles. @param {import("./lazy_popover.js").Popover} popover @returns {import("./lazy_popover.js").Content} */
export function createExports({ engine, now }, others, { isOpen }) {
  const part = /** @type {HTMLSelectElement} */ (byId("export-range"));
  const list = byId("export-list");
  const status = byId("export-status");
  const cancel = byId("export-cancel");
  const bar = /** @type {HTMLProgressElement} */ (byId("export-progress"));
  let stopped = false;
  let busy = false;
  part.addEventListener("change", offer);
  cancel.addEventListener("click", () => {
    stopped = true;
  });

  function offer() {
    const state = now();
    const span = between(state);
    setOptions(part, partsOf(state, span), span ? part.value || "whole" : "whole");
    if (!busy) setText(status, statusOf(state));
    const groups = [
      ...exportOffers(state, engine, part.value === "cursors" ? span : null),
      ...others.map(([title, offered]) => ({ title, offers: offered(state, engine) })),
    ];
    fill(
      list,
      ...groups
        .filter(({ offers }) => offers.length > 0)
        .map(({ title, offers }) => {
          const group = element("div", { role: "group", "aria-label": title }, element("h3", {}, title));
          for (const each of offers) {
            const press = element("button", { type: "button", "data-file": each.name }, each.label);
            press.disabled = busy;
            press.addEventListener("click", () => run(each));
            group.append(press);
          }
          return group;
        }),
    );
  }

  /** @param {Offer} file */
  async function run({ name, type, make }) {
    const summary = now().result?.summary;
    const show = (/** @type {boolean} */ on) => {
      busy = on;
      bar.hidden = cancel.hidden = !on;
      for (const press of list.querySelectorAll("button")) press.disabled = on;
    };
    stopped = false;
    bar.value = 0;
    setText(status, `Writing ${name}…`);
    show(true);
    try {
      const parts = await make((progress) => {
        if (stopped) throw new Canceled();
        if (now().result?.summary !== summary) throw new Error("the experiment has run again; export again");
        bar.value = progress;
      });
      save(name, type, parts);
      setText(status, `Saved ${name}, ${si(sizeOf(parts), "B", 3)}.`);
    } catch (error) {
      const why = error instanceof Dropped ? "the engine was restarted; export again" : errorMessage(error);
      setText(status, error instanceof Canceled ? "Canceled: nothing was saved." : `${name} was not saved: ${why}`);
    }
    show(false);
    refresh();
  }

  /** Updates the list, but keeps the message about the last file. */
  function refresh() {
    const text = status.textContent ?? "";
    if (isOpen()) offer();
    setText(status, text);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (
      isOpen() &&
      !busy &&
      before &&
      (before.result !== state.result || before.cursors !== state.cursors || before.validation !== state.validation)
    )
      offer();
  }
  return { onOpen: offer, render };
}
