/** Requests remedies for an invalid motion. */
import { unlessDropped } from "../engine/engine.js";

/** Rest after a change before remedies are computed, in ms: each request plans some motions. */
const REST_MS = 250;

/** Another worker computes them, so that no validation waits. @param {import("../engine/engine.js").Engine} engine */
export function createRemedyRequests(engine) {
  let request = new AbortController();
  return async (/** @type {string | null} */ json) => {
    request.abort();
    if (json === null) return null;
    request = new AbortController();
    const { signal } = request;
    await new Promise((resolve) => setTimeout(resolve, REST_MS));
    if (signal.aborted) return null;
    const replies = await engine.distribute("remedies", [[json]], signal).catch(unlessDropped);
    return replies?.[0] ?? null;
  };
}
