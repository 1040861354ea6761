//! The names under which a scenario holds what peripheral and motion own.

use crate::compact::{fields, kinds, words};
use stepscope_motion::{
    mechanics::{Acceleration, Direct, Distance, Jerk, Mechanics, Rotary, Screw, Speed, Wheel},
    motor::Motor,
    moves::{
        Axis, Constant, Cosine, CosineMethod, Dwell, Interpolation, JerkLimited, Move, PointUnit, Points,
        RampShape, Ramps, ShortMove, Sine, SineSegments, Staircase, Trapezoid, TrapezoidMethod,
    },
};
use stepscope_peripheral::config::{Bus, DirLine, Distribution, Protocol, PulsePhasing};

fields! {
    Bus {
        channels, slots, step_period_cycles, pulse_width_cycles, dir_setup_cycles, dir_hold_cycles, distribution,
        dir_line, pulse_phasing, settle_cycles, queue_depth, boot_cycles,
    }
    Axis { mechanics, moves, motor, }
    Rotary { full_step_deg, microsteps, }
    Wheel { full_step_deg, microsteps, radius_mm, }
    Screw { full_step_deg, microsteps, lead_mm, }
    Direct { step_mm, }
    Motor {
        rated_current_a, resistance_ohm, inductance_mh, holding_torque_mn_m, rotor_inertia_g_cm2, supply_v,
        peak_current_a, load_inertia_g_cm2, load_torque_mn_m, working_rate_hz,
    }
    Trapezoid { distance, start_speed, top_speed, acceleration, method, timer_hz, }
    Staircase { distance, top_speed, level, short_move, start_speed, max_speed, }
    Cosine { distance, duration_s, ramp_s, method, slice_s, }
    Ramps { distance, duration_s, ramp_s, shape, sigmoid_range, time_constants, }
    SineSegments { amplitude, period_s, periods, max_deviation, }
    Sine { amplitude, period_s, periods, }
    JerkLimited { distance, max_speed, max_acceleration, max_jerk, }
    Points { unit, interpolation, points, }
    Constant { distance, speed, }
    Dwell { duration_s, }
}

kinds! {
    Mechanics {
        Rotary(Rotary) = "rotary",
        Wheel(Wheel) = "wheel",
        Screw(Screw) = "screw",
        Direct(Direct) = "direct",
    }
    Distance { Steps(f64) = "steps", Millimetres(f64) = "mm", Degrees(f64) = "deg", }
    Speed {
        StepsPerSecond(f64) = "steps_s",
        MillimetresPerSecond(f64) = "mm_s",
        DegreesPerSecond(f64) = "deg_s",
        TurnsPerMinute(f64) = "rpm",
    }
    Acceleration {
        StepsPerSecond2(f64) = "steps_s2",
        MillimetresPerSecond2(f64) = "mm_s2",
        DegreesPerSecond2(f64) = "deg_s2",
    }
    Jerk {
        StepsPerSecond3(f64) = "steps_s3",
        MillimetresPerSecond3(f64) = "mm_s3",
        DegreesPerSecond3(f64) = "deg_s3",
    }
    Move {
        Trapezoid(Trapezoid) = "trapezoid",
        Staircase(Staircase) = "staircase",
        Cosine(Cosine) = "cosine",
        Ramps(Ramps) = "ramps",
        SineSegments(SineSegments) = "sine_segments",
        Sine(Sine) = "sine",
        JerkLimited(JerkLimited) = "jerk_limited",
        Points(Points) = "points",
        Constant(Constant) = "constant",
        Dwell(Dwell) = "dwell",
    }
}

words! {
    Distribution { Burst = "burst", Spread = "spread", }
    DirLine { PerChannel = "per_channel", Common = "common", }
    Protocol { Raw = "raw", Framed = "framed", }
    PulsePhasing { Simultaneous = "simultaneous", Staggered = "staggered", }
    crate::MotionEngine { Ticks = "ticks", Segments = "segments", }
    CosineMethod { Exact = "exact", Sliced = "sliced", }
    RampShape {
        Sigmoid = "sigmoid",
        Bezier = "bezier",
        Straight = "straight",
        Exponential = "exponential",
    }
    ShortMove { Document = "document", Reverse = "reverse", }
    Interpolation { Straight = "straight", Smooth = "smooth", }
    PointUnit { Steps = "steps", Millimetres = "mm", Degrees = "deg", }
    TrapezoidMethod { Table = "table", Exact = "exact", }
    crate::DriverModel {
        A4988 = "a4988",
        A4979 = "a4979",
        Drv8825 = "drv8825",
        Tmc2209 = "tmc2209",
        Tmc262 = "tmc262",
        Tb6600Class = "tb6600_class",
    }
}
