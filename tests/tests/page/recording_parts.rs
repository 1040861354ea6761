//! Parts of a recording: the file stays available for another part while the recording is visible; the overview; and the
//! transfer of its records to the engine.

use std::time::Duration;

use anyhow::{Result, ensure};
use serde_json::json;
use stepscope_core::inspect::recording::open_options::OpenOptions;
use tokio::time::sleep;

use crate::{
    bench::in_browser,
    native::{DISTANCE, Known, with_distance},
    recording::{CLOSED, MESSAGE, READY, SHOW, choose_file, cosine, digest, natively, says, type_into},
    session::{CONTROL, Session},
};

/// The button for another part of these files.
const AGAIN: &str = "[...document.querySelectorAll('#on-show button')].map((button) => button.getAttribute('aria-label')).join()";
/// Counts the ended workers, and the requests to that of a file.
const WATCH: &str = "window.ended = 0; window.overviews = 0; window.failing = false;
    const { terminate, postMessage } = Worker.prototype;
    Worker.prototype.terminate = function () { window.ended += 1; terminate.call(this); };
    Worker.prototype.postMessage = function (message, ...more) {
        if (message.method !== 'overview') return postMessage.call(this, message, ...more);
        window.overviews += 1;
        return postMessage.call(this, window.failing ? { ...message, method: 'nothing' } : message, ...more);
    };
    return true;";
/// The overview of a recording: its text, and whether something is drawn.
const SAID: &str = "document.querySelector('.whole p')?.textContent";
const DRAWN: &str = "(() => { const canvas = document.querySelector('.whole canvas');
    return canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.some((part) => part > 0); })()";

/// Shows a part of a file.
async fn show_part(page: &Session, name: &str, text: &str) -> Result<()> {
    choose_file(page, name, text).await?;
    says(page, "200 steps").await?;
    page.click("dialog.recording [aria-label='Show a part: enter its start and end']").await?;
    type_into(page, "Show from", "0.1").await?;
    type_into(page, "Show up to", "150 ms").await?;
    says(page, "Shown: 100 ms to 150 ms").await?;
    page.until(READY).await?;
    page.click(SHOW).await?;
    page.until(CLOSED).await?;
    page.until_equal(AGAIN, &json!(format!("Show another part of {name}"))).await
}

#[test]
fn the_file_of_a_part_is_released_when_no_longer_shown() -> Result<()> {
    in_browser(|page| async move {
        let own = Known::of(&with_distance(800.0))?;
        page.open("").await?;
        page.fill(DISTANCE, "800").await?;
        page.until_digest(&own.digest).await?;
        page.js::<bool>(WATCH, Vec::new()).await?;
        let text = cosine();
        let ended = "window.ended";
        for (file, way) in ["undo", "preset", "source", "link", "keys"].into_iter().enumerate() {
            show_part(&page, "mine.csv", &text).await?;
            page.fill("title", &format!("part {file}")).await?;
            page.until(&format!("document.title.startsWith('part {file}')")).await?;
            page.ready().await?;
            assert_eq!(page.eval::<usize>(ended).await?, file, "it is still on show");
            match way {
                "undo" => {
                    page.click("#undo").await?;
                    page.click("#undo").await?;
                }
                "preset" => page.preset("exact-sine").await?,
                "source" => page.fill("clock_hz", "8000000").await?,
                "link" => page.follow(&own.link).await?,
                // Its dialog is removed with it.
                _ => {
                    page.click("#on-show button").await?;
                    page.until(READY).await?;
                    page.click("dialog.recording h2").await?;
                    let undo = format!("{CONTROL}z");
                    page.press(SHOW, &undo).await?;
                    page.press(SHOW, &undo).await?;
                    page.until(CLOSED).await?;
                }
            }
            page.until_equal(ended, &json!(file + 1)).await?;
            page.until_equal(AGAIN, &json!("")).await?;
        }
        // With a part of another file, only that file has the button.
        show_part(&page, "mine.csv", &text).await?;
        show_part(&page, "other.csv", &text).await?;
        assert_eq!(page.eval::<usize>(ended).await?, 6);
        Ok(())
    })
}

