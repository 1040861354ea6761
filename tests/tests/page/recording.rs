//! Opening recordings: texts and fields of the dialog, what the views show instead of the experiment, and what remains.
//!
//! The page is compared with the same text opened natively.

use std::{f64::consts::PI, fmt::Write as _, io::Cursor};

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use stepscope_core::{
    capture::read::{Limits, read},
    inspect::{
        recording::{
            loaded_capture::{LoadedCapture, Part},
            open_options::OpenOptions,
        },
        trace::{drivers, timing::TimingCheck},
    },
    peripheral::{
        signal::{Levels, Record, Sink as _},
        trace::{Digest, steps},
    },
    scenario::{DriverModel, DriverTiming},
};

use crate::{
    axe,
    bench::in_browser,
    cursors,
    exchange::drop_file,
    keyboard::{go, key},
    native::{DISTANCE, Known, with_distance},
    reflow,
    session::{CONTROL, ENTER, RELEASE, SHIFT, Session, field},
};

/// Steps of the recorded motion.
const STEPS: u32 = 200;
/// Duration in s.
const DURATION_S: f64 = 0.2;
/// Number of pulses that are too short for an A4988.
const NARROW_EVERY: u32 = 10;

const DIALOG: &str = "document.querySelector('dialog.recording')";
pub(crate) const CLOSED: &str = "document.querySelector('dialog.recording') === null";
/// The figures of the recording, and the errors under the fields.
const RESULT: &str = "[...document.querySelectorAll('.recorded, dialog.recording .error')].map((node) => node.innerText).join('\\n').replace(/\\u202f/g, '')";
/// The channel map that the table shows, in the order of its text.
const MAP: &str = "[...document.querySelectorAll('.channels tbody tr')].flatMap((row) => {
    const [signal, motor, inverted] = row.querySelectorAll('select, input');
    const motors = motor.hidden ? [''] : motor.value.split(', ');
    return motors.map((motor) => signal.value && `${signal.value}${motor}=${inverted.checked ? '!' : ''}${row.cells[0].textContent}`);
}).filter(Boolean).sort()";
pub(crate) const SHOW: &str = "dialog.recording button.main";
/// It can be shown.
pub(crate) const READY: &str = "document.querySelector('dialog.recording button.main')?.disabled === false";
pub(crate) const MESSAGE: &str = "document.getElementById('link-message').innerText";

/// A cosine of 200 steps from firmware, in the format of Saleae Logic: no pulse is on time.
pub(crate) fn cosine() -> String {
    let mut table = "Time [s],X_STEP,X_DIR\n0.000000000,0,0\n0.010000000,0,1\n".to_owned();
    for step in 0..STEPS {
        let part = (f64::from(step) + 0.5) / f64::from(STEPS);
        let jitter_s = 1e-6 * f64::from(step * step % 7);
        let at = 0.0101 + DURATION_S / PI * libm::acos(1.0 - 2.0 * part) + jitter_s;
        let width_s = if step % NARROW_EVERY == 0 { 0.6e-6 } else { 2e-6 };
        let _ = write!(table, "{at:.9},1,1\n{:.9},0,1\n", at + width_s);
    }
    table
}

/// Some signals of a run, in the format of Saleae Logic.
pub(crate) fn saleae(trace: &[Record], clock_hz: u32, signals: &[(&str, u64)]) -> String {
    let head: Vec<&str> = signals.iter().map(|(name, _)| *name).collect();
    let mut table = format!("Time [s],{}\n", head.join(","));
    for record in trace {
        let levels: Vec<&str> =
            signals.iter().map(|(_, mask)| if record.levels.has(*mask) { "1" } else { "0" }).collect();
        let _ = writeln!(table, "{:.10},{}", record.cycle.0 as f64 / f64::from(clock_hz), levels.join(","));
    }
    table
}

/// A text opened by the core, next to a model with its first step at this time.
pub(crate) fn natively(
    text: &str,
    options: &OpenOptions,
    first_step_s: Option<f64>,
) -> Result<LoadedCapture> {
    let reading = read(Cursor::new(text.as_bytes()), &Limits::default(), &mut |_| true);
    let mut opened = LoadedCapture::new(reading.capture, options)?;
    first_step_s.into_iter().try_for_each(|at| opened.align(0, 0, at))?;
    Ok(opened)
}

