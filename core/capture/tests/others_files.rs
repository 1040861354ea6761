//! Files of other programs with the same edges: GTKWave (`vcd2fst`, `fst2vcd`) and sigrok, the base of
//! PulseView.
//!
//! `cargo xtask test --only vcd` installs these first, and runs it.
#![allow(clippy::expect_used, clippy::panic, reason = "a missing file or program fails the test")]

mod common;

use std::{
    fmt::Write as _,
    fs::{self, File},
    io::BufReader,
    path::{Path, PathBuf},
    process::Command,
};
use stepscope_capture::{
    Capture,
    capture::{Change, Format},
    read::{Limits, read},
    timebase::Timebase,
};

/// Names of the lines of the recording.
const NAMES: [&str; 4] = ["STEP", "DIR", "EN", "TX"];

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn call(program: &str, arguments: &[&str]) {
    let output = Command::new(program).args(arguments).output();
    let output = output.unwrap_or_else(|error| panic!("{program} is not on PATH: {error}"));
    assert!(output.status.success(), "{program} {arguments:?}: {output:?}");
}

fn open(path: &Path) -> Capture {
    let file = BufReader::new(File::open(path).expect("the file"));
    let reading = read(file, &Limits::default(), &mut |_| true);
    assert_eq!(reading.error, None, "{}", path.display());
    reading.capture
}

/// A recording of two ramps, in ticks of 1 us.
fn recording() -> Vec<Change> {
    let mut changes = vec![Change { tick: 0, levels: 0b1100 }];
    let mut tick = 0;
    for at in 0..3000_u64 {
        tick += 3 + 40_000 / (at % 1500 + 50);
        let before = changes[changes.len() - 1].levels;
        let levels = match at {
            1500 => before ^ 0b10,
            _ if at % 7 == 0 => before ^ 0b1001,
            _ => before ^ 1,
        };
        changes.push(Change { tick, levels });
    }
    changes
}

/// The recording as a dump; `other` is an additional, unrelated line.
fn dump(name: &str) -> PathBuf {
    let mut text = String::from("$timescale 1 us $end\n$scope module top $end\n$scope module motor $end\n");
    for (name, code) in NAMES.iter().zip('!'..) {
        let _ = writeln!(text, "$var wire 1 {code} {name} $end");
    }
    text.push_str("$upscope $end\n$upscope $end\n$enddefinitions $end\n");
    let changes = recording();
    let mut before = !0b1100;
    for Change { tick, levels } in &changes {
        let _ = writeln!(text, "#{tick}");
        for (bit, code) in ('!'..).take(NAMES.len()).enumerate() {
            if (before ^ levels) >> bit & 1 == 1 {
                let _ = writeln!(text, "{}{code}", levels >> bit & 1);
            }
        }
        before = *levels;
    }
    let _ = writeln!(text, "#{}", changes[changes.len() - 1].tick + 10);
    let path = path(name);
    fs::write(&path, text).expect("a file");
    path
}

