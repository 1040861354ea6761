/**
 * A further worker: answers long questions beside the run that the views ask about, those of the study and of what a form
 * could be changed to.
 *
 * In: first of all {module}, the compiled code; {id, method, args} for an answer {id, value} or {id, error}. The methods
 * `open` and `of` make an object of a scenario and ask it.
 */
import init, {
  Judged,
  replay,
  sheets,
  sine_best,
  sine_rows,
  sine_vertices,
  step_figures,
  with_motor,
} from "../pkg-tools/stepscope_wasm.js";
import { awaitModule, createJudging, fatal, text } from "./judging.js";

/** Questions that are about no scenario. @type {{[method: string]: (...args: any[]) => any}} */
const CALLS = { replay, sheets, sine_best, sine_rows, sine_vertices, step_figures, with_motor };

const { judge } = createJudging((json) => new Judged(json));

const { provide, ready } = awaitModule(init);

/** What was opened last. @type {any} */
let opened = null;

/** @param {string} method @param {any[]} args  Of a question about a scenario its text first. */
function answer(method, args) {
  if (method === "open") {
    const [make, json, ...rest] = args;
    opened?.free();
    opened = null;
    opened = /** @type {any} */ (judge(json))[make](...rest);
    return true;
  }
  if (method === "of") {
    const [ask, ...rest] = args;
    const held = opened;
    // Its end frees it.
    if (ask === "end") opened = null;
    return held[ask](...rest);
  }
  const call = CALLS[method];
  if (call) return call(...args);
  const [json, ...rest] = args;
  return /** @type {any} */ (judge(String(json)))[method](...rest);
}

self.onmessage = async ({ data }) => {
  if ("module" in data) return provide(data.module);
  try {
    await ready;
    postMessage({ id: data.id, value: answer(data.method, data.args) });
  } catch (error) {
    postMessage(fatal(error) ? { event: "crashed", message: text(error) } : { id: data.id, error: text(error) });
  }
};
