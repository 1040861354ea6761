//! Converts a capture to records of the 36 signals, in clock cycles (DESIGN A9, B1).
//!
//! Times are rounded to the nearest cycle, halves up. With a slow clock, changes may share a cycle and pulses may be
//! lost; both are counted.
//!
//! ```
//! use stepscope_capture::{ChannelMap, RecordedSignals, read::{Limits, read}};
//!
//! let dump = "$timescale 1 us $end $var wire 1 ! STEP $end $enddefinitions $end #0 0! #10 1! #12 0!";
//! let capture = read(std::io::Cursor::new(dump), &Limits::default(), &mut |_| true).capture;
//! let (map, timebase) = (ChannelMap::proposed(&capture), capture.timebase.expect("the dump has a time scale"));
//! let signals = RecordedSignals::new(capture, &map, timebase, 16_000_000).expect("the recording is short");
//! assert_eq!(signals.records[1].cycle.0, 160);
//! ```

use crate::capture::{Capture, Change};
use crate::channel_map::{BUS_SIGNALS, ChannelMap, Entry};
use crate::generated_pulses::{GeneratedPulses, Steps};
use crate::{changes, timebase::Timebase};
use core::fmt;
use stepscope_peripheral::signal::{Levels, Record};
use stepscope_peripheral::units::Instant;

/// Maximum width of generated pulses, as a frequency: 2.5 µs.
const MAX_WIDTH_HZ: u64 = 400_000;
/// The last valid cycle of a trace.
const LAST_CYCLE: u64 = 9_000_000_000_000_000;

/// Records of the signals of a capture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedSignals {
    pub clock_hz: u32,
    pub channels: u8,
    /// From cycle 0; cycles rise and levels differ. Signals without a channel have their reset levels; DIR is right.
    pub records: Vec<Record>,
    pub end: Instant,
    pub rounding: Rounding,
}

/// Effects of rounding times to cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rounding {
    /// Changes whose time is not a whole cycle.
    pub rounded: u64,
    /// Changes in the cycle of the previous change.
    pub merged: u64,
    /// Signals that changed twice within a cycle, and steps without space for a pulse.
    pub lost: u64,
    /// Simultaneous changes of both encoder inputs, or CW and CCW high together: no step is counted.
    pub ambiguous: u64,
}

impl fmt::Display for Rounding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.rounded {
            0 => f.write_str("all times are whole cycles; nothing is rounded")?,
            1 => f.write_str("1 time is rounded to the nearest cycle, by half a cycle at most")?,
            count => write!(f, "{count} times are rounded to the nearest cycle, by half a cycle at most")?,
        }
        match self.merged {
            0 => {}
            1 => f.write_str("; 1 change shares its cycle with the previous one")?,
            count => write!(f, "; {count} changes share their cycle with the previous one")?,
        }
        match self.lost {
            0 => Ok(()),
            1 => f.write_str("; 1 pulse within a cycle is lost; use a faster clock"),
            count => write!(f, "; {count} pulses within a cycle are lost; use a faster clock"),
        }
    }
}

/// A time after the last valid cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLate {
    /// In ticks of the file.
    pub tick: u64,
}

impl fmt::Display for TooLate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "tick {} of the file is after the last valid cycle, {LAST_CYCLE}; use a slower clock",
            self.tick
        )
    }
}

impl core::error::Error for TooLate {}

fn cycle(timebase: Timebase, tick: u64, clock_hz: u32) -> Result<u64, TooLate> {
    timebase.cycle(tick, clock_hz).filter(|cycle| *cycle <= LAST_CYCLE).ok_or(TooLate { tick })
}

