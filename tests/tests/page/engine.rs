//! Failures of the engine.

use anyhow::{Result, ensure};
use serde_json::{Value, json};

use crate::{
    bench::in_browser,
    native::{DISTANCE, Known, link_of, with_distance},
    session::Session,
};

#[test]
fn a_browser_without_webassembly_gets_a_message() -> Result<()> {
    in_browser(|page| async move {
        page.before_scripts("delete globalThis.WebAssembly;").await?;
        page.load("").await?;
        page.until("!document.getElementById('no-wasm').hidden").await?;
        let sentence = page.text("#no-wasm").await?;
        ensure!(sentence.contains("WebAssembly") && sentence.ends_with('.'), "{sentence}");
        let status = page.text("#status").await?;
        ensure!(!status.contains("loading"), "the status is still `{status}`");
        Ok(())
    })
}

/// Gives the test access to the page's worker.
const REACH: &str = "window.heard = 0; window.workers = 0; window.Worker = class extends Worker { \
     constructor(...given) { super(...given); window.worker = this; window.workers += 1; \
         this.addEventListener('message', ({ data }) => { if (data.event === 'progress') window.heard += 1; }); } \
     postMessage(data, ...given) { if (!(window.deaf && 'cancel' in data)) super.postMessage(data, ...given); } };";

/// 22 million steps: the run takes seconds and needs a confirmation.
const LONG: &str = r#"{"source":{"motion":{"axes":[{"moves":[
    {"cosine":{"distance":{"steps":22000000},"duration_s":600,"ramp_s":10}}]}]}}}"#;

/// Starts a long run, and waits for its progress.
async fn begin_long_run(page: &Session) -> Result<()> {
    page.open(&format!("#{}", link_of(LONG)?)).await?;
    page.click("#run-anyway").await?;
    page.until("document.getElementById('status').textContent.includes('%')").await
}

/// The worker's counters: validated scenarios, and runs.
const COUNTS: &str = "new Promise((done) => { const hear = ({ data }) => { if (data.id === -1) { \
     window.engine.removeEventListener('message', hear); done([data.value.validated, data.value.runs]); } }; \
     window.engine.addEventListener('message', hear); window.engine.postMessage({ id: -1, method: 'counts', args: [] }); })";

/// Removes three digits of a field, each after the reply to the previous request.
const SHORTEN: &str = "const input = document.querySelector(arguments[0]);
    const answered = () => new Promise((done) => {
        const hear = ({ data }) => { if (data.id === -2) { window.engine.removeEventListener('message', hear); done(); } };
        window.engine.addEventListener('message', hear);
        window.engine.postMessage({ id: -2, method: 'counts', args: [] });
    });
    return (async () => {
        for (let key = 0; key < 3; key++) {
            input.value = input.value.slice(0, -1);
            input.dispatchEvent(new Event('input'));
            await answered();
        }
        return null;
    })();";

#[test]
fn a_keystroke_parses_and_plans_once() -> Result<()> {
    in_browser(|page| async move {
        page.before_scripts(REACH).await?;
        page.open("").await?;
        // Another worker computes the remedies of a refused motion.
        page.eval::<bool>("(window.engine = window.worker, true)").await?;
        page.fill(DISTANCE, "1600").await?;
        page.until_digest(&Known::of(&with_distance(1600.0))?.digest).await?;
        let [validated, runs]: [u32; 2] = page.eval(COUNTS).await?;
        // Another digit, and the motion is too fast: it is validated, but not run.
        let field = format!("[data-path=\"{DISTANCE}\"]");
        page.press(&field, "\u{e010}0").await?;
        page.press(&field, "0").await?;
        // Each request waits for the previous replies, so this ends.
        let mut counts = [validated, runs];
        for _ in 0..200 {
            counts = page.eval(COUNTS).await?;
            if counts[0] >= validated + 2 {
                break;
            }
        }
        assert_eq!(counts, [validated + 2, runs], "a problem is not run");
        // Each as soon as the previous one is validated.
        page.js::<Value>(SHORTEN, vec![json!(field)]).await?;
        let known = Known::of(&with_distance(160.0))?;
        page.until_digest(&known.digest).await?;
        page.until(&format!("location.hash.startsWith('#{}')", known.link)).await?;
        let counts: [u32; 2] = page.eval(COUNTS).await?;
        assert_eq!(counts[0], validated + 5, "five keystrokes");
        // Two of the five can run; the first of them only if it began before the last keystroke.
        assert!((runs + 1..=runs + 2).contains(&counts[1]), "{counts:?} after {runs} runs");
        page.click("#study").await?;
        for (tab, shown) in [("compare", "tbody tr"), ("torque", ".study-note button")] {
            page.click(&format!("#study-tab-{tab}")).await?;
            page.until(&format!("document.querySelector('#study-{tab} {shown}')")).await?;
        }
        assert_eq!(page.eval::<[u32; 2]>(COUNTS).await?, counts, "the study reuses the validated scenario");
        Ok(())
    })
}