#[test]
fn the_overview_is_requested_once_per_width() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.ready().await?;
        page.js::<bool>(WATCH, Vec::new()).await?;
        choose_file(&page, "mine.csv", &cosine()).await?;
        let seen = format!("{SAID}?.includes('position 0 to 200 steps')");
        page.until(&seen).await?;
        page.until(READY).await?;
        page.until_equal("window.overviews", &json!(1)).await?;
        // As while a window's edge is dragged.
        let widths = "const whole = document.querySelector('.whole');
            return (async () => {
                for (let width = 300; width < 320; width++) {
                    whole.style.width = `${width}px`;
                    await new Promise(requestAnimationFrame);
                    await new Promise(requestAnimationFrame);
                }
                return true;
            })();";
        page.js::<bool>(widths, Vec::new()).await?;
        ensure!(page.eval::<bool>(DRAWN).await?, "it is there all the time");
        page.until("window.overviews > 1").await?;
        sleep(Duration::from_millis(500)).await;
        let asked: u32 = page.eval("window.overviews").await?;
        ensure!((2..=4).contains(&asked), "{asked} for 20 widths");

        // After a failure the old overview is removed, and everything else is unchanged.
        page.eval::<bool>("window.failing = true").await?;
        type_into(&page, "Clock", "8000000").await?;
        says(&page, "at 8 MHz").await?;
        page.until(&format!("{SAID}?.startsWith('The overview of channel 0 cannot be loaded: ')")).await?;
        ensure!(!page.eval::<bool>(DRAWN).await?);
        says(&page, "200 steps, 200 right and 0 left").await?;
        page.until(READY).await?;
        page.eval::<bool>("(window.failing = false, true)").await?;
        type_into(&page, "Clock", "16000000").await?;
        page.until(&seen).await?;
        ensure!(page.eval::<bool>(DRAWN).await?);
        page.click(SHOW).await?;
        page.until(CLOSED).await?;

        // The sample rate determines the duration, regardless of the clock.
        let samples: String = (0..400).map(|at| format!("{}\n", u8::from(at % 20 < 2))).collect();
        choose_file(&page, "samples.csv", &format!("STEP\n{samples}")).await?;
        says(&page, "has no sample rate").await?;
        type_into(&page, "Clock", "1000000").await?;
        for (rate, end) in [("1000", "399 ms"), ("2000", "199.5 ms")] {
            type_into(&page, "Sample rate", rate).await?;
            page.until(&format!("{SAID}?.replace(/[\\u202f\\u00a0]/g, ' ').startsWith('Channel 0, {end}')"))
                .await?;
        }
        Ok(())
    })
}

#[test]
fn a_run_waits_for_its_recording_and_a_newer_run_does_not() -> Result<()> {
    in_browser(|page| async move {
        let own = Known::of(&with_distance(800.0))?;
        page.open("").await?;
        page.fill(DISTANCE, "800").await?;
        page.until_digest(&own.digest).await?;
        let late = "window.late = []; const post = Worker.prototype.postMessage;
            Worker.prototype.postMessage = function (message, ...more) {
                if (message.piece && window.late) window.late.push(() => post.call(this, message, ...more));
                else post.call(this, message, ...more);
            };
            return true;";
        page.js::<bool>(late, Vec::new()).await?;
        let text = cosine();
        choose_file(&page, "mine.csv", &text).await?;
        page.until(READY).await?;
        page.click("#recording-compare").await?;
        page.until(READY).await?;
        page.click(SHOW).await?;
        page.until(&format!("{MESSAGE}.startsWith('Opened mine.csv')")).await?;
        page.until("window.late.length === 1").await?;
        page.click("#undo").await?;
        page.until_digest(&own.digest).await?;
        page.click("#redo").await?;
        sleep(Duration::from_millis(300)).await;
        ensure!(page.eval::<bool>("document.documentElement.dataset.state === 'busy'").await?, "it waits");
        page.eval::<bool>("(window.late.splice(0).forEach((send) => send()), true)").await?;
        page.until_digest(&digest(&natively(&text, &OpenOptions::default(), None)?)).await
    })
}
