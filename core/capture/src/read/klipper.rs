//! Reads Klipper's step commands from `parsedump.py` and `klippy.log`.
//!
//! ```text
//! reset_step_clock oid=3 clock=16000          the clock that intervals count from, 32 bits
//! set_next_step_dir oid=3 dir=1               the level of DIR from the next command on
//! queue_step oid=3 interval=1000 count=4 add=-10    steps 1000, 990, 980 and 970 ticks after the one before
//! ```
//!
//! A line may have several commands after any other text. Commands are stored until the file ends, because those of one
//! stepper come before earlier ones of another; then their steps become levels in order of time.

use super::{
    decimal::whole,
    reading::Reader,
    recorder::{Names, Recorder, grouped, quoted},
};
use crate::{capture::Capture, timebase::Timebase};

const MAX_STEPPERS: usize = 16;
/// 2 µs at 16 MHz; the commands do not give the width.
const PULSE: u64 = 32;

pub(super) struct StepCommands {
    recorder: Recorder,
    steppers: Vec<Stepper>,
    beyond: Names,
    beyond_oids: Vec<u64>,
    steps: u64,
    /// The latest clock of any stepper in 64 bits, to extend 32-bit clocks.
    clock: Option<i128>,
    is_reset: bool,
    /// The clock frequency is known if the file gives exactly one.
    frequency: Option<u64>,
    is_unclear: bool,
}

struct Stepper {
    oid: u64,
    moves: Vec<Move>,
    clock: Option<i128>,
    dir: bool,
}

/// A `queue_step` whose first step is `interval` ticks after `from`.
#[derive(Clone, Copy)]
struct Move {
    from: i64,
    interval: u32,
    add: i32,
    count: u16,
    dir: bool,
}

impl Move {
    const fn offset(self, step: u64) -> i128 {
        let (step, interval, add) = (step as i128, self.interval as i128, self.add as i128);
        step * interval + add * (step * (step - 1) / 2)
    }

    const fn step(self, step: u64) -> i128 {
        self.from as i128 + self.offset(step)
    }
}

pub(super) fn is_klipper(text: &[u8]) -> bool {
    let has = |word: &[u8]| text.windows(word.len()).any(|found| found == word);
    has(b"queue_step oid=") || has(b"reset_step_clock oid=") || has(b"set_next_step_dir oid=")
}

impl StepCommands {
    pub(super) const fn new(recorder: Recorder) -> Self {
        Self {
            recorder,
            steppers: Vec::new(),
            beyond: Names::new(),
            beyond_oids: Vec::new(),
            steps: 0,
            clock: None,
            is_reset: false,
            frequency: None,
            is_unclear: false,
        }
    }

    fn stepper(&mut self, oid: u64) -> Option<&mut Stepper> {
        let at = self.steppers.partition_point(|stepper| stepper.oid < oid);
        if self.steppers.get(at).is_none_or(|stepper| stepper.oid != oid) {
            if self.steppers.len() >= MAX_STEPPERS {
                if self.beyond_oids.len() < MAX_STEPPERS && !self.beyond_oids.contains(&oid) {
                    self.beyond_oids.push(oid);
                    self.beyond.add(&format!("oid={oid}"));
                }
                return None;
            }
            self.steppers.insert(at, Stepper { oid, moves: Vec::new(), clock: None, dir: false });
        }
        self.steppers.get_mut(at)
    }

    fn command(&mut self, name: &[u8], values: &Values) -> Result<(), String> {
        let oid = values.get(b"oid", name)?;
        let oid = u64::try_from(oid).map_err(|_| format!("oid={oid} is not a stepper's number"))?;
        match name {
            b"set_next_step_dir" => {
                let dir = values.get(b"dir", name)?;
                if !matches!(dir, 0 | 1) {
                    return Err(format!("dir={dir} is not a direction; it is 0 or 1"));
                }
                if let Some(stepper) = self.stepper(oid) {
                    stepper.dir = dir == 1;
                }
            }
            b"reset_step_clock" => {
                let low = values.get(b"clock", name)?;
                let low = u32::try_from(low)
                    .map_err(|_| format!("clock={low} is not a clock; it has 32 bits: 0 to {}", u32::MAX))?;
                // The 64-bit clock nearest to the latest one.
                let clock = match self.clock {
                    Some(before) => before + i128::from(low.wrapping_sub(before as u32) as i32),
                    None => i128::from(low),
                };
                if !self.is_reset && self.steps > 0 {
                    return Err("reset_step_clock comes after steps without one, so their distance is unknown; start \
                                the log earlier, or delete the lines before it"
                        .into());
                }
                self.is_reset = true;
                self.clock = Some(clock);
                if let Some(stepper) = self.stepper(oid) {
                    if stepper.clock.is_some_and(|before| clock < before) && !stepper.moves.is_empty() {
                        return Err(format!(
                            "the clock of oid={oid} is set back to {low}, before its last step; give one run per file"
                        ));
                    }
                    stepper.clock = Some(clock);
                }
            }
            _ => self.queue(oid, name, values)?,
        }
        Ok(())
    }

