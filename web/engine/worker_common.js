/** Code that workers share. */

/**
 * Waits for the compiled code: `provide` sets it, `ready` resolves once it runs.
 * @param {(options: {module_or_path: WebAssembly.Module}) => Promise<unknown>} init
 */
export function awaitModule(init) {
  /** @type {(module: WebAssembly.Module) => void} */
  let provide = () => {};
  const ready = new Promise((resolve) => {
    provide = (module) => resolve(init({ module_or_path: module }));
  });
  return { provide, ready };
}

/**
 * A cache of the last validated scenario.
 * @template {{free: () => void}} J
 * @param {(json: string) => J} make
 */
export function createScenarioCache(make) {
  /** The scenario with its equivalent JSON texts: as received, and as written by the core. @type {{texts: string[], scenario: J} | null} */
  let cached = null;
  let count = 0;
  /** @param {string} json @returns {J} */
  function get(json) {
    if (cached?.texts.includes(json)) return cached.scenario;
    count += 1;
    const scenario = make(json);
    cached?.scenario.free();
    cached = { texts: [json], scenario };
    return scenario;
  }
  /** Adds an equivalent JSON text of the last scenario. @param {string} json */
  const alias = (json) => cached?.texts.length === 1 && cached.texts.push(json);
  return { get, alias, count: () => count };
}

/** Whether the module must not be used any more: after a panic its memory is undefined. @param {unknown} error */
export function isFatal(error) {
  return error instanceof WebAssembly.RuntimeError || error instanceof RangeError;
}
