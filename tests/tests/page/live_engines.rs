//! The dialog Device in every engine, with a mock of `navigator.serial` (`device`): `cargo xtask test --only engines`. An engine
//! without support states the reason before anything is opened.

use anyhow::{Result, ensure};
use serde_json::json;

use crate::{
    bench::in_engine,
    browser::Browser,
    device::{ABOUT, ENDED, FRAMED, answers_a_host, open, open_with, start, verified},
    native::Known,
    session::Session,
};

/// Whether the engine can transfer both streams to a worker.
const MOVES: &str = "
    const { readable, writable } = new TransformStream();
    const { port1 } = new MessageChannel();
    try { port1.postMessage([readable, writable], [readable, writable]); return true; } catch { return false; }";

/// The dialog's buttons are disabled, and the dialog and its button state the reason.
async fn refused(page: &Session, why: &str) -> Result<()> {
    page.click("#device").await?;
    page.until(&format!("{ABOUT}.startsWith({})", json!(why))).await?;
    for button in ["live-choose", "live-start"] {
        let (off, title): (bool, String) = page
            .eval(&format!(
                "[document.getElementById('{button}').disabled, document.getElementById('{button}').title]"
            ))
            .await?;
        ensure!(off && title.starts_with(why), "{button}: {title}");
    }
    Ok(())
}

/// The engine's own ports; then the mock's, as both of its ends.
async fn all(page: Session) -> Result<()> {
    let (engine, known) = (page.bench.browser, Known::of(FRAMED)?);
    let link = format!("#{}", known.link);
    page.open(&link).await?;
    let has_serial: bool = page.eval("'serial' in navigator").await?;
    // Newer versions of Firefox support it.
    ensure!(
        engine == Browser::Firefox || has_serial == (engine == Browser::Chromium),
        "{engine:?}: {has_serial}"
    );
    if !has_serial {
        refused(&page, "This browser does not support Web Serial").await?;
    }
    if !page.js::<bool>(MOVES, vec![]).await? {
        ensure!(engine == Browser::WebKit, "{engine:?} moves no streams");
        open_with(&page, &link, "serve", FRAMED).await?;
        refused(&page, "This browser cannot transfer the streams of a port to a worker").await?;
        ensure!(page.eval::<Vec<u32>>("peer.opened").await?.is_empty(), "the port was opened");
        return Ok(());
    }
    open(&page, FRAMED, "serve").await?;
    start(&page).await?;
    page.until(ENDED).await?;
    verified(&page, &known).await?;
    open(&page, FRAMED, "stream").await?;
    answers_a_host(&page, &known).await
}

#[test]
fn chromium_streams_to_a_verified_end_and_serves_a_host() -> Result<()> {
    in_engine(Browser::Chromium, all)
}

#[test]
fn firefox_streams_to_a_verified_end_and_serves_a_host() -> Result<()> {
    in_engine(Browser::Firefox, all)
}

#[test]
fn webkit_streams_and_serves_or_explains_why_it_cannot() -> Result<()> {
    in_engine(Browser::WebKit, all)
}
