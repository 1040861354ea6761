/** Long work of the study with progress. */
import { element, setText } from "../../dom.js";
import { Dropped } from "../../engine/request_slots.js";
import { sleep } from "../../engine/sleep.js";
import { errorMessage } from "../../state/error_message.js";

/** Progress is shown only for work that takes longer than this, in ms. */
const PROGRESS_DELAY_MS = 100;
/** Delay after a change before work starts, in ms, so that typing a number starts it once. */
const START_DELAY_MS = 120;

/**
 * Long work of a tab, one at a time; new work ends the previous one. Shows progress, and buttons to cancel and to start again.
 * @param {string} label @param {() => string} [canceledNote]  Additional text after a cancel.
 */
export function createJob(label, canceledNote = () => "") {
  const bar = element("progress", { max: "1", value: "0", "aria-label": label });
  const text = element("span");
  const press = element("button", { type: "button" });
  const root = element("p", { class: "study-job", role: "group", "aria-label": label }, text, bar, press);
  root.hidden = true;
  /** @type {AbortController | null} */
  let running = null;
  /** @type {() => void} */
  let restart = () => {};
  press.addEventListener("click", () => {
    if (!running) return restart();
    running.abort();
    running = null;
    bar.hidden = true;
    setText(text, `Canceled: ${text.textContent}.${canceledNote()}`);
    setText(press, "Start again");
  });

  /**
   * @template T
   * @param {(signal: AbortSignal, report: (progress: number, text: string) => void) => Promise<T>} work
   * @param {(result: T) => void} onDone  Called with the result, unless newer work has started.
   */
  async function run(work, onDone) {
    running?.abort();
    const own = new AbortController();
    running = own;
    restart = () => run(work, onDone);
    await sleep(START_DELAY_MS);
    if (running !== own) return;
    setText(text, "");
    text.classList.remove("error");
    const timer = setTimeout(() => {
      root.hidden = bar.hidden = false;
      setText(press, "Cancel");
    }, PROGRESS_DELAY_MS);
    try {
      const result = await work(own.signal, (progress, status) => {
        if (running !== own) return;
        bar.value = progress;
        setText(text, status);
      });
      if (running !== own) return;
      running = null;
      // The focused button is about to be hidden, so its panel gets the focus.
      if (root.contains(document.activeElement)) {
        const panel = /** @type {HTMLElement | null} */ (root.closest("[role=tabpanel]"));
        panel?.setAttribute("tabindex", "-1");
        panel?.focus({ preventScroll: true });
      }
      root.hidden = true;
      onDone(result);
    } catch (error) {
      if (running !== own || error instanceof Dropped) return;
      running = null;
      root.hidden = false;
      bar.hidden = true;
      text.classList.add("error");
      setText(text, errorMessage(error));
      setText(press, "Try again");
    } finally {
      clearTimeout(timer);
    }
  }
  return { root, run };
}
