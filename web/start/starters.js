/** The three starter cards: on the first visit above the page, later in the gallery. */
import { byId, element, fill } from "../dom.js";
import { loadGuided, loadScenario, saveGuided } from "../shell/storage.js";
import { isFirstVisit } from "../state/gallery.js";
import { openPreset, reveal } from "./opening.js";

/** @typedef {import("./opening.js").Page} Page */

/** @type {{title: string, text: string, run: (page: Page) => void}[]} */
const STARTERS = [
  {
    title: "Plan a move and export a step table",
    text: "Enter distance and speed; save the intervals for a timer.",
    run: (page) => {
      if (page.now().scenario.source?.motion) {
        page.dispatch({ type: "view", view: "study" });
        page.dispatch({ type: "study", study: "tables" });
        void reveal(page, "study");
      } else openNamed(page, "song-2021-one-turn", "tstudy.ytables");
      // The user's own experiment keeps its step generation.
      if (loadScenario() === null) page.dispatch({ type: "edit", path: "source.motion.engine", value: "segments" });
      focusField('input[data-path^="source.motion.axes[0].moves[0]"]');
    },
  },
  {
    title: "Check pulses against my driver",
    text: "Choose a driver; each violation is listed with its time.",
    run: (page) => {
      if (loadScenario() === null) openNamed(page, "driver-timing-broken");
      else {
        page.dispatch({ type: "view", view: "timing" });
        page.dispatch({ type: "side", area: "spectrum", side: "timing" });
        void reveal(page, "timing");
      }
      focusField('[data-path^="driver_timing"]');
    },
  },
  {
    title: "Open a capture",
    text: "A file of a logic analyzer: VCD, sigrok, CSV or text.",
    run: () => {
      byId("open").focus();
      byId("open").click();
    },
  },
];

/** @param {Page} page @param {string} name @param {string} [view] */
function openNamed(page, name, view) {
  const preset = page.presets.find(({ id }) => id === name);
  if (preset) openPreset(page, preset, view);
}

/** Puts the focus on a field of the form, once the form shows the scenario. On a narrow screen, the form is folded above the view. @param {string} selector */
function focusField(selector) {
  requestAnimationFrame(() => {
    if (!(/** @type {HTMLDetailsElement} */ (byId("sheet")).open)) return byId("views").focus({ preventScroll: true });
    const field = /** @type {HTMLElement | null} */ (byId("fields").querySelector(selector));
    for (let at = field?.parentElement; at; at = at.parentElement) if (at instanceof HTMLDetailsElement) at.open = true;
    field?.scrollIntoView({ block: "center" });
    return field?.focus();
  });
}

/** The cards. @param {Page} page @param {() => void} close  Called when a card is clicked. */
export function starterCards(page, close) {
  return STARTERS.map(({ title, text, run }) => {
    const card = element(
      "button",
      { type: "button", class: "card", title: text },
      element("b", {}, title),
      element("span", {}, text),
    );
    card.addEventListener("click", () => {
      close();
      run(page);
    });
    return card;
  });
}

/** Shows the cards to a new visitor, until one is used or they are closed. @param {Page} page */
export function offerStarters(page) {
  const welcome = byId("welcome");
  const isNew = isFirstVisit({ guided: loadGuided(), saved: loadScenario() !== null, fragment: location.hash });
  if (!isNew) return;
  fill(byId("welcome-cards"), ...starterCards(page, close));
  welcome.hidden = false;
  byId("welcome-start").addEventListener("click", () => byId("guide-start").click());
  byId("welcome-never").addEventListener("click", () => {
    close();
    byId("preset").focus();
  });

  function close() {
    saveGuided();
    welcome.hidden = true;
  }
}
