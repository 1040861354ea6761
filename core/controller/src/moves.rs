//! Begin and end of moves (CONTROLLER G4), jogs and the return (G6).

use crate::controller::{Controller, Paused};
use crate::motion::{Climb, ENDLESS, Motion, Purpose};
use crate::parameters::{Release, ShortMove, SoftLimits};
use crate::state::{Alarm, State, trust};
use crate::{input::Signal, numbers::Common, pulses::profile, table::Table};
use stepscope_peripheral::segment::FRACTION_BITS;

impl Controller {
    pub(crate) fn table(&self, level: u32) -> Table {
        let acceleration_hz_s = self.parameters.level_hz_s.saturating_mul(level);
        Table { start_speed_hz: self.parameters.start_speed_hz, acceleration_hz_s }
    }

    fn climb(&self, steps: u64, speed_hz: u32, level: u32) -> Climb {
        let table = self.table(level);
        let top = table.steps_to(speed_hz);
        if top.saturating_mul(2) > steps && self.parameters.short_move == ShortMove::Document {
            Climb { table, top: 0, plateau_hz: self.parameters.start_speed_hz }
        } else {
            Climb { table, top, plateau_hz: speed_hz }
        }
    }

    /// A move of `steps` steps, right positive, along the acceleration table.
    pub(crate) fn plan_move(&self, purpose: Purpose, steps: i128, speed_hz: u32, level: u32) -> Motion {
        let count = u64::try_from(steps.unsigned_abs()).unwrap_or(ENDLESS);
        let climb = self.climb(count, speed_hz, level);
        Motion::new(purpose, steps > 0, count, climb, self.clock_hz)
    }

    /// Whether a move of `steps` would end outside the soft limits.
    pub(crate) fn is_outside(&self, steps: i128) -> bool {
        let target = i128::from(self.position) + steps;
        let Some(SoftLimits { min_steps, max_steps }) = self.parameters.soft_limits else { return false };
        steps != 0 && !(min_steps.into()..=max_steps.into()).contains(&target)
    }

    /// Whether a limit switch blocks this move. The switch of a homing leg does not.
    pub(crate) fn is_blocked_by_limit(&self, motion: &Motion) -> bool {
        let switch = if motion.right { Signal::LimitMax } else { Signal::LimitMin };
        let is_own = matches!(motion.purpose, Purpose::Leg(_))
            && self.parameters.home.as_ref().is_some_and(|home| home.switch == switch);
        self.is_limit_closed(motion.right) && !is_own
    }

    /// Begins a move in cycle `now`. It may wait for memory, or end immediately.
    pub(crate) fn begin_move(&mut self, now: u64, mut motion: Motion) {
        motion.has_hit_limit = motion.steps_left > 0 && self.is_blocked_by_limit(&motion);
        motion.until_met = motion.steps_left > 0
            && !motion.has_hit_limit
            && motion.until.is_some_and(|(input, level)| self.inputs.level(input) == level);
        if motion.steps_left == 0 || motion.has_hit_limit || motion.until_met {
            self.motion = Some(motion);
            self.end_move(now);
        } else if self.is_memory_open() {
            self.start_move(now, motion);
        } else {
            motion.waits_for_memory = true;
            self.motion = Some(motion);
        }
    }

    fn start_move(&mut self, now: u64, mut motion: Motion) {
        self.pins.turn(now, motion.right, self.pulse.hold.0);
        motion.begin(now, profile(&self.parameters, motion.profile));
        self.motion = Some(motion);
    }

    /// Starts a move whose opening record is complete.
    pub(crate) fn start_waiting_move(&mut self, now: u64) {
        if self.is_memory_open()
            && let Some(motion) = self.motion.take_if(|motion| motion.waits_for_memory)
        {
            self.start_move(now, motion);
        }
    }

    /// Ends a move whose last pulse has fallen, or that was stopped while STEP is low.
    pub(crate) fn end_stopped_move(&mut self, now: u64) {
        if !self.pins.step && self.motion.as_ref().is_some_and(|motion| !motion.is_active()) {
            self.end_move(now);
        }
    }

