//! Limits, new targets, groups and input shapers with any numbers in them.

use super::arbitrary::{acceleration, distance, jerk, number, one_move, small_or_any, speed};
use proptest::prelude::*;
use stepscope_core::motion::{
    groups::{Group, GroupMove, LineGroup, TimeGroup, WayPoint, WayPointGroup},
    moves::{AxisLimits, JerkLimited, LimitedProfile, Move, Retarget, SpeedTarget, Stop, Target},
    shaper::{InputShaper, ShaperSettings},
};

fn profile() -> impl Strategy<Value = LimitedProfile> {
    prop::sample::select(vec![LimitedProfile::JerkLimited, LimitedProfile::Trapezoid])
}

pub(super) fn limits() -> impl Strategy<Value = AxisLimits> {
    let edge = prop::option::of(speed(1000.0));
    (speed(1e4), acceleration(), prop::option::of(acceleration()), jerk(), edge).prop_map(
        |(max_speed, max_acceleration, max_deceleration, max_jerk, start_stop_speed)| AxisLimits {
            max_speed,
            max_acceleration,
            max_deceleration,
            max_jerk,
            start_stop_speed,
        },
    )
}

pub(super) fn shaper() -> impl Strategy<Value = InputShaper> {
    let kinds: [fn(ShaperSettings) -> InputShaper; 6] = [
        InputShaper::Zv,
        InputShaper::Mzv,
        InputShaper::Zvd,
        InputShaper::Ei,
        InputShaper::TwoHumpEi,
        InputShaper::ThreeHumpEi,
    ];
    (0..kinds.len(), number(45.0), number(0.1)).prop_map(move |(kind, frequency_hz, damping_ratio)| {
        kinds[kind](ShaperSettings { frequency_hz, damping_ratio })
    })
}

/// A move between two speeds, or a new target.
pub(super) fn continued() -> impl Strategy<Value = Move> {
    let target = prop_oneof![
        distance(500.0).prop_map(Target::Position),
        (speed(-500.0), number(0.2)).prop_map(|(speed, hold_s)| Target::Speed(SpeedTarget { speed, hold_s })),
        Just(Target::Stop(Stop {})),
    ];
    let own = (prop::option::of(speed(4000.0)), prop::option::of(acceleration()));
    let retarget = (number(0.1), target, profile(), own, prop::option::of(jerk())).prop_map(
        |(at_s, target, profile, (max_speed, max_acceleration), max_jerk)| {
            let max_deceleration = max_acceleration.clone();
            Move::Retarget(Retarget {
                at_s,
                target,
                profile,
                max_speed,
                max_acceleration,
                max_deceleration,
                max_jerk,
            })
        },
    );
    let edges = || prop::option::of(speed(500.0));
    let between = (distance(3200.0), edges(), edges(), prop::option::of(acceleration())).prop_map(
        |(distance, start_speed, end_speed, max_deceleration)| {
            Move::JerkLimited(JerkLimited {
                distance,
                start_speed,
                end_speed,
                max_deceleration,
                ..JerkLimited::default()
            })
        },
    );
    prop_oneof![retarget, between]
}

pub(super) fn group() -> impl Strategy<Value = Group> {
    let own = (small_or_any(0), one_move()).prop_map(|(axis, r#move)| GroupMove { axis, r#move });
    let time = (prop::option::of(number(2.0)), prop::collection::vec(own, 0..3))
        .prop_map(|(duration_s, moves)| Group::Time(TimeGroup { duration_s, moves }));
    let line = (prop::collection::vec(distance(1000.0), 0..3), profile())
        .prop_map(|(distances, profile)| Group::Line(LineGroup { distances, profile }));
    let speeds = prop::option::of(prop::collection::vec(prop::option::of(speed(100.0)), 0..3));
    let point = (prop::collection::vec(distance(1000.0), 0..3), speeds)
        .prop_map(|(positions, speeds)| WayPoint { positions, speeds });
    let points =
        prop::collection::vec(point, 0..4).prop_map(|points| Group::WayPoints(WayPointGroup { points }));
    prop_oneof![time, line, points]
}
