//! Converts a capture to records of the 36 signals, in clock cycles (DESIGN A9, B1).
//!
//! Times are rounded to the nearest cycle, halves up. With a slow clock, edges may share a cycle and pulses may be
//! lost; both are counted.

use crate::{
    capture::{Capture, Change},
    changes,
    channel_map::{BUS_SIGNALS, ChannelMap, Entry},
    generated_pulses::{GeneratedPulses, Steps},
    timebase::Timebase,
};
use core::fmt;
use stepscope_peripheral::{
    signal::{Levels, Record},
    units::Instant,
};

/// Generated pulses last at most 1/400000 s: 2.5 us.
const WIDEST: u64 = 400_000;
const LAST_CYCLE: u64 = 9_000_000_000_000_000;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorded {
    pub clock_hz: u32,
    pub channels: u8,
    /// Records from cycle 0; cycles rise and levels differ. Signals without a channel have their reset levels, DIR
    /// right.
    pub records: Vec<Record>,
    pub end: Instant,
    /// Effects of rounding.
    pub rounding: Rounding,
}

/// Effects of rounding times to cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rounding {
    /// Changes whose time is not a whole cycle.
    pub rounded: u64,
    /// Records that share a cycle with the one before.
    pub met: u64,
    /// Signals that changed twice within a cycle, and steps without room for a pulse.
    pub lost: u64,
    /// Simultaneous changes of both encoder inputs, or CW and CCW high together: no step is counted.
    pub ambiguous: u64,
}

impl fmt::Display for Rounding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.rounded {
            0 => f.write_str("every time of the file is a whole cycle: nothing is rounded")?,
            1 => f.write_str("1 time is rounded to the nearest cycle, by half a cycle at most")?,
            more => write!(f, "{more} times are rounded to the nearest cycle, by half a cycle at most")?,
        }
        if self.met > 0 {
            write!(f, "; {} times two changes meet in a cycle", self.met)?;
        }
        if self.lost > 0 {
            write!(f, ", and {} pulses within one are lost: use a faster clock", self.lost)?;
        }
        Ok(())
    }
}

/// A time after the last possible cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLate {
    /// In ticks of the file.
    pub tick: u64,
}

impl fmt::Display for TooLate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "tick {} of the file is after cycle {LAST_CYCLE}, the last that there can be: use a slower clock",
            self.tick
        )
    }
}

impl core::error::Error for TooLate {}

fn cycle(timebase: Timebase, tick: u64, clock_hz: u32) -> Result<u64, TooLate> {
    timebase.cycle(tick, clock_hz).filter(|cycle| *cycle <= LAST_CYCLE).ok_or(TooLate { tick })
}

impl Recorded {
    /// Converts a capture to cycles of `clock_hz`, with ticks of `timebase`; frees the capture's memory meanwhile.
    /// Errors: [`TooLate`] if a time has no cycle.
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
        let signals = Signals::new(map);
        // A generated pulse has an additional fall.
        let count = capture.changes.len() * if map.makes_pulses() { 2 } else { 1 };
        let mut records = Records::new(capture.changes.into_iter(), signals, timebase, clock_hz);
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
    cycles: Option<u64>,
    before: Option<Record>,
    last: Option<Levels>,
    /// STEP signals whose generated pulses are high in `before`.
    high: u64,
    fall: Option<Record>,
    pub rounding: Rounding,
}

impl<'m> Records<'m, changes::Iter<'m>> {
    /// Records of a capture, as in [`Recorded::new`].
    /// Errors: [`TooLate`] if a time has no cycle.
    pub fn of(
        capture: &'m Capture,
        map: &'m ChannelMap,
        timebase: Timebase,
        clock_hz: u32,
    ) -> Result<Self, TooLate> {
        Self::from(capture, map, timebase, clock_hz, 0)
    }

    /// Records from a tick on; the first, at cycle 0, has the levels at that time.
    /// Errors: [`TooLate`] if a time has no cycle.
    pub fn from(
        capture: &'m Capture,
        map: &'m ChannelMap,
        timebase: Timebase,
        clock_hz: u32,
        tick: u64,
    ) -> Result<Self, TooLate> {
        let last = capture.changes.last().map_or(0, |change| change.tick);
        cycle(timebase, last, clock_hz)?;
        Ok(Self::new(capture.changes.iter_from(tick), Signals::new(map), timebase, clock_hz))
    }
}

