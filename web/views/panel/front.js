/** The front panel: display, LED, buttons, keys, emergency stop, power and switches. */
import { element, fill, setText } from "../../dom.js";
import { advice, inputLabel, lcd, led, SWITCHES, sentence, shortInputLabel } from "./names.js";
import { driven } from "./script.js";

/** @typedef {import("./names.js").Word} Word */
/** @typedef {{word: Word, position: number, display: number, place: number, error: number, perUnit: number, decimals: number, powered: boolean, loops: number, groups: number}} Moment */
/** @typedef {{down: (input: string) => void, up: (input: string) => void, click: (input: string) => void, set: (input: string, level: number) => void}} PanelInputs  Called for the presses and switches of the user. */

/** Buttons of the panel, one per row. */
const BUTTONS = [
  ["start", "pause", "clear"],
  ["jog_minus", "jog_plus", "zero", "home"],
  ["debug", "system", "ok", "back"],
];
/** @type {{[input: string]: string}} */
const FACES = { jog_minus: "◀ jog", jog_plus: "jog ▶" };
/** The effect of each button. @type {{[input: string]: string}} */
const EFFECTS = {
  start: "start the program, or continue after a pause",
  pause: "pause a move, a delay or a wait",
  clear: "clear an alarm or the entry; cancel after a pause",
  jog_minus: "jog left while held",
  jog_plus: "jog right while held",
  zero: "return to zero",
  home: "start homing",
  debug: "switch to fine jog and setting of zero, and back",
  system: "show the next number",
  ok: "confirm the entry, or set zero here in the state DEBUG",
  back: "close the numbers",
};
const LEDS = { quick: "blinks fast", on: "is on", slow: "blinks slowly" };

/** @param {HTMLElement} root @param {PanelInputs} inputs */
export function createFront(root, inputs) {
  const display = element("output", { class: "lcd", "aria-label": "Display", "aria-live": "off" });
  const lamp = element("span", { class: "led", "aria-hidden": "true" });
  const lampText = element("span", { class: "led-text" });
  const words = element("p", { class: "panel-words" });
  const next = element("p", { class: "panel-advice" });
  const outputs = element("span", { class: "outputs" });
  /** @type {Map<string, HTMLButtonElement>} */
  const buttons = new Map();

  /** @param {string} input @param {string} face @param {string} about */
  function momentary(input, face, about) {
    const made = element(
      "button",
      { type: "button", "data-input": input, title: `${inputLabel(input)}: ${about}` },
      face,
    );
    if (face !== input) made.setAttribute("aria-label", inputLabel(input));
    made.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      made.setPointerCapture(event.pointerId);
      inputs.down(input);
    });
    for (const end of ["pointerup", "pointercancel", "blur"]) made.addEventListener(end, () => inputs.up(input));
    made.addEventListener("keydown", ({ key, repeat }) => {
      if ((key === " " || key === "Enter") && !repeat) inputs.down(input);
    });
    made.addEventListener("keyup", ({ key }) => {
      if (key === " " || key === "Enter") inputs.up(input);
    });
    made.addEventListener("click", () => inputs.click(input));
    buttons.set(input, made);
    return made;
  }

  /** A button that sets an input to a level. @param {string} input @param {number} level @param {string} face @param {string} about */
  function lever(input, level, face, about) {
    const made = element(
      "button",
      { type: "button", "data-input": input, "data-level": String(level), title: about },
      face,
    );
    made.addEventListener("click", () => inputs.set(input, level));
    return made;
  }

  const estop = lever("estop", 1, "E-STOP", "Press the emergency stop at the cursor: motors off at once");
  estop.classList.add("estop");
  const release = lever("estop", 0, "Release", "Release the emergency stop at the cursor; then press clear");
  const cut = lever("power", 0, "Cut power here", "Switch the power off at the cursor");
  const back = lever("power", 1, "Restore power", "Switch the power on at the cursor");
  const switches = SWITCHES.map((input) => {
    const made = element(
      "button",
      {
        type: "button",
        class: "switch",
        "data-input": input,
        "aria-label": inputLabel(input),
        "aria-pressed": "false",
      },
      shortInputLabel(input),
    );
    made.addEventListener("click", () => inputs.set(input, made.getAttribute("aria-pressed") === "true" ? 0 : 1));
    return made;
  });
  fill(
    root,
    element("div", { class: "glass" }, display, element("span", { class: "lamp" }, lamp, lampText), outputs),
    words,
    element("div", { class: "panel-messages" }, next),
    ...BUTTONS.map((row) =>
      element("div", { class: "pad" }, ...row.map((input) => momentary(input, FACES[input] ?? input, EFFECTS[input]))),
    ),
    element(
      "div",
      { class: "pad digits", role: "group", "aria-label": "Digits" },
      ...[1, 2, 3, 4, 5, 6, 7, 8, 9, 0].map((digit) => momentary(`key_${digit}`, String(digit), "digit of the entry")),
    ),
    element(
      "div",
      { class: "pad power", role: "group", "aria-label": "Emergency stop and power" },
      estop,
      release,
      cut,
      back,
    ),
    element("div", { class: "pad switches", role: "group", "aria-label": "Switches and inputs" }, ...switches),
  );

  /**
   * @param {Moment | null} moment @param {(input: string) => boolean} level  Level of an input at that moment. @param {any} settings
   */
  function show(moment, level, settings) {
    if (!moment) return;
    const { word, decimals } = moment;
    setText(display, word.state === "OFF" ? "" : lcd(moment.display, decimals));
    const light = word.state === "OFF" ? null : led(word);
    lamp.dataset.led = light ?? "off";
    setText(lampText, light ? `LED ${LEDS[light]}` : "LED is off");
    setText(words, sentence(word, moment));
    words.classList.toggle("alarm", word.state === "ALARM");
    setText(next, advice(word, Boolean(settings?.home)));
    const home = buttons.get("home");
    if (home)
      home.title = `home: ${EFFECTS.home}${settings?.home ? "" : "; no effect: homing is not set up in the form"}`;
    setText(
      outputs,
      word.outputs ? `outputs ${[0, 1, 2, 3].filter((output) => (word.outputs >> output) & 1).join(" ")}` : "",
    );
    for (const [input, made] of buttons) made.classList.toggle("down", level(input));
    estop.classList.toggle("down", level("estop"));
    estop.setAttribute("aria-pressed", String(level("estop")));
    for (const [made, off] of /** @type {[HTMLButtonElement, boolean][]} */ ([
      [release, !level("estop")],
      [cut, !level("power")],
      [back, level("power")],
    ])) {
      const hadFocus = document.activeElement === made;
      made.disabled = off;
      // A pressed button that is now disabled passes the focus to the button that undoes it.
      if (off && hadFocus) (made === cut ? back : made === back ? cut : estop).focus();
    }
    const drivenBy = driven(settings?.axis);
    for (const made of switches) {
      const input = /** @type {string} */ (made.dataset.input);
      made.setAttribute("aria-pressed", String(level(input)));
      made.classList.toggle("driven", input in drivenBy);
      made.title = drivenBy[input]
        ? `${inputLabel(input)}: driven by ${drivenBy[input]}`
        : `${inputLabel(input)}: toggle it at the cursor`;
    }
  }
  return { show };
}
