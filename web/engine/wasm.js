/** The core's code: fetched and compiled once, for the charts on the page and for every worker. */

/** @type {Promise<WebAssembly.Module> | null} */
let module = null;

/** @returns {Promise<WebAssembly.Module>} */
export function compiled() {
  module ??= compile();
  return module;
}

async function compile() {
  const url = new URL("../pkg/stepscope_wasm_bg.wasm", import.meta.url);
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url.pathname}: ${response.status}`);
  // Compiled while it comes in, if the host names its type.
  const streams = response.headers.get("Content-Type")?.startsWith("application/wasm");
  return streams ? WebAssembly.compileStreaming(response) : WebAssembly.compile(await response.arrayBuffer());
}
