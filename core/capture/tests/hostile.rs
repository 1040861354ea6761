//! Truncated, changed and random files cause an error at most, and the capture is always valid.

use crate::common::read_bytes;
use crate::writers::{self, Levels};
use proptest::prelude::*;
use std::io::{BufReader, Cursor};
use stepscope_capture::{
    capture::{Capture, Change, MAX_CHANNELS},
    read::{Limits, read},
};

/// The metadata of a session with one channel.
const METADATA: &[u8] = b"[device 1]\ncapturefile=logic-1\nsamplerate=1 MHz\nprobe1=A\nunitsize=1\n";

/// A small file of each format.
fn files() -> Vec<Vec<u8>> {
    let changes = (0..30).map(|at| Change { tick: at * 3, levels: at % 8 });
    let recording = Levels {
        names: ["STEP", "DIR", "EN"].map(String::from).to_vec(),
        changes: changes.collect(),
        end: 90,
    };
    let mut files = vec![
        recording.vcd(),
        recording.saleae("\r\n"),
        recording.edges(),
        recording.session(40, true),
        recording.session(7, false),
        b"$timescale 10 ns $end $scope module m $end $var wire 4 ab bus [3:0] $end $var real 64 r r $end $upscope $end\n\
          $enddefinitions $end $dumpvars bx ab r0 r $end #0 b1010 ab #5 b1 ab $dumpoff bx ab $end #8 b11 ab #9"
            .to_vec(),
        b"0 700000000\n5 700000001\nff 700000000\n".to_vec(),
        b"Time [s],A\n-0.5,0\n-1e-3,1\n0.000000001,0\n".to_vec(),
        b"name,type,start_time,duration,data\n\"A, \"\"B\",\"data\",0.1,1e-4,0x55\n\"C\",\"data\",0.2,1e-4,0xAA\n".to_vec(),
        b"Time [s],Value,Parity Error,Framing Error\n0.1,0x55,,\n0.2,'x' (0x78),,Error\n".to_vec(),
        b"55 AA 0x01 # x\n\\x10\\x20\n".to_vec(),
        "12.5us 55 AA\n13 µs: 01\n".into(),
        b"t_ms,hex\n0.5,55AA\n".to_vec(),
        b"time_s;position;speed\n0;0;1\n0.5;-7;2\n".to_vec(),
        b"2026-01-31T23:59:59.5Z,0\n".to_vec(),
        b"; libsigrok4DSL\n; Sample rate: 1 MHz\nTime(s), STEP, DIR\n0,0,0\n0,5,1,0\n".to_vec(),
        b"STEP\tsample\tDIR\n0\t0\t1\n1\t7\t1\n".to_vec(),
        b"0,0,1\n1000,1,1\n1005,0,1\n".to_vec(),
        b"00000000  44 45  |DE|\n*\n00000004  41 |A|\n00000005\n".to_vec(),
        b"00000000: 4445 4144  DEAD\n00000004: 41  A\n".to_vec(),
        b"2026-11-26T12:00:00.5+01:00 RX: 55 AA\n2026-11-26T12:00:01,25+01:00 TX: 01\n".to_vec(),
        b"23:59:59.5: /dev/ttyS0\n55 41  UA\n00:00:01: SEND\n01\n".to_vec(),
        b"[ 12.345678] >> 55\n[ 12.5] << AA\n".to_vec(),
        b"0-9 uart-1: Start bit\n9-80 uart-1: rx-data: 41\n".to_vec(),
        b"CLOCK_FREQ=16000000\nreset_step_clock oid=3 clock=4294967290\nset_next_step_dir oid=3 dir=1\n\
          queue_step oid=3 interval=100 count=9 add=-3\nqueue_step oid=4 interval=50 count=1 add=0\n"
            .to_vec(),
    ];
    files.extend(writers::SAMPLES.map(|options| recording.samples(24_000_000, options)));
    files
}

/// Checks the invariants of a [`Capture`].
fn check_invariants(capture: &Capture) {
    assert!(capture.channels.len() <= MAX_CHANNELS);
    assert!(
        capture
            .changes
            .iter()
            .zip(capture.changes.iter().skip(1))
            .all(|(one, next)| one.tick < next.tick && one.levels != next.levels)
    );
    assert!(capture.bytes.windows(2).all(|pair| pair[0].tick <= pair[1].tick));
    assert!(capture.positions.windows(2).all(|pair| pair[0].tick <= pair[1].tick));
    let bits = u64::MAX.checked_shr(64 - capture.channels.len() as u32).unwrap_or(0);
    assert!(capture.changes.iter().all(|change| change.levels & !bits == 0));
    assert!(capture.bytes.iter().all(|byte| usize::from(byte.channel) < capture.channels.len()));
    let last = capture.changes.last().map(|change| change.tick).into_iter();
    let last = last
        .chain(capture.bytes.last().map(|byte| byte.tick))
        .chain(capture.positions.last().map(|row| row.tick));
    assert!(last.max().unwrap_or(0) <= capture.end);
    assert!(capture.notes.len() <= 20);
}