pub(crate) fn digest(opened: &LoadedCapture) -> String {
    let mut digest = Digest::default();
    opened.records.iter().for_each(|record| digest.record(*record));
    format!("{:016x}", digest.value())
}

/// Time of a model's first step, in s.
fn first_step_s(known: &Known) -> Result<f64> {
    let steps = steps(&known.recording.trace, 0);
    Ok(known.seconds(steps.first().context("it steps")?.cycle))
}

/// Selects a file with the page's own input.
pub(crate) async fn choose_file(page: &Session, name: &str, text: &str) -> Result<()> {
    let script = "const data = new DataTransfer(); data.items.add(new File([arguments[1]], arguments[0]));
        const input = document.getElementById('open-file'); input.files = data.files;
        return input.dispatchEvent(new Event('change'));";
    page.js::<bool>(script, vec![json!(name), json!(text)]).await.map(drop)
}

/// Waits for this text in the dialog.
pub(crate) async fn says(page: &Session, text: &str) -> Result<()> {
    page.until(&format!("{RESULT}.includes({})", json!(text))).await
}

/// A control of the dialog by its name.
fn named(name: &str) -> String {
    format!("dialog.recording [aria-label=\"{name}\"]")
}

/// Replaces the text of a field of the dialog.
pub(crate) async fn type_into(page: &Session, label: &str, text: &str) -> Result<()> {
    let script = "const label = [...document.querySelectorAll('dialog.recording label')].find((label) => label.textContent.startsWith(arguments[0]));
        const input = label.control; input.value = arguments[1];
        return input.dispatchEvent(new Event('input', { bubbles: true }));";
    page.js::<bool>(script, vec![json!(label), json!(text)]).await.map(drop)
}

/// The map that the table shows.
pub(crate) async fn shown_map(page: &Session) -> Result<Vec<String>> {
    page.eval(MAP).await
}

/// Selects the signal of a channel, such as RX, STEP3 or DIR0,1. Unlike a user, WebDriver sends a change event, but no input
/// event.
pub(crate) async fn choose_signal(page: &Session, channel: &str, signal: &str) -> Result<()> {
    let (kind, motors) =
        signal.split_at(signal.find(|each: char| each.is_ascii_digit()).unwrap_or(signal.len()));
    page.choose(&named(&format!("Signal of {channel}")), kind).await?;
    set(page, &named(&format!("Signal of {channel}")), kind).await?;
    if !motors.is_empty() {
        set(page, &named(&format!("Motor of {channel}")), motors).await?;
    }
    Ok(())
}

/// Sets a field like a user.
pub(crate) async fn set(page: &Session, css: &str, value: &str) -> Result<()> {
    let script = "const field = document.querySelector(arguments[0]); field.value = arguments[1];
        return field.dispatchEvent(new Event('input', { bubbles: true }));";
    page.js::<bool>(script, vec![json!(css), json!(value)]).await.map(drop)
}

pub(crate) async fn cancel(page: &Session) -> Result<()> {
    page.click("dialog.recording .named > button:not(.main)").await?;
    page.until(CLOSED).await
}

