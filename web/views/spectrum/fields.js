/** Fields and buttons of the visible frequencies. */
import { button, byId, element, iconOf, setText } from "../../dom.js";
import { si } from "../../state/number.js";
import { parseNumber } from "../../state/parse_number.js";
import { frequency } from "./frequency.js";

/**
 * @param {HTMLElement} root
 * @param {{zoom: (factor: number) => void, fit: () => void, back: () => void, toggleLog: () => void, redraw: () => void}} actions
 */
export function createFields(root, { zoom, fit, back, toggleLog, redraw }) {
  const error = element("span", { class: "error", id: "spectrum-error", "aria-live": "polite" });
  const inputs = ["from", "to"].map((name) =>
    element("input", { class: "time", id: `spectrum-${name}`, "aria-describedby": error.id }),
  );
  const press = (/** @type {Node | string} */ text, /** @type {string} */ label, /** @type {() => void} */ run) =>
    button(text, label, run);
  const backButton = press(iconOf("[data-time=back]"), "Back to the previous view (Backspace)", back);
  const logButton = press("log", "log: logarithmic frequencies (L)", toggleLog);
  logButton.id = "spectrum-log";
  byId("spectrum-scale").parentElement?.after(logButton);
  root.append(
    ...inputs.map((input, at) => element("label", {}, `${["from", "to"][at]} `, input)),
    press("+", "Zoom in (+)", () => zoom(0.5)),
    press("−", "Zoom out (−)", () => zoom(2)),
    press(iconOf("#zoom-fit"), "Fit: the whole spectrum (0 or double-click)", fit),
    backButton,
    error,
  );
  for (const input of inputs) input.addEventListener("change", typed);

  function typed() {
    const [from, to] = inputs.map((input) => {
      const read = parseNumber(input.value, "Hz");
      input.setAttribute("aria-invalid", String("message" in read));
      return read;
    });
    const message = "message" in from ? from.message : "message" in to ? to.message : "";
    if (message || "message" in from || "message" in to) return setText(error, message);
    if (from.value < 0) return setText(error, "“from” is out of range; use 0 Hz or more.");
    if (to.value <= from.value) return setText(error, "“to” is not above “from”; use a higher frequency.");
    setText(error, "");
    frequency.showHertz(from.value, to.value);
    redraw();
    render(frequency.hertz(), true);
  }

  /** @param {import("../../state/types.js").Span} shown  In Hz. @param {boolean} [includesFocused]  Whether to update the focused field, too. */
  function render({ start, end }, includesFocused = false) {
    for (const [at, hz] of [start, end].entries())
      if (includesFocused || document.activeElement !== inputs[at]) inputs[at].value = si(hz, "Hz", 5);
    backButton.disabled = !frequency.canGoBack();
    logButton.setAttribute("aria-pressed", String(frequency.isLog()));
  }
  return { render };
}
