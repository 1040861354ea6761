//! A recording in the views: its acceleration at the cursors, its replies in the packet table, its label, and a
//! part that is selected in the overview.

use std::io::Cursor;

use anyhow::{Context, Result, ensure};
use serde_json::json;
use stepscope_core::inspect::trace::stored_run::StoredRun;
use stepscope_core::{
    capture::read::{Limits, read},
    inspect::{
        motion::{actual_motion::Pulses, cursor_stats},
        packets::packet_table::PacketTable,
        recording::{
            loaded_capture::{LoadedCapture, Part},
            open_options::OpenOptions,
        },
    },
    peripheral::{
        signal::{Levels, Record},
        units::Instant,
    },
};

use crate::{
    bench::in_browser,
    cursors,
    native::{DISTANCE, Known, with_distance},
    recording::{
        CLOSED, MESSAGE, READY, SHOW, choose_file, cosine, digest, natively, saleae, says, type_into,
    },
    session::{ALT, RELEASE, SHIFT, Session},
};

/// Whether the header shows that the views show a recording.
const ON_SHOW: &str = "document.getElementById('on-show').checkVisibility()";
const RIGHT: char = '\u{e014}';
/// The times of the part in the dialog.
const TIMES: &str =
    "['from', 'up-to'].map((name) => document.getElementById(`recording-show-${name}`).value)";
/// Additional delay of a recorded device's replies, relative to the model, in cycles.
const LATER: u64 = 500;

/// Shows the recording of the dialog, without the experiment.
async fn show(page: &Session) -> Result<()> {
    page.until(READY).await?;
    if page.visible("#recording-compare").await? {
        page.click("#recording-compare").await?;
        page.until(READY).await?;
    }
    page.click(SHOW).await?;
    page.until(CLOSED).await
}

#[test]
fn a_recordings_acceleration_is_read_at_both_cursors() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.ready().await?;
        let text = cosine();
        choose_file(&page, "mine.csv", &text).await?;
        show(&page).await?;
        let opened = natively(&text, &OpenOptions::default(), None)?;
        page.until_digest(&digest(&opened)).await?;
        page.until("document.getElementById('caption-acceleration').textContent.includes('over 8 steps')")
            .await?;
        let mut cycles = Vec::new();
        for which in ["a", "b"] {
            let css = format!("#charts-handles .handle.{which}");
            // Shift moves cursor A, Alt cursor B, from the middle.
            let key = if which == "a" { SHIFT } else { ALT };
            page.press("#charts", &format!("{key}{RIGHT}{RELEASE}")).await?;
            if which == "b" {
                page.press(&css, &format!("{SHIFT}{}{RELEASE}", RIGHT.to_string().repeat(10))).await?;
            }
            let after = cycles.last().copied();
            let look = async || Ok(cursors::cycle(&page, &css).await?.filter(|cycle| Some(*cycle) > after));
            cycles.push(page.eventually("a cursor", look).await?);
        }
        let steps = opened.steps_of(0);
        let pulses = Pulses::recorded(0, &steps, opened.clock_hz);
        let [a, b] = [cycles[0], cycles[1]].map(|cycle| cycle as f64 / pulses.hz());
        let between = cursor_stats::actual_acceleration(&pulses, a, b).context("it is known there")?;
        let at = [a, b].map(|at| pulses.acceleration_at(at));
        let expected = [
            at[0].context("at A")?,
            at[1].context("at B")?,
            at[1].context("at B")? - at[0].context("at A")?,
            between.mean,
            between.rms,
        ];
        ensure!(at[0] != at[1] && between.rms > 100.0, "{expected:?}");
        let cells = "[...document.querySelectorAll('#between-tables tbody tr:nth-child(3) td')].map((cell) => cell.textContent.replace('\u{2212}', '-'))";
        page.until(&format!("{cells}.length === 5")).await?;
        let found: Vec<String> = page.eval(cells).await?;
        for (found, expected) in found.iter().zip(expected) {
            let found: f64 = found.parse().with_context(|| found.clone())?;
            ensure!((found - expected).abs() <= 1e-5 * expected.abs(), "{found}, wanted {expected}");
        }
        let said = page.text("#between-tables").await?;
        ensure!(said.contains("rate of the next eight steps minus rate of the eight steps before"), "{said}");
        let read = cursors::reading(&page.text("#read-acceleration").await?, "actual")?;
        ensure!(
            (read - expected[0]).abs() <= 1e-5 * expected[0].abs(),
            "{read} at A, wanted {}",
            expected[0]
        );
        page.picture("recording-acceleration").await
    })
}