#[test]
fn a_recording_is_mapped_and_shown_next_to_the_model_until_undo() -> Result<()> {
    in_browser(|page| async move {
        let (own, text) = (Known::of(&with_distance(800.0))?, cosine());
        page.open("").await?;
        page.fill(DISTANCE, "800").await?;
        page.until_digest(&own.digest).await?;
        choose_file(&page, "mine.csv", &text).await?;

        // The map is proposed, and its change changes the figures.
        says(&page, "200 steps, 200 right and 0 left").await?;
        assert_eq!(shown_map(&page).await?, ["DIR0=X_DIR", "STEP0=X_STEP"]);
        page.picture("recording-dialog").await?;
        page.click(&named("X_DIR is inverted")).await?;
        says(&page, "0 right and 200 left").await?;
        page.click(&named("X_DIR is inverted")).await?;
        choose_signal(&page, "X_STEP", "STEP3").await?;
        says(&page, "Channel 3: 200 steps").await?;
        choose_signal(&page, "X_STEP", "STEP0").await?;
        type_into(&page, "Clock", "1000000").await?;
        says(&page, "at 1 MHz").await?;
        says(&page, "pulses within a cycle are lost").await?;
        type_into(&page, "Clock", "fast").await?;
        page.until("document.getElementById('recording-clock-error').innerText.includes('not a number')")
            .await?;
        ensure!(!page.eval::<bool>(READY).await?, "nothing is shown by a clock that is none");
        type_into(&page, "Clock", "16 MHz").await?;
        says(&page, "at 16 MHz").await?;
        says(&page, "200 right").await?;

        let options = OpenOptions { clock_hz: Some(16_000_000), ..OpenOptions::default() };
        let opened = natively(&text, &options, Some(first_step_s(&own)?))?;
        page.click(SHOW).await?;
        page.until_digest(&digest(&opened)).await?;
        page.until(CLOSED).await?;
        assert_eq!(page.field("title").await?.value, "recorded: mine.csv");
        let edges = opened.records.len() - 1;
        page.until(&format!("document.getElementById('status').textContent.replace(/\\u202f/g, '').startsWith('{edges} edges')")).await?;
        // No run has the recording's digests, so the link has none.
        page.click("#share").await?;
        page.until("document.getElementById('link-text').value.includes('#c=')").await?;
        ensure!(!page.eval::<bool>("/[&]d=/.test(document.getElementById('link-text').value)").await?);
        page.click("#share").await?;
        // Each step is compared with the model's, and the worst one can be shown.
        page.until(&format!(
            "{MESSAGE}.startsWith('Compared with the baseline: 200 steps, the baseline has 800')"
        ))
        .await?;
        let said = page.text("#link-message").await?;
        ensure!(
            said.contains("mine.csv") && said.contains("Undo") && said.contains("Go to this time"),
            "{said}"
        );
        // The message can be closed, because the experiment's note has it.
        let note = page.field("note").await?.value;
        ensure!(note.contains("Compared with the baseline: 200 steps, the baseline has 800"), "{note}");
        page.until("document.getElementById('chart-position').checkVisibility() && document.body.innerText.includes('Compared with the baseline: the experiment')").await?;
        // The position at a cursor is that of the file.
        page.press("#charts", &format!("{SHIFT}\u{e014}{RELEASE}")).await?;
        let look = async || cursors::cycle(&page, "#charts-handles .handle.a").await;
        let cycle = page.eventually("cursor A", look).await?;
        let position = opened.steps_of(0).into_iter().take_while(|step| step.cycle <= cycle).last();
        let position = position.context("it has moved")?.position;
        page.until(&format!(
            "document.getElementById('motion-time').textContent.replace(/\\D/g, '').endsWith('{cycle}')"
        ))
        .await?;
        let read = cursors::reading(&page.text("#read-position").await?, "actual")?;
        ensure!((20.0..180.0).contains(&read), "{read}");
        assert_eq!(read, f64::from(position), "at cycle {cycle}");
        page.picture("recording-compare").await?;

        page.click("#undo").await?;
        page.until_digest(&own.digest).await?;
        page.click("#redo").await?;
        page.until_digest(&digest(&opened)).await?;

        // Another source is no recording: the views show the model's run.
        let mut scenario: Value = serde_json::from_str(&opened.shown_scenario("mine.csv", false).to_json())?;
        let start = &mut scenario["source"]["segments"]["channels"][0]["start_cycle"];
        ensure!(start.is_u64(), "{start}");
        *start = json!(801);
        page.fill("source.segments.channels[0].start_cycle", "801").await?;
        page.until_digest(&Known::of(&scenario.to_string())?.digest).await
    })
}

