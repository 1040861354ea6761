//! An axis and its moves (DESIGN Part B); motion owns the types.

use crate::schema::rows::{fields, kinds, words};
use crate::schema::{Field, OWN, SINE, SONG, SONOBE, ZHANG, label};
use alloc::vec::Vec;
use stepscope_motion::mechanics::{Acceleration, Distance, Jerk, Mechanics, Speed};
use stepscope_motion::moves::{
    Axis, AxisLimits, Constant, Cosine, CosineMethod, Dwell, Interpolation, JerkLimited, LimitedProfile,
    Move, Point, PointUnit, Points, RampShape, Ramps, Retarget, ShortMove, Sine, SineSegments, SpeedTarget,
    Staircase, Stop, Target, Trapezoid, TrapezoidMethod,
};
use stepscope_motion::{limits, motor::Motor, shaper::InputShaper};

fields! {
    /// An axis runs its moves in order.
    Axis {
        /// Travel per step.
        mechanics: Mechanics => label("Mechanics"),
        /// Moves, in order; at least one without groups.
        moves: Vec<Move> => label("Moves").length(0..=*limits::MOVES.end(), "moves"),
        /// Motor, supply and load.
        motor: Option<Motor> => label("Motor")
            .null_means("torque is not checked")
            .term("Motor", "Motor data for the torque-speed curve: a two-phase hybrid motor on a driver that regulates the current. It does not affect the run. A move that needs more torque than the motor has gets a warning; Study > Torque shows both. The default is the motor of Song, Han, Lu 2021.")
            .from(SONG),
        /// Limits for lines, waypoints and new targets, and the start-stop speed.
        limits: AxisLimits => label("Limits").only_if_set(),
        /// Shapes all moves of the axis so that they do not excite a vibration.
        input_shaper: Option<InputShaper> => label("Input shaper")
            .null_means("not shaped")
            .term("Input shaper", "The sum of the curve at several delays, which cancels the vibration of a machine at one frequency. The axis ends later by the longest delay, exactly where it would end without a shaper.")
            .from(OWN)
            .only_if_set(),
    }
}

kinds! {
    /// One move of an axis.
    Move {
        /// Constant acceleration from the start speed to the maximum speed, plateau, constant deceleration. After k steps v =
        /// √(v0² + 2·a·x), where x is the travel of k steps.
        Trapezoid(Trapezoid) = "trapezoid" => label("Trapezoid").from(SONOBE),
        /// Speed rises in stairs of whole rates, each held for some steps (30, later 60, 90, …), so a short table covers a
        /// long ramp. After the plateau the same stairs lead down.
        Staircase(Staircase) = "staircase" => label("Staircase of rates").from(ZHANG),
        /// Speed follows half a cosine wave up to a plateau and back down, without jumps of acceleration. Distance and
        /// duration are exact.
        Cosine(Cosine) = "cosine" => label("Cosine S-curve").from(SONG),
        /// Like the cosine S-curve, with exact distance and duration, but with ramps of another shape. Song 2021 compares
        /// sigmoid and Bezier curves with the cosine.
        Ramps(Ramps) = "ramps" => label("Ramps of a shape").from(SONG),
        /// A sine of straight segments, each with a constant rate: a few numbers instead of one interval per step. The
        /// maximum deviation d1 determines the breakpoints.
        SineSegments(SineSegments) = "sine_segments" => label("Sine in segments").from(SINE),
        /// Each step comes where the sine is halfway between two steps. The sine in segments approximates this; the exact
        /// sine needs one interval per step.
        Sine(Sine) = "sine" => label("Exact sine").from(SINE),
        /// As fast as the limits of speed, acceleration and jerk allow, in up to seven phases. The acceleration does not
        /// jump, so a machine vibrates less.
        JerkLimited(JerkLimited) = "jerk_limited" => label("Jerk-limited S-curve").from(OWN),
        /// A curve given as times and positions, such as a cam, a measurement or the output of another program. Each step
        /// comes where the curve crosses half a step.
        Points(Points) = "points" => label("Through points").from(OWN),
        /// One rate without ramps. A motor follows it only up to its start-stop rate.
        Constant(Constant) = "constant" => label("Constant rate"),
        /// A new target for the previous move, from any of its states. The fastest way there may overshoot and reverse.
        Retarget(Retarget) = "retarget" => label("New target").from(OWN),
        /// A pause between two moves, with the windings powered.
        Dwell(Dwell) = "dwell" => label("Dwell").from(ZHANG),
    }
}

