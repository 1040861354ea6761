/** Requests remedies for an invalid motion. */
import { unlessDropped } from "../engine/engine.js";
import { sleep } from "../engine/sleep.js";

/** Delay after a change before remedies are computed, in ms; each request plans several motions. */
const DELAY_MS = 250;

/** An additional worker computes them, so that validations do not wait. @param {import("../engine/engine.js").Engine} engine */
export function createRemedyRequests(engine) {
  let request = new AbortController();
  return async (/** @type {string | null} */ json) => {
    request.abort();
    if (json === null) return null;
    request = new AbortController();
    const { signal } = request;
    await sleep(DELAY_MS);
    if (signal.aborted) return null;
    const replies = await engine.distribute("remedies", [[json]], signal).catch(unlessDropped);
    return replies?.[0] ?? null;
  };
}