impl RecordedSignals {
    /// Converts a capture, with ticks of `timebase`, to cycles of `clock_hz`; frees the capture's memory meanwhile.
    /// Errors: [`TooLate`].
    pub fn new(
        capture: Capture,
        map: &ChannelMap,
        timebase: Timebase,
        clock_hz: u32,
    ) -> Result<Self, TooLate> {
        let end = Instant(cycle(timebase, capture.end, clock_hz)?);
        if let Some(last) = capture.changes.last() {
            cycle(timebase, last.tick, clock_hz)?;
        }
        // A generated pulse has an additional fall.
        let count = capture.changes.len() * if map.generates_pulses() { 2 } else { 1 };
        let mut records =
            Records::with_signals(capture.changes.into_iter(), Signals::new(map), timebase, clock_hz);
        // Allocated once: a doubled vector may not fit next to the old one.
        let mut all: Vec<Record> = Vec::with_capacity(count);
        all.extend(records.by_ref());
        if all.is_empty() {
            all.push(Record { cycle: Instant(0), levels: records.signals.levels(0) });
        }
        let end = end.max(all.last().map_or(Instant(0), |record| record.cycle));
        Ok(Self { clock_hz, channels: map.bus_channels(), records: all, end, rounding: records.rounding })
    }
}

/// Iterator that converts changes to records.
#[derive(Clone, Debug)]
pub struct Records<'m, I> {
    changes: I,
    signals: Signals<'m>,
    timebase: Timebase,
    clock_hz: u32,
    /// Cycles per tick if that is a whole number, which avoids a division.
    cycles_per_tick: Option<u64>,
    /// The latest record. It is not returned yet, since later changes may be in its cycle.
    pending: Option<Record>,
    /// Levels of the last returned record.
    last: Option<Levels>,
    /// STEP signals whose generated pulses are high in `pending`.
    high: u64,
    /// The end of generated pulses, returned next.
    fall: Option<Record>,
    /// Effects of rounding up to now.
    pub rounding: Rounding,
}

impl<'m> Records<'m, changes::Iter<'m>> {
    /// Records of a capture, as in [`RecordedSignals::new`]. Errors: [`TooLate`].
    pub fn new(
        capture: &'m Capture,
        map: &'m ChannelMap,
        timebase: Timebase,
        clock_hz: u32,
    ) -> Result<Self, TooLate> {
        Self::starting_at(capture, map, timebase, clock_hz, 0)
    }

    /// Records from a tick on; the first, at cycle 0, has the levels at that time. Errors: [`TooLate`].
    pub fn starting_at(
        capture: &'m Capture,
        map: &'m ChannelMap,
        timebase: Timebase,
        clock_hz: u32,
        tick: u64,
    ) -> Result<Self, TooLate> {
        let last = capture.changes.last().map_or(0, |change| change.tick);
        cycle(timebase, last, clock_hz)?;
        Ok(Self::with_signals(capture.changes.iter_from(tick), Signals::new(map), timebase, clock_hz))
    }

    /// Records with ticks as cycles, without rounding.
    pub fn in_ticks(capture: &'m Capture, map: &'m ChannelMap) -> Self {
        Self::with_signals(capture.changes.iter(), Signals::new(map), Timebase::SECOND, 1)
    }
}

impl<'m, I: Iterator<Item = Change>> Records<'m, I> {
    fn with_signals(changes: I, signals: Signals<'m>, timebase: Timebase, clock_hz: u32) -> Self {
        let cycles_per_tick = timebase.cycles_per_tick(clock_hz);
        let (pending, last, high, fall, rounding) = (None, None, 0, None, Rounding::default());
        Self { changes, signals, timebase, clock_hz, cycles_per_tick, pending, last, high, fall, rounding }
    }

    /// Adds a change and returns the pending record if no later change can be in its cycle.
    fn add(&mut self, Change { tick, levels }: Change) -> Option<Record> {
        // The first record has the levels of cycle 0.
        let cycle = if self.pending.is_some() { self.cycle(tick) } else { 0 };
        let (levels, high) = self.levels(cycle, levels);
        let now = Record { cycle: Instant(cycle), levels };
        let (ended, falling) = (self.pending.replace(now)?, core::mem::replace(&mut self.high, high));
        if ended.cycle == now.cycle {
            self.count_merged(ended.levels, now.levels);
            return None;
        }
        self.finish_record(ended, falling, cycle - ended.cycle.0)
    }

