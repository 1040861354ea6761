//! Random recordings are equal after they are written and read in each format.

use crate::common::read_bytes;
use crate::writers::{self, Levels};
use proptest::prelude::*;
use stepscope_capture::{
    capture::{Change, Format, TimedByte, TimedPosition},
    timebase::Timebase,
};

/// Changes in order of time, the first at tick 0, each with other levels than the previous one.
fn changes(channels: usize, most: u64) -> impl Strategy<Value = Vec<Change>> {
    let mask = u64::MAX >> (64 - channels);
    let rows = prop::collection::vec((1..most, any::<u64>()), 1..40);
    rows.prop_map(move |rows| {
        let (mut tick, mut list) = (0, Vec::<Change>::new());
        for (gap, levels) in rows {
            let levels = levels & mask;
            if list.last().is_none_or(|last| last.levels != levels) {
                list.push(Change { tick, levels });
            }
            tick += gap;
        }
        list
    })
}

fn recording(most_channels: usize, most_gap: u64) -> impl Strategy<Value = Levels> {
    (1..=most_channels).prop_flat_map(move |channels| {
        changes(channels, most_gap).prop_map(move |changes| {
            let end = changes.last().map_or(0, |change| change.tick);
            let names = (0..channels).map(|at| format!("line {at}").replace(' ', "_")).collect();
            Levels { names, changes, end }
        })
    })
}

fn equal(file: &[u8], format: Format, base: Option<Timebase>, written: &Levels) {
    let reading = read_bytes(file);
    assert_eq!(reading.error, None, "{}", String::from_utf8_lossy(file));
    let capture = reading.capture;
    let name = |name: String| name.strip_prefix("top.").map(String::from).unwrap_or(name);
    let names: Vec<String> = capture.channels.into_iter().map(|channel| name(channel.name)).collect();
    assert_eq!((capture.format, capture.timebase, names), (format, base, written.names.clone()));
    assert_eq!(
        capture.changes.iter().collect::<Vec<_>>(),
        written.changes,
        "{}",
        String::from_utf8_lossy(file)
    );
    assert_eq!((capture.end, capture.notes), (written.end, Vec::new()));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn dumps_round_trip(recording in recording(64, 1 << 40)) {
        equal(&recording.vcd(), Format::Vcd, Timebase::new(1, 1_000_000_000), &recording);
    }

    #[test]
    fn tables_of_levels_round_trip(recording in recording(64, 1 << 40), shift in any::<bool>()) {
        let format = Format::SaleaeCsv;
        equal(&recording.saleae("\n"), format, Timebase::new(1, 1_000_000_000), &recording);
        equal(&recording.saleae("\r\n"), format, Timebase::new(1, 1_000_000_000), &recording);
        if shift {
            equal(&recording.edges(), Format::EdgesCsv, None, &recording);
        }
    }

    #[test]
    fn traces_round_trip(changes in changes(36, 1 << 40)) {
        let mut text = writers::trace(&changes);
        let expected = read_bytes(&text).capture;
        prop_assume!(changes.iter().any(|change| change.levels > 0xff));
        prop_assert_eq!(expected.changes.iter().collect::<Vec<_>>(), changes);
        text.insert(0, '\u{feff}');
        prop_assert_eq!(read_bytes(&text).capture, expected);
    }

    #[test]
    fn samples_round_trip(recording in recording(64, 30), rate in 1_u64..2_000_000_000) {
        let base = Timebase::new(1, rate);
        for options in writers::SAMPLES {
            equal(&recording.samples(rate, options), Format::SigrokCsv, base, &recording);
        }
    }

    #[test]
    fn sessions_round_trip(recording in recording(64, 3000), piece in 1_usize..4000, pack in any::<bool>()) {
        // No more files than a session may have.
        let piece = piece.max((recording.end as usize + 1) * 8 / 60_000 + 1);
        let file = recording.session(piece, pack);
        equal(&file, Format::SigrokSession, Timebase::new(1, 24_000_000), &recording);
    }

    #[test]
    fn bytes_round_trip(bytes in prop::collection::vec(any::<u8>(), 1..60), gaps in prop::collection::vec(0_u64..1 << 30, 60)) {
        for (separator, prefix) in [(" ", ""), (",", "0x"), ("; ", "0X"), ("\n", ""), ("", "")] {
            let words: Vec<String> = bytes.iter().map(|byte| format!("{prefix}{byte:02x}")).collect();
            let text = words.join(separator);
            // Rows of zeros and ones alone, and a word alone, may be of another kind.
            prop_assume!(separator == " " || separator == "; " || bytes.len() > 2 && bytes[0] > 0x11);
            let capture = read_bytes(text).capture;
            prop_assert_eq!(capture.format, Format::HexBytes);
            prop_assert_eq!(capture.bytes.iter().map(|byte| byte.byte).collect::<Vec<_>>(), bytes.clone());
        }
        let mut tick = 0;
        let timed: Vec<TimedByte> = bytes.iter().zip(gaps).map(|(&byte, gap)| {
            tick += gap;
            TimedByte { tick, channel: 0, byte, framing_error: byte > 99 }
        }).collect();
        let capture = read_bytes(writers::decoded(&timed)).capture;
        prop_assert_eq!(capture.format, Format::SaleaeBytes);
        prop_assert_eq!(&capture.bytes, &timed);
        let capture = read_bytes(writers::timed_hex(&timed)).capture;
        prop_assert_eq!(capture.timebase, Timebase::new(1, 1_000_000_000));
        let plain: Vec<TimedByte> = timed.iter().map(|byte| TimedByte { framing_error: false, ..*byte }).collect();
        prop_assert_eq!(capture.bytes, plain);
    }

    #[test]
    fn positions_round_trip(steps in prop::collection::vec((1_u64..1 << 40, any::<i64>()), 1..40)) {
        let mut tick = 0;
        let positions: Vec<TimedPosition> = steps.into_iter().map(|(gap, position)| {
            tick += gap;
            TimedPosition { tick, position }
        }).collect();
        let capture = read_bytes(writers::positions(&positions)).capture;
        prop_assert_eq!(capture.timebase, Timebase::new(1, 1_000_000_000));
        prop_assert_eq!(capture.positions, positions);
    }
}
