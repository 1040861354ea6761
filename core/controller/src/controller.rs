//! A controller and one cycle of it (CONTROLLER G1).
//!
//! ```text
//! effects of the last cycle, panel -> 1 engine -> 2 memory -> 3 inputs -> 4 reactions -> 5 memory begins
//! ```
//!
//! Other files extend it: `pulses` (1, 3), `store` (2, 5), `reactions` (4) with `power`, `buttons`, `moves`, `program` and
//! `homing`.

use crate::{
    axis::VirtualAxis,
    checked::CheckedSetup,
    debounce::{Inputs, Times},
    eeprom::Eeprom,
    input::Signal,
    journal::{self, Valid},
    motion::{ENDLESS, Motion, Purpose, interval},
    numbers::Numbers,
    panel::{PanelRecord, Word},
    parameters::Parameters,
    pins::Pins,
    script::Script,
    state::{Alarm, State},
};
use alloc::{rc::Rc, vec::Vec};
use stepscope_peripheral::{segment::PulseTimes, units::Instant};

pub(crate) const NEVER: u64 = u64::MAX;
/// Groups per window of the most recent groups.
const WINDOW: u64 = 1024;

#[derive(Clone, Debug)]
pub(crate) struct Program {
    pub(crate) group: u32,
    pub(crate) loop_: u32,
    pub(crate) base: i128,
    pub(crate) sum: i64,
    pub(crate) reached: Vec<u32>,
}

#[derive(Clone, Debug)]
pub(crate) enum Paused {
    Move(Motion),
    /// A state without a move, and the rest of its time.
    Time(State, Option<u64>),
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Edit {
    pub(crate) number: usize,
    pub(crate) entry: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Press {
    pub cycle: Instant,
    pub button: Signal,
    /// The state in which it had no effect.
    pub state: State,
}

/// Statistics of groups that began, for the message about a run without end.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Begun {
    pub(crate) count: u64,
    /// `count` at the last step or wait.
    pub(crate) progress: u64,
    /// Minimum and maximum group number of the previous and the current window.
    before: Option<(u32, u32)>,
    window: Option<(u32, u32)>,
}

impl Begun {
    pub(crate) fn group(&mut self, number: u32) {
        if self.count.is_multiple_of(WINDOW) {
            self.before = self.window.take();
        }
        self.count += 1;
        let (first, last) = self.window.unwrap_or((number, number));
        self.window = Some((first.min(number), last.max(number)));
    }

    /// Minimum and maximum number of the most recent groups.
    pub(crate) fn range(&self) -> (u32, u32) {
        let (first, last) = self.window.or(self.before).unwrap_or((0, 0));
        let (before_first, before_last) = self.before.unwrap_or((first, last));
        (first.min(before_first), last.max(before_last))
    }