    fn queue(&mut self, oid: u64, name: &[u8], values: &Values) -> Result<(), String> {
        let (interval, count, add) =
            (values.get(b"interval", name)?, values.get(b"count", name)?, values.get(b"add", name)?);
        let (Ok(interval), Ok(count), Ok(add)) = (interval.try_into(), count.try_into(), add.try_into())
        else {
            return Err(format!(
                "interval={interval} count={count} add={add} does not fit: an interval has 32 bits, a count is 0 to 65535, \
                 add has 16 bits and a sign"
            ));
        };
        let add: i16 = add;
        let max_rows = self.recorder.max_rows() as u64 / 2;
        self.steps = self.steps.saturating_add(u64::from(count));
        if self.steps > max_rows {
            return Err(format!(
                "more than {} steps, which are {} changes; give a shorter part of the log",
                grouped(max_rows),
                grouped(self.recorder.max_rows() as u64)
            ));
        }
        let is_reset = self.is_reset;
        let Some(stepper) = self.stepper(oid) else { return Ok(()) };
        if stepper.clock.is_none() && is_reset {
            return Err(format!(
                "oid={oid} has no reset_step_clock, and others have one: when its steps come is not known; start the log earlier"
            ));
        }
        let from = stepper.clock.unwrap_or(0);
        let Ok(start) = i64::try_from(from) else { return Err("the clock does not fit 63 bits".into()) };
        let step = Move { from: start, interval, add: add.into(), count, dir: stepper.dir };
        if count == 0 {
            return Ok(());
        }
        // The intervals change evenly, so the shortest is the first or the last.
        let last = i128::from(interval) + i128::from(add) * i128::from(count - 1);
        let shortest = last.min(interval.into());
        if shortest < 2 {
            return Err(format!(
                "interval={interval} count={count} add={add} has an interval of {shortest} ticks; steps are at least 2 ticks apart"
            ));
        }
        if stepper.moves.len() == stepper.moves.capacity() {
            let more = (stepper.moves.len() / 2).max(64);
            stepper
                .moves
                .try_reserve_exact(more)
                .map_err(|_| "no memory for more step commands; give a shorter log")?;
        }
        let end = step.step(count.into());
        stepper.moves.push(step);
        stepper.clock = Some(end);
        self.clock = Some(self.clock.map_or(end, |clock| clock.max(end)));
        Ok(())
    }

    fn levels(&mut self) -> Result<(), String> {
        let mut queues = Vec::new();
        for (motor, stepper) in self.steppers.iter().enumerate() {
            for signal in ["STEP", "DIR"] {
                self.recorder.channel(&format!("{signal}{motor}"));
            }
            queues.push(Queue::new(2 * motor as u32, &stepper.moves));
        }
        let firsts = queues.iter().filter_map(|queue| queue.next.as_ref().map(|next| next.tick));
        let Some(first) = firsts.min() else { return Ok(()) };
        // Without a clock the recording starts one interval before the first step.
        let start = self
            .steppers
            .iter()
            .filter_map(|stepper| stepper.moves.first().map(|step| i128::from(step.from)));
        let origin = start.min().unwrap_or(0).min(first);
        let mut levels = queues.iter().fold(0, |levels, queue| levels | queue.first_levels());
        self.recorder.levels(0, levels)?;
        loop {
            let next = queues.iter().filter_map(|queue| queue.next.as_ref().map(|next| next.tick)).min();
            let Some(tick) = next else { return Ok(()) };
            for queue in &mut queues {
                while let Some(edge) = queue.next.as_ref().filter(|edge| edge.tick == tick) {
                    levels = levels & !edge.mask | edge.levels;
                    queue.advance();
                }
            }
            let tick = u64::try_from(tick - origin).map_err(|_| "a clock is before the first")?;
            self.recorder.levels(tick, levels)?;
        }
    }
}

struct Edge {
    tick: i128,
    mask: u64,
    levels: u64,
}

struct Queue<'m> {
    bit: u32,
    moves: core::slice::Iter<'m, Move>,
    current: Option<Move>,
    step: u64,
    before: Option<i128>,
    dir: bool,
    phase: Phase,
    next: Option<Edge>,
}

#[derive(Clone, Copy)]
enum Phase {
    Dir,
    Rise,
    Fall,
}

impl<'m> Queue<'m> {
    fn new(bit: u32, moves: &'m [Move]) -> Self {
        let mut moves = moves.iter();
        let current = moves.next().copied();
        let dir = current.is_some_and(|current| current.dir);
        let mut queue =
            Self { bit, moves, current, step: 1, before: None, dir, phase: Phase::Dir, next: None };
        queue.advance();
        queue
    }

    fn first_levels(&self) -> u64 {
        u64::from(self.dir) << (self.bit + 1)
    }

    fn following(&self) -> Option<i128> {
        let current = self.current?;
        if self.step < u64::from(current.count) {
            return Some(current.step(self.step + 1));
        }
        self.moves.clone().next().map(|next| next.step(1))
    }

