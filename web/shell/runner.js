/** Validates each scenario, and runs it if it is valid. */
import { Dropped } from "../engine/request_slots.js";
import { blockedBy } from "../state/queries.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {Pick<import("../engine/engine.js").Engine, "latest" | "run" | "cancel" | "revive">} Engine */

/** Rest after a change before it runs, in ms: typing a number is one run. */
const REST_MS = 120;
/** A run without progress after this time is still planning, in ms. */
const PLANNING_MS = 100;

/**
 * What to do with a scenario.
 * @param {State} state @param {number} ran  Revision that ran last.
 * @returns {"wait" | "blocked" | "done" | "run"}
 */
export function nextStep(state, ran) {
  const blocked = blockedBy(state);
  if (blocked === "unvalidated") return "wait";
  if (blocked !== null) return "blocked";
  return ran === state.revision ? "done" : "run";
}

/** @param {{engine: Engine, blocked: () => void, started: () => void} & import("../state/types.js").Page} page  `blocked` is called where nothing is to come. */
export function createRunner({ engine, blocked, started, dispatch, now }) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  /** Revision whose run has begun; none runs twice. */
  let ran = -1;

  async function validate() {
    const { revision, scenario } = now();
    try {
      const validation = await engine.latest("check", "check", JSON.stringify(scenario));
      dispatch({ type: "validated", revision, validation });
    } catch (error) {
      if (!(error instanceof Dropped)) throw error;
    }
  }

  function run() {
    const { revision, scenario } = now();
    ran = revision;
    started();
    engine.run(revision, JSON.stringify(scenario));
    dispatch({ type: "running" });
    setTimeout(() => {
      const { revision: current, run } = now();
      if (current === revision && run.phase === "running" && run.progress === null)
        dispatch({ type: "progress", progress: { done: false, cycle: 0, end_cycle: 0, records: 0 } });
    }, PLANNING_MS);
  }

  return {
    validate,
    /** After a change of the validation, of an approval or of a draft. */
    plan() {
      clearTimeout(timer);
      const step = nextStep(now(), ran);
      if (step === "blocked") blocked();
      else if (step === "run") timer = setTimeout(run, now().result ? REST_MS : 0);
    },
    cancel() {
      engine.cancel(now().revision);
      dispatch({ type: "failed", message: "The run was canceled. The views show the last result." });
    },
    retry() {
      engine.revive();
      ran = -1;
      validate();
    },
    /** The engine crashed: this scenario is not tried again by itself. */
    giveUp() {
      ran = now().revision;
    },
  };
}