#[test]
fn a_recording_is_aligned_by_a_step_that_both_have() -> Result<()> {
    in_browser(|page| async move {
        let (own, text) = (Known::of(&with_distance(800.0))?, cosine());
        page.open("").await?;
        page.fill(DISTANCE, "800").await?;
        page.until_digest(&own.digest).await?;
        choose_file(&page, "mine.csv", &text).await?;
        says(&page, "200 steps, 200 right and 0 left").await?;
        // Without an experiment there is no alignment.
        let aligned = "#recording-aligned-by-step";
        page.click("#recording-compare").await?;
        ensure!(!page.visible(aligned).await?);
        page.click("#recording-compare").await?;
        ensure!(page.visible(aligned).await?);
        type_into(&page, "Aligned by step", "-1").await?;
        page.until(
            "document.getElementById('recording-aligned-by-step-error').innerText.includes('-1 is out of range; use 0 to')",
        )
        .await?;
        for (step, why) in [
            ("900", "The experiment has no step 900 (the first is 0); use a step that both have"),
            ("250", "There is no step 250; 200 steps were recorded, numbered from 0; use one that both have"),
        ] {
            type_into(&page, "Aligned by step", step).await?;
            page.until(READY).await?;
            page.click(SHOW).await?;
            says(&page, why).await?;
            ensure!(!page.eval::<bool>(CLOSED).await?);
        }
        type_into(&page, "Aligned by step", "50").await?;
        page.until(READY).await?;
        page.click(SHOW).await?;
        let mut opened = natively(&text, &OpenOptions::default(), None)?;
        let model = steps(&own.recording.trace, 0);
        opened.align(0, 50, own.seconds(model.get(50).context("it steps")?.cycle))?;
        page.until_digest(&digest(&opened)).await?;
        page.until(&format!(
            "{MESSAGE}.startsWith('Compared with the baseline, aligned by step 50: 200 steps, the baseline has 800')"
        ))
        .await
    })
}

#[test]
fn recorded_pulses_are_checked_and_their_map_is_remembered() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        let text = cosine();
        choose_file(&page, "first.csv", &text).await?;
        says(&page, "200 right").await?;
        page.click(&named("X_DIR is inverted")).await?;
        says(&page, "200 left").await?;
        // Without an experiment nothing is moved to the model's first step.
        page.click("#recording-compare").await?;
        says(&page, "200 left").await?;
        page.until(READY).await?;
        page.click(SHOW).await?;
        let options =
            OpenOptions { map: Some("STEP0=X_STEP,DIR0=!X_DIR".to_owned()), ..OpenOptions::default() };
        let opened = natively(&text, &options, None)?;
        page.until_digest(&digest(&opened)).await?;
        ensure!(
            !page
                .eval::<bool>(
                    "document.body.innerText.includes('Compared with the baseline: the experiment')"
                )
                .await?
        );
        // Its acceleration is drawn, with the maximum of the figures.
        let greatest = opened.report.channels[0].figures.greatest_acceleration_steps_s2.context("steps")?;
        let label = "document.getElementById('chart-acceleration').getAttribute('aria-label').replace(/\\u202f/g, '')";
        page.until("document.getElementById('chart-acceleration').checkVisibility()").await?;
        let look = async || {
            let said: String = page.eval(label).await?;
            let numbers = said.split_once("from ").and_then(|(_, rest)| rest.split_once(" to "));
            let (low, high) = numbers.context("a range")?;
            let [low, high] = [low, high.split(' ').next().unwrap_or("")]
                .map(|text| text.replace('\u{2212}', "-").parse::<f64>().unwrap_or(0.0));
            anyhow::Ok(Some(low.abs().max(high)).filter(|most| (most / greatest - 1.0).abs() < 0.01))
        };
        page.eventually("the acceleration's range", look).await?;

        let rules = drivers::rules(&DriverTiming::Preset(DriverModel::A4988));
        let mut check = TimingCheck::new(&rules, opened.clock_hz, 1000);
        opened.records.iter().for_each(|record| check.record(*record));
        let total = check.total();
        ensure!(total >= u64::from(STEPS / NARROW_EVERY), "narrow pulses: {total}");
        page.choose(&field("driver_timing#kind"), "a4988").await?;
        page.until_equal(
            "document.getElementById('health').textContent",
            &json!(format!("{total} timing violations")),
        )
        .await?;
        page.until_digest(&digest(&opened)).await?;

        // Other channels have another map; the same channels again have the stored one.
        choose_file(&page, "other.csv", &text.replace("X_DIR", "X_DIRECTION")).await?;
        says(&page, "200 right").await?;
        cancel(&page).await?;
        choose_file(&page, "second.csv", &text).await?;
        says(&page, "200 left").await?;
        ensure!(
            page.eval::<bool>("document.querySelector('[aria-label=\"X_DIR is inverted\"]').checked").await?
        );
        cancel(&page).await?;
        page.until_digest(&digest(&opened)).await
    })
}

