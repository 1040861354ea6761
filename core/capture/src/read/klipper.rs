//! Reads Klipper's step commands from `parsedump.py` and `klippy.log`.
//!
//! ```text
//! reset_step_clock oid=3 clock=16000          the clock that intervals count from, 32 bits
//! set_next_step_dir oid=3 dir=1               the level of DIR from the next command on
//! queue_step oid=3 interval=1000 count=4 add=-10    steps 1000, 990, 980 and 970 ticks after the one before
//! ```
//!
//! A line may have several commands after any other text. Commands are stored until the file ends, because
//! commands of one stepper may come before earlier commands of another; then their steps become levels in order of time.

use super::recorder::{Names, Recorder, grouped, quoted};
use super::{decimal::whole, reading::Reader};
use crate::{capture::Capture, timebase::Timebase};

const MAX_STEPPERS: usize = 16;
/// Maximum width of a pulse in ticks: 2 µs at 16 MHz. The commands do not give the width.
const MAX_PULSE: u64 = 32;

pub(super) struct StepCommands {
    recorder: Recorder,
    steppers: Vec<Stepper>,
    omitted: Names,
    omitted_oids: Vec<u64>,
    steps: u64,
    /// The latest clock of any stepper in 64 bits, to extend 32-bit clocks.
    clock: Option<i128>,
    has_reset: bool,
    /// The clock frequency is known if the file gives exactly one.
    frequency: Option<u64>,
    has_several_frequencies: bool,
}

struct Stepper {
    oid: u64,
    queued: Vec<QueuedSteps>,
    clock: Option<i128>,
    dir: bool,
}

/// A `queue_step` whose first step is `interval` ticks after `from`.
#[derive(Clone, Copy)]
struct QueuedSteps {
    from: i64,
    interval: u32,
    add: i32,
    count: u16,
    dir: bool,
}

