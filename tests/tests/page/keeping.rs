//! Nothing that a visitor typed is lost: over a reload, behind a link, beside a field that is gone.

use anyhow::{Result, ensure};

use crate::{
    bench::in_browser,
    native::{Known, with_distance},
};

const DISTANCE: &str = "source.motion.axes[0].moves[0].cosine.distance";
const SAVED: &str = "localStorage.getItem('stepscope.scenario') ?? ''";

#[test]
fn work_with_a_problem_in_it_survives_a_reload_and_is_no_link() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.fill("bus.queue_depth", "7").await?;
        page.until(&format!("{SAVED}.includes('\"queue_depth\":7')")).await?;
        page.ready().await?;
        page.fill(DISTANCE, "0").await?;
        page.until("document.querySelector('#status').textContent.startsWith('not run')").await?;
        page.click("#share").await?;
        ensure!(page.text("#link-about").await?.starts_with("No link yet"), "a link of what does not stand");
        ensure!(page.eval::<bool>("document.getElementById('copy-link').disabled").await?, "nothing to copy");

        page.open("").await?;
        assert_eq!(page.field("bus.queue_depth").await?.value, "7");
        assert_eq!(page.field(DISTANCE).await?.value, "0");
        assert_eq!(page.text("#link-message").await?, "");
        // The views show what ran last, dimmed.
        let last = Known::of(r#"{"bus":{"queue_depth":7}}"#)?;
        page.until_equal("document.getElementById('digest').textContent", &last.digest.into()).await?;
        page.ready().await?;
        ensure!(page.shown().await?.stale, "it is shown as what it is not");
        page.until("document.getElementById('views').className === 'views dim'").await?;
        page.canvas("chart-position").await?.has_curve("--ideal")?;
        let mended = with_distance(500.0).replacen('{', r#"{"bus":{"queue_depth":7},"#, 1);
        page.fill(DISTANCE, "500").await?;
        page.until_digest(&Known::of(&mended)?.digest).await
    })
}

#[test]
fn work_from_before_an_edited_link_comes_back_by_undo_after_a_reload() -> Result<()> {
    in_browser(|page| async move {
        let (own, shared) = (Known::of(&with_distance(1234.0))?, Known::of(&with_distance(800.0))?);
        page.open("").await?;
        page.fill(DISTANCE, "1234").await?;
        page.until_digest(&own.digest).await?;
        page.open(&format!("#{}", shared.link)).await?;
        page.until_digest(&shared.digest).await?;
        page.fill(DISTANCE, "801").await?;
        page.until_digest(&Known::of(&with_distance(801.0))?.digest).await?;

        page.open("").await?;
        page.until_digest(&Known::of(&with_distance(801.0))?.digest).await?;
        page.click("#undo").await?;
        page.until_digest(&own.digest).await
    })
}

#[test]
fn what_was_typed_into_a_field_that_is_gone_holds_nothing() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.fill("source.motion.axes[0].moves[0].cosine.duration_s", "zz").await?;
        page.until("document.querySelector('#digest').classList.contains('stale')").await?;
        page.choose("[data-path='source#kind']", "packets").await?;
        page.until("!document.querySelector('#status').textContent.startsWith('not run')").await?;
        page.ready().await
    })
}
