//! The framed protocol on the page: frames, replies, and their outcomes on a noisy line.

use anyhow::{Result, ensure};
use stepscope_core::inspect::packets::log::RowOutcome;
use stepscope_core::peripheral::protocol::FrameOutcome;

use crate::{
    bench::in_browser,
    native::{Known, problems},
    session::{Session, WINDOW_S, field},
};

const FRAMED: &str = r#"{"line":{"protocol":"framed"}}"#;

/// Classes of the visible rows of packets, by their numbers.
async fn classes(page: &Session) -> Result<Vec<String>> {
    page.eval("[...document.querySelectorAll('#packets tbody tr')].map((row) => row.className)").await
}

#[test]
fn a_framed_line_shows_frames_with_their_ticks_and_replies() -> Result<()> {
    in_browser(|page| async move {
        let (raw, framed) = (Known::of("{}")?, Known::of(FRAMED)?);
        page.open("").await?;
        page.until_digest(&raw.digest).await?;
        ensure!(
            !page.visible(&field("line.host.max_attempts")).await?,
            "a raw line's host waits for nothing"
        );
        ensure!(classes(&page).await?.iter().all(|class| class.contains("packet")));

        page.choose(&field("line.protocol"), "framed").await?;
        page.until_digest(&framed.digest).await?;
        ensure!(page.visible(&field("line.host.max_attempts")).await?, "the host's settings are hidden");
        let ticks = framed.experiment.ticks_of(0).len();
        let health = page.text("#health").await?;
        assert_eq!(health.replace('\u{202f}', ""), format!("all {ticks} ticks done"));
        let shown = classes(&page).await?;
        for (index, row) in framed.recording.packets.rows().iter().enumerate().take(shown.len()) {
            let kind = if matches!(row.outcome, RowOutcome::Reply(_)) { "reply" } else { "frame" };
            ensure!(shown[index].contains(kind), "row {index} is {}", shown[index]);
        }
        page.pulses().await?;
        page.picture("framed").await?;

        // The first TICKS frame: its bytes, the reply, and all its ticks.
        let first = |row: &&stepscope_core::inspect::packets::log::LoggedPacket| {
            matches!(row.outcome, RowOutcome::Frame(FrameOutcome::Queued(_)))
        };
        let rows = framed.recording.packets.rows();
        let (index, row) = rows.iter().enumerate().find(|(_, row)| first(row)).expect("it queues ticks");
        // It may be below the visible part.
        page.eval::<bool>(&format!(
            "(() => {{ const height = document.querySelector('#packets tbody tr').offsetHeight;
             document.getElementById('packets-scroll').scrollTop = {index} * height; return true; }})()"
        ))
        .await?;
        page.until(&format!("document.getElementById('packet-{}') !== null", index + 1)).await?;
        let said = page.text(&format!("#packet-{index} td:nth-child(4)")).await?;
        ensure!(said.starts_with("\u{2192} to 0: TICKS seq 0, 8 ticks"), "{said}");
        let answer = page.text(&format!("#packet-{} td:nth-child(4)", index + 1)).await?;
        ensure!(answer.starts_with("\u{2190} from 0: ACK TICKS"), "{answer}");
        let whole = page.eval::<(f64, f64)>(WINDOW_S).await?;
        page.click(&format!("#packet-{index} td")).await?;
        page.until(&format!("({WINDOW_S})[1] < {}", whole.1)).await?;
        let (start, end): (f64, f64) = page.eval(WINDOW_S).await?;
        ensure!(start <= framed.seconds(row.start.0) && framed.seconds(row.end.0) <= end);
        let last = framed.seconds(row.tick_end.map_or(0, |at| at.0));
        ensure!(last <= end, "the ticks up to {last} s are not in {start} to {end}");

        page.click("#undo").await?;
        page.until_digest(&raw.digest).await?;
        assert_eq!(page.text("#health").await?, "");
        ensure!(!page.visible(&field("line.host.max_attempts")).await?);
        page.click("#redo").await?;
        page.until_digest(&framed.digest).await
    })
}

#[test]
fn repetitions_overcome_noise_and_its_seed_changes_the_run() -> Result<()> {
    let with = |seed: u32| {
        format!(r#"{{"line":{{"protocol":"framed","noise":{{"seed":{seed},"flipped_bits_ppm":1000}}}}}}"#)
    };
    in_browser(move |page| async move {
        page.open("").await?;
        page.choose(&field("line.protocol"), "framed").await?;
        page.until_digest(&Known::of(FRAMED)?.digest).await?;
        page.fill("line.noise.flipped_bits_ppm", "1k").await?;
        let (zero, seven) = (Known::of(&with(0))?, Known::of(&with(7))?);
        page.until_digest(&zero.digest).await?;
        page.fill("line.noise.seed", "7").await?;
        page.until_digest(&seven.digest).await?;
        let health = page.text("#health").await?;
        ensure!(health.contains("ticks done") && health.contains("repeated"), "{health}");
        ensure!(health.contains("CRC"), "broken frames leave a fault: {health}");
        assert_eq!(seven.recording.packets.ticks().len(), seven.experiment.ticks_of(0).len());

        page.click("#undo").await?;
        page.until_digest(&zero.digest).await?;
        page.click("#undo").await?;
        page.until_digest(&Known::of(FRAMED)?.digest).await
    })
}

#[test]
fn the_header_reports_a_host_that_gives_up() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.choose(&field("line.protocol"), "framed").await?;
        page.fill("line.noise.lost_replies_ppm", "1M").await?;
        page.until("document.getElementById('health').textContent.startsWith('gave up: no reply')").await?;
        ensure!(page.eval::<bool>("document.getElementById('health').classList.contains('error')").await?);
        Ok(())
    })
}

#[test]
fn errors_of_host_and_noise_are_shown_at_their_field() -> Result<()> {
    let rows = [
        ("line.host.ticks_per_frame", "33", r#"{"line":{"host":{"ticks_per_frame":33}}}"#),
        ("line.host.max_attempts", "0", r#"{"line":{"host":{"attempts":0}}}"#),
        ("line.host.reply_timeout_cycles", "0", r#"{"line":{"host":{"reply_timeout_cycles":0}}}"#),
        ("line.noise.host_crashes_ppm", "1000001", r#"{"line":{"noise":{"host_crashes_ppm":1000001}}}"#),
        ("line.noise.seed", "-1", r#"{"line":{"noise":{"seed":-1}}}"#),
    ];
    in_browser(move |page| async move {
        page.open("").await?;
        page.choose(&field("line.protocol"), "framed").await?;
        page.until_digest(&Known::of(FRAMED)?.digest).await?;
        for (path, typed, json) in rows {
            page.fill(path, typed).await?;
            page.ready().await?;
            let shown = page.field(path).await?;
            let found = problems(json);
            assert_eq!(found.len(), 1, "{json}");
            let message = found[0].cause.to_string();
            ensure!(shown.invalid && shown.error.contains(&message), "{path}: {shown:?}, wanted {message}");
            page.click("#undo").await?;
            page.until_digest(&Known::of(FRAMED)?.digest).await?;
        }
        Ok(())
    })
}