const DISTANCE: Field = label("Distance")
    .unit("steps")
    .number(limits::STEPS)
    .term("Distance", "Travel of the move, rounded to whole steps.");
const SPEED: Field = label("Speed")
    .unit("steps/s")
    .number(limits::SPEED_STEPS_S)
    .term("Speed", "Step rate of the whole move.");
const START_SPEED: Field = label("Start speed")
    .unit("steps/s")
    .number(limits::TABLE_RATE_STEPS_S)
    .term(
        "Start speed",
        "Rate of the first step, v0 or f_1. A motor can start at any rate up to its start-stop rate.",
    )
    .from(SONOBE);
const MAX_SPEED: Field = label("Max speed")
    .unit("steps/s")
    .number(limits::TABLE_RATE_STEPS_S)
    .term(
        "Max speed",
        "Rate of the plateau between the ramps, f_s. Above its pull-out rate a motor loses steps.",
    )
    .from(ZHANG);
/// A speed along the move, whatever the sign of the distance.
const EDGE_SPEED: Field = label("Start speed")
    .unit("steps/s")
    .number(limits::EDGE_SPEED_STEPS_S)
    .null_means("the end speed given in the previous move, or 0")
    .term("Start and end speed", "Speed along the move at its start and its end, positive toward its end. A move without a start speed takes over the end speed given in the previous move, so that moves follow each other without a stop.");
const END_SPEED: Field = Field { label: "End speed", null_means: "0", ..EDGE_SPEED };
const DECELERATION: Field = label("Deceleration")
    .unit("steps/s²")
    .number(limits::ACCELERATION_STEPS_S2)
    .null_means("as the acceleration")
    .term(
        "Deceleration",
        "Limit while the speed falls. A motor brakes harder than it accelerates, because friction helps.",
    );
/// The plateau of a staircase, whose `max_speed` is the end of its table.
const TOP_SPEED: Field = Field { label: "Top speed", ..MAX_SPEED };
const MAX_ACCELERATION: Field = label("Max acceleration")
    .unit("steps/s²")
    .number(limits::ACCELERATION_STEPS_S2)
    .term("Max acceleration", "Change of speed per second on the ramps. A motor reaches at most its torque minus the load torque, divided by the inertia.")
    .from(SONOBE);
const DURATION: Field = label("Duration")
    .unit("s")
    .number(limits::DURATION_S)
    .term("Duration", "Time from the start to the end of the move.");
const RAMP: Field = label("Ramp")
    .unit("s")
    .range_text("0 to half of the duration; below 10^-9 it counts as 0")
    .term("Ramp", "Time t_s of each ramp. Peak rate = steps / (duration − ramp): a longer ramp is gentler but has a higher peak.")
    .from(SONG);
const AMPLITUDE: Field = label("Amplitude")
    .unit("steps")
    .number(limits::STEPS)
    .term("Amplitude", "From the center of the oscillation to one end. The total travel is twice this.")
    .from(SINE);
const PERIOD: Field = label("Period")
    .unit("s")
    .number(limits::DURATION_S)
    .term("Period", "Time T_k of one oscillation; its reciprocal is the frequency.")
    .from(SINE);
const PERIODS: Field = label("Periods")
    .number(limits::PERIODS)
    .term("Periods", "Number of oscillations. The spectrum uses whole periods.")
    .from(SINE);

const LIMIT_SPEED: Field = label("Max speed").unit("steps/s").number(limits::SPEED_STEPS_S);
const LIMIT_ACCELERATION: Field =
    label("Max acceleration").unit("steps/s²").number(limits::ACCELERATION_STEPS_S2);
const LIMIT_DECELERATION: Field = Field { label: "Max deceleration", ..LIMIT_ACCELERATION };
const LIMIT_JERK: Field = label("Max jerk").unit("steps/s³").number(limits::JERK_STEPS_S3);

kinds! {
    /// The new target of an axis.
    Target {
        /// A position from the start of the motion, where the axis comes to rest; rounded to a whole step.
        Position(Distance) = "position" => label("Position"),
        /// A speed.
        Speed(SpeedTarget) = "speed" => label("Speed"),
        /// The fastest stop.
        Stop(Stop) = "stop" => label("Stop"),
    }
}