#[test]
fn missing_information_is_requested_and_errors_are_reported() -> Result<()> {
    in_browser(|page| async move {
        let own = Known::of("{}")?;
        page.open("").await?;
        page.until_digest(&own.digest).await?;

        // Samples of no length.
        let samples: String = (0..400).map(|at| format!("{},1\n", u8::from(at % 20 < 2))).collect();
        let samples = format!("STEP,DIR\n{samples}");
        choose_file(&page, "samples.csv", &samples).await?;
        says(&page, "has no sample rate").await?;
        ensure!(!page.eval::<bool>(READY).await?, "there is nothing to show yet");
        page.until("document.activeElement.id === 'recording-sample-rate'").await?;
        type_into(&page, "Sample rate", "1000000").await?;
        let options = OpenOptions { sample_rate_hz: Some(1_000_000), ..OpenOptions::default() };
        let opened = natively(&samples, &options, None)?;
        says(&page, &format!("{} steps", opened.steps_of(0).len())).await?;
        page.until(READY).await?;
        page.picture("recording-asked").await?;
        cancel(&page).await?;

        // Channels without meaningful names or behavior.
        choose_file(&page, "quiet.csv", "Time [s],D0,D1\n0.0,0,0\n").await?;
        says(&page, "Choose which channel is STEP, DIR, RX or TX").await?;
        let shown =
            "[...document.querySelectorAll('.channels tbody tr')].map((row) => row.cells[0].textContent)";
        assert_eq!(page.eval::<Vec<String>>(shown).await?, ["D0", "D1"]);
        ensure!(!page.eval::<bool>(READY).await?);
        choose_signal(&page, "D1", "STEP0").await?;
        page.until(READY).await?;
        cancel(&page).await?;

        // Truncated and damaged files: the readable part is there.
        let text = cosine();
        let torn: String =
            text.lines().take(102).chain(["0.1,maybe,1"]).map(|line| format!("{line}\n")).collect();
        choose_file(&page, "torn.csv", &torn).await?;
        says(&page, "steps").await?;
        let said: String = page.eval(&format!("{DIALOG}.innerText")).await?;
        ensure!(said.contains("line 103") && said.contains("maybe"), "{said}");
        let steps = natively(&torn, &OpenOptions::default(), None)?.steps_of(0).len();
        ensure!(steps > 40 && said.contains(&format!("{steps} steps")), "{said}");
        page.picture("recording-torn").await?;
        cancel(&page).await?;

        // Nothing readable.
        choose_file(&page, "photo.bin", "\u{0}\u{1}nothing\u{0}").await?;
        page.until(&format!("{MESSAGE}.includes('photo.bin cannot be opened') && {CLOSED}")).await?;
        // Nothing has changed, and there is nothing to undo.
        page.until_digest(&own.digest).await?;
        ensure!(page.eval::<bool>("document.getElementById('undo').disabled").await?);
        Ok(())
    })
}

