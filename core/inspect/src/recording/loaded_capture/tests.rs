use super::*;
use crate::recording::{events::Events, report::LineReport, tolerance::Tolerance};
use alloc::borrow::ToOwned;
use stepscope_capture::capture::Format;
use stepscope_capture::read::{Limits, read};
use stepscope_scenario::Scenario;

fn capture() -> Capture {
    let text = "Time [s],STEP,DIR\n0.0,0,1\n0.001,1,1\n0.0011,0,1\n0.002,1,1\n0.0021,0,1\n0.003,1,1\n0.0031,0,1\n0.005,1,1\n0.0051,0,1\n";
    read(std::io::Cursor::new(text), &Limits::default(), &mut |_| true).capture
}

/// Steps at 1, 2, 3 and 5 ms, as Saleae Logic saves them.
fn loaded() -> LoadedCapture {
    LoadedCapture::new(capture(), &options()).expect("it opens")
}

fn options() -> OpenOptions {
    OpenOptions { clock_hz: Some(1_000_000), ..OpenOptions::default() }
}

#[test]
fn bytes_after_the_last_cycle_make_no_scenario() {
    // Seconds of day and then of the epoch: more than 50 years apart.
    let log = "20.123456 RX: 55 AA\n2026-11-26T12:00:00.2 RX: 01\n";
    let capture = read(std::io::Cursor::new(log), &Limits::default(), &mut |_| true).capture;
    let loaded =
        LoadedCapture::new(capture, &OpenOptions { baud: Some(9600), ..options() }).expect("it opens");
    let fast = Scenario { clock_hz: 1_000_000_000, ..Scenario::default() };
    let refused = loaded.scenario("log.txt", false, 0.0, Some(&fast)).expect_err("no such cycle").to_string();
    assert!(
        refused.contains("start_cycle") && refused.ends_with("use a shorter recording or another clock"),
        "{refused}"
    );
}

#[test]
fn bytes_of_two_directions_are_two_mapped_lines() {
    let read =
        |text: &str| read(std::io::Cursor::new(text.to_owned()), &Limits::default(), &mut |_| true).capture;
    let log = "12:00:00.5 TX 55 AA\n12:00:00.6 RX 01\n";
    let lines = |map: Option<&str>| {
        let options = OpenOptions { map: map.map(Into::into), baud: Some(9600), ..OpenOptions::default() };
        let loaded = LoadedCapture::new(read(log), &options).expect("it opens");
        let bytes =
            |line: &LineReport| line.decoded.bytes.iter().map(|decoded| decoded.byte).collect::<Vec<_>>();
        loaded.report.lines.iter().map(|line| (line.name, bytes(line))).collect::<Vec<_>>()
    };
    assert_eq!(lines(None), [("RX", vec![1]), ("TX", vec![0x55, 0xaa])]);
    assert_eq!(lines(Some("RX=TX,TX=RX")), [("RX", vec![0x55, 0xaa]), ("TX", vec![1])]);
    // A step within the first cycle is not in the records or the figures.
    let loaded =
        LoadedCapture::new(read("time_s,STEP\n0,0\n1e-18,1\n"), &OpenOptions::default()).expect("it loads");
    assert!(loaded.report.channels.is_empty() && loaded.steps_of(0).is_empty());
    // Without times each direction is back to back by itself.
    let annotations = "uart-1: rx-data: 41\nuart-1: tx-data: 42\nuart-1: tx-data: AA\n";
    let options = OpenOptions { baud: Some(9600), ..OpenOptions::default() };
    let loaded = LoadedCapture::new(read(annotations), &options).expect("it opens");
    let found: Vec<_> =
        loaded.report.lines.iter().map(|line| (line.name, line.decoded.bytes.len())).collect();
    assert_eq!(found, [("RX", 1), ("TX", 2)]);
    assert_eq!(loaded.report.lines[1].decoded.bytes[0].start, loaded.report.lines[0].decoded.bytes[0].start);
    // Times without a unit require a sample rate.
    let table = "0,55\n1041,AA\n2083,01\n";
    let options = |sample_rate_hz| OpenOptions { sample_rate_hz, baud: Some(9600), ..OpenOptions::default() };
    assert_eq!(
        LoadedCapture::new(read(table), &options(None)).err(),
        Some(OpenError::NoSampleRate(Format::HexBytes))
    );
    let loaded = LoadedCapture::new(read(table), &options(Some(1_000_000))).expect("it opens");
    let starts =
        loaded.report.lines[0].decoded.bytes.iter().map(|decoded| decoded.start.0).collect::<Vec<_>>();
    assert_eq!(starts, [0, 1041, 2083]);
}

