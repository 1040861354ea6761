/**
 * The first steps with Stepscope, over the real page: a small panel that points at one thing after another. It covers
 * nothing that it speaks of, and the page can be used meanwhile. It loads when it is first asked for (guide.js).
 */
import { button, byId, element, fill } from "../dom.js";
import { saveGuided } from "../shell/storage.js";

/** @typedef {{title: string, text: string, at: string, view?: string}} Step  `at` is what it points at, `view` the tab that it is in on a narrow screen. */

/** @type {Step[]} */
export const STEPS = [
  {
    title: "Choose a motion",
    at: "#fields > details",
    text: "A preset above, or a move of your own here: type a distance such as 1.2k. All that follows is computed at once. A word with dots under it explains itself.",
  },
  {
    title: "Look at the curves",
    at: "#view-motion",
    view: "motion",
    text: "Position, speed and acceleration: the thin line is what was asked for, the broad one what the pulses make of it. A click sets cursor A, with Shift cursor B; their handles can be dragged.",
  },
  {
    title: "Zoom into the pulses",
    at: "#view-pulses",
    view: "pulses",
    text: "Turn the wheel, or press + and the arrow keys, until single pulses show: every edge stands at its exact clock cycle. N goes to the next edge.",
  },
  {
    title: "See what was sent",
    at: "#view-packets",
    view: "packets",
    text: "A row a packet, with its bytes and what the controller did with it. Choose one: it is shown in the pulses.",
  },
  {
    title: "Break it, and fix it",
    at: "#preset",
    text: "“Pulses too short for a DRV8825” and “Raw packets on a noisy line” go wrong on purpose. The page says what is wrong and why, and “Fix it” puts it right; Undo takes that back.",
  },
  {
    title: "Share it",
    at: "#share",
    text: "The link holds the whole experiment. Whoever opens it computes the same edges, and the digest proves it. ? at the right end has the keys and the help.",
  },
];

/** Distance of the panel from what it points at, and from the window's edges, in CSS pixels. */
const GAP_PX = 10;

/** @type {{go: (step: number) => void} | null} */
let guide = null;

/** Begins with the first step. @param {import("../state/types.js").Page} page */
export function startGuide(page) {
  guide ??= createGuide(page);
  guide.go(0);
}

/** @param {import("../state/types.js").Page} page */
function createGuide({ dispatch, now }) {
  const panel = byId("guide");
  const narrow = matchMedia("(max-width: 899px)");
  let current = -1;

  panel.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    event.preventDefault();
    end();
  });
  window.addEventListener("resize", () => {
    if (current >= 0) place();
  });

  /** @param {number} step */
  function go(step) {
    saveGuided();
    byId("welcome").hidden = true;
    mark(null);
    current = step;
    const { title, text, view } = STEPS[step];
    if (view) dispatch({ type: "view", view });
    // What it points at has to be on show.
    const { form, folded, largest } = now().panes;
    if (largest !== null || form === 0 || folded.length > 0) {
      dispatch({ type: "pane", panes: { largest: null, folded: [], form: form || null } });
      requestAnimationFrame(() => {
        if (current === step) place();
      });
    }
    // On a narrow screen the form is folded away.
    const target = targetOf();
    const sheet = /** @type {HTMLDetailsElement} */ (byId("sheet"));
    if (target && sheet.contains(target)) sheet.open = true;
    else if (narrow.matches) sheet.open = false;
    const last = step === STEPS.length - 1;
    const heading = element("h2", { tabindex: "-1", id: "guide-title" }, `${step + 1} of ${STEPS.length}: ${title}`);
    fill(
      panel,
      heading,
      element("p", {}, text),
      element(
        "div",
        { class: "buttons" },
        button("Back", "Back", () => go(step - 1), step === 0),
        last ? button("Done", "Done", end) : button("Next", "Next", () => go(step + 1)),
        button("✕", "End the guide", end),
      ),
    );
    panel.hidden = false;
    mark(target);
    place();
    heading.focus({ preventScroll: true });
  }

  function targetOf() {
    return /** @type {HTMLElement | null} */ (document.querySelector(STEPS[current]?.at ?? ":not(*)"));
  }

  /** Marks what the panel points at, and nothing else. @param {HTMLElement | null} target */
  function mark(target) {
    for (const marked of document.querySelectorAll(".pointed")) marked.classList.remove("pointed");
    target?.classList.add("pointed");
    target?.scrollIntoView({ block: narrow.matches ? "start" : "nearest" });
  }

  /** Beside its target where there is room, else over the least of it. */
  function place() {
    const target = targetOf();
    const { clientWidth, clientHeight } = document.documentElement;
    const { width, height } = panel.getBoundingClientRect();
    if (narrow.matches || !target) {
      panel.style.left = `${Math.max(0, (clientWidth - width) / 2)}px`;
      panel.style.top = `${clientHeight - height - GAP_PX}px`;
      return;
    }
    const box = target.getBoundingClientRect();
    const below = box.bottom + GAP_PX;
    const within = (/** @type {number} */ at, /** @type {number} */ most) =>
      Math.max(GAP_PX, Math.min(at, most - GAP_PX));
    // Left of the views, over the form; right of the form, over the views; under what stands in the header.
    const left = box.width > clientWidth / 3 ? box.left - width - GAP_PX : box.right + GAP_PX;
    const beside = box.height > height / 2;
    panel.style.left = `${within(beside ? left : box.left, clientWidth - width)}px`;
    panel.style.top = `${within(beside ? box.top : below, clientHeight - height)}px`;
  }

  function end() {
    mark(null);
    current = -1;
    panel.hidden = true;
    byId("guide-start").focus();
  }

  return { go };
}