fn check_reading(bytes: &[u8]) {
    let reading = read_bytes(bytes);
    check_invariants(&reading.capture);
    let few = read(BufReader::with_capacity(3, Cursor::new(bytes)), &Limits { max_rows: 5 }, &mut |_| true);
    check_invariants(&few.capture);
    assert!(few.capture.len() <= 5);
}

#[test]
fn every_file_is_read() {
    for (at, file) in files().iter().enumerate() {
        let reading = read_bytes(file);
        let is_meant =
            file.starts_with(b"2026-01-31T") || file.ends_with(b"oid=4 interval=50 count=1 add=0\n");
        assert_eq!(reading.error.is_some(), is_meant, "{at}: {:?}", reading.error);
    }
}

#[test]
fn truncated_files_are_read_up_to_their_end() {
    for file in files() {
        let whole = read_bytes(&file).capture;
        for length in 0..file.len() {
            check_reading(&file[..length]);
            let part = read_bytes(&file[..length]).capture;
            // All but the last row, in which a number may be cut off.
            if part.format == whole.format && part.timebase == whole.timebase {
                let rows = part.changes.len().saturating_sub(1);
                assert!(part.changes.iter().take(rows).eq(whole.changes.iter().take(rows)));
            }
        }
    }
}

#[test]
fn a_session_that_unpacks_to_too_many_samples_is_refused() {
    let zeros = vec![0; 3_000_000];
    let metadata = b"[device 1]\ncapturefile=logic-1\nsamplerate=1 MHz\nprobe1=A\nunitsize=1\n".to_vec();
    let files = [("metadata".to_string(), metadata), ("logic-1-1".into(), zeros)];
    let session = writers::zip(&files, true);
    assert!(session.len() < 20_000);
    let mut calls = 0;
    let reading = read(Cursor::new(&session), &Limits { max_rows: 100 }, &mut |_| {
        calls += 1;
        true
    });
    let error = reading.error.expect("it is refused");
    assert_eq!(error.message, "more than 1 000 000 samples; record a shorter time");
    assert!(calls >= 3);
    assert_eq!(read(Cursor::new(&session), &Limits { max_rows: 1000 }, &mut |_| true).error, None);
}