impl QueuedSteps {
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
            omitted: Names::new(),
            omitted_oids: Vec::new(),
            steps: 0,
            clock: None,
            has_reset: false,
            frequency: None,
            has_several_frequencies: false,
        }
    }

    fn stepper(&mut self, oid: u64) -> Option<&mut Stepper> {
        let at = self.steppers.partition_point(|stepper| stepper.oid < oid);
        if self.steppers.get(at).is_none_or(|stepper| stepper.oid != oid) {
            if self.steppers.len() >= MAX_STEPPERS {
                if self.omitted_oids.len() < MAX_STEPPERS && !self.omitted_oids.contains(&oid) {
                    self.omitted_oids.push(oid);
                    self.omitted.add(&format!("oid={oid}"));
                }
                return None;
            }
            self.steppers.insert(at, Stepper { oid, queued: Vec::new(), clock: None, dir: false });
        }
        self.steppers.get_mut(at)
    }

    fn command(&mut self, name: &[u8], values: &Values) -> Result<(), String> {
        let oid = values.get(b"oid", name)?;
        let oid = u64::try_from(oid)
            .map_err(|_| format!("oid: {oid} is out of range; use the number of a stepper, from 0"))?;
        match name {
            b"set_next_step_dir" => {
                let dir = values.get(b"dir", name)?;
                if !matches!(dir, 0 | 1) {
                    return Err(format!("dir: {dir} is out of range; use 0 or 1"));
                }
                if let Some(stepper) = self.stepper(oid) {
                    stepper.dir = dir == 1;
                }
            }
            b"reset_step_clock" => {
                let low = values.get(b"clock", name)?;
                let low = u32::try_from(low)
                    .map_err(|_| format!("clock: {low} is out of range; use 0 to {}", u32::MAX))?;
                // The 64-bit clock nearest to the latest one.
                let clock = match self.clock {
                    Some(before) => before + i128::from(low.wrapping_sub(before as u32) as i32),
                    None => i128::from(low),
                };
                if !self.has_reset && self.steps > 0 {
                    return Err("reset_step_clock follows steps without a clock, so their times are unknown; start the log earlier or delete the lines before this one"
                        .into());
                }
                self.has_reset = true;
                self.clock = Some(clock);
                if let Some(stepper) = self.stepper(oid) {
                    if stepper.clock.is_some_and(|before| clock < before) && !stepper.queued.is_empty() {
                        return Err(format!(
                            "the clock of oid={oid} goes back to {low}, before its last step; use one run per file"
                        ));
                    }
                    stepper.clock = Some(clock);
                }
            }
            _ => self.queue_step(oid, name, values)?,
        }
        Ok(())
    }

    fn queue_step(&mut self, oid: u64, name: &[u8], values: &Values) -> Result<(), String> {
        let (interval, count, add) =
            (values.get(b"interval", name)?, values.get(b"count", name)?, values.get(b"add", name)?);
        let text = || format!("interval={interval} count={count} add={add}");
        let (Ok(interval), Ok(count), Ok(add)) = (interval.try_into(), count.try_into(), i16::try_from(add))
        else {
            return Err(format!(
                "{} is out of range; use an interval of 32 bits, a count of 16 bits and an add of 16 bits with sign",
                text()
            ));
        };
        self.count_steps(count)?;
        let has_reset = self.has_reset;
        let Some(stepper) = self.stepper(oid) else { return Ok(()) };
        if stepper.clock.is_none() && has_reset {
            return Err(format!(
                "oid={oid} has no reset_step_clock, unlike other steppers, so the times of its steps are unknown; start the \
                 log earlier"
            ));
        }
        let Ok(from) = i64::try_from(stepper.clock.unwrap_or(0)) else {
            return Err("the clock exceeds 63 bits; use a shorter part of the log".into());
        };
        let step = QueuedSteps { from, interval, add: add.into(), count, dir: stepper.dir };
        if count == 0 {
            return Ok(());
        }
        // The intervals change evenly, so the shortest is the first or the last.
        let last = i128::from(interval) + i128::from(add) * i128::from(count - 1);
        let shortest = last.min(interval.into());
        if shortest < 2 {
            return Err(format!(
                "{} has a step interval of {shortest} ticks, below the minimum of 2; record the log again",
                text()
            ));
        }
        if stepper.queued.len() == stepper.queued.capacity() {
            let more = (stepper.queued.len() / 2).max(64);
            stepper
                .queued
                .try_reserve_exact(more)
                .map_err(|_| "not enough memory for more step commands; use a shorter log")?;
        }
        let end = step.step(count.into());
        stepper.queued.push(step);
        stepper.clock = Some(end);
        self.clock = Some(self.clock.map_or(end, |clock| clock.max(end)));
        Ok(())
    }

    fn count_steps(&mut self, count: u16) -> Result<(), String> {
        let max_rows = self.recorder.max_rows() as u64;
        self.steps = self.steps.saturating_add(u64::from(count));
        if self.steps <= max_rows / 2 {
            return Ok(());
        }
        Err(format!(
            "more than {} steps ({} changes); use a shorter part of the log",
            grouped(max_rows / 2),
            grouped(max_rows)
        ))
    }

    /// Merges the edges of all steppers in order of time.
    fn levels(&mut self) -> Result<(), String> {
        let mut queues = Vec::new();
        for (motor, stepper) in self.steppers.iter().enumerate() {
            for signal in ["STEP", "DIR"] {
                self.recorder.channel(&format!("{signal}{motor}"));
            }
            queues.push(Queue::new(2 * motor as u32, &stepper.queued));
        }
        let firsts = queues.iter().filter_map(|queue| queue.next.as_ref().map(|next| next.tick));
        let Some(first) = firsts.min() else { return Ok(()) };
        // Without a clock the recording starts one interval before the first step.
        let start = self
            .steppers
            .iter()
            .filter_map(|stepper| stepper.queued.first().map(|step| i128::from(step.from)));
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
            let tick = u64::try_from(tick - origin)
                .map_err(|_| "a clock is before the first one; use one run per file")?;
            self.recorder.levels(tick, levels)?;
        }
    }
}

/// A change of the signals in `mask` to `levels`.
struct Edge {
    tick: i128,
    mask: u64,
    levels: u64,
}

