//! Begin and end of moves (CONTROLLER G4), jogs and the return (G6).

use crate::{
    controller::{Controller, Paused},
    input::Signal,
    motion::{Climb, ENDLESS, Motion, Purpose},
    parameters::{Release, ShortMove},
    pulses::profile,
    state::{Alarm, State},
    table::Table,
};
use stepscope_peripheral::segment::FRACTION_BITS;

impl Controller {
    pub(crate) fn table(&self, level: u32) -> Table {
        let acceleration_hz_s = self.parameters.level_hz_s.saturating_mul(level);
        Table { start_speed_hz: self.parameters.start_speed_hz, acceleration_hz_s }
    }

    fn climb(&self, steps: u64, speed_hz: u32, level: u32) -> Climb {
        let table = self.table(level);
        let top = table.climb(speed_hz);
        if top.saturating_mul(2) > steps && self.parameters.short_move == ShortMove::Document {
            Climb { table, top: 0, plateau_hz: self.parameters.start_speed_hz }
        } else {
            Climb { table, top, plateau_hz: speed_hz }
        }
    }

    /// A move of `steps` steps, positive to the right, by G3.
    pub(crate) fn planned(&self, purpose: Purpose, steps: i128, speed_hz: u32, level: u32) -> Motion {
        let rem = u64::try_from(steps.unsigned_abs()).unwrap_or(ENDLESS);
        let climb = self.climb(rem, speed_hz, level);
        Motion::new(purpose, steps > 0, rem, climb, self.clock_hz)
    }

    /// Whether a move of `steps` would end outside the soft limits.
    pub(crate) fn is_outside(&self, steps: i128) -> bool {
        let target = i128::from(self.position) + steps;
        let outside = |min: i64, max: i64| target < i128::from(min) || target > i128::from(max);
        steps != 0
            && self
                .parameters
                .soft_limits
                .as_ref()
                .is_some_and(|soft| outside(soft.min_steps, soft.max_steps))
    }

    /// Whether a limit switch blocks this move; homing's own switch does not.
    pub(crate) fn is_limited(&self, motion: &Motion) -> bool {
        let switch = if motion.right { Signal::LimitMax } else { Signal::LimitMin };
        let is_own = matches!(motion.purpose, Purpose::Leg(_))
            && self.parameters.home.as_ref().is_some_and(|home| home.switch == switch);
        self.limit(motion.right) && !is_own
    }

    /// Begins a move in cycle `now`; it may wait for memory, or end at once.
    pub(crate) fn begin_move(&mut self, now: u64, mut motion: Motion) {
        motion.is_limited = motion.rem > 0 && self.is_limited(&motion);
        motion.until_met = motion.rem > 0
            && !motion.is_limited
            && motion.until.is_some_and(|(input, level)| self.inputs.level(input) == level);
        if motion.rem == 0 || motion.is_limited || motion.until_met {
            self.motion = Some(motion);
            self.end_move(now);
        } else if self.is_memory_open() {
            self.start_move(now, motion);
        } else {
            motion.waits = true;
            self.motion = Some(motion);
        }
    }

    fn start_move(&mut self, now: u64, mut motion: Motion) {
        self.pins.turn(now, motion.right, self.pulse.hold.0);
        motion.begin(now, profile(&self.parameters, motion.profile));
        self.motion = Some(motion);
    }

    pub(crate) fn waiting(&mut self, now: u64) {
        if self.is_memory_open()
            && let Some(motion) = self.motion.take_if(|motion| motion.waits)
        {
            self.start_move(now, motion);
        }
    }

    /// Ends a move whose last pulse has fallen, or that was stopped while STEP is low.
    pub(crate) fn ended(&mut self, now: u64) {
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
            Purpose::HomeReturn if motion.is_limited || motion.rem > 0 => self.raise(Alarm::Homing),
            Purpose::HomeReturn => self.end_homing(now),
            Purpose::Group | Purpose::Return if motion.is_limited => self.raise(Alarm::Limit),
            Purpose::Group if motion.until_met || motion.rem == 0 => self.end_move_group(now, &motion),
            Purpose::Return if motion.rem == 0 => self.state = State::Ready,
            Purpose::Group | Purpose::Return if self.state == State::Pausing => {
                self.state = State::Paused;
                self.paused = Some(Paused::Move(motion));
            }
            Purpose::Group | Purpose::Return => self.begin_rest(now, &motion),
        }
    }

    pub(crate) fn begin_rest(&mut self, now: u64, paused: &Motion) {
        let steps = i128::from(paused.rem) * if paused.right { 1 } else { -1 };
        let (speed_hz, level) = self.speed_and_level(paused.purpose);
        let mut motion = self.planned(paused.purpose, steps, speed_hz, level);
        motion.until = paused.until;
        self.begin_move(now, motion);
    }

    fn speed_and_level(&self, purpose: Purpose) -> (u32, u32) {
        match purpose {
            Purpose::Group => self.group_speed_and_level(),
            _ => (self.numbers.return_speed_hz(), self.numbers.return_level()),
        }
    }

    /// Trust is lost if the last step was beyond the start-stop range.
    pub(crate) fn check_last_step(&mut self, motion: &Motion) {
        if motion.last_interval.is_some_and(|interval| self.is_jump(interval)) {
            self.trust = 0;
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
        let speed_hz =
            if back == State::Debug { self.numbers.jog_fine_hz() } else { self.numbers.jog_speed_hz() };
        let bound = self.parameters.soft_limits.as_ref().filter(|_| self.trust >= 1);
        let rem = bound.map_or(ENDLESS, |soft| {
            let position = i64::from(self.position);
            let left = if right { soft.max_steps - position } else { position - soft.min_steps };
            u64::try_from(left).unwrap_or(0)
        });
        let table = self.table(jog.level.into());
        let top = match jog.release {
            Release::AtOnce => 0,
            Release::Ramp => table.climb(speed_hz),
        };
        let climb = Climb { table, top, plateau_hz: speed_hz };
        let mut motion = Motion::new(Purpose::Jog(back), right, rem, climb, self.clock_hz);
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
        self.keep_dir_of_stopped();
    }

    /// Begins the return to zero, by itself or as the end of homing.
    pub(crate) fn return_to_zero(&mut self, now: u64, purpose: Purpose) {
        let steps = -i128::from(self.position);
        if self.is_outside(steps) {
            self.raise(Alarm::SoftLimit);
            return;
        }
        let motion =
            self.planned(purpose, steps, self.numbers.return_speed_hz(), self.numbers.return_level());
        if purpose == Purpose::Return {
            self.state = State::Returning;
        }
        self.begin_move(now, motion);
    }
}
