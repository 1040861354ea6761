/**
 * The two wasm modules, fetched and compiled once for the page and all workers: the simulation, and the recordings,
 * loaded in the background. The HTML has their addresses, because built files have other names.
 */
import { byId } from "../dom.js";

/** Addresses; the help page has only the simulation. */
const ADDRESSES = {
  core: () => /** @type {HTMLLinkElement} */ (byId("core")).href,
  recordings: () => byId("main").dataset.recordingsCore ?? "",
};

/** Delay of the recordings after the first result, in ms. */
const PRELOAD_MS = 500;

/** @type {{[which in keyof typeof ADDRESSES]?: Promise<WebAssembly.Module>}} */
const modules = {};

/** @param {keyof typeof ADDRESSES} which @returns {Promise<WebAssembly.Module>} */
export function compiled(which = "core") {
  const compiling = modules[which] ?? compile(ADDRESSES[which]());
  modules[which] = compiling;
  // After an error the next call tries again.
  compiling.catch(() => {
    modules[which] = undefined;
  });
  return compiling;
}

let preloaded = false;

/** Loads the module of recordings after the first result. */
export function preloadRecordings() {
  // With data saving they load on demand.
  if (preloaded || /** @type {any} */ (navigator).connection?.saveData) return;
  preloaded = true;
  setTimeout(() => compiled("recordings").catch(() => {}), PRELOAD_MS);
}

/** @param {string} address */
async function compile(address) {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`${new URL(response.url).pathname}: ${response.status}`);
  // Streaming needs the right content type.
  const streams = response.headers.get("Content-Type")?.startsWith("application/wasm");
  return streams ? WebAssembly.compileStreaming(response) : WebAssembly.compile(await response.arrayBuffer());
}
