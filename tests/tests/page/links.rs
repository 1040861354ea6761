//! Links: the experiment of one user in the browser of another.

use anyhow::{Context, Result, ensure};
use serde_json::json;
use stepscope_core::{
    inspect::trace::{fingerprint::Fingerprint, run_fingerprint::RunFingerprint},
    scenario::{link::with_part, presets::PRESETS},
};

use crate::{
    bench::in_browser,
    native::{DISTANCE, Known, with_distance},
    session::Session,
};

/// Opens Share, copies, and returns the clipboard.
pub(crate) async fn copied(page: &Session) -> Result<String> {
    page.allow_clipboard().await?;
    page.click("#share").await?;
    page.until("!document.getElementById('copy-link').disabled").await?;
    page.click("#copy-link").await?;
    page.until("document.getElementById('copy-link').textContent === 'Copied'").await?;
    page.clipboard().await
}

/// The page's link of a scenario's run.
pub(crate) fn whole(page: &Session, known: &Known) -> String {
    let proof = RunFingerprint::of(vec![Fingerprint::of(&known.recording.trace)]);
    format!("{}#{}", page.address(), with_part(known.link.clone(), "d", &proof.emit()))
}

#[test]
fn a_copied_link_restores_the_form_and_the_digest() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(&with_distance(1200.0))?;
        page.open("").await?;
        page.fill(DISTANCE, "1200").await?;
        page.until_digest(&known.digest).await?;
        let link = copied(&page).await?;
        assert_eq!(link, whole(&page, &known), "the link is the core's, bit by bit, and its digests");

        let stranger = page.stranger().await?;
        let (_, fragment) = link.split_once('#').context("no fragment")?;
        stranger.open(&format!("#{fragment}")).await?;
        stranger.until_digest(&known.digest).await?;
        assert_eq!(stranger.form().await?, page.form().await?);
        let message = stranger.text("#link-message").await?;
        ensure!(message.contains("Undo"), "the way back is named: {message}");
        stranger.click("#undo").await?;
        stranger.until_digest(&Known::of("{}")?.digest).await
    })
}

#[test]
fn links_changed_by_chat_programs_still_open() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(&with_distance(2400.0))?;
        let link = &known.link;
        let encoded = link.replace('=', "%3D").replace('.', "%2E").replace('_', "%5F");
        for copy in [encoded, format!("{link})"), format!("{link})."), format!("{link}&v=broken&d=0")] {
            page.open(&format!("#{copy}")).await?;
            page.until_digest(&known.digest).await.with_context(|| copy.clone())?;
        }
        Ok(())
    })
}

#[test]
fn without_clipboard_access_the_link_can_be_copied_manually() -> Result<()> {
    in_browser(|page| async move {
        page.before_scripts("globalThis.Clipboard && (Clipboard.prototype.writeText = () => Promise.reject(new Error('refused')));").await?;
        page.open("").await?;
        page.click("#share").await?;
        page.until("!document.getElementById('copy-link').disabled").await?;
        page.click("#copy-link").await?;
        page.until("document.getElementById('link-about').textContent.includes('blocked copying')").await?;
        let link = whole(&page, &Known::of("{}")?);
        assert_eq!(page.eval::<String>("document.getElementById('link-text').value").await?, link);
        assert_eq!(page.eval::<String>("getSelection().toString()").await?, link, "it is selected");
        Ok(())
    })
}

#[test]
fn the_address_follows_edits_without_adding_to_the_history() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        let before: u32 = page.eval("history.length").await?;
        for steps in ["1.2k", "800", "2400"] {
            page.fill(DISTANCE, steps).await?;
        }
        let known = Known::of(&with_distance(2400.0))?;
        page.until_equal("location.hash", &json!(format!("#{}", known.link))).await?;
        assert_eq!(page.eval::<u32>("history.length").await?, before);
        Ok(())
    })
}

#[test]
fn a_link_pasted_into_the_address_opens_and_can_be_undone() -> Result<()> {
    in_browser(|page| async move {
        let own = Known::of(&with_distance(800.0))?;
        let preset = PRESETS.first().context("there are presets")?;
        let shared = Known::preset(preset)?;
        page.open("").await?;
        page.fill(DISTANCE, "800").await?;
        page.until_digest(&own.digest).await?;
        let form = page.form().await?;
        page.follow(&shared.link).await?;
        page.until_digest(&shared.digest).await?;
        ensure!(
            page.text("#link-message").await?.contains(&shared.scenario.title),
            "the link's name is shown"
        );

        page.click("#undo").await?;
        page.until_digest(&own.digest).await?;
        let (mut now, mut then) = (page.form().await?, form);
        // The same value, in the page's own format.
        ensure!(now.remove(DISTANCE) == Some(json!("800")) && then.remove(DISTANCE).is_some());
        assert_eq!(now, then);
        page.until_equal("location.hash", &json!(format!("#{}", own.link))).await
    })
}

#[test]
fn work_is_restored_after_a_visit_with_a_link() -> Result<()> {
    in_browser(|page| async move {
        let own = Known::of(&with_distance(800.0))?;
        let shared = Known::preset(PRESETS.first().context("there are presets")?)?;
        page.open("").await?;
        page.fill(DISTANCE, "800").await?;
        page.until_digest(&own.digest).await?;
        page.open(&format!("#{}", shared.link)).await?;
        page.until_digest(&shared.digest).await?;
        // Its message is shown once, and can be closed.
        page.until("document.getElementById('link-message').textContent.startsWith('Shared with you')")
            .await?;
        page.click("#link-message .close").await?;
        ensure!(!page.visible("#link-message").await?);
        page.until(&format!("location.hash.startsWith('#{}')", shared.link)).await?;
        // The address becomes the page's own a short time after an edit.
        page.until("history.state?.own === false").await?;
        page.client.refresh().await?;
        page.until_digest(&shared.digest).await?;
        ensure!(!page.visible("#link-message").await?, "a reload is no news");
        page.open("").await?;
        page.until_digest(&own.digest).await
    })
}
