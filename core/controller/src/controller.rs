//! A controller and one cycle of it (CONTROLLER G1).
//!
//! ```text
//! effects of the last cycle, panel -> 1 engine -> 2 memory -> 3 inputs -> 4 reactions -> 5 memory begins
//! ```
//!
//! Other files extend it: `pulses` (1, 3), `store` (2, 5), `reactions` (4) with `power`, `buttons`, `moves`, `program` and
//! `homing`.

use crate::debounce::{Inputs, Times};
use crate::journal::{self, ValidRecord};
use crate::motion::{ENDLESS, Motion, Purpose, interval};
use crate::panel::{PanelRecord, Word};
use crate::state::{Alarm, State};
use crate::{
    axis::VirtualAxis, checked::CheckedSetup, eeprom::Eeprom, input::Signal, numbers::Numbers,
    parameters::Parameters, pins::Pins, script::Script,
};
use alloc::{sync::Arc, vec::Vec};
use stepscope_peripheral::{segment::PulseTimes, units::Instant};

pub(crate) const NEVER: u64 = u64::MAX;
/// Groups that count as the most recent ones, and that may begin without a step or a wait.
const WINDOW: u64 = 1024;

/// A program in progress. Positions are `base` plus the rounded sum of all lengths, so rounding errors do not add up.
#[derive(Clone, Debug)]
pub(crate) struct Program {
    /// Current group and loop, from 1.
    pub(crate) group: u32,
    pub(crate) loop_: u32,
    pub(crate) base: i128,
    pub(crate) length_sum: i64,
    /// How often each `repeat` was reached in this loop.
    pub(crate) repeat_counts: Vec<u32>,
}

#[derive(Clone, Debug)]
pub(crate) enum Paused {
    Move(Motion),
    /// A state without a move, and its remaining cycles; `None` without a timeout.
    Time(State, Option<u64>),
}

/// The number that is edited, and the digits entered so far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Edit {
    pub(crate) number: usize,
    pub(crate) entry: Option<u32>,
}

/// A press that had no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Press {
    /// When the debounced press was handled.
    pub cycle: Instant,
    pub button: Signal,
    /// The state that ignored it.
    pub state: State,
}

/// Counts the groups that begin, to detect endless programs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct GroupCounter {
    pub(crate) count: u64,
    /// `count` at the last step or wait.
    pub(crate) progress: u64,
    /// Minimum and maximum group number of the previous and the current [`WINDOW`].
    previous: Option<(u32, u32)>,
    current: Option<(u32, u32)>,
}

impl GroupCounter {
    pub(crate) fn group(&mut self, number: u32) {
        if self.count.is_multiple_of(WINDOW) {
            self.previous = self.current.take();
        }
        self.count += 1;
        let (min, max) = self.current.unwrap_or((number, number));
        self.current = Some((min.min(number), max.max(number)));
    }

    /// Minimum and maximum number of the most recent groups.
    pub(crate) fn range(&self) -> (u32, u32) {
        let (min, max) = self.current.or(self.previous).unwrap_or((0, 0));
        let (previous_min, previous_max) = self.previous.unwrap_or((min, max));
        (min.min(previous_min), max.max(previous_max))
    }

