/** Validates each scenario, and runs it if it is valid. */
import { Dropped } from "../engine/request_slots.js";
import { blockedBy } from "../state/queries.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {Pick<import("../engine/engine.js").Engine, "latest" | "run" | "cancel" | "revive">} Engine */

/** Maximum delay after a change before it runs, in ms, so that typing a number is one run. */
const MAX_RUN_DELAY_MS = 120;
/** A run without progress after this time is shown as planning, in ms. */
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

/** @param {{engine: Engine, blocked: () => void, started: () => void} & import("../state/types.js").Page} page  `blocked` is called if the scenario cannot run. */
export function createRunner({ engine, blocked, started, dispatch, now }) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  /** Revision that ran last; no revision runs twice. */
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
    /** Runs the scenario if it is due; called after each change of validation, approval or drafts. */
    plan() {
      clearTimeout(timer);
      const step = nextStep(now(), ran);
      if (step === "blocked") blocked();
      // A run that is replaced costs at most about as long as the last one, so a short run need not wait.
      else if (step === "run") timer = setTimeout(run, Math.min(MAX_RUN_DELAY_MS, now().result?.ms ?? 0));
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
    /** After a crash the scenario runs again only on request. */
    giveUp() {
      ran = now().revision;
    },
  };
}