fields! {
    /// Constant acceleration: with the table of whole rates and timer reloads of Sonobe 2011, or exact.
    Trapezoid {
        /// Negative values move left.
        distance: Distance => DISTANCE,
        /// Speed at the start.
        start_speed: Option<Speed> => START_SPEED.null_means("the end speed given in the previous move, or 0; not for a table"),
        /// Speed at the end; not for a table.
        end_speed: Option<Speed> => END_SPEED.null_means("a given start speed, or 0").only_if_set(),
        /// Rate of the plateau, at least the start speed. Short moves do not reach it.
        max_speed: Speed => MAX_SPEED.number(limits::SPEED_STEPS_S),
        /// Also the deceleration, unless that is given.
        max_acceleration: Acceleration => MAX_ACCELERATION,
        /// Change of speed per second while the speed falls; not for a table.
        deceleration: Option<Acceleration> => DECELERATION.only_if_set(),
        /// How step times are computed.
        method: TrapezoidMethod => label("Step times")
            .term("Step times", "A small controller stores one pulse rate per step and reloads a timer with clock / rate. Both are whole numbers, so each step is slightly early or late. Exact step times have no such error.")
            .from(SONOBE),
        /// Clock of the timer that the table reloads.
        timer_hz: u32 => label("Timer clock")
            .unit("Hz")
            .number(limits::TIMER_HZ)
            .term("Timer clock", "Clock of the timer that the controller reloads at every step. A slow clock makes step times coarse.")
            .from(SONOBE)
            .when("method", "table"),
    }
    /// A fixed length with a table of whole rates, each held for some steps.
    Staircase {
        /// L in Zhang 2012. Negative values move left.
        distance: Distance => DISTANCE,
        /// Rate of the plateau, f_s. At or below the start speed it is the rate of the whole move.
        top_speed: Speed => TOP_SPEED,
        /// Level times 1000 steps/s².
        level: u8 => label("Acceleration level").named("acceleration_level")
            .number(limits::LEVEL)
            .term("Acceleration level", "One of five accelerations: level times 1000 steps/s².")
            .from(ZHANG),
        /// Moves that are too short for the top speed.
        short_move: ShortMove => label("Short moves")
            .term("Short moves", "A move that is shorter than both ramps cannot reach its top speed. Zhang 2012 runs it at the start speed; accelerating to the highest rate that fits is faster.")
            .from(ZHANG),
        /// First rate of the table, f_1.
        start_speed: Speed => START_SPEED,
        /// The table ends with the first rate above this value, f_max. It limits `top_speed`.
        max_speed: Speed => label("Table ends above")
            .unit("steps/s")
            .number(limits::TABLE_RATE_STEPS_S)
            .term("Table ends above", "The table has rates up to the first one above this value.")
            .from(ZHANG),
    }
    /// A given number of steps in a given time.
    Cosine {
        /// Negative values move left. Rounded to whole steps, which are reached exactly.
        distance: Distance => DISTANCE,
        /// Duration of the whole move; exact, except for slices with a plateau.
        duration_s: f64 => DURATION,
        /// Duration of each ramp.
        ramp_s: f64 => RAMP,
        /// How step times are computed.
        method: CosineMethod => label("Step times")
            .term("Step times", "A small controller evaluates the curve once per slice and rounds down to whole steps, so it makes too few steps in total. Song 2021 therefore scales the curve up and shortens the plateau, so the move ends up to 0.8 % early. Exact step times have no such error.")
            .from(SONG),
        /// Length of a slice; 0.001 in Song 2021.
        slice_s: f64 => label("Slice")
            .unit("s")
            .number(limits::SLICE_S)
            .term("Slice", "Time T_S during which the rate is constant, 1 ms in Song 2021. The rate at the start of a slice determines its number of steps.")
            .from(SONG)
            .when("method", "sliced"),
        /// Speed at the start; not for slices.
        start_speed: Option<Speed> => EDGE_SPEED.only_if_set(),
        /// Speed at the end; not for slices.
        end_speed: Option<Speed> => END_SPEED.only_if_set(),
    }
    /// A given number of steps in a given time. Deceleration mirrors acceleration.
    Ramps {
        /// Negative values move left. Rounded to whole steps, which are reached exactly.
        distance: Distance => DISTANCE,
        /// Duration of the whole move; exact.
        duration_s: f64 => DURATION,
        /// Duration of each ramp.
        ramp_s: f64 => RAMP,
        /// Shape of the ramps. Deceleration mirrors acceleration.
        shape: RampShape => label("Shape")
            .term("Shape", "Shape of the speed ramp. Straight: the lowest peak acceleration, but the acceleration jumps. Exponential: the lowest peak rate; it is steep at low speed, where a motor has the most torque. Sigmoid and Bezier: gentle at both ends, like a cosine.")
            .from(SONG),
        /// Over a ramp, x in 1/(1 + e⁻ˣ) goes from minus this value to plus this value.
        sigmoid_range: f64 => label("Sigmoid range")
            .number(limits::RAMP_PARAMETER)
            .term("Sigmoid range", "1/(1 + e⁻ˣ) only approaches 0 and 1, so the ramp uses x from minus this value to plus this value, stretched to full speed. With a small range the ramp is nearly straight; with a large one the acceleration peaks in the middle.")
            .from(SONG)
            .when("shape", "sigmoid"),
        /// Time constants of the exponential per ramp.
        time_constants: f64 => label("Time constants")
            .number(limits::RAMP_PARAMETER)
            .term("Time constants", "Time constants of the exponential per ramp. A higher number makes the ramp steeper at the start and flatter at the end; a low number makes it nearly straight.")
            .when("shape", "exponential"),
        /// Speed at the start.
        start_speed: Option<Speed> => EDGE_SPEED.only_if_set(),
        /// Speed at the end.
        end_speed: Option<Speed> => END_SPEED.only_if_set(),
    }
    /// From the right extreme to the left one and back.
    SineSegments {
        /// From the center to an extreme.
        amplitude: Distance => AMPLITUDE,
        /// Time of one period.
        period_s: f64 => PERIOD,
        /// Number of whole periods.
        periods: u32 => PERIODS,
        /// Maximum distance of a segment from the sine, d1, relative to the amplitude; 0.002 to 0.015 in SWorldJournal.
        max_deviation: f64 => label("Deviation d1")
            .unit("× A")
            .number(limits::MAX_DEVIATION)
            .term("Deviation d1", "Maximum distance of a segment from the sine, relative to the amplitude. A smaller d1 makes more segments, but not always less distortion.")
            .from(SINE),
    }
    /// Step k is due where the cosine crosses k - 1/2. One period has 4 × amplitude steps.
    Sine {
        /// From the center to an extreme. A negative value starts at the left extreme.
        amplitude: Distance => AMPLITUDE,
        /// Time of one period.
        period_s: f64 => PERIOD,
        /// Number of whole periods.
        periods: u32 => PERIODS,
    }
    /// As fast as the limits allow, from rest to rest or between two speeds. A short move omits its plateau, its constant
    /// acceleration, or both.
    JerkLimited {
        /// Negative values move left.
        distance: Distance => DISTANCE,
        /// Short moves do not reach it.
        max_speed: Speed => label("Max speed")
            .unit("steps/s")
            .number(limits::SPEED_STEPS_S)
            .term("Max speed", "Rate of the plateau. Short moves do not reach it."),
        /// Also the deceleration, unless that is given.
        max_acceleration: Acceleration => label("Max acceleration")
            .unit("steps/s²")
            .number(limits::ACCELERATION_STEPS_S2)
            .term("Max acceleration", "Limit of the acceleration. Short moves do not reach it."),
        /// How fast the acceleration may change.
        max_jerk: Jerk => label("Max jerk")
            .unit("steps/s³")
            .number(limits::JERK_STEPS_S3)
            .term("Max jerk", "Limit of the change of acceleration per second. An infinite jerk makes a trapezoid."),
        /// Limit while the speed falls.
        max_deceleration: Option<Acceleration> => Field { label: "Max deceleration", ..DECELERATION }.only_if_set(),
        /// Speed at the start.
        start_speed: Option<Speed> => EDGE_SPEED.only_if_set(),
        /// Speed at the end.
        end_speed: Option<Speed> => END_SPEED.only_if_set(),
    }
    /// Cuts the previous move of the axis and goes on from its position, speed and acceleration, as fast as the limits
    /// allow. The move that is cut must not follow a table.
    Retarget {
        /// Time of the cut after the start of the previous move, up to its duration.
        at_s: f64 => label("Cut at")
            .unit("s")
            .number(limits::CUT_S)
            .term("Cut at", "Time after the start of the previous move at which the new target takes over."),
        /// Where the axis goes.
        target: Target => label("Target"),
        /// How the acceleration changes.
        profile: LimitedProfile => label("Profile")
            .term("Profile", "Jerk-limited: the acceleration changes gradually. Trapezoid: the acceleration jumps, so the move takes less time."),
        /// Maximum speed.
        max_speed: Option<Speed> => LIMIT_SPEED.null_means("the axis' `limits`"),
        /// Limit while the speed rises.
        max_acceleration: Option<Acceleration> => LIMIT_ACCELERATION.null_means("the axis' `limits`"),
        /// Limit while the speed falls.
        max_deceleration: Option<Acceleration> => LIMIT_DECELERATION.null_means("the axis' `limits`, or the acceleration"),
        /// Not for a trapezoid.
        max_jerk: Option<Jerk> => LIMIT_JERK.null_means("the axis' `limits`"),
    }
    /// A speed, which is then held.
    SpeedTarget {
        /// Negative values move left.
        speed: Speed => label("Speed").unit("steps/s").number(limits::SIGNED_SPEED_STEPS_S),
        /// Time at this speed.
        hold_s: f64 => label("Hold").unit("s").number(limits::PAUSE_S),
    }
    /// The fastest stop, wherever it ends. It has no fields.
    Stop {}
    /// Limits of the axis, for moves without limits.
    AxisLimits {
        /// Maximum speed.
        max_speed: Speed => LIMIT_SPEED,
        /// Limit while the speed rises.
        max_acceleration: Acceleration => LIMIT_ACCELERATION,
        /// Limit while the speed falls.
        max_deceleration: Option<Acceleration> => LIMIT_DECELERATION.null_means("as the acceleration"),
        /// Limit of the change of acceleration per second.
        max_jerk: Jerk => LIMIT_JERK,
        /// Maximum jump of the speed at the start, between moves and at the end.
        start_stop_speed: Option<Speed> => label("Start-stop speed")
            .unit("steps/s")
            .number(limits::EDGE_SPEED_STEPS_S)
            .null_means("not checked")
            .term("Start-stop speed", "A motor can start and stop without a ramp up to this rate. A larger jump of the speed is refused."),
    }
    /// Both columns are relative to the first point. Times rise by at least 1 ns; positions are within 10^9 steps.
    /// `"straight"` is the polyline itself, whose speed jumps at each point. `"smooth"` uses cubics (Steffen 1990) from
    /// rest to rest, which turn only where the points turn. Step k is due where the curve crosses k - 1/2. The
    /// axis ends at the last position, rounded half up to a whole step.
    ///
    /// `stepscope points table.csv` makes a scenario from a table with two columns; the page's form reads one too. A long
    /// list may not fit into a link: use a file.
    Points {
        /// Unit of the positions.
        unit: PointUnit => label("Unit")
            .term("Unit", "Unit of the positions. Millimeters and degrees need mechanics that have them."),
        /// Curve between the points.
        interpolation: Interpolation => label("Interpolation")
            .term("Interpolation", "Straight: the speed jumps at every point. Smooth: cubics (Steffen 1990) without overshoot, from rest to rest."),
        /// Time in s and position: `0.25, 12.5`. Times rise.
        points: Vec<Point> => label("One point per line")
            .length(limits::POINTS, "points")
            .term("Points", "Time in s and position, one pair per line, both relative to the first point. The last position is rounded to a whole step."),
    }
    /// One rate for the whole move.
    Constant {
        /// Negative values move left.
        distance: Distance => DISTANCE,
        /// Rate of every step.
        speed: Speed => SPEED,
    }
    /// A pause.
    Dwell {
        /// Length of the pause.
        duration_s: f64 => DURATION.number(limits::PAUSE_S),
    }
}