    /// Whether they repeat without a step or a wait.
    pub(crate) const fn is_endless(&self) -> bool {
        self.count - self.progress > WINDOW
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Controller {
    pub(crate) parameters: Rc<Parameters>,
    pub(crate) clock_hz: u32,
    pub(crate) pulse: PulseTimes,
    pub(crate) state: State,
    pub(crate) alarm: Alarm,
    pub(crate) trust: u8,
    pub(crate) position: i32,
    pub(crate) outputs: u8,
    pub(crate) pins: Pins,
    pub(crate) steps: i32,
    pub(crate) motion: Option<Motion>,
    pub(crate) program: Option<Program>,
    pub(crate) timer: u64,
    pub(crate) paused: Option<Paused>,
    pub(crate) edit: Edit,
    pub(crate) numbers: Numbers,
    /// Whether a number was changed since the numbers were read or saved.
    pub(crate) is_changed: bool,
    pub(crate) inputs: Inputs,
    pub(crate) script: Script,
    pub(crate) axis: VirtualAxis,
    pub(crate) eeprom: Eeprom,
    pub(crate) newest: Option<Valid>,
    pub(crate) writes_journal: bool,
    /// Whether the opening record after a read is needed, or complete.
    pub(crate) wants_opening: bool,
    pub(crate) is_opened: bool,
    pub(crate) wants_save: bool,
    /// Whether no record can become newer, because the newest has the maximum sequence number.
    pub(crate) is_stuck: bool,
    pub(crate) is_unknown: bool,
    pub(crate) is_read: bool,
    pub(crate) reads: u64,
    pub(crate) dies: u64,
    pub(crate) is_stopped: bool,
    pub(crate) begun: Begun,
    pub(crate) ignored: Vec<Press>,
    pub(crate) panel: Vec<PanelRecord>,
    shown: Option<(Word, i64)>,
    shows: u64,
}

impl Controller {
    pub(crate) fn new(checked: &CheckedSetup, parameters: &Rc<Parameters>, script: Script) -> Self {
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
            steps: 0,
            motion: None,
            program: None,
            timer: NEVER,
            paused: None,
            edit: Edit::default(),
            numbers: Numbers::new(parameters),
            is_changed: false,
            inputs: Inputs::new(times),
            script,
            axis: VirtualAxis::new(parameters.axis.as_ref()),
            eeprom: Eeprom::new(len, memory.byte_write_cycles, &memory.initial, &factory),
            newest: None,
            writes_journal: false,
            wants_opening: false,
            is_opened: false,
            wants_save: false,
            is_stuck: false,
            is_unknown: false,
            is_read: false,
            reads: parameters.self_test_cycles.into(),
            dies: NEVER,
            is_stopped: false,
            begun: Begun::default(),
            ignored: Vec::new(),
            panel: Vec::new(),
            shown: None,
            shows: 0,
        };
        controller.newest = controller.find_newest();
        // At reset the debounced levels are the raw ones of cycle 0, with the switches that the axis closes.
        controller.switches(0);
        controller.inputs.restart();
        controller
    }

    pub(crate) fn cycle(&mut self, now: u64) {
        self.eeprom.settle(now);
        self.pins.apply_pending(now);
        self.show(now);
        self.engine(now);
        self.complete_byte(now);
        self.read_inputs(now);
        self.react(now);
        self.begin_record(now);
        self.shows = if self.shown == Some(self.face()) { NEVER } else { now.saturating_add(1) };
    }

    /// The next cycle in which something can change; everything due by `now` must be done in `now`.
    pub(crate) fn due(&self) -> u64 {
        let motion = self.motion.as_ref().map_or(NEVER, Motion::rise);
        let waits = self.pins.due().min(self.timer).min(self.reads).min(self.dies).min(self.eeprom.due());
        motion.min(waits).min(self.shows).min(self.inputs.due()).min(self.script.due())
    }

    pub(crate) fn jogs_without_end(&self) -> bool {
        let endless = |motion: &Motion| {
            let jogs = matches!(motion.purpose, Purpose::Jog(_)) && motion.is_due && !motion.brakes;
            jogs && motion.rem > ENDLESS / 2 && !self.axis.has_switch_ahead(motion.right)
        };
        let is_last = self.script.due() == NEVER && self.inputs.due() == NEVER && self.dies == NEVER;
        is_last && self.motion.as_ref().is_some_and(endless)
    }

    /// Adds the panel's record of this cycle, if it changed.
    fn show(&mut self, now: u64) {
        if self.shows > now {
            return;
        }
        let (word, display) = self.face();
        // Only in EDIT a change of the display adds a record.
        self.shown = Some((word, display));
        let (cycle, display) = (Instant(now), self.display());
        self.panel.push(PanelRecord { cycle, word, position: self.position.into(), display });
    }

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

    pub(crate) fn is_jump(&self, rate_interval: u64) -> bool {
        rate_interval < interval(self.clock_hz, self.parameters.start_speed_hz.into())
    }
}