/// Both lines of a run, with a device that replies later, and the pulses of a motor, if there are some.
fn with_late_replies(trace: &[Record], clock_hz: u32) -> String {
    let mut changes: Vec<(u64, u64, bool)> = Vec::new();
    let mut before = Levels::RESET;
    for record in trace {
        for (mask, later) in [(Levels::RX, 0), (Levels::TX, LATER), (1, 0)] {
            if record.levels.has(mask) != before.has(mask) {
                changes.push((record.cycle.0 + later, mask, record.levels.has(mask)));
            }
        }
        before = record.levels;
    }
    changes.sort_unstable();
    let mut levels = Levels::RESET.0;
    let mut trace: Vec<Record> = vec![Record { cycle: Instant(0), levels: Levels(levels) }];
    for (cycle, mask, high) in changes {
        levels = if high { levels | mask } else { levels & !mask };
        trace.push(Record { cycle: Instant(cycle), levels: Levels(levels) });
    }
    saleae(&trace, clock_hz, &[("RX", Levels::RX), ("TX", Levels::TX), ("STEP", 1)])
}

#[test]
fn recorded_replies_and_turnarounds_survive_a_reload() -> Result<()> {
    in_browser(|page| async move {
        let framed = Known::of(r#"{"line":{"protocol":"framed"}}"#)?;
        page.open(&format!("#{}", framed.link)).await?;
        page.until_digest(&framed.digest).await?;
        let clock_hz = framed.experiment.config().clock_hz();
        choose_file(&page, "link.csv", &with_late_replies(&framed.recording.trace, clock_hz)).await?;
        says(&page, "TX: 115200 baud").await?;
        show(&page).await?;
        // The model's table has the same number of rows.
        page.until(ON_SHOW).await?;
        let run = framed.experiment.run(&mut StoredRun::default());
        let table = PacketTable::new(&framed.experiment, &run, 0, &framed.recording.packets);
        let rows = table.len();
        let turnaround = table.detail(1).and_then(|reply| reply.turnaround_cycles).context("a reply")?;
        page.until(&format!("document.getElementById('packets-count').textContent.replace(/\\u202f/g, '').startsWith('{rows} on the line')")).await?;
        for after in ["", "a reload"] {
            page.until("document.querySelector('#packet-1')?.classList.contains('reply')")
                .await
                .context(after)?;
            let hex = page.text("#packet-1 td:nth-child(3)").await?;
            let bytes: Vec<String> = table.bytes(1).iter().map(|byte| format!("{byte:02x}")).collect();
            ensure!(bytes.join(" ").starts_with(hex.trim_end_matches('\u{2026}').trim()), "{hex}");
            page.click("#packet-1 td").await?;
            page.until("document.getElementById('packet-detail').textContent.startsWith('#1 ')").await?;
            page.eval::<bool>("(document.getElementById('packet-inspector').open = true)").await?;
            page.until("document.getElementById('packet-facts').textContent.includes('turnaround')").await?;
            let facts: String = page.eval("document.getElementById('packet-facts').textContent").await?;
            // A reply starts at the detected start bit: within one bit of the cycle in which it was sent.
            let said = facts.split_once("turnaround").context("it answers")?.1.trim().to_owned();
            let micros: f64 = said
                .split(['\u{a0}', ' ', '\u{202f}'])
                .next()
                .context("a number")?
                .parse()
                .with_context(|| said.clone())?;
            let expected = (turnaround + LATER) as f64 / f64::from(clock_hz) * 1e6;
            ensure!((micros - expected).abs() < 2.0, "{said}, wanted {expected} us");
            ensure!(said.contains("after the end of #0") && !said.contains("DE rises"), "{said}");
            if after.is_empty() {
                page.picture("recording-replies").await?;
                page.until("history.state?.own === false").await?;
                page.client.refresh().await?;
                page.listen().await?;
                page.ready().await?;
            }
        }
        Ok(())
    })
}

#[test]
fn the_header_labels_a_recording_and_is_short_on_phones() -> Result<()> {
    in_browser(|page| async move {
        let own = Known::of(&with_distance(800.0))?;
        page.open("").await?;
        page.fill(DISTANCE, "800").await?;
        page.until_digest(&own.digest).await?;
        ensure!(!page.eval::<bool>(ON_SHOW).await?, "the model's run is on show");
        let text = cosine();
        choose_file(&page, "mine.csv", &text).await?;
        show(&page).await?;
        page.until_digest(&digest(&natively(&text, &OpenOptions::default(), None)?)).await?;
        page.until(ON_SHOW).await?;
        page.until(&format!("{MESSAGE}.startsWith('Opened mine.csv. The views show the recording.')"))
            .await?;
        // Its message can be closed: the label stays.
        page.click("#link-message .close").await?;
        ensure!(page.eval::<bool>(ON_SHOW).await?);
        page.fill("title", "another name").await?;
        page.until("document.title.startsWith('another name')").await?;
        ensure!(page.eval::<bool>(ON_SHOW).await?, "a name changes nothing of what is on show");
        // With another source the views show the model.
        page.fill("source.segments.channels[0].start_cycle", "801").await?;
        page.until(&format!("!{ON_SHOW}")).await?;

        page.screen(390, 844).await?;
        choose_file(&page, "mine.csv", &text).await?;
        show(&page).await?;
        page.until(ON_SHOW).await?;
        page.until(&format!("{MESSAGE}.startsWith('Opened mine.csv.')")).await?;
        let height: f64 =
            page.eval("document.getElementById('link-message').getBoundingClientRect().height").await?;
        ensure!(height <= 96.0, "{height} of 844 pixels: {}", page.text("#link-message").await?);
        page.picture("recording-phone").await
    })
}

#[test]
fn a_part_is_selected_by_dragging_on_the_overview() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.ready().await?;
        let text = cosine();
        choose_file(&page, "mine.csv", &text).await?;
        let whole = "document.querySelector('.whole canvas')";
        let seen = format!("{whole}?.getAttribute('aria-label')?.includes('position 0 to 200 steps')");
        page.until(&seen).await?;
        let drawn = format!(
            "(() => {{ const {{ data }} = {whole}.getContext('2d').getImageData(0, 0, {whole}.width, {whole}.height); return data.some((part) => part > 0); }})()"
        );
        page.until(&drawn).await?;
        page.picture("recording-whole").await?;
        let drag = "const [from, to] = arguments; const canvas = document.querySelector('.whole canvas');
            canvas.scrollIntoView({ block: 'center' });
            const { left, top, width } = canvas.getBoundingClientRect();
            canvas.setPointerCapture = () => {};
            const event = (name, part) => canvas.dispatchEvent(new PointerEvent(name, { clientX: left + part * width, clientY: top + 9, pointerId: 1, bubbles: true }));
            event('pointerdown', from); event('pointermove', (from + to) / 2); event('pointermove', to); event('pointerup', to);
            return true;";
        page.js::<bool>(drag, vec![json!(0.75), json!(0.5)]).await?;
        says(&page, "Shown: 10").await?;
        page.until(READY).await?;
        let times: Vec<String> = page.eval(TIMES).await?;
        let [from_s, to_s] = [&times[0], &times[1]].map(|time| time.parse::<f64>().unwrap_or(0.0));
        let capture = read(Cursor::new(text.as_bytes()), &Limits::default(), &mut |_| true).capture;
        let end_s = natively(&text, &OpenOptions::default(), None)?.end_s;
        ensure!(
            (from_s / end_s - 0.5).abs() < 0.01 && (to_s / end_s - 0.75).abs() < 0.01,
            "{times:?} of {end_s}"
        );
        page.picture("recording-part").await?;
        // The figures and the overview are of the whole recording.
        says(&page, "200 steps, 200 right and 0 left").await?;
        // A press selects the whole recording again, and its times select the same part.
        page.js::<bool>(drag, vec![json!(0.2), json!(0.2)]).await?;
        page.until("document.getElementById('recording-show-from').checkVisibility() === false").await?;
        page.until(READY).await?;
        page.click("dialog.recording [aria-label='Show a part: enter its start and end']").await?;
        page.until("document.activeElement.id === 'recording-show-from'").await?;
        type_into(&page, "Show from", &times[0]).await?;
        type_into(&page, "Show up to", &times[1]).await?;
        says(&page, "Shown: 10").await?;
        show(&page).await?;
        let part = Part { max_records: 20_000_000, from_s: Some(from_s), to_s: Some(to_s) };
        page.until_digest(&digest(&LoadedCapture::of_part(&capture, &OpenOptions::default(), &part)?))
            .await?;
        // From there another part is selected without opening the file again.
        page.until(ON_SHOW).await?;
        page.click("#on-show button").await?;
        page.until(&seen).await?;
        says(&page, "Shown: 10").await?;
        page.js::<bool>(drag, vec![json!(0.1), json!(0.4)]).await?;
        says(&page, "Shown: 2").await?;
        page.until(READY).await?;
        let other: Vec<String> = page.eval(TIMES).await?;
        let [from_s, to_s] = [&other[0], &other[1]].map(|time| time.parse::<f64>().unwrap_or(0.0));
        ensure!(
            (from_s / end_s - 0.1).abs() < 0.01 && (to_s / end_s - 0.4).abs() < 0.01,
            "{other:?} of {end_s}"
        );
        show(&page).await?;
        let part = Part { max_records: 20_000_000, from_s: Some(from_s), to_s: Some(to_s) };
        page.until_digest(&digest(&LoadedCapture::of_part(&capture, &OpenOptions::default(), &part)?))
            .await?;
        // The whole recording is shown like any other, without a selection of parts.
        page.click("#on-show button").await?;
        page.until(&seen).await?;
        page.until(READY).await?;
        page.js::<bool>(drag, vec![json!(0.2), json!(0.2)]).await?;
        page.until("document.getElementById('recording-show-from').checkVisibility() === false").await?;
        show(&page).await?;
        page.until_digest(&digest(&natively(&text, &OpenOptions::default(), None)?)).await?;
        page.until(&format!("{ON_SHOW} && document.querySelector('#on-show button') === null")).await
    })
}

