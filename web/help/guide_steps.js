/** The guided tour: a small panel next to each element that it explains. The page stays usable. */
import { button, byId, element, fill } from "../dom.js";
import { saveGuided } from "../shell/storage.js";

/** @typedef {{title: string, text: string, at: string, view?: string, touch?: string}} Step  `at`: selector of its target; `view`: tab of the target on a narrow screen; `touch`: its text without a mouse and keys. */

/** @type {Step[]} */
export const STEPS = [
  {
    title: "Choose a motion",
    at: "#fields > details",
    text: "Choose a preset above, or enter a move here: type a distance such as 1.2k, or drag its label sideways. The result updates at once. Click a word with a dotted underline to see its meaning.",
  },
  {
    title: "View the curves",
    at: "#view-motion",
    view: "motion",
    text: "Position, speed and acceleration: the thin line is the ideal curve, the wide one the actual pulses. Click to set cursor A, with Shift cursor B. Drag their handles to move them.",
    touch:
      "Position, speed and acceleration: the thin line is the ideal curve, the wide one the actual pulses. Tap to set cursor A, and drag its handle.",
  },
  {
    title: "Zoom into the pulses",
    at: "#view-pulses",
    view: "pulses",
    text: "Turn the wheel, or press + and the arrow keys, until you see single pulses. Every edge is cycle-exact. N goes to the next edge.",
    touch: "Pinch until you see single pulses. Every edge is cycle-exact.",
  },
  {
    title: "Inspect the packets",
    at: "#view-packets",
    view: "packets",
    text: "One row per packet, with its bytes and its outcome. Select one to show it in the pulses.",
  },
  {
    title: "Find and fix an error",
    at: "#preset",
    text: "“Pulses too short for a DRV8825” and “Raw packets on a noisy line” contain a deliberate error. The page explains it, and “Fix it” corrects it. Undo restores it.",
  },
  {
    title: "Share it",
    at: "#share",
    text: "The link contains the whole experiment. It reproduces the same edges, and the digest proves it. The menu on the right has the keys and the help.",
  },
];

/** Distance of the panel from its target and from the window, in CSS pixels. */
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
    const { title, text: withKeys, touch, view } = STEPS[step];
    const text = (matchMedia("(hover: none)").matches && touch) || withKeys;
    if (view) dispatch({ type: "view", view });
    // The target must be visible.
    const { form, folded, largest } = now().panes;
    if (largest !== null || form === 0 || folded.length > 0) {
      // A width of 0 is folded; null is the default width.
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

  /** Highlights the target. @param {HTMLElement | null} target */
  function mark(target) {
    for (const marked of document.querySelectorAll(".pointed")) marked.classList.remove("pointed");
    target?.classList.add("pointed");
    target?.scrollIntoView({ block: narrow.matches ? "start" : "nearest" });
  }

  /** Next to the target if there is room, else over a part of it. */
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
    const within = (/** @type {number} */ at, /** @type {number} */ max) =>
      Math.max(GAP_PX, Math.min(at, max - GAP_PX));
    // Left of the views, right of the form, or below the header.
    const left = box.width > clientWidth / 3 ? box.left - width - GAP_PX : box.right + GAP_PX;
    const tall = box.height > height / 2;
    panel.style.left = `${within(tall ? left : box.left, clientWidth - width)}px`;
    panel.style.top = `${within(tall ? box.top : below, clientHeight - height)}px`;
  }

  function end() {
    mark(null);
    current = -1;
    panel.hidden = true;
    byId("more").focus();
  }

  return { go };
}