impl<'m> Records<'m, changes::Iter<'m>> {
    /// Records with ticks as cycles, without rounding.
    #[must_use]
    pub fn in_ticks(capture: &'m Capture, map: &'m ChannelMap) -> Self {
        Self::new(capture.changes.iter_from(0), Signals::new(map), Timebase::SECOND, 1)
    }
}

impl<'m, I: Iterator<Item = Change>> Records<'m, I> {
    fn new(changes: I, signals: Signals<'m>, timebase: Timebase, clock_hz: u32) -> Self {
        let cycles = timebase.cycles(clock_hz);
        let (before, last, high, fall, rounding) = (None, None, 0, None, Rounding::default());
        Self { changes, signals, timebase, clock_hz, cycles, before, last, high, fall, rounding }
    }

    fn take(&mut self, Change { tick, levels }: Change) -> Option<Record> {
        // The first levels become cycle 0.
        let at = match self.before {
            Some(_) => match self.cycles {
                Some(cycles) => tick.checked_mul(cycles),
                None => {
                    self.rounding.rounded += u64::from(!self.timebase.is_whole(tick, self.clock_hz));
                    self.timebase.cycle(tick, self.clock_hz)
                }
            }
            .unwrap_or(LAST_CYCLE),
            None => 0,
        };
        let mut now = Record { cycle: Instant(at), levels: self.signals.levels(levels) };
        let mut high = 0;
        if let Some(generated) = &mut self.signals.generated {
            let Steps { pulses, levels, ambiguous } = generated.take(levels);
            self.rounding.ambiguous += u64::from(ambiguous);
            let since = self.before.map_or(u64::MAX, |before| at - before.cycle.0);
            // A pulse lasts at least one cycle, so an earlier step waits for it.
            let held = if since < 2 { self.high & pulses } else { 0 };
            self.rounding.lost += u64::from(held.count_ones());
            high = pulses & !held | if since == 0 { self.high } else { 0 };
            now.levels.0 |= high | levels;
        }
        let (shown, falling) = (self.before.replace(now)?, core::mem::replace(&mut self.high, high));
        if shown.cycle == now.cycle {
            let since = self.last.unwrap_or(Levels::RESET).0;
            let recorded = !self.signals.generated.as_ref().map_or(0, GeneratedPulses::signals);
            self.rounding.met += u64::from(shown.levels != now.levels);
            self.rounding.lost +=
                u64::from(((since ^ shown.levels.0) & !(since ^ now.levels.0) & recorded).count_ones());
            return None;
        }
        self.show(shown, falling, at - shown.cycle.0)
    }

    /// Returns a record if its levels are new, then the end of generated pulses: halfway to the next record, at most
    /// [`WIDEST`].
    fn show(&mut self, shown: Record, falling: u64, room: u64) -> Option<Record> {
        let is_new = self.last.replace(shown.levels) != Some(shown.levels);
        if falling != 0 && room > 1 {
            let width = (room / 2).min(u64::from(self.clock_hz) / WIDEST).max(1);
            let fall =
                Record { cycle: Instant(shown.cycle.0 + width), levels: Levels(shown.levels.0 & !falling) };
            self.last = Some(fall.levels);
            self.fall = Some(fall);
        }
        is_new.then_some(shown)
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
            if let Some(record) = self.take(change) {
                return Some(record);
            }
        }
        let last = self.before.take()?;
        let falling = core::mem::take(&mut self.high);
        self.show(last, falling, u64::MAX)
    }
}