    /// Whether groups repeat without a step or a wait.
    pub(crate) const fn is_endless(&self) -> bool {
        self.count - self.progress > WINDOW
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Controller {
    pub(crate) parameters: Arc<Parameters>,
    pub(crate) clock_hz: u32,
    pub(crate) pulse: PulseTimes,
    pub(crate) state: State,
    pub(crate) alarm: Alarm,
    pub(crate) trust: u8,
    pub(crate) position: i32,
    pub(crate) outputs: u8,
    pub(crate) pins: Pins,
    /// Steps since reset, right positive. Unlike `position` it is never set.
    pub(crate) step_count: i32,
    pub(crate) motion: Option<Motion>,
    pub(crate) program: Option<Program>,
    /// End of a delay or a wait, or begin of the next group.
    pub(crate) timer: u64,
    pub(crate) paused: Option<Paused>,
    pub(crate) edit: Edit,
    pub(crate) numbers: Numbers,
    /// Whether a number was changed since the numbers were read or saved.
    pub(crate) has_unsaved_numbers: bool,
    pub(crate) inputs: Inputs,
    pub(crate) script: Script,
    pub(crate) axis: VirtualAxis,
    pub(crate) eeprom: Eeprom,
    pub(crate) newest: Option<ValidRecord>,
    pub(crate) writes_journal: bool,
    /// Whether the opening record after a read is needed, or complete.
    pub(crate) needs_opening_record: bool,
    pub(crate) has_opening_record: bool,
    pub(crate) needs_number_save: bool,
    /// Whether no record can become newer, because the newest one has the maximum sequence number.
    pub(crate) is_sequence_exhausted: bool,
    pub(crate) is_memory_invalid: bool,
    pub(crate) is_memory_read: bool,
    /// When the self-test reads memory, and when the hold-up time ends.
    pub(crate) read_at: u64,
    pub(crate) off_at: u64,
    pub(crate) is_stopped_in_self_test: bool,
    pub(crate) group_counter: GroupCounter,
    pub(crate) ignored: Vec<Press>,
    pub(crate) panel: Vec<PanelRecord>,
    /// The last panel record, and when the next one is due.
    shown: Option<(Word, i64)>,
    show_at: u64,
}

impl Controller {
    pub(crate) fn new(checked: &CheckedSetup, parameters: &Arc<Parameters>, script: Script) -> Self {
        let memory = &parameters.memory;
        let len = parameters.memory_len();
        let factory = journal::factory();
        let times = Times {
            buttons: parameters.debounce_cycles.into(),
            sensors: parameters.sensor_debounce_cycles.into(),
        };
        let mut controller = Self {
            parameters: parameters.clone(),
            clock_hz: checked.clock_hz(),
            pulse: checked.pulse(),
            state: State::SelfTest,
            alarm: Alarm::None,
            trust: 0,
            position: 0,
            outputs: 0,
            pins: Pins::new(),
            step_count: 0,
            motion: None,
            program: None,
            timer: NEVER,
            paused: None,
            edit: Edit::default(),
            numbers: Numbers::new(parameters),
            has_unsaved_numbers: false,
            inputs: Inputs::new(times),
            script,
            axis: VirtualAxis::new(parameters.axis.as_ref()),
            eeprom: Eeprom::new(len, memory.byte_write_cycles, &memory.initial, &factory),
            newest: None,
            writes_journal: false,
            needs_opening_record: false,
            has_opening_record: false,
            needs_number_save: false,
            is_sequence_exhausted: false,
            is_memory_invalid: false,
            is_memory_read: false,
            read_at: parameters.self_test_cycles.into(),
            off_at: NEVER,
            is_stopped_in_self_test: false,
            group_counter: GroupCounter::default(),
            ignored: Vec::new(),
            panel: Vec::new(),
            shown: None,
            show_at: 0,
        };
        controller.newest = controller.find_newest();
        // At reset the debounced levels are the raw levels of cycle 0, which include the switches of the axis.
        controller.update_switches(0);
        controller.inputs.restart();
        controller
    }

    pub(crate) fn cycle(&mut self, now: u64) {
        self.eeprom.catch_up(now);
        self.pins.apply_pending(now);
        self.show(now);
        self.run_engine(now);
        self.complete_byte(now);
        self.read_inputs(now);
        self.react(now);
        self.begin_record(now);
        self.show_at = if self.shown == Some(self.face()) { NEVER } else { now.saturating_add(1) };
    }

    /// The next cycle in which something can change; everything due by `now` must be done in `now`.
    pub(crate) fn due(&self) -> u64 {
        let motion = self.motion.as_ref().map_or(NEVER, Motion::rise);
        let timers =
            self.pins.due().min(self.timer).min(self.read_at).min(self.off_at).min(self.eeprom.due());
        motion.min(timers).min(self.show_at).min(self.inputs.due()).min(self.script.due())
    }

    /// Whether a jog continues for ever, because no input and no limit can end it.
    pub(crate) fn jogs_without_end(&self) -> bool {
        let endless = |motion: &Motion| {
            let is_jog = matches!(motion.purpose, Purpose::Jog(_));
            is_jog
                && motion.has_pending_step
                && !motion.is_braking
                && motion.steps_left > ENDLESS / 2
                && !self.axis.has_switch_ahead(motion.right)
        };
        let has_no_more_events =
            self.script.due() == NEVER && self.inputs.due() == NEVER && self.off_at == NEVER;
        has_no_more_events && self.motion.as_ref().is_some_and(endless)
    }

    /// Adds the panel's record of this cycle, if it changed.
    fn show(&mut self, now: u64) {
        if self.show_at > now {
            return;
        }
        let (word, display) = self.face();
        self.shown = Some((word, display));
        let (cycle, display) = (Instant(now), self.display());
        self.panel.push(PanelRecord { cycle, word, position: self.position.into(), display });
    }

    /// What adds a panel record when it changes: the word and, only in EDIT, the display.
    fn face(&self) -> (Word, i64) {
        (self.word(), if self.state == State::Edit { self.display() } else { 0 })
    }

    pub(crate) fn word(&self) -> Word {
        let (group, loop_) = match &self.program {
            _ if self.state == State::Edit => (self.edit.number as u64, 0),
            Some(program) => (program.group.into(), program.loop_.into()),
            None => (0, 0),
        };
        Word::new(self.state, self.alarm, self.trust, self.outputs, group, loop_)
    }

    pub(crate) fn display(&self) -> i64 {
        match self.edit.entry {
            _ if self.state != State::Edit => self.numbers.digits(self.position),
            Some(entry) => entry.into(),
            None => self.numbers.get(self.edit.number).into(),
        }
    }

    pub(crate) fn cycles(&self, ms: u32) -> u64 {
        u64::from(ms) * u64::from(self.clock_hz) / 1000
    }

    /// Whether a first or last step with this interval exceeds the start-stop rate, so that steps may be lost.
    pub(crate) fn is_jump(&self, rate_interval: u64) -> bool {
        rate_interval < interval(self.clock_hz, self.parameters.start_speed_hz.into())
    }
}
