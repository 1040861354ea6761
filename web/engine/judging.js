/** What the workers share: the wait for their code, a scenario validated once, errors as texts. */

/**
 * The wait for the compiled code: `provide` takes it, `ready` resolves once it runs.
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
 * Keeps the scenario that was judged last, read and planned once for all that is asked of it until another one comes.
 * @template {{free: () => void}} J
 * @param {(json: string) => J} make
 */
export function createJudging(make) {
  /** The texts that it goes by: as it came, and as the core writes it. @type {{texts: string[], judged: J} | null} */
  let held = null;
  let count = 0;
  /** @param {string} json @returns {J} */
  function judge(json) {
    if (held?.texts.includes(json)) return held.judged;
    count += 1;
    const judged = make(json);
    held?.judged.free();
    held = { texts: [json], judged };
    return judged;
  }
  /** What was judged last goes by another text, too. @param {string} json */
  const alias = (json) => held?.texts.length === 1 && held.texts.push(json);
  return { judge, alias, count: () => count };
}

/** A panic leaves the wasm memory in no known state: the page has to start another worker. @param {unknown} error */
export function fatal(error) {
  return error instanceof WebAssembly.RuntimeError || error instanceof RangeError;
}

/** @param {unknown} error */
export function text(error) {
  return error instanceof Error ? error.message : String(error);
}