#[test]
fn dropped_bytes_and_positions_become_packets_and_steps() -> Result<()> {
    in_browser(|page| async move {
        let own = Known::of("{}")?;
        page.open("").await?;
        page.until_digest(&own.digest).await?;
        let clock_hz = own.experiment.config().clock_hz();
        let signals = [("MCU RX", Levels::RX), ("STEP", 1), ("DIR", 1 << Levels::DIR_SHIFT)];
        let text = saleae(&own.recording.trace, clock_hz, &signals);
        drop_file(&page, "line.csv", &text).await?;
        says(&page, "115200 baud").await?;
        says(&page, "200 bytes, raw packets of 1 byte").await?;
        page.until(READY).await?;
        page.click(SHOW).await?;
        let options = OpenOptions { clock_hz: Some(clock_hz), ..OpenOptions::default() };
        let opened = natively(&text, &options, Some(first_step_s(&own)?))?;
        page.until(CLOSED).await?;
        page.until_digest(&digest(&opened)).await?;
        let rows = own.recording.packets.rows().len();
        page.until(&format!(
            "document.getElementById('packets-count').textContent.startsWith('{rows} on the line')"
        ))
        .await?;

        // Pasted positions: the model steps at their times.
        let table = (0..=40).fold("time_s,position\n".to_owned(), |mut table, step| {
            let _ = writeln!(table, "{:.4},{step}", 0.1 + 0.001 * f64::from(step));
            table
        });
        let script = "const clipboardData = new DataTransfer(); clipboardData.setData('text/plain', arguments[0]);
            return !document.body.dispatchEvent(new ClipboardEvent('paste', { clipboardData, bubbles: true, cancelable: true }));";
        ensure!(page.js::<bool>(script, vec![json!(table)]).await?, "the page takes it");
        says(&page, "40 steps").await?;
        page.until(READY).await?;
        page.click("#recording-compare").await?;
        page.until(READY).await?;
        page.click(SHOW).await?;
        page.until(CLOSED).await?;
        let positions = natively(&table, &OpenOptions::default(), None)?;
        let shown = Known::of(&positions.shown_scenario("the pasted text", false).to_json())?;
        page.until_digest(&shown.digest).await?;
        page.click("#undo").await?;
        page.until_digest(&digest(&opened)).await
    })
}

#[test]
fn a_selected_part_keeps_the_figures_of_the_whole_recording() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.ready().await?;
        let text = cosine();
        choose_file(&page, "mine.csv", &text).await?;
        says(&page, "200 steps").await?;
        // The fields appear if a recording is too long; here they are filled anyway.
        let is_there = "document.getElementById('recording-show-from').checkVisibility()";
        ensure!(!page.eval::<bool>(is_there).await?, "all of it is shown");
        type_into(&page, "Show from", "0.1").await?;
        type_into(&page, "Show up to", "150 ms").await?;
        says(&page, "Shown: 100 ms to 150 ms of 203").await?;
        says(&page, "200 steps, 200 right and 0 left").await?;
        ensure!(!page.visible("#recording-compare").await?, "a part is not compared with anything");
        type_into(&page, "Show up to", "x").await?;
        page.until(
            "document.getElementById('recording-show-up-to-error').innerText.includes('not a number')",
        )
        .await?;
        ensure!(!page.eval::<bool>(READY).await?, "nothing is shown up to a time that is none");
        type_into(&page, "Show up to", "150 ms").await?;
        page.until(READY).await?;
        page.click(SHOW).await?;
        page.until(CLOSED).await?;
        let capture = read(Cursor::new(text.as_bytes()), &Limits::default(), &mut |_| true).capture;
        let part = Part { max_records: 20_000_000, from_s: Some(0.1), to_s: Some(0.15) };
        let shown = LoadedCapture::of_part(&capture, &OpenOptions::default(), &part)?;
        ensure!((20..390).contains(&shown.records.len()), "{}", shown.records.len());
        page.until_digest(&digest(&shown)).await?;
        page.until(&format!("{MESSAGE}.includes('Shown: 100 ms to 150 ms of 203')")).await
    })
}