#[derive(Clone, Debug)]
struct Signals<'m> {
    entries: &'m [Entry],
    rest: u64,
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
        let rest = (Levels::RESET.0 | right & used << Levels::DIR_SHIFT) & !mapped;
        Self { entries: map.entries(), rest, generated }
    }

    fn levels(&self, channels: u64) -> Levels {
        let bus = self.entries.iter().filter(|entry| entry.bit < BUS_SIGNALS);
        Levels(bus.fold(self.rest, |levels, entry| levels | u64::from(entry.level(channels)) << entry.bit))
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
        let base = Timebase::new(1, 1_000_000).expect("it has a length");
        let found = Recorded::new(capture, &map, base, clock_hz).expect("it fits");
        let records = found.records.iter().map(|record| (record.cycle.0, record.levels.0)).collect();
        (records, found.rounding, found.end.0)
    }

    const IDLE: u64 = Levels::RX | Levels::TX;
    const RIGHT: u64 = 1 << Levels::DIR_SHIFT;

    #[test]
    fn changes_become_records_and_what_is_on_no_signal_is_left_out() {
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
        // At 100 kHz a cycle is 10 us: the pulse from 21 to 23 is within one, DIR and STEP meet at 50.
        let (records, rounding, _) =
            recorded(&[(0, 0), (21, 1), (23, 0), (51, 2), (53, 3), (70, 2)], 100_000);
        let cycles: Vec<u64> = records.iter().map(|(cycle, _)| *cycle).collect();
        assert_eq!(cycles, [0, 5, 7]);
        assert_eq!(rounding, Rounding { rounded: 4, met: 2, lost: 1, ambiguous: 0 });
        assert!(rounding.to_string().contains("1 pulses within one are lost"), "{rounding}");
        // A channel that is no signal changes first, in the same cycle.
        let (records, rounding, _) = recorded(&[(0, 0), (20, 1), (21, 0b1001), (22, 0b1000)], 100_000);
        assert_eq!(records.iter().map(|(cycle, _)| *cycle).collect::<Vec<_>>(), [0]);
        assert_eq!((rounding.met, rounding.lost), (1, 1));
    }

    #[test]
    fn a_time_beyond_the_last_cycle_is_refused_and_nothing_gives_one_record() {
        let base = Timebase::new(1, 1).expect("it has a length");
        let late = capture(&[(0, 0), (u64::MAX / 2, 1)]);
        let map = ChannelMap::proposed(&late);
        assert!(Recorded::new(late, &map, base, 1_000_000_000).is_err());
        let none =
            Recorded::new(Capture::new(Format::Vcd), &ChannelMap::default(), base, 1).expect("it fits");
        assert_eq!(none.records.len(), 1);
    }

    fn generated(map: &str, changes: &[(u64, u64)]) -> (Vec<(u64, u64, u64)>, Rounding) {
        let capture = capture(changes);
        let map = ChannelMap::parse(map, &capture).expect("a map");
        let base = Timebase::new(1, 1_000_000).expect("it has a length");
        let found = Recorded::new(capture.clone(), &map, base, 1_000_000).expect("it fits");
        let streamed = Records::of(&capture, &map, base, 1_000_000).expect("it fits");
        assert!(streamed.eq(found.records.iter().copied()));
        let levels =
            |record: &Record| (record.cycle.0, record.levels.0 & 1, u64::from(record.levels.0 & RIGHT != 0));
        (found.records.iter().map(levels).collect(), found.rounding)
    }

    #[test]
    fn both_edges_make_a_pulse_each() {
        // The edge at 31 comes a cycle after the one at 30, whose pulse cannot end before; so does the second one at 60.
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
        let slow = Timebase::new(1, 10_000_000).expect("it has a length");
        let twice = capture(&[(0, 0), (100, 1), (104, 0), (300, 1)]);
        let map = ChannelMap::parse("DEDGE0=STEP", &twice).expect("a map");
        let found = Recorded::new(twice, &map, slow, 1_000_000).expect("it fits");
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
        // Four steps ahead, two back, and then both lines at once.
        assert_eq!(rises, [(10, 1), (20, 1), (30, 1), (40, 1), (50, 0), (60, 0)]);
        assert_eq!((rounding.ambiguous, rounding.lost), (1, 0));
        assert_eq!(generated("A0=!STEP,B0=DIR", &phases).0[1], (10, 1, 0));
    }

    #[test]
    fn a_table_becomes_records() {
        use crate::{
            ChannelMap, Recorded,
            read::{Limits, read},
        };

        let table = "Time [s],STEP,DIR\n0,0,1\n0.00001,1,1\n0.0000125,0,1\n";
        let capture = read(std::io::Cursor::new(table), &Limits::default(), &mut |_| true).capture;
        let (map, base) = (ChannelMap::proposed(&capture), capture.timebase.expect("times in s"));
        let recorded = Recorded::new(capture, &map, base, 16_000_000).expect("it is short");
        assert_eq!(recorded.records.iter().map(|record| record.cycle.0).collect::<Vec<_>>(), [0, 160, 200]);
        assert!(recorded.records[1].levels.step() & 1 == 1 && recorded.rounding.lost == 0);
    }
}