    fn advance(&mut self) {
        self.next = None;
        loop {
            let Some(current) = self.current else { return };
            let tick = current.step(self.step);
            let (step, dir) = (1_u64 << self.bit, 2_u64 << self.bit);
            let since = self.before.map(|before| tick - before);
            match self.phase {
                Phase::Dir => {
                    self.phase = Phase::Rise;
                    if current.dir != self.dir {
                        self.dir = current.dir;
                        let ahead = since.map_or(i128::from(PULSE), half);
                        let levels = if current.dir { dir } else { 0 };
                        self.next = Some(Edge { tick: tick - ahead, mask: dir, levels });
                        return;
                    }
                }
                Phase::Rise => {
                    self.phase = Phase::Fall;
                    self.next = Some(Edge { tick, mask: step, levels: step });
                    return;
                }
                Phase::Fall => {
                    let wide = self.following().map_or(i128::from(PULSE), |next| half(next - tick));
                    self.before = Some(tick);
                    self.phase = Phase::Dir;
                    if self.step < u64::from(current.count) {
                        self.step += 1;
                    } else {
                        self.current = self.moves.next().copied();
                        self.step = 1;
                    }
                    self.next = Some(Edge { tick: tick + wide, mask: step, levels: 0 });
                    return;
                }
            }
        }
    }
}

fn half(ticks: i128) -> i128 {
    (ticks / 2).clamp(1, i128::from(PULSE))
}

struct Values {
    list: Vec<(Vec<u8>, i64)>,
}

impl Values {
    fn get(&self, key: &[u8], command: &[u8]) -> Result<i64, String> {
        self.list.iter().find(|(name, _)| name == key).map(|(_, value)| *value).ok_or_else(|| {
            format!(
                "{} has no whole number {}=",
                String::from_utf8_lossy(command),
                String::from_utf8_lossy(key)
            )
        })
    }
}

fn value(word: &[u8]) -> Option<(Vec<u8>, i64)> {
    let equals = word.iter().position(|byte| *byte == b'=')?;
    let (key, value) = word.split_at(equals);
    let digits = value.get(1..)?;
    let number = match digits.strip_prefix(b"-") {
        Some(digits) => whole(digits).and_then(|value| i64::try_from(value).ok()).map(|value| -value),
        None => whole(digits).and_then(|value| i64::try_from(value).ok()),
    };
    Some((key.to_vec(), number?))
}

impl Reader for StepCommands {
    fn take(&mut self, line: &[u8]) -> Result<(), String> {
        let mut words = line
            .split(|byte| byte.is_ascii_whitespace() || matches!(byte, b',' | b';' | b'\'' | b'"'))
            .filter(|word| !word.is_empty())
            .peekable();
        while let Some(word) = words.next() {
            if let Some((_, frequency)) = value(word).filter(|(key, _)| key == b"CLOCK_FREQ") {
                let frequency = u64::try_from(frequency).ok().filter(|frequency| *frequency > 0);
                self.is_unclear |= self.frequency.is_some() && self.frequency != frequency;
                self.frequency = frequency.or(self.frequency);
            }
            if !matches!(word, b"queue_step" | b"set_next_step_dir" | b"reset_step_clock") {
                continue;
            }
            let mut values = Values { list: Vec::new() };
            while let Some(found) = words.peek().and_then(|word| value(word)) {
                if values.list.len() < 8 {
                    values.list.push(found);
                }
                words.next();
            }
            // A name without values is part of a sentence.
            if values.list.is_empty() && words.peek().is_none_or(|word| !word.contains(&b'=')) {
                continue;
            }
            self.command(word, &values).map_err(|what| format!("{}: {what}", quoted(line.trim_ascii())))?;
        }
        Ok(())
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        let mut found = self.levels();
        if found.is_ok() && self.recorder.capture.is_empty() && self.steps == 0 {
            found = Err("the log has no queue_step; log the step commands (klippy.log, parsedump.py)".into());
        }
        let steppers: Vec<String> = self
            .steppers
            .iter()
            .enumerate()
            .map(|(motor, stepper)| format!("oid={} is STEP{motor} and DIR{motor}", stepper.oid))
            .collect();
        if !steppers.is_empty() {
            self.recorder.leave_out(format!("steppers: {}", steppers.join(", ")));
            self.recorder.leave_out(format!(
                "the commands have no pulse widths and no DIR set-up times: pulses of at most {PULSE} ticks are made, so \
                 timing checks do not apply"
            ));
        }
        if !self.is_reset && self.steps > 0 {
            self.recorder.leave_out(
                "no reset_step_clock: each stepper begins at time 0, so times of different steppers cannot be compared",
            );
        }
        if !self.beyond.is_empty() {
            let sentence = format!("more than {MAX_STEPPERS} steppers: {} left out", self.beyond.to_text());
            self.recorder.leave_out(sentence);
        }
        if self.is_unclear {
            self.recorder
                .leave_out("several frequencies (CLOCK_FREQ): the log is of more than one controller");
        } else {
            self.recorder.capture.timebase = self.frequency.and_then(|frequency| Timebase::new(1, frequency));
        }
        (self.recorder.finish(), found)
    }
}