/// The edges of one stepper in order of time: a change of DIR before its step, then rise and fall of STEP.
struct Queue<'m> {
    bit: u32,
    queued: core::slice::Iter<'m, QueuedSteps>,
    current: Option<QueuedSteps>,
    step: u64,
    previous_step: Option<i128>,
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
    fn new(bit: u32, queued: &'m [QueuedSteps]) -> Self {
        let mut queued = queued.iter();
        let current = queued.next().copied();
        let dir = current.is_some_and(|current| current.dir);
        let mut queue =
            Self { bit, queued, current, step: 1, previous_step: None, dir, phase: Phase::Dir, next: None };
        queue.advance();
        queue
    }

    fn first_levels(&self) -> u64 {
        u64::from(self.dir) << (self.bit + 1)
    }

    fn next_step_tick(&self) -> Option<i128> {
        let current = self.current?;
        if self.step < u64::from(current.count) {
            return Some(current.step(self.step + 1));
        }
        self.queued.clone().next().map(|next| next.step(1))
    }

    fn advance(&mut self) {
        self.next = None;
        loop {
            let Some(current) = self.current else { return };
            let tick = current.step(self.step);
            let (step, dir) = (1_u64 << self.bit, 2_u64 << self.bit);
            let since = self.previous_step.map(|before| tick - before);
            match self.phase {
                Phase::Dir => {
                    self.phase = Phase::Rise;
                    if current.dir != self.dir {
                        self.dir = current.dir;
                        let ahead = since.map_or(i128::from(MAX_PULSE), half_interval);
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
                    let wide = self
                        .next_step_tick()
                        .map_or(i128::from(MAX_PULSE), |next| half_interval(next - tick));
                    self.previous_step = Some(tick);
                    self.phase = Phase::Dir;
                    if self.step < u64::from(current.count) {
                        self.step += 1;
                    } else {
                        self.current = self.queued.next().copied();
                        self.step = 1;
                    }
                    self.next = Some(Edge { tick: tick + wide, mask: step, levels: 0 });
                    return;
                }
            }
        }
    }
}

/// Half the interval between two steps, at most the maximum width of a pulse.
fn half_interval(ticks: i128) -> i128 {
    (ticks / 2).clamp(1, i128::from(MAX_PULSE))
}

/// Values of a command.
struct Values {
    list: Vec<(Vec<u8>, i64)>,
}

impl Values {
    fn get(&self, key: &[u8], command: &[u8]) -> Result<i64, String> {
        self.list.iter().find(|(name, _)| name == key).map(|(_, value)| *value).ok_or_else(|| {
            format!(
                "{0} has no number {1}; use {0} with {1}= and a whole number",
                String::from_utf8_lossy(command),
                String::from_utf8_lossy(key)
            )
        })
    }
}

/// Parses `key=value` with a whole number.
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
                self.has_several_frequencies |= self.frequency.is_some() && self.frequency != frequency;
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
            self.command(word, &values)
                .map_err(|message| format!("{}: {message}", quoted(line.trim_ascii())))?;
        }
        Ok(())
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        let mut found = self.levels();
        if found.is_ok() && self.recorder.capture.is_empty() && self.steps == 0 {
            found = Err(
                "the log has no queue_step; use a log of step commands (klippy.log, parsedump.py)".into()
            );
        }
        let steppers: Vec<String> = self
            .steppers
            .iter()
            .enumerate()
            .map(|(motor, stepper)| format!("oid={} is STEP{motor} and DIR{motor}", stepper.oid))
            .collect();
        if !steppers.is_empty() {
            self.recorder.note(format!("steppers: {}", steppers.join(", ")));
            self.recorder.note(format!(
                "the commands have no pulse widths and no DIR set-up times: pulses are at most {MAX_PULSE} ticks wide, so timing checks do not apply"
            ));
        }
        if !self.has_reset && self.steps > 0 {
            self.recorder.note(
                "no reset_step_clock: each stepper begins at time 0, so times of different steppers cannot be compared",
            );
        }
        if !self.omitted.is_empty() {
            let sentence = format!("more than {MAX_STEPPERS} steppers: {} left out", self.omitted.to_text());
            self.recorder.note(sentence);
        }
        if self.has_several_frequencies {
            self.recorder
                .note("several frequencies (CLOCK_FREQ): the log has more than one controller, so the unit of time is unknown");
        } else {
            self.recorder.capture.timebase = self.frequency.and_then(|frequency| Timebase::new(1, frequency));
        }
        (self.recorder.finish(), found)
    }
}
