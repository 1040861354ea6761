//! A recording survives a reload, with and without a link; lost, damaged or refused storage is reported.

use std::{fmt::Write as _, time::Duration};

use anyhow::{Context, Result, ensure};
use serde_json::json;
use stepscope_core::inspect::recording::{loaded_capture::LoadedCapture, open_options::OpenOptions};
use tokio::time::sleep;

use crate::{
    bench::in_browser,
    native::{DISTANCE, Known, with_distance},
    recording::{CLOSED, MESSAGE, READY, SHOW, choose_file, digest, natively},
    session::Session,
};

/// Irregular steps, in the format of Saleae Logic; many of them are too long for a link.
fn wandering(steps: u32) -> String {
    let mut table = "Time [s],STEP,DIR\n0.000000000,0,1\n".to_owned();
    let mut at_ns = 10_000_000;
    for step in 0..steps {
        at_ns += 1_000_000 + 16 * (u64::from(step).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 48);
        let _ = write!(table, "{:.9},1,1\n{:.9},0,1\n", at_ns as f64 * 1e-9, (at_ns + 2000) as f64 * 1e-9);
    }
    table
}

/// Opens a file without the experiment, and waits until the views show it.
async fn open(page: &Session, name: &str, text: &str) -> Result<LoadedCapture> {
    choose_file(page, name, text).await?;
    page.until(READY).await?;
    page.click("#recording-compare").await?;
    page.until(READY).await?;
    page.click(SHOW).await?;
    page.until(CLOSED).await?;
    let opened = natively(text, &OpenOptions::default(), None)?;
    page.until_digest(&digest(&opened)).await?;
    page.until(&format!("{MESSAGE}.startsWith('Opened {name}')")).await?;
    Ok(opened)
}

/// Waits until the address has the experiment.
async fn linked(page: &Session) -> Result<()> {
    page.until("history.state?.own === false").await
}

async fn reload(page: &Session) -> Result<()> {
    page.client.refresh().await?;
    page.listen().await?;
    page.ready().await
}

/// The digest of its model.
fn model(opened: &LoadedCapture, name: &str) -> Result<String> {
    Ok(Known::of(&opened.shown_scenario(name, false).to_json())?.digest)
}

/// Accesses the database of recordings, in the page.
async fn database(page: &Session, work: &str) -> Result<()> {
    let script = format!(
        "return new Promise((resolve, reject) => {{
            const opening = indexedDB.open('stepscope', 1);
            opening.onerror = () => reject(opening.error);
            opening.onsuccess = () => {{
                const base = opening.result;
                const stores = base.transaction(['recordings', 'pieces'], 'readwrite');
                const pieces = stores.objectStore('pieces'), facts = stores.objectStore('recordings');
                stores.oncomplete = () => {{ base.close(); resolve(true); }};
                {work}
            }};
        }});"
    );
    page.js::<bool>(&script, Vec::new()).await.map(drop)
}

#[test]
fn a_recording_survives_a_reload_with_and_without_a_link() -> Result<()> {
    in_browser(|page| async move {
        let own = Known::of(&with_distance(800.0))?;
        page.open("").await?;
        page.fill(DISTANCE, "800").await?;
        page.until_digest(&own.digest).await?;
        // Short enough for a link: the address has its scenario.
        let short = open(&page, "short.csv", &wandering(40)).await?;
        linked(&page).await?;
        reload(&page).await?;
        page.until_digest(&digest(&short)).await?;
        let long = open(&page, "long.csv", &wandering(4000)).await?;
        reload(&page).await?;
        page.until_digest(&digest(&long)).await?;
        assert_eq!(page.field("title").await?.value, "recorded: long.csv");
        assert_eq!(page.text("#link-message").await?, "", "there is no message");
        page.until(
            "document.getElementById('status').textContent.replace(/\\u202f/g, '').startsWith('8000 edges')",
        )
        .await?;
        page.click("#undo").await?;
        page.until_digest(&own.digest).await
    })
}

