/**
 * The page: creates the state, the engine and the views. Each change flows from message to state, validation, run and
 * drawing. Folders and files only import from their left, which a test checks:
 *
 *     pkg -> pkg-recordings -> state -> dom.js -> engine -> shell -> time -> form -> help -> views -> start -> main.js
 */

import { byId } from "./dom.js";
import { Engine, unlessDropped } from "./engine/engine.js";
import { preloadRecordings } from "./engine/wasm.js";
import { createForm } from "./form/form.js";
import { problemText } from "./form/problem_places.js";
import { createRemedyRequests } from "./form/remedy_requests.js";
import { samples, setSchema } from "./form/schema.js";
import { createCard } from "./help/card.js";
import { createGuide } from "./help/guide.js";
import { createKeys } from "./help/keys.js";
import { createHeader } from "./shell/header.js";
import { createImports } from "./shell/imports.js";
import { createLazyPopover } from "./shell/lazy_popover.js";
import { createLink } from "./shell/link.js";
import { createNotices } from "./shell/notices.js";
import { cacheOffline } from "./shell/offline.js";
import { createPanes } from "./shell/panes.js";
import { dropDown } from "./shell/popover.js";
import { createRunner } from "./shell/runner.js";
import { createSavedExperiments } from "./shell/saved_experiments.js";
import { offerNewer, savedWork } from "./shell/saved_work.js";
import {
  listedRecordings,
  loadScenario,
  saveHistory,
  saveLastValid,
  savePrevious,
  saveScenario,
} from "./shell/storage.js";
import { createTabs } from "./shell/tabs.js";
import { createTheme } from "./shell/theme.js";
import { createStart } from "./start/start.js";
import { offerStarters } from "./start/starters.js";
import { errorMessage } from "./state/error_message.js";
import { initial } from "./state/initial.js";
import { blockedBy, isStale } from "./state/queries.js";
import { EARLIER_REVISION } from "./state/result.js";
import { update } from "./state/update.js";
import { load as loadCharts } from "./time/plot.js";
import { createViews, exportsOf } from "./views/all_views.js";

/** @typedef {import("./state/types.js").State} State */
/** @typedef {{render: (state: State, before: State | undefined) => any}} View */

/** @type {State} */
let state = initial({});
/** @type {View[]} */
let views = [];

const engine = new Engine({
  progress: (revision, progress) => {
    if (revision === state.revision) dispatch({ type: "progress", progress });
  },
  done: (revision, summary, ms) => {
    dispatch({ type: "done", revision, summary, ms });
    preloadRecordings();
  },
  failed: (revision, message) => {
    if (revision === state.revision) dispatch({ type: "failed", message: `The run stopped: ${message}` });
  },
  crashed: (message) => {
    runner.giveUp();
    dispatch({ type: "baseline", baseline: null });
    dispatch({
      type: "failed",
      message: `The engine failed and was restarted. The form is unchanged (${message}).`,
    });
  },
  // All views request their data again.
  restored: () => {
    if (state.result) dispatch({ type: "controller", controller: state.result.controller });
  },
  stopped: () => {
    dispatch({ type: "baseline", baseline: null });
    if (blockedBy(state) === "unvalidated") runner.validate();
  },
});

/** @param {import("./state/message.js").Message} message */
function dispatch(message) {
  const before = state;
  state = update(state, message);
  if (state !== before) applyChange(before);
}

/** Reacts to a change of the state. @param {State | undefined} before */
function applyChange(before) {
  const changed = (/** @type {keyof State} */ key) => before?.[key] !== state[key];
  if (changed("scenario")) {
    document.documentElement.dataset.state = "busy";
    runner.validate();
    // The initial scenario is not saved.
    if (before) saveOwnScenario(before);
  }
  if (changed("validation") || changed("approved") || changed("drafts")) runner.plan();
  const { result } = state;
  const isNewResult = result !== null && changed("result");
  // The views request their data of the selected controller, so it comes first.
  if (isNewResult) selectResult(result);
  if (state.run.progress) revealPage();
  const drawn = views.map((view) => view.render(state, before));
  byId("views").classList.toggle("blank", result === null);
  byId("views").classList.toggle("dim", result !== null && isOutdated());
  if (isNewResult) markReady(Promise.allSettled(drawn));
  else if (state.run.phase === "failed") markReady(Promise.resolve());
}

