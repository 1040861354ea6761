//! Recordings of common kinds: the dialog proposes the same map and shows the same figures as the core, and both
//! are correct.

use std::{fs, io::Cursor};

use anyhow::{Context, Result, ensure};
use stepscope_core::{
    capture::read::{Limits, read},
    inspect::recording::{loaded_capture::LoadedCapture, open_options::OpenOptions},
};

use crate::{
    bench::in_browser,
    recording::{CLOSED, READY, SHOW, cancel, choose_file, choose_signal, says, shown_map, type_into},
    session::Session,
};

/// Recordings with known results, which the command's tests also use.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../cli/tests/recordings");

/// Checks that the dialog shows the contents of the file.
const TABLE: &str = "document.querySelector('dialog.recording h2') !== null";

/// A file, the input in its dialog, and the result.
struct Case {
    file: &'static str,
    /// Channels with their selected signals.
    signals: &'static [(&'static str, &'static str)],
    /// Fields with their input.
    fields: &'static [(&'static str, &'static str)],
    /// The same as options of the core.
    options: fn() -> OpenOptions,
    expected: &'static [&'static str],
}

impl Case {
    const fn new(file: &'static str, expected: &'static [&'static str]) -> Self {
        Self { file, signals: &[], fields: &[], options: OpenOptions::default, expected }
    }
}

fn mapped(map: &str) -> OpenOptions {
    OpenOptions { map: Some(map.to_owned()), ..OpenOptions::default() }
}

const CASES: &[Case] = &[
    Case::new(
        "dsview.csv",
        &["Channel 0: 25 steps, 20 right and 5 left, from 1 ms to 31 ms", "1000 steps/s"],
    ),
    Case::new(
        "two-motors-one-dir.vcd",
        &["Channel 0: 50 steps, 25 right and 25 left", "Channel 1: 50 steps, 25 right and 25 left"],
    ),
    Case {
        signals: &[("top.CW", "CW0"), ("top.CCW", "CCW0")],
        options: || mapped("CW0=CW,CCW0=CCW"),
        ..Case::new("cw-ccw.vcd", &["Channel 0: 32 steps, 20 right and 12 left"])
    },
    Case::new("dedge.vcd", &["Channel 0: 20 steps, 20 right"]),
    Case {
        signals: &[("top.STEP", "DEDGE0")],
        options: || mapped("DEDGE0=STEP,DIR0=DIR"),
        ..Case::new("dedge.vcd", &["Channel 0: 40 steps, 40 right", "10000 steps/s"])
    },
    Case {
        fields: &[("Serial format", "8E1")],
        options: || OpenOptions { uart: Some("8E1".to_owned()), ..OpenOptions::default() },
        ..Case::new("8e1.csv", &["115200 baud", "42 bytes"])
    },
    Case::new("rx-random-gaps.csv", &["115200 baud", "112 bytes"]),
    Case::new("83ns.vcd", &["Channel 0: 20 steps"]),
    Case::new("verilator-like.vcd", &["Channel 0: 30 steps"]),
    Case {
        fields: &[("Bit rate", "115200")],
        options: || OpenOptions { baud: Some(115_200), ..OpenOptions::default() },
        ..Case::new("hexdump-C-hexletters.txt", &["115200 baud", "16 bytes"])
    },
    Case::new("iso.txt", &["3 bytes", "10 ms"]),
];

/// A file opened by the core.
fn opened(text: &str, options: &OpenOptions) -> Result<LoadedCapture> {
    let reading = read(Cursor::new(text), &Limits::default(), &mut |_| true);
    ensure!(reading.error.is_none(), "{:?}", reading.error);
    Ok(LoadedCapture::new(reading.capture, options)?)
}

/// Opens a file in the page and compares its dialog with the core.
async fn compare(page: &Session, case: &Case) -> Result<()> {
    let path = format!("{FOLDER}/{}", case.file);
    let text = fs::read_to_string(&path).context(path)?;
    let known = opened(&text, &(case.options)())?;
    choose_file(page, case.file, &text).await?;
    page.until(TABLE).await?;
    for (channel, signal) in case.signals {
        choose_signal(page, channel, signal).await?;
    }
    for (name, value) in case.fields {
        type_into(page, name, value).await?;
    }
    for expected in case.expected {
        says(page, expected).await?;
    }
    for channel in &known.report.channels {
        let figures = &channel.figures;
        let counts = format!("{} steps, {} right and {} left", figures.steps, figures.right, figures.left);
        says(page, &format!("Channel {}: {counts}", channel.channel)).await?;
    }
    for line in &known.report.lines {
        says(page, &line.to_text()).await?;
    }
    if known.has_levels() {
        let mut map: Vec<&str> = known.map.split(',').collect();
        map.sort_unstable();
        assert_eq!(shown_map(page).await?, map, "{}", case.file);
    }
    page.until(READY).await?;
    page.picture(&format!("recording-{}", case.file)).await?;
    cancel(page).await
}

#[test]
fn recordings_of_all_kinds_match_the_core() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.ready().await?;
        for case in CASES {
            compare(&page, case).await.with_context(|| case.file)?;
        }
        Ok(())
    })
}

#[test]
fn a_map_with_a_shared_dir_is_imported_and_remembered() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.ready().await?;
        let text = "Time [s],D0,D1,D2\n0,0,0,0\n0.001,1,0,0\n0.002,0,1,0\n0.003,0,0,1\n0.004,1,0,1\n0.005,0,1,1\n0.006,0,0,1\n";
        choose_file(&page, "first.csv", text).await?;
        page.until(TABLE).await?;
        for (channel, signal) in [("D0", "STEP0"), ("D1", "STEP1"), ("D2", "DIR0, 1")] {
            choose_signal(&page, channel, signal).await?;
        }
        says(&page, "Channel 0: 2 steps, 1 right and 1 left").await?;
        says(&page, "Channel 1: 2 steps, 1 right and 1 left").await?;
        // An error is below its field, and nothing is lost.
        for (motors, why) in [
            ("0, 16", "Motor 16 is out of range; use 0 to 15, several as 0, 1."),
            ("x", "“x” is not a motor; use 0 to 15, several as 0, 1."),
        ] {
            type_motor(&page, "D2", motors).await?;
            says(&page, why).await?;
            ensure!(!page.eval::<bool>(READY).await?);
        }
        type_motor(&page, "D0", "0, 1").await?;
        says(&page, "Only DIR can be shared by several motors; use one.").await?;
        type_motor(&page, "D0", "0").await?;
        type_motor(&page, "D2", "0-1").await?;
        says(&page, "Channel 1: 2 steps, 1 right and 1 left").await?;
        page.until(READY).await?;
        page.click(SHOW).await?;
        page.until(CLOSED).await?;
        choose_file(&page, "second.csv", text).await?;
        says(&page, "Channel 1: 2 steps, 1 right and 1 left").await?;
        assert_eq!(shown_map(&page).await?, ["DIR0=D2", "DIR1=D2", "STEP0=D0", "STEP1=D1"]);
        // A new signal of a motor starts at the first motor without one.
        choose_signal(&page, "D1", "").await?;
        choose_signal(&page, "D1", "STEP").await?;
        assert_eq!(shown_map(&page).await?, ["DIR0=D2", "DIR1=D2", "STEP0=D0", "STEP1=D1"]);
        cancel(&page).await
    })
}

/// Types the motors of a channel.
async fn type_motor(page: &Session, channel: &str, motors: &str) -> Result<()> {
    crate::recording::set(page, &format!("dialog.recording [aria-label=\"Motor of {channel}\"]"), motors)
        .await
}
