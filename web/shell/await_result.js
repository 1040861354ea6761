/** Waits for results of the current experiment. */
import { sleep } from "../engine/sleep.js";

/** @typedef {Pick<import("../state/types.js").Page, "now">} Page */

/** Maximum waiting time for a run, and the interval of checks, in ms. */
const [MAX_WAIT_MS, POLL_MS] = [60_000, 100];

/** The result of the current experiment once it has run; null if it did not run in time, or the experiment changed. @param {Page} page */
export async function awaitResult({ now }) {
  const { revision } = now();
  for (let waited = 0; waited < MAX_WAIT_MS && now().revision === revision; waited += POLL_MS) {
    const { result } = now();
    if (result?.revision === revision) return result;
    await sleep(POLL_MS);
  }
  return null;
}

/** Waits until there is any result. @param {Page} page @param {number} maxMs */
export async function awaitAnyResult({ now }, maxMs) {
  for (let waited = 0; waited < maxMs && !now().result; waited += POLL_MS) await sleep(POLL_MS);
}