/** @param {State} before */
function saveOwnScenario(before) {
  if (state.origin !== "own") return;
  const json = JSON.stringify(state.scenario);
  // An edited link or preset becomes the user's work.
  if (before.origin !== "own") savePrevious(json);
  saveScenario(json);
}

/** @param {NonNullable<State["result"]>} result */
function selectResult(result) {
  document.documentElement.dataset.state = "busy";
  if (result.revision === state.revision && state.origin === "own") saveLastValid(JSON.stringify(state.scenario));
  engine.request("select", result.controller).catch(unlessDropped);
}

/** Whether the visible result is not that of the scenario, and no run will replace it soon. */
function isOutdated() {
  return isStale(state) && blockedBy(state) !== "unvalidated" && state.run.phase !== "running";
}

/** Shows the form and the views. */
function revealPage() {
  delete document.documentElement.dataset.boot;
}

/** Marks the page as ready after drawing. @param {Promise<unknown>} drawn */
async function markReady(drawn) {
  const { revision, result } = state;
  await drawn;
  await new Promise((resolve) => requestAnimationFrame(resolve));
  revealPage();
  if (state.revision === revision && state.result === result) document.documentElement.dataset.state = "ready";
  cacheOffline();
}

const runner = createRunner({
  engine,
  dispatch,
  now: () => state,
  blocked: () => markReady(Promise.resolve()),
  started: () => {
    document.documentElement.dataset.state = "busy";
  },
});

async function start() {
  createTheme();
  dropDown("more", "more-panel");
  createCard();
  if (typeof WebAssembly !== "object") {
    byId("no-wasm").hidden = false;
    byId("status").textContent = "No engine";
    return;
  }
  const page = { engine, dispatch, now: () => state };
  /** @type {import("./start/opening.js").Page} */
  const gallery = { presets: [], problemText, ...page };
  // Before the engine arrives, since the cards must not move the page.
  offerStarters(gallery);
  const [fallback, presets, drivers, schema] = await Promise.all([
    engine.request("default_scenario"),
    engine.request("presets"),
    engine.request("drivers"),
    engine.request("schema"),
    loadCharts(),
  ]);
  setSchema(schema);
  // The history of another version of the page is not used.
  const version = byId("version").textContent ?? "";
  const { saved, lastValid } = await savedWork(engine, fallback, version);
  state = saved;
  gallery.presets = presets;
  // Saving long histories is too slow for every keystroke.
  window.addEventListener("pagehide", () => saveHistory(version, state));
  // Enter in a field must not submit the form.
  byId("form").addEventListener("submit", (event) => event.preventDefault());
  const link = createLink(page);
  createImports({ openLink: link.openLink, problemText, ...page });
  const remedies = createRemedyRequests(engine);
  const { all, loadKeys } = createViews(page, drivers, samples());
  views = [
    createHeader({ cancel: runner.cancel, retry: runner.retry, ...page }),
    createForm({ root: byId("fields"), samples: samples(), drivers, dispatch, remedies }),
    createTabs(page),
    createPanes(page),
    ...all,
    createNotices(page),
    createLazyPopover(
      "share",
      "share-panel",
      async (popover) => (await import("./shell/share.js")).createShare({ address: link.address, ...page }, popover),
      "link-about",
    ),
    createLazyPopover("export", "export-panel", (popover) => exportsOf(page, popover), "export-status"),
    createSavedExperiments({ newExperiment: fallback, problemText, ...page }),
    createStart(gallery),
    link,
  ];
  createKeys(loadKeys);
  createGuide(page);
  // Loaded only if there are saved recordings.
  if (listedRecordings())
    await import("./shell/recording/saved_recordings.js").then(({ restore }) => restore(page)).catch(() => {});
  await link.start(loadScenario() !== null);
  // The link did not replace the scenario.
  if (state.revision === 0) {
    applyChange(undefined);
    // The last valid run is shown dimmed.
    if (lastValid !== null) engine.run(EARLIER_REVISION, lastValid);
  }
  await offerNewer(page);
}

start().catch((error) => {
  byId("try-again").addEventListener("click", () => location.reload());
  byId("status").textContent = "The engine could not be started";
  byId("engine-message").hidden = false;
  /** @type {Element} */ (byId("engine-message").firstElementChild).textContent =
    `The engine could not be started: ${errorMessage(error)}`;
});
