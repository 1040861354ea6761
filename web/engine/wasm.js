/**
 * The two wasm modules, each fetched and compiled once for the page and all workers: the core, and the tools, which the page
 * loads in the background. The page's HTML has their addresses, because built files have other names.
 */
import { byId } from "../dom.js";

/** Where each module is; the help page names the core alone. */
const ADDRESSES = {
  core: () => /** @type {HTMLLinkElement} */ (byId("core")).href,
  tools: () => byId("main").dataset.toolsCore ?? "",
};

/** Time for the first result to be drawn before the tools load, in ms. */
const PRELOAD_MS = 500;

/** @type {{[which in keyof typeof ADDRESSES]?: Promise<WebAssembly.Module>}} */
const modules = {};

/** @param {keyof typeof ADDRESSES} which @returns {Promise<WebAssembly.Module>} */
export function compiled(which = "core") {
  const made = modules[which] ?? compile(ADDRESSES[which]());
  modules[which] = made;
  // What could not be fetched is asked for again.
  made.catch(() => {
    modules[which] = undefined;
  });
  return made;
}

let preloaded = false;

/** Loads the tools once the first result is on the screen, so that opening one of them waits for nothing. */
export function preloadTools() {
  // With data saving on they load with the first tool, or with the copy for offline use.
  if (preloaded || /** @type {any} */ (navigator).connection?.saveData) return;
  preloaded = true;
  setTimeout(() => compiled("tools").catch(() => {}), PRELOAD_MS);
}

/** @param {string} address */
async function compile(address) {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`${new URL(response.url).pathname}: ${response.status}`);
  // Compiled while it comes in, if the host names its type.
  const streams = response.headers.get("Content-Type")?.startsWith("application/wasm");
  return streams ? WebAssembly.compileStreaming(response) : WebAssembly.compile(await response.arrayBuffer());
}