#[test]
fn a_canceled_run_stops_completely() -> Result<()> {
    in_browser(|page| async move {
        page.before_scripts(REACH).await?;
        begin_long_run(&page).await?;
        page.click("#cancel").await?;
        page.until("document.getElementById('engine-message').textContent.includes('canceled')").await?;
        // A run continues in slices of some ms, and reports its progress after a few.
        let heard = "(async () => { const before = window.heard; \
             for (let question = 0; question < 100; question++) await new Promise((answered) => { \
                 const hear = ({ data }) => { if (data.id === -1) { window.worker.removeEventListener('message', hear); answered(); } }; \
                 window.worker.addEventListener('message', hear); \
                 window.worker.postMessage({ id: -1, method: 'pulses', args: [0, 1000, 10] }); }); \
             return window.heard - before; })()";
        // One message may still arrive.
        ensure!(page.eval::<u32>(heard).await? <= 1, "it still runs");
        assert_eq!(page.eval::<u32>("window.workers").await?, 1, "it received the cancel");
        page.click("#undo").await?;
        page.until_digest(&Known::of("{}")?.digest).await
    })
}

#[test]
fn an_unresponsive_engine_is_replaced_and_recomputes_the_result() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(&with_distance(1200.0))?;
        page.before_scripts(REACH).await?;
        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        // In the same visit, so that there is a previous result.
        page.follow(&link_of(LONG)?).await?;
        page.until("!document.getElementById('budget').hidden").await?;
        page.js::<()>("window.deaf = true;", vec![]).await?;
        page.click("#run-anyway").await?;
        page.until("document.getElementById('status').textContent.includes('%')").await?;
        page.click("#cancel").await?;
        page.until("window.workers === 2").await?;
        let message = page.text("#engine-message").await?;
        ensure!(message.contains("canceled"), "{message}");

        // The views still show the last result and can request other parts of it.
        assert_eq!(page.text("#digest").await?, known.digest);
        let asked = "new Promise((done) => { const hear = ({ data }) => { if (data.id === -1) done(data.value ? \
             data.value.high.length : 0); }; window.worker.addEventListener('message', hear); \
             window.worker.postMessage({ id: -1, method: 'pulses', args: [0, 1000, 10] }); })";
        page.until(&format!("{asked}.then((length) => length > 0)")).await?;
        page.fill(DISTANCE, "2400").await?;
        page.until_digest(&Known::of(&LONG.replace("22000000", "2400"))?.digest).await
    })
}

#[test]
fn requests_during_an_unanswered_cancel_are_executed() -> Result<()> {
    in_browser(|page| async move {
        page.before_scripts(REACH).await?;
        begin_long_run(&page).await?;
        page.js::<()>("window.deaf = true;", vec![]).await?;
        page.click("#cancel").await?;
        page.fill(DISTANCE, "2400").await?;
        page.until_digest(&Known::of(&LONG.replace("22000000", "2400"))?.digest).await?;
        page.until("window.workers === 2").await
    })
}

/// Overflows the engine's stack by a call with too many arguments.
async fn crash(page: &Session) -> Result<()> {
    page.eval::<bool>(
        "(window.worker.postMessage({ id: -1, method: 'check', args: new Array(1e6).fill(0) }), true)",
    )
    .await
    .map(drop)
}

#[test]
fn a_crash_of_the_engine_is_reported_and_repaired() -> Result<()> {
    in_browser(|page| async move {
        let (first, second) = (Known::of(&with_distance(1200.0))?, Known::of(&with_distance(2400.0))?);
        page.before_scripts(REACH).await?;
        page.open("").await?;
        page.fill(DISTANCE, "1.2k").await?;
        page.until_digest(&first.digest).await?;
        let form = page.form().await?;

        crash(&page).await?;
        page.until("!document.getElementById('engine-message').hidden").await?;
        let message = page.text("#engine-message").await?;
        ensure!(message.contains("engine failed"), "{message}");
        assert_eq!(page.form().await?, form, "the form is as it was");

        page.click("#try-again").await?;
        page.until("document.getElementById('engine-message').hidden").await?;
        page.until_digest(&first.digest).await?;
        page.canvas("chart-position").await?.has_curve("--ideal")?;

        crash(&page).await?;
        page.until("!document.getElementById('engine-message').hidden").await?;
        page.fill(DISTANCE, "2400").await?;
        page.until_digest(&second.digest).await?;
        ensure!(!page.visible("#engine-message").await?, "the message stays after a good run");
        Ok(())
    })
}

#[test]
fn an_engine_that_cannot_be_loaded_is_reported() -> Result<()> {
    in_browser(|page| async move {
        // Every worker fails before it receives anything.
        page.before_scripts(
            "window.Worker = class extends EventTarget { constructor() { super(); \
             queueMicrotask(() => this.onerror(new ErrorEvent('error', { message: 'not to be had' }))); } \
             postMessage() {} terminate() {} };",
        )
        .await?;
        page.load("").await?;
        page.until("!document.getElementById('engine-message').hidden").await?;
        let message = page.text("#engine-message").await?;
        ensure!(message.contains("engine") && message.contains("not to be had"), "{message}");
        Ok(())
    })
}