#[test]
fn records_of_a_long_recording_are_sent_in_pieces() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.ready().await?;
        // 600 000 steps: more than two pieces.
        let script = "const lines = ['$timescale 1 us $end $var wire 1 ! STEP $end $enddefinitions $end #0 0!'];
            for (let step = 1; step <= 600000; step++) lines.push(`#${50 * step} 1! #${50 * step + 5} 0!`);
            const data = new DataTransfer(); data.items.add(new File([lines.join('\\n')], 'long.vcd'));
            window.sent = [];
            const post = Worker.prototype.postMessage;
            Worker.prototype.postMessage = function (message, ...more) {
                const size = (value) => value instanceof Uint8Array ? value.byteLength : Array.isArray(value) ? value.reduce((sum, each) => sum + size(each), 0)
                    : value && typeof value === 'object' && !(value instanceof File) ? size(Object.values(value)) : 0;
                // Maximum size of one transfer.
                if (!window.task) { window.task = true; window.sent.push(0); setTimeout(() => { window.task = false; }); }
                window.sent[window.sent.length - 1] += size(message);
                return post.call(this, message, ...more);
            };
            const input = document.getElementById('open-file'); input.files = data.files;
            return input.dispatchEvent(new Event('change'));";
        page.js::<bool>(script, Vec::new()).await?;
        says(&page, "600000 steps").await?;
        show(&page).await?;
        page.until("document.getElementById('status').textContent.replace(/\\u202f/g, '').startsWith('1200000 edges')").await?;
        let sent: Vec<u64> = page.eval("window.sent.filter((size) => size > 0)").await?;
        // 16 bytes for each of the 1 200 001 records, at most 8 MiB of them at once.
        assert_eq!(sent.iter().sum::<u64>(), 16 * 1_200_001, "{sent:?}");
        ensure!(sent.iter().all(|size| *size <= 8 << 20), "{sent:?}");
        ensure!(page.eval::<bool>(ON_SHOW).await?);
        Ok(())
    })
}
