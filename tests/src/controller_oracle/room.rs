//! G1: one controller and its cycle.

use super::arithmetic::{Table, interval};
use super::buttons::Edit;
use super::eeprom::Eeprom;
use super::engine::Motion;
use super::homing::Homing;
use super::inputs::Inputs;
use super::numbers::Numbers;
use super::panel::PanelRecord;
use super::parameters::{Controller, Entry, Input};
use super::programs::Program;

/// States (G2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[expect(missing_docs, reason = "G2's words")]
pub enum State {
    Off = 0,
    SelfTest = 1,
    Ready = 2,
    Running = 3,
    Delay = 4,
    Wait = 5,
    Pausing = 6,
    Paused = 7,
    Jog = 8,
    Returning = 9,
    Homing = 10,
    Debug = 11,
    Edit = 12,
    Alarm = 13,
    PowerLoss = 14,
}

/// Alarms (G2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[expect(missing_docs, reason = "G2's words")]
pub enum Alarm {
    None = 0,
    Estop = 1,
    Limit = 2,
    SoftLimit = 3,
    Homing = 4,
    Trust = 5,
    Timeout = 6,
    Memory = 7,
}

/// Constants of a run.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) clock_hz: u64,
    pub(super) w: u64,
    pub(super) d: u64,
    pub(super) h: u64,
    pub(super) controller: Controller,
    /// Its own entries, and controller 0's of power, estop and clear, in the order of time.
    pub(super) script: Vec<Entry>,
    /// G3's tables of levels 1 to 5.
    pub(super) tables: Vec<Table>,
}

impl Plan {
    /// I(r).
    pub(super) fn interval(&self, rate_hz: i64) -> u128 {
        interval(self.clock_hz, rate_hz)
    }

    /// Lm.
    pub(super) fn least_interval(&self) -> u128 {
        u128::from(self.w + (self.h + self.d).max(1)) << 16
    }

    pub(super) fn table(&self, level: i64) -> &Table {
        &self.tables[level as usize - 1]
    }
}

/// State of the self-test (G2).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SelfTest {
    /// s: its first cycle.
    pub(super) begun: u64,
    /// ALARM ESTOP is pending.
    pub(super) estop: bool,
    /// Memory has been read since power-up, without a valid record.
    pub(super) none_valid: bool,
    /// The opening record is complete.
    pub(super) opened: bool,
}

/// State saved by a pause (G5).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Kept {
    /// Remaining steps; 0: a time is saved.
    pub(super) rem: i128,
    pub(super) right: bool,
    /// DELAY, WAIT, or RUNNING without a move.
    pub(super) state: State,
    /// The remaining time; `None`: a wait without limit.
    pub(super) left: Option<u64>,
}

/// The state of a controller.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Status {
    pub(super) state: State,
    pub(super) alarm: Alarm,
    pub(super) trust: u8,
    pub(super) position: i32,
    pub(super) outputs: u8,
    // The lines, and their pending changes.
    pub(super) en: bool,
    pub(super) step: bool,
    pub(super) dir: bool,
    pub(super) fall_at: Option<u64>,
    pub(super) last_fall: Option<u64>,
    pub(super) dir_at: Option<u64>,
    pub(super) motion: Option<Motion>,
    pub(super) program: Option<Program>,
    /// Cycle of the end of DELAY, of the end of a wait, or of the start of the next group.
    pub(super) timer: Option<u64>,
    pub(super) kept: Option<Kept>,
    pub(super) homing: Option<Homing>,
    /// JOG began in DEBUG.
    pub(super) jog_from_debug: bool,
    pub(super) self_test: SelfTest,
    /// Memory has been read since power-up.
    pub(super) memory_read: bool,
    /// Cycle in which a power loss becomes OFF.
    pub(super) dies_at: Option<u64>,
    pub(super) inputs: Inputs,
    pub(super) eeprom: Eeprom,
    pub(super) numbers: Numbers,
    pub(super) edit: Edit,
    /// m.
    pub(super) place: i64,
    /// m - position when zero was set, or before that when memory was first read.
    pub(super) place_of_zero: Option<i64>,
    pub(super) groups_begun: u64,
}

/// A controller in one cycle.
#[derive(Debug)]
pub(super) struct Room {
    pub(super) plan: Plan,
    /// c.
    pub(super) now: u64,
    pub(super) s: Status,
    pub(super) panel: Vec<PanelRecord>,
}

impl Room {
    pub(super) fn new(plan: Plan) -> Self {
        let eeprom = Eeprom::new(&plan.controller);
        let numbers = Numbers::of_scenario(&plan.controller);
        let place = plan.controller.axis.as_ref().map_or(0, |axis| axis.start_steps);
        let s = Status {
            state: State::SelfTest,
            alarm: Alarm::None,
            trust: 0,
            position: 0,
            outputs: 0,
            en: true,
            step: false,
            dir: false,
            fall_at: None,
            last_fall: None,
            dir_at: None,
            motion: None,
            program: None,
            timer: None,
            kept: None,
            homing: None,
            jog_from_debug: false,
            self_test: SelfTest { begun: 0, estop: false, none_valid: false, opened: false },
            memory_read: false,
            dies_at: None,
            inputs: Inputs::at_reset(),
            eeprom,
            numbers,
            edit: Edit::default(),
            place,
            place_of_zero: None,
            groups_begun: 0,
        };
        let mut room = Self { plan, now: 0, s, panel: Vec::new() };
        room.axis_drives_switches();
        room.s.inputs.debounce_all();
        room
    }

    /// The steps of G1. Returns (STEP, DIR, EN) in `c`.
    pub(super) fn cycle(&mut self, c: u64) -> (bool, bool, bool) {
        self.now = c;
        self.show();
        self.engine();
        // Effects of reactions on EN, STEP and DIR show from c + 1 on.
        // Reading: DIR = 0 of OFF and of a restart shows from c + 1 on, too.
        let lines = (self.s.step, self.s.dir, self.s.en);
        self.byte_complete();
        self.read_inputs();
        self.reactions();
        self.memory_begins();
        self.s.inputs.forget_edges();
        lines
    }

    /// The next cycle for which the state has a time; if the last cycle changed nothing, all cycles before it change
    /// nothing, either.
    pub(super) fn next_time(&self) -> Option<u64> {
        let mut times = vec![
            self.s.fall_at,
            self.s.dir_at,
            self.s.motion.as_ref().and_then(Motion::due_cycle),
            self.s.timer,
            self.s.dies_at,
            self.s.eeprom.byte_ends(&self.plan.controller),
            self.next_entry(),
            self.next_debounced(),
        ];
        if self.s.state == State::SelfTest && !self.s.memory_read {
            times.push(Some(self.end_of_test()));
        }
        times.into_iter().flatten().filter(|time| *time > self.now).min()
    }

    /// s + `self_test_cycles`.
    pub(super) fn end_of_test(&self) -> u64 {
        self.s.self_test.begun + self.plan.controller.self_test_cycles
    }

    /// The debounced level.
    pub(super) fn level(&self, input: Input) -> bool {
        self.s.inputs.debounced[input.index()]
    }

    /// An alarm drops the program.
    // Reading: "out of ALARM it is 0" refers to the alarm.
    pub(super) fn alarm(&mut self, alarm: Alarm) {
        self.s.state = State::Alarm;
        self.s.alarm = alarm;
        self.drop_program();
    }

    /// Drops program, move and timer.
    pub(super) fn drop_program(&mut self) {
        self.s.program = None;
        self.s.motion = None;
        self.s.timer = None;
        self.s.kept = None;
        self.s.homing = None;
    }
}
