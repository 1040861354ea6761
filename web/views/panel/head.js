/** The header of the panel view: controller, hold time and live mode. */
import { element, setOptions, setText } from "../../dom.js";
import { si } from "../../state/number.js";
import { parseHold, shortestPress } from "./presses.js";

/** Speeds of the live mode. @type {[string, string][]} */
const SPEEDS = [
  ["1", "real time"],
  ["0.1", "1/10"],
  ["0.01", "1/100"],
];

/**
 * @param {Element} title  The heading before it.
 * @param {{panel: () => any, clock: () => number, report: (text: string, isError?: boolean) => void,
 *   select: (controller: number) => void, play: () => void, toEnd: () => void}} page
 */
export function createHead(title, { panel, clock, report, select, play, toEnd }) {
  const controller = element("select", {});
  const controllerLabel = element("label", {}, "controller ", controller);
  const at = element("output", { class: "panel-at", "aria-live": "off" });
  const hold = element("input", { class: "time", size: "8", spellcheck: "false", "aria-describedby": "panel-status" });
  const playButton = element(
    "button",
    {
      type: "button",
      "aria-pressed": "false",
      title: "The cursor moves in real time, and buttons react while you hold them",
    },
    "▶ Live",
  );
  const speed = element("select", { "aria-label": "Speed of live mode" });
  setOptions(speed, SPEEDS, "1");
  const end = element(
    "button",
    {
      type: "button",
      hidden: "",
      title: "Remove cursor A: the panel shows the end, and presses are added there",
    },
    "To the end",
  );
  title.after(
    controllerLabel,
    element("label", { title: "Length of a press. It must be longer than the debounce time" }, "hold ", hold),
    element("span", { class: "group", role: "group", "aria-label": "Live" }, playButton, speed),
    at,
    end,
  );
  /** The hold time that the user entered, in cycles. @type {number | null} */
  let enteredHold = null;
  controller.addEventListener("change", () => select(Number(controller.value)));
  playButton.addEventListener("click", play);
  end.addEventListener("click", toEnd);
  hold.addEventListener("change", () => {
    const parsed = parseHold(hold.value, panel(), clock());
    if ("message" in parsed) return report(parsed.message, true);
    enteredHold = parsed.cycles;
    if (enteredHold !== null) report(parsed.warning);
    return showHold();
  });

  /** Cycles of a press. */
  const holdCycles = () => enteredHold ?? shortestPress(panel(), clock());

  function showHold() {
    if (document.activeElement !== hold || enteredHold !== null) hold.value = si(holdCycles() / clock(), "s", 6);
  }

  return {
    holdCycles,
    showHold,
    speed: () => Number(speed.value),
    /** @param {number} count @param {number} selected */
    showControllers(count, selected) {
      controllerLabel.hidden = count < 2;
      setOptions(
        controller,
        Array.from({ length: count }, (_, index) => [String(index), String(index)]),
        String(selected),
      );
    },
    /** @param {boolean} isOn */
    showLive(isOn) {
      playButton.setAttribute("aria-pressed", String(isOn));
      setText(playButton, isOn ? "❚❚ Stop" : "▶ Live");
    },
    /** @param {string} text @param {boolean} isEnd  Whether the panel already shows the end. */
    showTime(text, isEnd) {
      setText(at, text);
      end.hidden = isEnd;
    },
  };
}