/// Overlapping files, files with a false size, and two files with one name are refused.
#[test]
fn a_zip_with_overlapping_files_or_false_sizes_is_refused() {
    let metadata = METADATA.to_vec();
    let files = |samples: &[(&str, Vec<u8>)]| {
        let mut all = vec![("metadata".to_string(), metadata.clone())];
        all.extend(samples.iter().map(|(name, held)| ((*name).to_string(), held.clone())));
        writers::zip(&all, true)
    };
    let refused = |zip: &[u8]| {
        read(Cursor::new(zip), &Limits::default(), &mut |_| true).error.map(|error| error.message)
    };
    let good = files(&[("logic-1-1", vec![0, 1, 0]), ("logic-1-2", vec![0, 1, 0])]);
    assert_eq!(refused(&good), None);
    // The directory's entry of the second piece points to the first.
    let entries: Vec<usize> =
        (0..good.len() - 4).filter(|at| good[*at..].starts_with(b"PK\x01\x02")).collect();
    let mut overlapping = good.clone();
    let first: Vec<u8> = good[entries[1] + 16..entries[1] + 28].to_vec();
    overlapping[entries[2] + 16..entries[2] + 28].copy_from_slice(&first);
    let first: Vec<u8> = good[entries[1] + 42..entries[1] + 46].to_vec();
    overlapping[entries[2] + 42..entries[2] + 46].copy_from_slice(&first);
    assert!(refused(&overlapping).is_some_and(|message| message.starts_with("files of the zip overlap")));
    // The declared size is too small, or too large.
    let mut less = good.clone();
    less[entries[1] + 24] = 2;
    assert!(refused(&less).is_some_and(|message| message.starts_with("“logic-1-1” cannot be unpacked: ")));
    let mut more = good;
    more[entries[1] + 24..entries[1] + 28].copy_from_slice(&[0xfe; 4]);
    assert!(refused(&more).is_some_and(|message| message.starts_with("“logic-1-1” cannot be unpacked: ")));
    // Pieces are numbered from 1 without gaps, or there is one without a number.
    for (names, message) in [
        (&["logic-1-2", "logic-1-3"][..], "the session begins with “logic-1-2”, so samples are missing"),
        (&["logic-1-1", "logic-1-3"], "“logic-1-3” follows “logic-1-1”, so samples are missing"),
        (&["logic-1", "logic-1-1"], "“logic-1-1” follows “logic-1”, so samples are missing or duplicated"),
        (
            &["logic-1-1", "logic-1-1"],
            "“logic-1-1” follows “logic-1-1”, so samples are missing or duplicated",
        ),
        (&["logic-1-18446744073709551615"; 2], "the session begins with “logic-1-18446744073709551615”"),
    ] {
        let pieces: Vec<_> = names.iter().map(|&name| (name, vec![0, 1])).collect();
        let found = refused(&files(&pieces));
        assert!(found.as_ref().is_some_and(|found| found.starts_with(message)), "{names:?}: {found:?}");
    }
    assert_eq!(refused(&files(&[("logic-1", vec![0, 1])])), None);
    // A description that is too long.
    let long = writers::zip(
        &[("metadata".to_string(), vec![b' '; (1 << 20) + 1]), ("logic-1-1".into(), vec![0, 1])],
        true,
    );
    assert_eq!(
        refused(&long).as_deref(),
        Some("“metadata” has more than 1048576 bytes; save the session again")
    );
    // Two descriptions; one in a folder.
    let two = files(&[("metadata", metadata.clone()), ("logic-1-1", vec![0, 1])]);
    assert_eq!(
        refused(&two).as_deref(),
        Some("the zip has two files named “metadata”; save the session again")
    );
    let nested = writers::zip(
        &[("own/metadata".to_string(), metadata.clone()), ("own/logic-1-1".into(), vec![0, 1])],
        true,
    );
    assert!(
        refused(&nested)
            .is_some_and(|message| message.starts_with("“metadata” is in the folder “own/” of the zip; "))
    );
}

/// Programs differ in the value that they use if there are two.
#[test]
fn a_session_with_a_repeated_value_is_refused() {
    let refused = |files: &[(&str, &[u8])]| {
        let all: Vec<_> = files.iter().map(|(name, held)| ((*name).to_string(), held.to_vec())).collect();
        let reading = read(Cursor::new(writers::zip(&all, true)), &Limits::default(), &mut |_| true);
        reading.error.map(|error| error.message)
    };
    let samples: (&str, &[u8]) = ("logic-1-1", &[0, 1, 0]);
    assert_eq!(refused(&[("version", b"2"), ("metadata", METADATA), samples]), None);
    assert_eq!(
        refused(&[("version", b"2"), ("version", b"1"), ("metadata", METADATA), samples]).as_deref(),
        Some("the zip has two files named “version”; save the session again")
    );
    for (key, line) in [
        ("samplerate", "samplerate=2 MHz"),
        ("samplerate", " samplerate = 1 MHz"),
        ("unitsize", "unitsize=2"),
        ("capturefile", "capturefile=logic-2"),
        ("probe1", "probe1=B"),
        ("probe1", "probe01=B"),
    ] {
        let metadata = [METADATA, line.as_bytes()].concat();
        assert_eq!(
            refused(&[("metadata", &metadata), samples]),
            Some(format!("“metadata” contains {key} twice; save the session again")),
            "{line}"
        );
    }
    // Values of a second device are ignored.
    let metadata = [METADATA, b"[device 2]\nsamplerate=2 MHz\nprobe1=B\n"].concat();
    assert_eq!(refused(&[("metadata", &metadata), samples]), None);
}

/// 70 separate pieces with a declared size of 4 GB each.
#[test]
fn a_session_of_terabytes_is_refused() {
    let mut all = vec![("metadata".to_string(), METADATA.to_vec())];
    all.extend((1..=70).map(|piece| (format!("logic-1-{piece}"), vec![0, 1, 0])));
    let mut zip = writers::zip(&all, true);
    let entries: Vec<usize> = (0..zip.len() - 4).filter(|at| zip[*at..].starts_with(b"PK\x01\x02")).collect();
    for entry in &entries[1..] {
        zip[entry + 24..entry + 28].copy_from_slice(&0xffff_fffe_u32.to_le_bytes());
    }
    let error = read(Cursor::new(zip), &Limits::default(), &mut |_| true).error.expect("it is refused");
    assert_eq!(
        error.message,
        "the samples unpack to 300 647 710 580 bytes, more than the maximum of 274 877 906 944; record a shorter time or at a lower rate"
    );
}

