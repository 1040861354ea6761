//! Plans a new target for a move that is cut.

use crate::curves::between_speeds::MoveLimits;
use crate::curves::{
    cut::Cut, move_curve::MoveCurve, numeric::Numeric, phases::Phase, phases::State, retarget,
};
use crate::moves::{AxisLimits, LimitedProfile, Retarget, SpeedTarget, Target};
use crate::{Profile, limits, planners::quantities::Quantities, problem::Cause};
use alloc::boxed::Box;

/// The duration of a cut move may be less than `at_s` by a rounding.
const TIME_TOLERANCE: f64 = 1e-12;

/// Limits of an axis in steps and s; the deceleration is the acceleration if it is not given.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    speed: f64,
    acceleration: f64,
    deceleration: Option<f64>,
    jerk: f64,
    pub(crate) start_stop_speed: Option<f64>,
}

impl Limits {
    /// The limits of an axis.
    pub(crate) fn plan(quantities: &mut Quantities<'_>, given: &AxisLimits) -> Option<Self> {
        quantities.at("limits", |here| {
            let speed = here.speed("max_speed", &given.max_speed);
            let acceleration = here.acceleration("max_acceleration", &given.max_acceleration);
            let deceleration =
                here.acceleration_or("max_deceleration", given.max_deceleration.as_ref(), acceleration);
            let jerk = here.jerk("max_jerk", &given.max_jerk);
            let start_stop_speed = here.edge_speed("start_stop_speed", given.start_stop_speed.as_ref());
            Some(Self {
                speed: speed?,
                acceleration: acceleration?,
                deceleration: given.max_deceleration.as_ref().and(deceleration),
                jerk: jerk?,
                start_stop_speed: start_stop_speed?,
            })
        })
    }

    pub(crate) fn of(&self, profile: LimitedProfile) -> MoveLimits {
        let Self { speed, acceleration, deceleration, jerk, .. } = *self;
        let jerk = if profile == LimitedProfile::Trapezoid { f64::INFINITY } else { jerk };
        MoveLimits { speed, acceleration, deceleration: deceleration.unwrap_or(acceleration), jerk }
    }

    /// These limits with those that a move gives instead.
    fn with(self, quantities: &mut Quantities<'_>, given: &Retarget) -> Option<MoveLimits> {
        let speed = given.max_speed.as_ref().map_or(Some(self.speed), |it| quantities.speed("max_speed", it));
        let acceleration = quantities.acceleration_or(
            "max_acceleration",
            given.max_acceleration.as_ref(),
            Some(self.acceleration),
        );
        let deceleration = quantities.acceleration_or(
            "max_deceleration",
            given.max_deceleration.as_ref(),
            self.deceleration.or(acceleration),
        );
        let jerk = given.max_jerk.as_ref().map_or(Some(self.jerk), |it| quantities.jerk("max_jerk", it));
        let limits = Self {
            speed: speed?,
            acceleration: acceleration?,
            deceleration: Some(deceleration?),
            jerk: jerk?,
            ..self
        };
        Some(limits.of(given.profile))
    }
}

/// The target in steps and s.
enum Goal {
    /// Whole steps from the start of the motion.
    Position(i64),
    Speed(f64, f64),
}

fn goal(quantities: &mut Quantities<'_>, target: &Target, max_speed: Option<f64>) -> Option<Goal> {
    quantities.at("target", |here| match target {
        Target::Position(position) => here.position("position", position).map(Goal::Position),
        Target::Stop(_) => Some(Goal::Speed(0.0, 0.0)),
        Target::Speed(SpeedTarget { speed, hold_s }) => here.at("speed", |here| {
            let speed = here.speed_within("speed", speed, limits::SIGNED_SPEED_STEPS_S);
            let hold_s = here.range("hold_s", *hold_s, limits::PAUSE_S, "s");
            let (speed, hold_s, max) = (speed?, hold_s?, max_speed?);
            if libm::fabs(speed) > max {
                here.refuse("speed", Cause::EdgeAboveMax { speed: libm::fabs(speed), max });
                return None;
            }
            Some(Goal::Speed(speed, hold_s))
        }),
    })
}

/// A move that is cut, and what follows.
pub(crate) struct Retargeted {
    pub(crate) cut: Profile,
    pub(crate) profile: Profile,
    /// The target speed along the axis.
    pub(crate) end_speed: f64,
}

/// Plans a new target for `previous`, which begins at `start_steps`; `None` without it only checks the numbers.
pub(crate) fn plan(
    quantities: &mut Quantities<'_>,
    given: &Retarget,
    axis_limits: Option<Limits>,
    previous: Option<(&Profile, i64)>,
) -> Option<Retargeted> {
    let at_s = quantities.range("at_s", given.at_s, limits::CUT_S, "s");
    let move_limits = axis_limits.and_then(|limits| limits.with(quantities, given));
    let goal = goal(quantities, &given.target, move_limits.map(|limits| limits.speed));
    let (previous, start_steps) = previous?;
    if previous.follows_table() {
        quantities
            .refuse("", Cause::FollowsTable { what: "cannot be cut", remedy: "the exact method before it" });
        return None;
    }
    let (at_s, move_limits, goal) = (at_s?, move_limits?, goal?);
    let duration_s = previous.duration_s();
    if at_s > duration_s * (1.0 + TIME_TOLERANCE) {
        quantities.refuse("at_s", Cause::CutTooLate { at_s, duration_s });
        return None;
    }
    let cut = Cut::new(previous.clone(), at_s);
    let steps = cut.base().due_within(at_s).0;
    let end = cut.end();
    let from = State { position: end.position - steps as f64, ..end };
    let (phases, end_speed) = match goal {
        Goal::Position(position) => {
            let position = position.saturating_sub(start_steps).saturating_sub(steps);
            (retarget::to_position(&move_limits, from, position as f64), 0.0)
        }
        Goal::Speed(speed, hold_s) => {
            let mut phases = retarget::to_speed(&move_limits, from, speed);
            phases.extend([Phase::cruise(hold_s)]);
            (phases, speed)
        }
    };
    let profile = Profile::Phases(Numeric::of_phases(phases, from.position));
    Some(Retargeted { cut: Profile::Cut(Box::new(cut)), profile, end_speed })
}
