/**
 * The core's code: fetched and compiled once, for the charts on the page and for every worker. The page says where it
 * lies, because what is built has other names.
 */
import { byId } from "../dom.js";

/** @type {Promise<WebAssembly.Module> | null} */
let module = null;

/** @returns {Promise<WebAssembly.Module>} */
export function compiled() {
  module ??= compile();
  return module;
}

async function compile() {
  const { href } = /** @type {HTMLLinkElement} */ (byId("core"));
  const response = await fetch(href);
  if (!response.ok) throw new Error(`${new URL(href).pathname}: ${response.status}`);
  // Compiled while it comes in, if the host names its type.
  const streams = response.headers.get("Content-Type")?.startsWith("application/wasm");
  return streams ? WebAssembly.compileStreaming(response) : WebAssembly.compile(await response.arrayBuffer());
}