    fn cycle(&mut self, tick: u64) -> u64 {
        let cycle = if let Some(cycles) = self.cycles_per_tick {
            tick.checked_mul(cycles)
        } else {
            self.rounding.rounded += u64::from(!self.timebase.is_on_cycle(tick, self.clock_hz));
            self.timebase.cycle(tick, self.clock_hz)
        };
        cycle.unwrap_or(LAST_CYCLE)
    }

    /// Levels of the signals, and the STEP signals whose generated pulses are high.
    fn levels(&mut self, cycle: u64, channels: u64) -> (Levels, u64) {
        let levels = self.signals.levels(channels);
        let Some(generated) = &mut self.signals.generated else { return (levels, 0) };
        let Steps { pulses, levels: more, ambiguous } = generated.update(channels);
        self.rounding.ambiguous += u64::from(ambiguous);
        let since = self.pending.map_or(u64::MAX, |pending| cycle - pending.cycle.0);
        // A pulse and the pause after it last at least one cycle each.
        let lost = if since < 2 { self.high & pulses } else { 0 };
        self.rounding.lost += u64::from(lost.count_ones());
        let high = pulses & !lost | if since == 0 { self.high } else { 0 };
        (Levels(levels.0 | high | more), high)
    }

    /// Counts a change in the cycle of the previous one, and recorded signals that change back in it.
    fn count_merged(&mut self, before: Levels, now: Levels) {
        let last = self.last.unwrap_or(Levels::RESET).0;
        let recorded = !self.signals.generated.as_ref().map_or(0, GeneratedPulses::signals);
        self.rounding.merged += u64::from(before != now);
        self.rounding.lost += u64::from(((last ^ before.0) & !(last ^ now.0) & recorded).count_ones());
    }

    /// Returns a record if its levels are new, and sets the end of its generated pulses: halfway to the next record, or
    /// after the maximum width.
    fn finish_record(&mut self, record: Record, falling: u64, cycles_to_next: u64) -> Option<Record> {
        let is_new = self.last.replace(record.levels) != Some(record.levels);
        if falling != 0 && cycles_to_next > 1 {
            let width = (cycles_to_next / 2).min(u64::from(self.clock_hz) / MAX_WIDTH_HZ).max(1);
            let levels = Levels(record.levels.0 & !falling);
            self.last = Some(levels);
            self.fall = Some(Record { cycle: Instant(record.cycle.0 + width), levels });
        }
        is_new.then_some(record)
    }
}

impl<I: Iterator<Item = Change>> Iterator for Records<'_, I> {
    type Item = Record;

    #[inline]
    fn next(&mut self) -> Option<Record> {
        if let Some(fall) = self.fall.take() {
            return Some(fall);
        }
        while let Some(change) = self.changes.next() {
            if let Some(record) = self.add(change) {
                return Some(record);
            }
        }
        let last = self.pending.take()?;
        let falling = core::mem::take(&mut self.high);
        self.finish_record(last, falling, u64::MAX)
    }
}

/// Converts levels of channels to levels of signals.
#[derive(Clone, Debug)]
struct Signals<'m> {
    entries: &'m [Entry],
    /// Levels of signals without a channel.
    unmapped: u64,
    generated: Option<GeneratedPulses>,
}

impl<'m> Signals<'m> {
    fn new(map: &'m ChannelMap) -> Self {
        let right = 0xffff << Levels::DIR_SHIFT;
        let generated = GeneratedPulses::new(map);
        let bus = map.entries().iter().filter(|entry| entry.bit < BUS_SIGNALS);
        let mapped = bus.fold(generated.as_ref().map_or(0, GeneratedPulses::signals), |mask, entry| {
            mask | 1 << entry.bit
        });
        // DIR of unused channels is low.
        let used = (1_u64 << map.bus_channels()) - 1;
        let unmapped = (Levels::RESET.0 | right & used << Levels::DIR_SHIFT) & !mapped;
        Self { entries: map.entries(), unmapped, generated }
    }