    fn end_move(&mut self, now: u64) {
        let Some(motion) = self.motion.take() else { return };
        self.check_last_step(&motion);
        match motion.purpose {
            Purpose::Jog(back) => self.state = back,
            Purpose::Leg(leg) => self.end_leg(now, leg, &motion),
            Purpose::HomeReturn if motion.has_hit_limit || motion.steps_left > 0 => self.raise(Alarm::Homing),
            Purpose::HomeReturn => self.end_homing(now),
            Purpose::Group | Purpose::Return if motion.has_hit_limit => self.raise(Alarm::Limit),
            Purpose::Group if motion.until_met || motion.steps_left == 0 => self.end_move_group(now, &motion),
            Purpose::Return if motion.steps_left == 0 => self.state = State::Ready,
            Purpose::Group | Purpose::Return if self.state == State::Pausing => {
                self.state = State::Paused;
                self.paused = Some(Paused::Move(motion));
            }
            Purpose::Group | Purpose::Return => self.resume_move(now, &motion),
        }
    }

    /// Begins a move for the remaining steps of another one.
    pub(crate) fn resume_move(&mut self, now: u64, paused: &Motion) {
        let steps = i128::from(paused.steps_left) * if paused.right { 1 } else { -1 };
        let (speed_hz, level) = self.speed_and_level(paused.purpose);
        let mut motion = self.plan_move(paused.purpose, steps, speed_hz, level);
        motion.until = paused.until;
        self.begin_move(now, motion);
    }

    fn speed_and_level(&self, purpose: Purpose) -> (u32, u32) {
        match purpose {
            Purpose::Group => self.group_speed_and_level(),
            _ => (self.numbers.common(Common::ReturnSpeedHz), self.numbers.common(Common::ReturnLevel)),
        }
    }

    /// Trust is lost if the last step exceeded the start-stop rate.
    pub(crate) fn check_last_step(&mut self, motion: &Motion) {
        if motion.last_interval.is_some_and(|interval| self.is_jump(interval)) {
            self.trust = trust::LOST;
        }
    }

    pub(crate) const fn state_of(&self, purpose: Purpose) -> State {
        match purpose {
            Purpose::Return => State::Returning,
            _ => State::Running,
        }
    }

    pub(crate) fn jog(&mut self, now: u64, right: bool) {
        let (jog, back) = (&self.parameters.jog, self.state);
        let speed = if back == State::Debug { Common::JogFineHz } else { Common::JogSpeedHz };
        let speed_hz = self.numbers.common(speed);
        let soft_limits = self.parameters.soft_limits.as_ref().filter(|_| self.trust >= trust::HELD);
        let steps = soft_limits.map_or(ENDLESS, |soft| {
            let position = i64::from(self.position);
            let distance = if right { soft.max_steps - position } else { position - soft.min_steps };
            u64::try_from(distance).unwrap_or(0)
        });
        let table = self.table(jog.level.into());
        let top = match jog.release {
            Release::AtOnce => 0,
            Release::Ramp => table.steps_to(speed_hz),
        };
        let climb = Climb { table, top, plateau_hz: speed_hz };
        let mut motion = Motion::new(Purpose::Jog(back), right, steps, climb, self.clock_hz);
        motion.first_interval = Some(self.pulse.min_interval().0.saturating_mul(1 << FRACTION_BITS));
        self.state = State::Jog;
        self.begin_move(now, motion);
    }

    pub(crate) fn end_jog(&mut self) {
        let Some(motion) = &mut self.motion else { return };
        match self.parameters.jog.release {
            Release::AtOnce => motion.stop(),
            Release::Ramp => motion.brake(),
        }
        self.keep_dir_if_stopped();
    }

    /// Begins the return to zero, on its own or at the end of homing.
    pub(crate) fn return_to_zero(&mut self, now: u64, purpose: Purpose) {
        let steps = -i128::from(self.position);
        if self.is_outside(steps) {
            self.raise(Alarm::SoftLimit);
            return;
        }
        let (speed_hz, level) = self.speed_and_level(purpose);
        let motion = self.plan_move(purpose, steps, speed_hz, level);
        if purpose == Purpose::Return {
            self.state = State::Returning;
        }
        self.begin_move(now, motion);
    }
}
