//! When the engine can't be had, or dies.

use anyhow::{Result, ensure};

use crate::{
    bench::in_browser,
    native::{Known, with_distance},
    session::Session,
};

const DISTANCE: &str = "source.motion.axes[0].moves[0].cosine.distance";

#[test]
fn without_webassembly_the_page_says_so() -> Result<()> {
    in_browser(|page| async move {
        page.before_scripts("delete globalThis.WebAssembly;").await?;
        page.load("").await?;
        page.until("!document.getElementById('no-wasm').hidden").await?;
        let sentence = page.text("#no-wasm").await?;
        ensure!(sentence.contains("WebAssembly") && sentence.ends_with('.'), "{sentence}");
        let status = page.text("#status").await?;
        ensure!(!status.contains("loading"), "it still says `{status}`");
        Ok(())
    })
}

/// Lets the test reach the worker that the page has started.
const REACH: &str = "window.Worker = class extends Worker { constructor(...given) { super(...given); window.worker = this; } };";

/// Lets the engine run out of stack, by a call with more arguments than fit on it.
async fn crash(page: &Session) -> Result<()> {
    page.eval::<bool>(
        "(window.worker.postMessage({ id: -1, method: 'check', args: new Array(1e6).fill(0) }), true)",
    )
    .await
    .map(drop)
}

#[test]
fn a_crash_of_the_engine_is_told_keeps_the_form_and_is_mended() -> Result<()> {
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
        ensure!(message.contains("engine stopped"), "{message}");
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
fn an_engine_that_cannot_be_loaded_is_told() -> Result<()> {
    in_browser(|page| async move {
        // Every worker ends in an error of its own before it hears anything.
        page.before_scripts(
            "window.Worker = class extends EventTarget { constructor() { super(); \
             setTimeout(() => this.onerror(new ErrorEvent('error', { message: 'not to be had' })), 10); } \
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