#[test]
fn a_session_of_too_many_files_is_refused() {
    let mut all = vec![("metadata".to_string(), METADATA.to_vec())];
    all.extend((1..=65_536).map(|piece| (format!("logic-1-{piece}"), vec![0])));
    let read = |all: &[(String, Vec<u8>)]| {
        read(Cursor::new(writers::zip(all, false)), &Limits::default(), &mut |_| true).error
    };
    let error = read(&all).expect("it is refused");
    assert_eq!(error.message, "more than 65536 files in the zip; record a shorter time");
    all.pop();
    assert_eq!(read(&all), None);
}

/// A file with a name in another character set does not overlap the next one.
#[test]
fn a_session_may_have_names_that_are_not_utf8() {
    let name = "x".repeat(40);
    let all = [
        ("metadata".to_string(), METADATA.to_vec()),
        (name.clone(), vec![1]),
        ("logic-1-1".into(), vec![0, 1, 0]),
    ];
    let mut zip = writers::zip(&all, true);
    let places: Vec<usize> =
        (0..zip.len() - name.len()).filter(|at| zip[*at..].starts_with(name.as_bytes())).collect();
    assert_eq!(places.len(), 2);
    for at in places {
        zip[at..at + name.len()].fill(0x82);
    }
    let reading = read(Cursor::new(zip), &Limits::default(), &mut |_| true);
    assert_eq!((reading.error, reading.capture.changes.len()), (None, 3));
}

/// Endless gaps: no text is searched.
#[test]
fn a_line_of_a_megabyte_is_read() {
    let bytes = 1 << 18;
    for (line, expected) in [
        ("55  ".repeat(bytes), bytes),
        ("20  ".repeat(bytes), bytes),
        ("20\t".repeat(bytes), bytes),
        (format!("00000000  {}", "20  ".repeat(bytes - 3)), bytes - 3),
        (format!("{} |{}|", "20 ".repeat(bytes - 3), " ".repeat(bytes - 3)), bytes - 3),
        (format!("12:00:00.5 RX: {}", "55  ".repeat(bytes - 4)), bytes - 4),
        (format!("0.5: {}", "55  ".repeat(bytes - 2)), bytes - 2),
        (format!("[12.5] {} 55", ">> ".repeat(bytes)), 1),
    ] {
        let reading = read_bytes(format!("{line}\n"));
        assert_eq!(reading.error, None, "{}", &line[..20]);
        assert_eq!(reading.capture.bytes.len(), expected, "{}", &line[..20]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        check_reading(&bytes);
    }

    #[test]
    fn random_letters_never_panic(text in "[ -~\n\t]{0,300}") {
        check_reading(text.as_bytes());
    }

    #[test]
    fn words_of_dumps_in_any_order_never_panic(
        words in prop::collection::vec(prop::sample::select(vec![
            "$var", "wire", "1", "64", "real", "!", "a", "$end", "$scope", "module", "m", "$upscope", "$enddefinitions",
            "#0", "#5", "#9", "1!", "x!", "b10", "b", "r1", "s", "[3:0]", "[0:3]", "$dumpoff", "$dumpvars", "$timescale",
            "1us", "$comment", "bzx", "-", "#18446744073709551615", "[9223372036854775807:-9223372036854775808]",
        ]), 0..80),
    ) {
        check_reading(format!("$var wire 4 a n $end {}", words.join(" ")).as_bytes());
    }

    #[test]
    fn changed_files_never_panic(
        at in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4_u8), 1..8),
    ) {
        let files = files();
        let mut file = at.get(&files).clone();
        for (at, byte, kind) in changes {
            let at = at.index(file.len());
            match kind {
                0 => file[at] = byte,
                1 => file.insert(at, b"0123456789,;-.e\n\"$#"[usize::from(byte) % 19]),
                2 if file.len() > 1 => drop(file.remove(at)),
                _ => {
                    let part: Vec<u8> = file.iter().skip(at).take(usize::from(byte)).copied().collect();
                    file.extend(part);
                }
            }
        }
        check_reading(&file);
    }
}
