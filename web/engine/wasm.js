/**
 * The core's code: fetched and compiled once, for the charts on the page and for every worker; and that of the study, of
 * files of logic analysers and of stand-alone controllers, once something is asked of it. The page says where they lie, because what is built has other names.
 */
import { byId } from "../dom.js";

/** @typedef {"core" | "study" | "capture" | "panel" | "live"} Part */

/** @type {{[part in Part]?: Promise<WebAssembly.Module>}} */
const modules = {};

/** @param {Part} which @returns {Promise<WebAssembly.Module>} */
export function compiled(which = "core") {
  // The help page has the core alone, and no scripts to name the others.
  const named = () => byId("main").dataset[`${which}Core`] ?? "";
  const address = () => (which === "core" ? /** @type {HTMLLinkElement} */ (byId("core")).href : named());
  const made = modules[which] ?? compile(address());
  modules[which] = made;
  // What could not be fetched is asked for again.
  made.catch(() => {
    modules[which] = undefined;
  });
  return made;
}

/** @param {string} address */
async function compile(address) {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`${new URL(response.url).pathname}: ${response.status}`);
  // Compiled while it comes in, if the host names its type.
  const streams = response.headers.get("Content-Type")?.startsWith("application/wasm");
  return streams ? WebAssembly.compileStreaming(response) : WebAssembly.compile(await response.arrayBuffer());
}