#[test]
fn a_part_has_the_figures_of_the_whole_recording() {
    let whole = loaded();
    let part = |max_records, from_s, to_s| {
        LoadedCapture::of_part(&capture(), &options(), &Part { max_records, from_s, to_s }).expect("it opens")
    };
    assert_eq!(part(9, None, None), whole);
    // Loading another part equals loading that part first.
    let parts = [
        (4, None, None),
        (9, None, None),
        (9, Some(0.0015), Some(0.0025)),
        (1, None, None),
        (9, Some(9.0), None),
    ];
    for (max, from_s, to_s) in parts {
        for (after, from, to) in parts {
            let again = part(max, from_s, to_s).with_part(
                &capture(),
                &options(),
                &Part { max_records: after, from_s: from, to_s: to },
            );
            assert_eq!(
                again,
                Ok(part(after, from, to)),
                "{max} {from_s:?} {to_s:?}, then {after} {from:?} {to:?}"
            );
        }
    }
    let records = |of: &LoadedCapture| -> Vec<(u64, u64)> {
        of.records.iter().map(|record| (record.cycle.0, record.levels.0 & 1)).collect()
    };
    for (max, from_s, to_s, expected, span) in [
        // Up to the first record that does not fit.
        (4, None, None, &[(0, 0), (1000, 1), (1100, 0), (2000, 1)][..], (0.0, 0.0021)),
        // Levels at the start of the part are at cycle 0.
        (
            9,
            Some(0.002_05),
            None,
            &[(0, 1), (2100, 0), (3000, 1), (3100, 0), (5000, 1), (5100, 0)],
            (0.002_05, 0.0051),
        ),
        (9, Some(0.0015), Some(0.003), &[(0, 0), (2000, 1), (2100, 0), (3000, 1)], (0.0015, 0.003)),
        (2, Some(0.0015), Some(0.003), &[(0, 0), (2000, 1)], (0.0015, 0.0021)),
        (9, Some(7.0), Some(1.0), &[(0, 0)], (0.0051, 0.0051)),
        (0, None, Some(0.5), &[(0, 0)], (0.0, 0.001)),
    ] {
        let found = part(max, from_s, to_s);
        assert_eq!(records(&found), expected, "{max} {from_s:?} {to_s:?}");
        let kept = found.part.expect("a part");
        assert_eq!((kept.from_s, kept.to_s, kept.records, kept.of), (span.0, span.1, expected.len(), 9));
        assert_eq!((kept.end_s, found.end_s), (whole.end_s, kept.to_s));
        assert_eq!((&found.report, found.rounding.as_str()), (&whole.report, whole.rounding.as_str()));
        assert_eq!(found.clone().align(0, 0, 0.01), Err(Misaligned::Part));
        let run = found.shown_scenario("own.csv", true).run_cycles.expect("it ends");
        assert!(run > records(&found).last().expect("one").0 && run <= 5101, "{run}");
    }
}

#[test]
fn the_overview_covers_the_whole_recording() {
    let found = LoadedCapture::overview(&capture(), &options(), 0, 5).expect("it opens").expect("levels");
    // 5.1 ms in five columns, a step in each of the first three and in the last.
    assert_eq!(found.position.max, [1.0, 2.0, 3.0, 3.0, 4.0]);
    assert_eq!((found.speed.max[1].round(), found.speed.max[4].round()), (1000.0, 500.0));
    let still = LoadedCapture::overview(&capture(), &options(), 1, 2).expect("it opens").expect("levels");
    assert_eq!(still.position.max, [0.0, 0.0]);
    assert_eq!(LoadedCapture::overview(&capture(), &options(), 0, 0), Ok(None));
    let bytes = "0.1: 55\n0.2: AA\n";
    let bytes = read(std::io::Cursor::new(bytes), &Limits::default(), &mut |_| true).capture;
    assert_eq!(LoadedCapture::overview(&bytes, &OpenOptions::default(), 0, 5), Ok(None));
}

#[test]
fn steps_are_aligned_unless_one_would_precede_cycle_1() {
    for (aligned, at_s, expected) in [
        (0, 0.01, Ok([10_000, 11_000, 12_000, 14_000])),
        (3, 0.01, Ok([6000, 7000, 8000, 10_000])),
        (2, 0.002_001, Ok([1, 1001, 2001, 4001])),
        (
            2,
            0.001,
            Err(
                "aligned by step 2, the first step would be at -0.001000 s, before the start of the experiment; use a later one",
            ),
        ),
        (4, 0.01, Err("there is no step 4; 4 steps were recorded, numbered from 0; use one that both have")),
    ] {
        let mut found = loaded();
        let before = found.clone();
        let aligned = found.align(0, aligned, at_s);
        match expected {
            Ok(expected) => {
                aligned.expect("it can be");
                let cycles: Vec<u64> = found.steps_of(0).iter().map(|step| step.cycle).collect();
                assert_eq!(cycles, expected);
            }
            Err(expected) => {
                assert_eq!(aligned.expect_err("it cannot be").to_string(), expected);
                assert_eq!(found, before);
            }
        }
    }
    // A channel without steps moves nothing.
    let mut found = loaded();
    assert_eq!((found.align(1, 7, 0.01), &found), (Ok(()), &loaded()));
}

#[test]
fn steps_of_fine_files_are_compared_in_ticks() {
    // The second step is 20 us late, the third 20 us and 1 ps: a clock of 1 GHz rounds both to 20 us.
    let dump = "$timescale 1 ps $end $var wire 1 ! STEP $end $enddefinitions $end #0 0! #1000000 1! #2000000 0! \
                #121000000 1! #122000000 0! #221000001 1! #222000000 0!";
    let capture = read(std::io::Cursor::new(dump), &Limits::default(), &mut |_| true).capture;
    let options = OpenOptions::default();
    let part = Part { max_records: 100, from_s: None, to_s: None };
    let plan =
        [1000, 101_000, 201_000].into_iter().zip(1..).map(|(cycle, position)| Step { cycle, position });
    let plan = Events::of_steps(plan.collect(), 1_000_000_000);
    let within = Tolerance::from_micros(20, 0).expect("a time");
    let whole = LoadedCapture::of_part(&capture, &options, &part);
    for loaded in [LoadedCapture::new(capture, &options), whole] {
        let loaded = loaded.expect("it loads");
        assert_eq!(loaded.clock_hz, 1_000_000_000);
        let found = loaded.events(0).compare(&plan, Some(0), within).expect("both have steps").comparison;
        assert_eq!((found.differing, found.first_difference.map(|off| off.step)), (1, Some(2)), "{found:?}");
    }
}