/// Checks that edges and times are the same, regardless of scopes and time base.
fn same(capture: &Capture, format: Format) {
    let names: Vec<&str> =
        capture.channels.iter().filter_map(|channel| channel.name.rsplit('.').next()).collect();
    assert_eq!((capture.format, names.as_slice()), (format, &NAMES[..]));
    let base = capture.timebase.expect("it has a time base");
    let micros = |tick: u64| base.cycle(tick, 1_000_000).expect("it fits");
    assert!(
        capture
            .changes
            .iter()
            .all(|change| base.cycle(change.tick, 1_000_000_000).is_some_and(|ns| ns % 1000 == 0))
    );
    let found: Vec<Change> =
        capture.changes.iter().map(|change| Change { tick: micros(change.tick), ..change }).collect();
    assert_eq!(found, recording());
    assert!(capture.notes.is_empty(), "{:?}", capture.notes);
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

#[test]
#[ignore = "asks programs of GTKWave and sigrok: cargo xtask test --only vcd"]
fn gtkwaves_dumps_have_the_same_edges() {
    let dump = dump("others-gtkwave.vcd");
    same(&open(&dump), Format::Vcd);
    let (waves, summary) = (dump.with_extension("fst"), dump.with_extension("summary.vcd"));
    call("vcd2fst", &[text(&dump), text(&waves)]);
    call("fst2vcd", &["-f", text(&waves), "-o", text(&summary)]);
    same(&open(&summary), Format::Vcd);
    // The binary format is refused; the message gives the fix.
    let file = BufReader::new(File::open(&waves).expect("the file"));
    let error = read(file, &Limits::default(), &mut |_| true).error.expect("it is refused");
    assert!(error.message.contains("fst2vcd"), "{error}");
}

#[test]
#[ignore = "asks programs of GTKWave and sigrok: cargo xtask test --only vcd"]
fn sigroks_files_have_the_same_edges() {
    let dump = dump("others-sigrok.vcd");
    let session = dump.with_extension("sr");
    call("sigrok-cli", &["-I", "vcd", "-i", text(&dump), "-O", "srzip", "-o", text(&session)]);
    same(&open(&session), Format::SigrokSession);
    let written = dump.with_extension("written");
    let of_dump = ["-I", "vcd", "-i", text(&dump), "-O"];
    let of_session = ["-i", text(&session), "-O"];
    for (input, output, format) in [
        (&of_dump[..], "vcd", Format::Vcd),
        (&of_dump, "csv", Format::SigrokCsv),
        (&of_dump, "csv:label=channel", Format::SigrokCsv),
        (&of_session, "vcd", Format::Vcd),
        (&of_session, "csv", Format::SigrokCsv),
        (&of_session, "csv:label=off", Format::SigrokCsv),
        (&of_session, "csv:label=channel:value=;", Format::SigrokCsv),
        (&of_session, "csv:value=\t:comment=#", Format::SigrokCsv),
        (&of_session, "csv:value=|:trigger=true", Format::SigrokCsv),
        (&of_session, "csv:time=true", Format::SigrokCsv),
        (&of_session, "csv:time=true:dedup=true:label=channel", Format::SigrokCsv),
        (&of_session, "csv:time=true:dedup=true:trigger=true:value= ", Format::SigrokCsv),
    ] {
        let _ = fs::remove_file(&written);
        call("sigrok-cli", &[input, &[output, "-o", text(&written)]].concat());
        println!("{output}");
        same(&open(&written), format);
    }
}

/// sigrok's demo device: many pieces, and rates that are not divisors.
#[test]
#[ignore = "asks programs of GTKWave and sigrok: cargo xtask test --only vcd"]
fn a_recording_of_sigroks_demo_device_is_the_same_in_all_of_its_formats() {
    for rate in ["24m", "2m", "1500", "999999"] {
        let session = demo(rate, &["-C", "D0,D1,D2,D3,D4,D5,D6,D7"]);
        let whole = open(&session);
        assert_eq!((whole.channels.len(), whole.end, whole.notes.len()), (8, 8999, 0));
        assert!(whole.changes.len() > 100 && whole.timebase.is_some());
        let written = session.with_extension("written");
        for output in ["csv", "csv:time=true", "csv:time=true:dedup=true"] {
            let _ = fs::remove_file(&written);
            call("sigrok-cli", &["-i", text(&session), "-O", output, "-o", text(&written)]);
            let capture = open(&written);
            assert_eq!(capture.timebase, whole.timebase, "{rate} {output}");
            assert!(capture.changes == whole.changes, "{rate} {output}");
        }
    }
    assert_eq!(open(&path("others-demo-24m.sr")).timebase, Timebase::new(1, 24_000_000));
}

/// Its tables cannot have both kinds of channels (sigrok-cli 0.7.2 crashes), but its sessions can.
#[test]
#[ignore = "asks programs of GTKWave and sigrok: cargo xtask test --only vcd"]
fn analog_channels_of_a_session_are_left_out() {
    let capture = open(&demo("20k", &[]));
    assert_eq!((capture.channels.len(), capture.end), (8, 8999));
    assert_eq!(capture.notes, ["skipped analog channels: A0, A1, A2, A3, A4"]);
}

/// 9000 samples of the demo device, as a session.
fn demo(rate: &str, options: &[&str]) -> PathBuf {
    let session = path(&format!("others-demo-{rate}.sr"));
    let config = format!("samplerate={rate}");
    let arguments =
        ["-d", "demo", "--config", &config, "--samples", "9000", "-O", "srzip", "-o", text(&session)];
    call("sigrok-cli", &[&arguments, options].concat());
    session
}