#[test]
fn a_recording_survives_edits_reloads_and_a_new_tab() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.js::<bool>("history.replaceState = () => {}; return true;", Vec::new()).await?;
        // A pulse of another width: the model, which has one width, differs.
        let text = wandering(100).replacen(",0,1\n0.0", ",0,1\n0.009000000,1,1\n0.009500000,0,1\n0.0", 1);
        let opened = open(&page, "mine.csv", &text).await?;
        let (recorded, made) = (digest(&opened), model(&opened, "mine.csv")?);
        ensure!(recorded != made, "the label shows which one is visible");
        // The page was left before the link was in the address.
        assert_eq!(page.eval::<String>("location.hash").await?, "");
        reload(&page).await?;
        page.until_digest(&recorded).await?;
        page.fill("title", "mine.csv!").await?;
        page.until("localStorage.getItem('stepscope.scenario')?.includes('mine.csv!')").await?;
        page.until_digest(&recorded).await?;
        reload(&page).await?;
        page.until_digest(&recorded).await?;
        // A new visit starts with the user's own work.
        page.open("").await?;
        page.until_digest(&recorded).await?;
        // Another experiment has no recording.
        page.open(&format!("#{}", Known::of("{}")?.link)).await?;
        page.until_digest(&Known::of("{}")?.digest).await?;
        page.click("#undo").await?;
        page.until_digest(&recorded).await
    })
}

#[test]
fn storage_failures_are_reported_once_and_show_the_model() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        let text = wandering(100).replacen(",0,1\n0.0", ",0,1\n0.009000000,1,1\n0.009500000,0,1\n0.0", 1);
        let spoilt = [
            // An invalid level, a short piece, falling times, a missing piece, a missing recording, an invalid scenario.
            (
                "pieces.openCursor().onsuccess = ({ target: { result } }) => { if (!result) return; result.value[23] = 0xff; result.update(result.value); result.continue(); };",
                "damaged",
            ),
            (
                "pieces.openCursor().onsuccess = ({ target: { result } }) => { if (!result) return; result.update(result.value.slice(16)); result.continue(); };",
                "damaged",
            ),
            (
                "pieces.openCursor().onsuccess = ({ target: { result } }) => { if (!result) return; result.value.copyWithin(16, 32, 40); result.value[32] = 0; result.value[33] = 0; result.value[34] = 0; result.update(result.value); result.continue(); };",
                "damaged",
            ),
            ("pieces.clear();", "damaged"),
            ("pieces.clear(); facts.clear();", "gone"),
            (
                "facts.openCursor().onsuccess = ({ target: { result } }) => { if (!result) return; result.value.scenario = '{'; result.update(result.value); result.continue(); };",
                "damaged",
            ),
            (
                "facts.openCursor().onsuccess = ({ target: { result } }) => { if (!result) return; result.value.sizes = null; result.update(result.value); result.continue(); };",
                "damaged",
            ),
        ];
        for (work, what) in spoilt {
            let opened = open(&page, "mine.csv", &text).await?;
            linked(&page).await?;
            database(&page, work).await?;
            reload(&page).await?;
            page.until_digest(&model(&opened, "mine.csv")?).await?;
            let gone = "The recording mine.csv is no longer available";
            page.until(&format!("{MESSAGE}.startsWith('{gone}') && {MESSAGE}.includes('{what}')"))
                .await
                .with_context(|| work.to_owned())?;
            reload(&page).await?;
            page.until_digest(&model(&opened, "mine.csv")?).await?;
            sleep(Duration::from_millis(300)).await;
            assert_eq!(page.text("#link-message").await?, "", "{work}: the message is shown once");
        }
        // Storage that fails from the start.
        page.eval::<bool>("(indexedDB.constructor.prototype.open = () => { throw new DOMException('no room', 'QuotaExceededError'); }, true)").await?;
        let opened = open(&page, "mine.csv", &text).await?;
        ensure!(
            page.text("#link-message")
                .await?
                .contains("until you leave this page: the browser cannot save it (no room)")
        );
        linked(&page).await?;
        reload(&page).await?;
        page.until_digest(&model(&opened, "mine.csv")?).await?;
        page.until(&format!("{MESSAGE}.includes('no longer available: the browser cannot save it')")).await?;
        // And invalid lists of it.
        for text in ["{", "7", "null", "[null,5]", "[]"] {
            page.js::<bool>("return (localStorage.setItem('stepscope.recordings', arguments[0]), sessionStorage.setItem('stepscope.recording', arguments[0]), true)", vec![json!(text)]).await?;
            reload(&page).await?;
            page.until_digest(&model(&opened, "mine.csv")?).await?;
        }
        Ok(())
    })
}