    fn levels(&self, channels: u64) -> Levels {
        let bus = self.entries.iter().filter(|entry| entry.bit < BUS_SIGNALS);
        Levels(
            bus.fold(self.unmapped, |levels, entry| levels | u64::from(entry.level(channels)) << entry.bit),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::{Channel, Format};

    fn capture(changes: &[(u64, u64)]) -> Capture {
        let channels = ["STEP", "DIR", "nEN"].map(|name| Channel { name: name.into() }).into();
        let changes: crate::changes::Changes =
            changes.iter().map(|&(tick, levels)| Change { tick, levels }).collect();
        let end = changes.last().map_or(0, |change| change.tick) + 10;
        Capture { channels, changes, end, ..Capture::new(Format::Vcd) }
    }

    fn recorded(changes: &[(u64, u64)], clock_hz: u32) -> (Vec<(u64, u64)>, Rounding, u64) {
        let capture = capture(changes);
        let map = ChannelMap::proposed(&capture);
        let base = Timebase::new(1, 1_000_000).expect("a time base");
        let found = RecordedSignals::new(capture, &map, base, clock_hz).expect("it fits");
        let records = found.records.iter().map(|record| (record.cycle.0, record.levels.0)).collect();
        (records, found.rounding, found.end.0)
    }

    const IDLE: u64 = Levels::RX | Levels::TX;
    const RIGHT: u64 = 1 << Levels::DIR_SHIFT;

    #[test]
    fn changes_become_records_without_channels_that_have_no_signal() {
        let (records, rounding, end) =
            recorded(&[(5, 0b110), (20, 0b1110), (30, 0b1010), (40, 0b1011), (42, 0b1010)], 2_000_000);
        let en = Levels::EN;
        assert_eq!(
            records,
            [
                (0, IDLE | RIGHT),
                (60, IDLE | RIGHT | en),
                (80, IDLE | RIGHT | en | 1),
                (84, IDLE | RIGHT | en)
            ]
        );
        assert_eq!((rounding, end), (Rounding::default(), 104));
    }

    #[test]
    fn simultaneous_and_lost_changes_are_counted() {
        // At 100 kHz a cycle is 10 us: the pulse from 21 to 23 is within one, DIR and STEP change together at 50.
        let (records, rounding, _) =
            recorded(&[(0, 0), (21, 1), (23, 0), (51, 2), (53, 3), (70, 2)], 100_000);
        let cycles: Vec<u64> = records.iter().map(|(cycle, _)| *cycle).collect();
        assert_eq!(cycles, [0, 5, 7]);
        assert_eq!(rounding, Rounding { rounded: 4, merged: 2, lost: 1, ambiguous: 0 });
        assert!(rounding.to_string().contains("1 pulse within a cycle is lost"), "{rounding}");
        // A channel that is no signal changes first, in the same cycle.
        let (records, rounding, _) = recorded(&[(0, 0), (20, 1), (21, 0b1001), (22, 0b1000)], 100_000);
        assert_eq!(records.iter().map(|(cycle, _)| *cycle).collect::<Vec<_>>(), [0]);
        assert_eq!((rounding.merged, rounding.lost), (1, 1));
    }

    #[test]
    fn a_time_after_the_last_cycle_is_an_error_and_an_empty_capture_has_one_record() {
        let base = Timebase::new(1, 1).expect("a time base");
        let late = capture(&[(0, 0), (u64::MAX / 2, 1)]);
        let map = ChannelMap::proposed(&late);
        assert!(RecordedSignals::new(late, &map, base, 1_000_000_000).is_err());
        let none = RecordedSignals::new(Capture::new(Format::Vcd), &ChannelMap::default(), base, 1)
            .expect("it fits");
        assert_eq!(none.records.len(), 1);
    }

    fn generated(map: &str, changes: &[(u64, u64)]) -> (Vec<(u64, u64, u64)>, Rounding) {
        let capture = capture(changes);
        let map = ChannelMap::parse(map, &capture).expect("a map");
        let base = Timebase::new(1, 1_000_000).expect("a time base");
        let found = RecordedSignals::new(capture.clone(), &map, base, 1_000_000).expect("it fits");
        let streamed = Records::new(&capture, &map, base, 1_000_000).expect("it fits");
        assert!(streamed.eq(found.records.iter().copied()));
        let levels =
            |record: &Record| (record.cycle.0, record.levels.0 & 1, u64::from(record.levels.0 & RIGHT != 0));
        (found.records.iter().map(levels).collect(), found.rounding)
    }

    #[test]
    fn each_edge_of_dedge_becomes_a_pulse() {
        // The edge at 31 is one cycle after that at 30, whose pulse ends only then.
        let edges = [(0, 0b10), (20, 0b11), (23, 0b01), (30, 0b00), (31, 0b01), (50, 0b00), (60, 0b01)];
        let (records, rounding) = generated("DEDGE0=STEP,DIR0=DIR", &edges);
        let expected = [
            (0, 0, 1),
            (20, 1, 1),
            (21, 0, 1),
            (23, 0, 0),
            (30, 1, 0),
            (31, 0, 0),
            (50, 1, 0),
            (52, 0, 0),
            (60, 1, 0),
            (62, 0, 0),
        ];
        assert_eq!((records, rounding.lost), (expected.to_vec(), 1));
        // In one cycle two edges are one step, and one is lost.
        let slow = Timebase::new(1, 10_000_000).expect("a time base");
        let twice = capture(&[(0, 0), (100, 1), (104, 0), (300, 1)]);
        let map = ChannelMap::parse("DEDGE0=STEP", &twice).expect("a map");
        let found = RecordedSignals::new(twice, &map, slow, 1_000_000).expect("it fits");
        assert_eq!((found.records.len(), found.rounding.lost), (5, 1));
    }

    #[test]
    fn cw_and_ccw_pulses_keep_their_width_and_give_dir() {
        let pulses = [(0, 0), (20, 1), (25, 0), (40, 2), (43, 0), (60, 1), (62, 3), (64, 0)];
        let (records, rounding) = generated("CW0=STEP,CCW0=DIR", &pulses);
        let expected = [(0, 0, 1), (20, 1, 1), (25, 0, 1), (40, 1, 0), (43, 0, 0), (60, 1, 1), (64, 0, 1)];
        // Both are high at 62.
        assert_eq!((records, rounding.ambiguous, rounding.lost), (expected.to_vec(), 1, 0));
        let (records, _) = generated("CW0=!STEP,CCW0=!DIR", &[(0, 3), (20, 2), (25, 3)]);
        assert_eq!(records, [(0, 0, 1), (20, 1, 1), (25, 0, 1)]);
    }

    #[test]
    fn each_edge_of_an_encoder_counts_by_its_phase() {
        let phases = [(0, 0), (10, 1), (20, 3), (30, 2), (40, 0), (50, 2), (60, 3), (70, 0)];
        let (records, rounding) = generated("A0=STEP,B0=DIR", &phases);
        let rises: Vec<(u64, u64)> =
            records.iter().filter(|record| record.1 == 1).map(|record| (record.0, record.2)).collect();
        // Four steps right, two left, then a change of both lines at once.
        assert_eq!(rises, [(10, 1), (20, 1), (30, 1), (40, 1), (50, 0), (60, 0)]);
        assert_eq!((rounding.ambiguous, rounding.lost), (1, 0));
        assert_eq!(generated("A0=!STEP,B0=DIR", &phases).0[1], (10, 1, 0));
    }

    #[test]
    fn a_table_becomes_records() {
        use crate::{
            ChannelMap, RecordedSignals,
            read::{Limits, read},
        };

        let table = "Time [s],STEP,DIR\n0,0,1\n0.00001,1,1\n0.0000125,0,1\n";
        let capture = read(std::io::Cursor::new(table), &Limits::default(), &mut |_| true).capture;
        let (map, base) = (ChannelMap::proposed(&capture), capture.timebase.expect("times in s"));
        let recorded = RecordedSignals::new(capture, &map, base, 16_000_000).expect("it is short");
        assert_eq!(recorded.records.iter().map(|record| record.cycle.0).collect::<Vec<_>>(), [0, 160, 200]);
        assert!(recorded.records[1].levels.step() & 1 == 1 && recorded.rounding.lost == 0);
    }
}