words! {
    TrapezoidMethod {
        Table = "table", "table and timer": "whole pulse rates, one per step, and whole timer reloads (Sonobe 2011)";
        Exact = "exact", "exact": "step k where the ideal curve crosses k - 1/2";
    }
    LimitedProfile {
        JerkLimited = "jerk_limited", "jerk-limited": "limited jerk";
        Trapezoid = "trapezoid", "trapezoid": "jumps of the acceleration";
    }
    ShortMove {
        Document = "at_start_speed", "at start speed": "run the whole move at the start speed (Zhang 2012)";
        Reverse = "reverse", "accelerate and decelerate": "accelerate to the highest rate that fits, then decelerate";
    }
    CosineMethod {
        Exact = "exact", "exact": "step k where the ideal curve crosses k - 1/2";
        Sliced = "sliced", "in slices": "whole steps per time slice, with the time error of Song 2021";
    }
    RampShape {
        Sigmoid = "sigmoid", "sigmoid": "1/(1 + e^-x), stretched from rest to full speed";
        Bezier = "bezier", "Bezier": "3x^2 - 2x^3";
        Straight = "straight", "straight": "constant acceleration";
        Exponential = "exponential", "exponential": "1 - e^-x over the time constants";
    }
    PointUnit {
        Steps = "steps", "steps": "steps";
        Millimeters = "mm", "mm": "millimeters";
        Degrees = "deg", "°": "degrees";
    }
    Interpolation {
        Straight = "straight", "straight": "lines between points";
        Smooth = "smooth", "smooth": "smooth, from rest to rest";
    }
}
