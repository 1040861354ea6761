//! The page's main task and the golden digests, in every engine: `cargo xtask test --only engines`.

use anyhow::{Context, Result, ensure};
use serde_json::json;
use stepscope_core::scenario::presets::{CONTROLLER_PRESETS, PLANT_PRESETS, PRESETS};
use stepscope_tests::golden::CASES;

use crate::{
    bench::in_engine,
    browser::Browser,
    native::{DISTANCE, Known, with_distance},
    session::Session,
};

/// A complete use of the page, from loading to a link that a second user opens; returns this user.
async fn main_job(page: Session) -> Result<Session> {
    let (default, typed) = (Known::of("{}")?, Known::of(&with_distance(1200.0))?);
    page.open("").await?;
    page.until_digest(&default.digest).await?;
    page.canvas("chart-position").await?.has_curve("--ideal")?;

    page.fill(DISTANCE, "1.2k").await?;
    page.until_digest(&typed.digest).await?;
    page.click("#undo").await?;
    page.until_digest(&default.digest).await?;
    page.click("#redo").await?;
    page.until_digest(&typed.digest).await?;

    // Zoom, a cursor on the next edge, a packet.
    let shown = "document.getElementById('window-start').value";
    page.click("#zoom-in").await?;
    page.until(&format!("{shown} !== '0 s'")).await?;
    page.click("#zoom-fit").await?;
    page.until(&format!("{shown} === '0 s'")).await?;
    page.press("#pulses", "n").await?;
    page.until("document.getElementById('cursor-readings').textContent.includes('A')").await?;
    page.click("#packet-3 td").await?;
    page.until("document.querySelector('#packet-3').ariaSelected === 'true'").await?;
    page.until(&format!("{shown} !== '0 s'")).await?;
    ensure!(page.pulses().await?.ink("--step").pixels > 200, "the pulses are drawn");
    page.click("#zoom-fit").await?;

    // Without access to the clipboard the page shows the link for manual copying.
    page.click("#share").await?;
    page.until("!document.getElementById('copy-link').disabled").await?;
    page.click("#copy-link").await?;
    page.until(
        "document.getElementById('copy-link').textContent === 'Copied' || \
         document.getElementById('link-about').textContent.includes('The link is selected')",
    )
    .await?;
    page.until_equal("location.hash.split('&')[0]", &json!(format!("#{}", typed.link))).await?;
    let form = page.form().await?;

    let stranger = page.next_visitor().await?;
    stranger.open(&format!("#{}", typed.link)).await?;
    stranger.until_digest(&typed.digest).await?;
    assert_eq!(stranger.form().await?, form);

    for preset in PRESETS.iter().chain(PLANT_PRESETS).chain(CONTROLLER_PRESETS) {
        let known = Known::preset(preset)?;
        stranger.preset(preset.id).await?;
        stranger.until_digest(&known.digest).await.with_context(|| preset.id)?;
    }
    Ok(stranger)
}

/// A second engine, created like the page's, in its own worker.
const ENGINE: &str = "
    return import(new URL('engine/engine.js', document.baseURI)).then(({ Engine }) => {
        let end;
        const engine = new Engine({
            progress() {}, done: (_, summary) => end(summary.controllers.map(({ digest }) => digest).join('\\n')),
            failed: (_, message) => end(message), crashed: (message) => end(message),
        });
        let number = 0;
        window.plant = () => engine.request('plant').then(({ plant }) => plant.digest);
        window.digests = (json) => new Promise((resolve) => { end = resolve; engine.run(number++, json); });
        return true;
    });";

/// Every golden case has its digests in the page's engine, and every preset with a plant that of the plant.
async fn golden(page: &Session) -> Result<()> {
    page.open("").await?;
    page.js::<bool>(ENGINE, vec![]).await?;
    let mut wrong = Vec::new();
    for case in CASES {
        let json = case.json().map_err(anyhow::Error::msg)?;
        let found: String = page.js("return digests(arguments[0]);", vec![json!(json)]).await?;
        let wanted = case.file("digest").context(case.name)?.trim();
        if found != wanted {
            wrong.push(format!("{}: {found}, wanted {wanted}", case.name));
        }
    }
    for preset in PLANT_PRESETS {
        let known = Known::preset(preset)?;
        let mut run = known.experiment.start();
        while !run.advance_each(u64::MAX, &mut [Vec::new()]) {}
        let wanted = run.results().first().map(|result| format!("{:016x}", result.digest));
        page.js::<String>("return digests(arguments[0]);", vec![json!(preset.json)]).await?;
        let found: String = page.js("return plant();", vec![]).await?;
        if wanted.as_ref() != Some(&found) {
            wrong.push(format!("plant of {}: {found}, wanted {wanted:?}", preset.id));
        }
    }
    ensure!(wrong.is_empty(), "{}", wrong.join("\n"));
    Ok(())
}

/// One browser for both, because starting one takes long.
async fn all(page: Session) -> Result<()> {
    let stranger = main_job(page).await?;
    golden(&stranger).await
}

#[test]
fn chromium_completes_the_main_task_with_the_golden_digests() -> Result<()> {
    in_engine(Browser::Chromium, all)
}

#[test]
fn firefox_completes_the_main_task_with_the_golden_digests() -> Result<()> {
    in_engine(Browser::Firefox, all)
}

#[test]
fn webkit_completes_the_main_task_with_the_golden_digests() -> Result<()> {
    in_engine(Browser::WebKit, all)
}
