/** The export panel. The worker writes long files in pieces. */
import { byId, element, fill, options, say } from "../dom.js";
import { Dropped } from "../engine/request_slots.js";
import { si } from "../state/number.js";
import { exportOffers, partsOf, sizeOf, statusOf } from "./export_offers.js";
import { message } from "./link.js";
import { between } from "./offers.js";
import { save } from "./save.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../engine/engine.js").Engine} Engine */
/** @typedef {import("./offers.js").Offer} Offer */

class Cancelled extends Error {}

/** @param {{engine: Engine} & import("../state/types.js").Page} page  @param {[string, (state: State, engine: Engine) => Offer[]][]} others  What other parts of the page offer, each list with its title. @param {import("./lazy_popover.js").Popover} popover @returns {import("./lazy_popover.js").Content} */
export function createExports({ engine, now }, others, { isOpen }) {
  const part = /** @type {HTMLSelectElement} */ (byId("export-stretch"));
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
    options(part, partsOf(state, span), span ? part.value || "whole" : "whole");
    if (!busy) say(status, statusOf(state));
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

  /** @param {Offer} offered */
  async function run({ name, type, make }) {
    const begun = now().result?.summary;
    const show = (/** @type {boolean} */ on) => {
      busy = on;
      bar.hidden = cancel.hidden = !on;
      for (const press of list.querySelectorAll("button")) press.disabled = on;
    };
    stopped = false;
    bar.value = 0;
    say(status, `Writing ${name}…`);
    show(true);
    try {
      const parts = await make((done) => {
        if (stopped) throw new Cancelled();
        if (now().result?.summary !== begun) throw new Error("the experiment has run again; export again");
        bar.value = done;
      });
      save(name, type, parts);
      say(status, `Saved ${name}, ${si(sizeOf(parts), "B", 3)}.`);
    } catch (error) {
      const why = error instanceof Dropped ? "the engine was restarted; export again" : message(error);
      say(status, error instanceof Cancelled ? "Canceled: nothing was saved." : `${name} was not saved: ${why}`);
    }
    show(false);
    offerAgain();
  }

  /** Keeps the last word on a file while the list is made anew. */
  function offerAgain() {
    const text = status.textContent ?? "";
    if (isOpen()) offer();
    say(status, text);
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
