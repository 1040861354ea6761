/**
 * An additional worker for long requests of the study and the form.
 *
 * In: first {module}, the compiled code; {id, method, args}, replied with {id, value} or {id, error}. The methods `open` and
 * `of` create an object of a scenario and call it.
 */
import init, {
  replay,
  sheets,
  sine_best,
  sine_rows,
  sine_vertices,
  step_figures,
  step_walker,
  ValidatedScenario,
  with_motor,
} from "../pkg/stepscope_wasm.js";
import { errorMessage } from "../state/error_message.js";
import { awaitModule, createScenarioCache, isFatal } from "./worker_common.js";

/** Requests without a scenario. @type {{[method: string]: (...args: any[]) => any}} */
const CALLS = { replay, sheets, sine_best, sine_rows, sine_vertices, step_figures, step_walker, with_motor };

const { get } = createScenarioCache((json) => new ValidatedScenario(json));

const { provide, ready } = awaitModule(init);

/** The open object. @type {any} */
let object = null;

/** @param {string} method @param {any[]} args  For a scenario, its JSON first. */
function reply(method, args) {
  if (method === "open") {
    const [make, json, ...rest] = args;
    object?.free();
    object = null;
    object = /** @type {any} */ (get(json))[make](...rest);
    return true;
  }
  if (method === "of") {
    const [name, ...rest] = args;
    const called = object;
    // `end` frees it.
    if (name === "end") object = null;
    return called[name](...rest);
  }
  const call = CALLS[method];
  if (call) return call(...args);
  const [json, ...rest] = args;
  return /** @type {any} */ (get(String(json)))[method](...rest);
}

self.onmessage = async ({ data }) => {
  if ("module" in data) return provide(data.module);
  try {
    await ready;
    postMessage({ id: data.id, value: reply(data.method, data.args) });
  } catch (error) {
    postMessage(
      isFatal(error) ? { event: "crashed", message: errorMessage(error) } : { id: data.id, error: errorMessage(error) },
    );
  }
};
