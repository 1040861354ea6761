//! Broken, newer, hostile or expensive links: a clear message, and never a blank page.

use anyhow::{Context, Result, ensure};
use miniz_oxide::deflate::compress_to_vec;

use crate::{
    bench::in_browser,
    native::{Known, forged, refusal, with_distance},
    session::Session,
};

/// Checks that the page has the default motion, and a message on the link.
async fn refused(page: &Session, what: &str, fragment: &str, says: &str) -> Result<()> {
    page.open(&format!("#{fragment}")).await?;
    page.until_digest(&Known::of("{}")?.digest).await.with_context(|| what.to_owned())?;
    page.canvas("chart-position").await?.has_curve("--ideal").with_context(|| what.to_owned())?;
    ensure!(page.visible("#link-message").await?, "{what}: no message");
    let message = page.text("#link-message").await?;
    let core = refusal(fragment)?;
    ensure!(message.contains(&core), "{what}: `{message}`, wanted `{core}`");
    ensure!(message.contains(says), "{what}: `{message}` does not contain `{says}`");
    Ok(())
}

#[test]
fn an_invalid_link_shows_the_reason_and_the_default_motion() -> Result<()> {
    in_browser(|page| async move {
        let link = Known::of(&with_distance(1200.0))?.link;
        let cut = link.get(..link.len() - 12).context("long enough")?;
        let (head, tail) = link.split_at(link.len() / 2);
        let flipped = if tail.starts_with('A') { 'B' } else { 'A' };
        let flipped = format!("{head}{flipped}{}", tail.get(1..).unwrap_or_default());
        let bomb = forged('z', &compress_to_vec(&vec![b' '; 10 << 20], 10));
        ensure!(bomb.len() > 10_000 && bomb.len() < 16_384, "a bomb of {} characters", bomb.len());
        let rows = [
            ("cut short", cut.to_owned(), "cut short"),
            ("one character changed", flipped, "cut short or changed"),
            ("from a newer version", "c=7.z.AAAA.00000000".to_owned(), "newer version of Stepscope"),
            ("a deflate bomb", bomb, "more than 65536 bytes"),
            ("out of range", forged('j', br#"{"bus":{"slots":200,"queue_depth":0}}"#), "bus.slots"),
            ("two out of range", forged('j', br#"{"bus":{"slots":200,"queue_depth":0}}"#), "bus.queue_depth"),
            ("a prototype", forged('j', br#"{"__proto__":{"polluted":1}}"#), "__proto__"),
            (
                "a constructor",
                forged('j', br#"{"bus":{"constructor":{"prototype":{"polluted":1}}}}"#),
                "bus.constructor",
            ),
            ("no scenario", "d=0123456789abcdef".to_owned(), "no scenario"),
            ("too long", format!("c=1.j.{}", "A".repeat(17_000)), "too long"),
            ("no JSON", forged('j', b"<script>alert(1)</script>"), "scenario"),
        ];
        for (what, fragment, says) in rows {
            refused(&page, what, &fragment, says).await?;
        }
        ensure!(page.eval::<bool>("({}).polluted === undefined").await?, "the prototype is polluted");
        Ok(())
    })
}

#[test]
fn markup_in_a_link_is_only_text() -> Result<()> {
    in_browser(|page| async move {
        let json = r#"{"title":"<img src=x onerror=\"window.hit=1\">","note":"</textarea><script>window.hit=1</script>"}"#;
        let known = Known::of(json)?;
        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        ensure!(page.text("#link-message").await?.contains("<img src=x"), "the name is shown as it is");
        assert_eq!(page.field("title").await?.value, known.scenario.title);
        assert_eq!(page.field("note").await?.value, known.scenario.note);
        ensure!(page.eval::<bool>("window.hit === undefined && !document.querySelector('body img')").await?);
        Ok(())
    })
}

/// More edges than a run without a confirmation may have: 2.2 million steps.
const MUCH: &str = r#"{"title":"Two million steps","source":{"motion":{"axes":[{"moves":[
    {"cosine":{"distance":{"steps":2200000},"duration_s":60,"ramp_s":10}}]}]}}}"#;

#[test]
fn a_link_with_too_much_work_waits_for_confirmation() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(MUCH)?;
        ensure!(known.experiment.cost().records > 4_000_000, "{:?}", known.experiment.cost());
        page.open(&format!("#{}", known.link)).await?;
        ensure!(page.visible("#run-anyway").await?, "there is no button to run it");
        let word = page.text("#budget").await?;
        ensure!(word.contains("edges") && word.contains("Not run"), "the cost is shown: {word}");
        let distance = page.field("source.motion.axes[0].moves[0].cosine.distance").await?;
        assert_eq!(distance.value, "2200000");
        // A run would have been requested by now; one more request gets its reply after that.
        page.click("#share").await?;
        page.until(
            "document.getElementById('link-about').textContent.includes('the experiment has not run')",
        )
        .await?;
        page.press("#link-text", "\u{e00c}").await?;
        page.ready().await?;
        let shown = page.shown().await?;
        ensure!(
            shown.digest != known.digest && shown.digest.len() != 16,
            "it ran without a confirmation: {shown:?}"
        );

        page.click("#run-anyway").await?;
        page.until_digest(&known.digest).await?;
        page.canvas("chart-position").await?.has_curve("--ideal")?;
        ensure!(!page.visible("#budget").await?, "the question stays");
        Ok(())
    })
}

#[test]
fn a_long_run_shows_its_progress_and_can_be_canceled() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(&MUCH.replace("2200000", "22000000").replace(":60", ":600"))?;
        page.open(&format!("#{}", known.link)).await?;
        page.click("#run-anyway").await?;
        page.until("document.getElementById('status').textContent.includes('%')").await?;
        let status = page.text("#status").await?;
        ensure!(status.contains('%') && status.contains("edges"), "progress in numbers: {status}");
        page.click("#cancel").await?;
        page.until("document.getElementById('progress').hidden").await?;
        page.ready().await?;
        ensure!(page.text("#engine-message").await?.contains("canceled"), "no message reports the cancel");
        assert_ne!(page.shown().await?.digest, known.digest);
        page.click("#undo").await?;
        page.until_digest(&Known::of("{}")?.digest).await
    })
}