#[test]
fn packets_of_both_lines_are_listed_with_recorded_replies() -> Result<()> {
    in_browser(|page| async move {
        let framed = Known::of(r#"{"line":{"protocol":"framed"}}"#)?;
        page.open("").await?;
        page.ready().await?;
        let clock_hz = framed.experiment.config().clock_hz();
        let signals = [("RX", Levels::RX), ("TX", Levels::TX)];
        choose_file(&page, "link.csv", &saleae(&framed.recording.trace, clock_hz, &signals)).await?;
        page.until(READY).await?;
        let said = "document.querySelector('.packet-list').textContent.replace(/\\u202f/g, '')";
        page.click(".packet-list summary").await?;
        let log = &framed.recording.packets;
        let all = log.rows().len();
        page.until(&format!("{said}.includes('{all} packets, {} complete frames of the device')", all / 2))
            .await?;
        let cells = "[...document.querySelectorAll('.packet-list tbody tr')].slice(0, 2).map((row) => [...row.cells].map((cell) => cell.textContent))";
        let rows: Vec<Vec<String>> = page.eval(cells).await?;
        for (index, (row, line)) in rows.iter().zip(["RX frame", "TX reply"]).enumerate() {
            let bytes: Vec<String> = log.bytes(index).iter().map(|byte| format!("{byte:02x}")).collect();
            assert_eq!((row[0].as_str(), row[2].as_str()), (line, bytes.join(" ").as_str()), "{rows:?}");
        }
        ensure!(rows[1][3].starts_with("from 0: ") && rows[1][3].ends_with("CRC valid"), "{rows:?}");
        let mut wrong = Vec::new();
        axe::look(&page, "light", &mut wrong).await?;
        axe::none(&wrong)?;
        // Another map has other packets: the list is closed.
        choose_signal(&page, "TX", "DE").await?;
        page.until("!document.querySelector('.packet-list').open").await?;
        cancel(&page).await
    })
}

#[test]
fn the_dialog_works_with_keys_and_on_narrow_screens() -> Result<()> {
    in_browser(|page| async move {
        let own = Known::of("{}")?;
        page.open("").await?;
        page.until_digest(&own.digest).await?;
        page.allow_clipboard().await?;
        go(&page, &[], "open").await?;
        let text = cosine();
        page.js::<()>(
            "return navigator.clipboard.writeText(arguments[0]).then(() => null);",
            vec![json!(text)],
        )
        .await?;
        key(&page, &[CONTROL], 'v').await?;
        says(&page, "200 right").await?;
        page.until(READY).await?;
        let mut wrong = Vec::new();
        for scheme in ["dark", "light"] {
            page.system_colors(scheme).await?;
            axe::look(&page, scheme, &mut wrong).await?;
        }
        axe::none(&wrong)?;
        go(&page, &[SHIFT], "X_DIR is inverted").await?;
        key(&page, &[], ' ').await?;
        says(&page, "200 left").await?;
        go(&page, &[SHIFT], "Motor of X_STEP").await?;
        for (motor, expected) in [('1', "Channel 1"), ('0', "Channel 0")] {
            key(&page, &[CONTROL], 'a').await?;
            key(&page, &[], motor).await?;
            says(&page, expected).await?;
        }

        page.screen(320, 640).await?;
        page.picture("recording-narrow").await?;
        let widths = format!(
            "[document.documentElement.scrollWidth, innerWidth, {DIALOG}.scrollWidth, {DIALOG}.clientWidth]"
        );
        let [content, window, within, dialog]: [u32; 4] = page.eval(&widths).await?;
        ensure!(content <= window && within <= dialog, "{content} in {window}, {within} in {dialog}");
        for script in [reflow::SMALL, reflow::CUT] {
            let found: Vec<String> = page.js(script, vec![]).await?;
            ensure!(found.is_empty(), "{found:?}");
        }
        page.screen(1440, 900).await?;
        go(&page, &[], "Import: show the recording in all views").await?;
        key(&page, &[], ENTER).await?;
        page.until(CLOSED).await?;
        let options =
            OpenOptions { map: Some("STEP0=X_STEP,DIR0=!X_DIR".to_owned()), ..OpenOptions::default() };
        page.until_digest(&digest(&natively(&text, &options, Some(first_step_s(&own)?))?)).await?;

        page.until("document.activeElement.id === 'open'").await?;

        // Escape closes the dialog, and the page is unchanged.
        choose_file(&page, "again.csv", &text).await?;
        says(&page, "200 left").await?;
        key(&page, &[], '\u{e00c}').await?;
        page.until(CLOSED).await?;
        page.until("document.activeElement.id === 'open'").await
    })
}
