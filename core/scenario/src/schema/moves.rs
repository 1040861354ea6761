//! An axis and its moves (DESIGN Part B); motion owns the types.

use crate::schema::{
    Field, OWN, SINE, SONG, SONOBE, ZHANG, label,
    rows::{fields, kinds, words},
};
use alloc::vec::Vec;
use stepscope_motion::{
    limits,
    mechanics::{Acceleration, Distance, Jerk, Mechanics, Speed},
    motor::Motor,
    moves::{
        Axis, Constant, Cosine, CosineMethod, Dwell, Interpolation, JerkLimited, Move, Point, PointUnit,
        Points, RampShape, Ramps, ShortMove, Sine, SineSegments, Staircase, Trapezoid, TrapezoidMethod,
    },
};

fields! {
    /// An axis makes its moves one after another.
    Axis {
        /// What one step is.
        mechanics: Mechanics => label("Mechanics"),
        /// Made one after another.
        moves: Vec<Move> => label("Moves").length(limits::MOVES, "moves"),
        /// The motor, its supply and its load.
        motor: Option<Motor> => label("Motor")
            .empty("nothing is said of torque")
            .term("Motor", "What its torque-speed curve follows from, by the textbooks' model of a two-phase hybrid motor on a driver that regulates the current. It changes nothing in a run: a move that asks for more torque than there is gets a warning, and the study's tab Torque shows both. It begins as the document's motor.")
            .from(SONG),
    }
}

kinds! {
    /// One move of an axis.
    Move {
        /// Speed rises evenly from the start speed to the top speed, stays, and falls evenly. After k steps v = √(v0² +
        /// 2·a·x), x the way of k steps.
        Trapezoid(Trapezoid) = "trapezoid" => label("Trapezoid").from(SONOBE),
        /// Speed climbs a staircase of whole rates, each held for some steps (30, later 60, 90, …), so that a short table
        /// is enough for a long ramp; then a plateau, and down the same stairs.
        Staircase(Staircase) = "staircase" => label("Staircase of rates").from(ZHANG),
        /// Speed rises as half a wave of a cosine, stays, and falls the same way: no jump of acceleration at the top. So
        /// many steps are made in exactly so much time.
        Cosine(Cosine) = "cosine" => label("Cosine S-curve").from(SONG),
        /// As the cosine S-curve, so many steps in exactly so much time, with ramps of another shape: what each costs in
        /// peak rate, acceleration and jerk shows beside it. The document weighs sigmoid and Bezier curves against the
        /// cosine.
        Ramps(Ramps) = "ramps" => label("Ramps of a shape").from(SONG),
        /// A sine made of straight segments, each with one fixed rate: a few numbers in place of one interval for every
        /// step. Where the segments break is worked out from the largest deviation d1.
        SineSegments(SineSegments) = "sine_segments" => label("Sine in segments").from(SINE),
        /// Oscillates like a pendulum: each step comes when the sine itself is half way between two steps. The ideal that
        /// a sine made of segments is measured against; it needs an interval for every step.
        Sine(Sine) = "sine" => label("Exact sine").from(SINE),
        /// As fast as three limits allow: acceleration rises evenly by the jerk, stays at its limit, and falls again
        /// before the top speed is reached; then the same to slow down. Seven phases, of which a short move leaves some
        /// out. Without a jump of acceleration a machine shakes less.
        JerkLimited(JerkLimited) = "jerk_limited" => label("Jerk-limited S-curve").from(OWN),
        /// A curve given as times and positions: a cam, a record of a real machine, the result of another program. Each
        /// step comes where the curve crosses half a step.
        Points(Points) = "points" => label("Through points").from(OWN),
        /// One rate from the first step to the last, with no ramp. A motor follows this only up to its start-stop rate.
        Constant(Constant) = "constant" => label("Constant rate"),
        /// Standing still with the windings powered: a pause between two moves, such as in the programs of a fixed-length
        /// controller.
        Dwell(Dwell) = "dwell" => label("Dwell").from(ZHANG),
    }
}

/// A way.
const DISTANCE: Field = label("Distance")
    .unit("steps")
    .number(limits::STEPS)
    .term("Distance", "How far the move goes. It is rounded to whole steps: a motor cannot do less.");
/// A speed above 0.
const SPEED: Field = label("Speed")
    .unit("steps/s")
    .number(limits::SPEED_STEPS_S)
    .term("Speed", "Rate of all steps of the move.");
/// The rate of the first step.
const START_SPEED: Field = label("Start speed")
    .unit("steps/s")
    .number(limits::TABLE_RATE_STEPS_S)
    .term("Start speed", "Rate of the first step, v0 or f_1. A motor can jump to it from standing still, up to its start-stop rate.")
    .from(SONOBE);
/// The rate of a plateau.
const TOP_SPEED: Field = label("Top speed")
    .unit("steps/s")
    .number(limits::TABLE_RATE_STEPS_S)
    .term("Top speed", "Rate of the plateau between the ramps, f_s. Above the pull-out rate for its load a motor loses steps.")
    .from(ZHANG);
/// An acceleration above 0.
const ACCELERATION: Field = label("Acceleration")
    .unit("steps/s²")
    .number(limits::ACCELERATION_STEPS_S2)
    .term("Acceleration", "How much the speed grows in a second. The motor's torque less the load's, divided by the inertia, is the most it can be.")
    .from(SONOBE);
/// The time of a whole move.
const DURATION: Field = label("Duration")
    .unit("s")
    .number(limits::DURATION_S)
    .term("Duration", "Time from the start of the move to its end.");
/// The time of a ramp.
const RAMP: Field = label("Ramp")
    .unit("s")
    .follows("0 to half of the duration; under 10^-9, the shortest cycle of a clock, it counts as 0")
    .term("Ramp", "Time t_s in which speed rises to its peak, and again falls from it. Peak rate = steps / (duration − ramp): a longer ramp is gentler but needs a higher peak.")
    .from(SONG);
/// From the middle to an extreme.
const AMPLITUDE: Field = label("Amplitude")
    .unit("steps")
    .number(limits::STEPS)
    .term("Amplitude", "From the middle of the oscillation to one end; the carriage of a calibration rig goes to and fro by twice this.")
    .from(SINE);
/// The time of a period.
const PERIOD: Field = label("Period")
    .unit("s")
    .number(limits::DURATION_S)
    .term("Period", "Time T_k of once to and fro; one over it is the frequency.")
    .from(SINE);
/// How many periods.
const PERIODS: Field = label("Periods")
    .number(limits::PERIODS)
    .term("Periods", "How often the oscillation is repeated. The spectrum is taken over whole periods.")
    .from(SINE);

fields! {
    /// Uniform acceleration: by the document's table of whole rates and timer reloads, or exact.
    Trapezoid {
        /// Negative is left.
        distance: Distance => DISTANCE,
        /// Speed of the first step.
        start_speed: Speed => START_SPEED,
        /// Speed of the plateau, at least the start speed; short moves do not reach it.
        top_speed: Speed => TOP_SPEED.number(limits::SPEED_STEPS_S),
        /// Also of the slowing down.
        acceleration: Acceleration => ACCELERATION,
        /// Whose step times.
        method: TrapezoidMethod => label("Step times")
            .term("Step times", "A small controller keeps a table of pulse rates, one entry a step, and loads a timer with clock / rate: both are whole numbers, so each step comes a little early or late. Exact times show what is lost by that.")
            .from(SONOBE),
        /// Counts the table's reloads.
        timer_hz: u32 => label("Timer clock")
            .unit("Hz")
            .number(limits::TIMER_HZ)
            .term("Timer clock", "The timer that the controller reloads for every step counts this clock. A slow one makes coarse step times.")
            .from(SONOBE)
            .when("method", "table"),
    }
    /// A fixed length by a table of whole rates, each held for some steps.
    Staircase {
        /// The document's L; negative is left.
        distance: Distance => DISTANCE,
        /// Speed of the plateau, f_s; at or below the start speed that of the whole move.
        top_speed: Speed => TOP_SPEED,
        /// Level times 1000 steps/s².
        level: u8 => label("Acceleration level")
            .number(limits::LEVEL)
            .term("Acceleration level", "One of five accelerations that the controller offers: level times 1000 steps/s².")
            .from(ZHANG),
        /// What becomes of a move that is too short for its top speed.
        short_move: ShortMove => label("Short moves")
            .term("Short moves", "A move with less way than both ramps need never reaches its top speed. The document makes the whole of it at the start speed; reversing on the way up is quicker.")
            .from(ZHANG),
        /// First rate of the table, f_1.
        start_speed: Speed => START_SPEED,
        /// The table ends with the first rate above this, f_max; no top speed may be above it.
        max_speed: Speed => label("Table ends above")
            .unit("steps/s")
            .number(limits::TABLE_RATE_STEPS_S)
            .term("Table ends above", "The rates of the table are worked out once, up to the first one above this.")
            .from(ZHANG),
    }
    /// So many steps in so much time.
    Cosine {
        /// Negative is left. Rounded to whole steps, and these are reached exactly.
        distance: Distance => DISTANCE,
        /// Time of the whole move. Kept exactly but by slices with a plateau.
        duration_s: f64 => DURATION,
        /// Time of each ramp.
        ramp_s: f64 => RAMP,
        /// Whose step times.
        method: CosineMethod => label("Step times")
            .term("Step times", "A small controller looks at the curve once a slice and makes whole steps in it: too few, so the document asks for more steps than there are until the sum is right, and then shortens the plateau. The move ends early by that, up to 0.8 % in the document. Exact times have no such error.")
            .from(SONG),
        /// Length of a slice; the document has 0.001.
        slice_s: f64 => label("Slice")
            .unit("s")
            .number(limits::SLICE_S)
            .term("Slice", "Time TS for which the document's controller keeps a rate, 1 ms there. Each slice has the whole steps of the rate at its start.")
            .from(SONG)
            .when("method", "sliced"),
    }
    /// So many steps in so much time. Slowing down is speeding up, mirrored in time.
    Ramps {
        /// Negative is left. Rounded to whole steps, and these are reached exactly.
        distance: Distance => DISTANCE,
        /// Time of the whole move. Kept exactly.
        duration_s: f64 => DURATION,
        /// Time of each ramp.
        ramp_s: f64 => RAMP,
        /// What the ramps look like; slowing down is speeding up, mirrored in time.
        shape: RampShape => label("Shape")
            .term("Shape", "How the speed goes from nothing to its top. Straight is uniform acceleration: least peak acceleration, but it jumps. An exponential is steep at first, where a motor has most torque, and needs the lowest peak rate. Sigmoid and Bezier curves start and end gently, as a cosine does.")
            .from(SONG),
        /// x of 1/(1 + e⁻ˣ) goes from minus to plus this over a ramp.
        sigmoid_range: f64 => label("Sigmoid's range")
            .number(limits::RAMP_PARAMETER)
            .term("Sigmoid's range", "1/(1 + e⁻ˣ) has no end; this is where it is cut off on both sides. A cut one would never reach its full speed, which the document holds against it, so what is left is stretched to do so. A small range is nearly straight, a great one crowds all acceleration into the middle.")
            .from(SONG)
            .when("shape", "sigmoid"),
        /// Of the exponential within a ramp.
        time_constants: f64 => label("Time constants")
            .number(limits::RAMP_PARAMETER)
            .term("Time constants", "How many time constants of the exponential a ramp has. More of them are steeper at the start and flatter at the top; few are nearly straight.")
            .when("shape", "exponential"),
    }
    /// From the right extreme to the left one and back.
    SineSegments {
        /// From the middle to an extreme.
        amplitude: Distance => AMPLITUDE,
        /// Time of one period.
        period_s: f64 => PERIOD,
        /// How many whole periods.
        periods: u32 => PERIODS,
        /// Largest distance of a segment from the sine, d1, in parts of the amplitude; 0.002 to 0.015 in the document.
        max_deviation: f64 => label("Deviation d1")
            .unit("× A")
            .number(limits::MAX_DEVIATION)
            .term("Deviation d1", "How far a segment may lie from the sine, in parts of the amplitude. A smaller d1 makes more segments; the distortion does not simply fall with it.")
            .from(SINE),
    }
    /// Each step where the cosine crosses its half-integer: 4 x amplitude steps a period.
    Sine {
        /// From the middle to an extreme; negative starts at the left one.
        amplitude: Distance => AMPLITUDE,
        /// Time of one period.
        period_s: f64 => PERIOD,
        /// How many whole periods.
        periods: u32 => PERIODS,
    }
    /// From rest to rest, as fast as the three limits allow; a short move leaves out its plateau, its constant
    /// acceleration, or both.
    JerkLimited {
        /// Negative is left.
        distance: Distance => DISTANCE,
        /// Short moves do not reach it.
        max_speed: Speed => label("Greatest speed")
            .unit("steps/s")
            .number(limits::SPEED_STEPS_S)
            .term("Greatest speed", "Speed of the plateau, where the move is long enough to have one."),
        /// Also of the slowing down.
        max_acceleration: Acceleration => label("Greatest acceleration")
            .unit("steps/s²")
            .number(limits::ACCELERATION_STEPS_S2)
            .term("Greatest acceleration", "The acceleration never passes this; a short move may not reach it."),
        /// How fast the acceleration may change.
        max_jerk: Jerk => label("Greatest jerk")
            .unit("steps/s³")
            .number(limits::JERK_STEPS_S3)
            .term("Greatest jerk", "How much the acceleration changes in a second, at most. An infinite jerk would be a trapezoid."),
    }
    /// Both columns count from the first point: a record may begin at any time and place. Times rise by at least 1 ns,
    /// positions are within 10^9 steps. With `"straight"` the curve is the polyline itself, whose speed jumps at each
    /// point; with `"smooth"` cubics (Steffen 1990) that turn only where the points turn, from rest to rest. Each step
    /// falls due where the curve crosses a half-integer; a turn that only touches one, or rests at it, does not cross it.
    /// The axis ends at the last position, rounded half up to a whole step.
    ///
    /// `stepscope points table.csv` makes a scenario of a table of two columns, and the page's form takes one too. A long
    /// list may not fit into a link; a file holds it.
    Points {
        /// Of the positions.
        unit: PointUnit => label("Unit")
            .term("Unit", "Of the positions; millimetres and degrees need mechanics that have them."),
        /// How the curve goes from point to point.
        interpolation: Interpolation => label("Between them")
            .term("Between them", "Straight: the speed jumps at every point. Smooth: cubics (Steffen 1990) that turn only where the points turn, so nothing overshoots; they start and end at rest."),
        /// Time in s and position: `0.25, 12.5`. Rising in time.
        points: Vec<Point> => label("Points, one a line")
            .length(limits::POINTS, "points")
            .term("Points", "Times in s and positions, one pair a line. Both count from the first point, so a record may begin anywhere. The last position is rounded to a whole step."),
    }
    /// One rate from end to end.
    Constant {
        /// Negative is left.
        distance: Distance => DISTANCE,
        /// From the first step to the last.
        speed: Speed => SPEED,
    }
    /// Standing still.
    Dwell {
        /// How long.
        duration_s: f64 => DURATION.number(limits::PAUSE_S),
    }
}

words! {
    TrapezoidMethod {
        /// the document's: whole pulse rates, one a step, and a timer's whole reload
        Table = "table", "table and timer";
        /// each step where the ideal curve crosses its half-integer
        Exact = "exact", "exact";
    }
    ShortMove {
        /// the whole of it at the start speed, as in the document
        Document = "document", "at start speed";
        /// up as many rows as fit, and down again
        Reverse = "reverse", "reverse at the highest row";
    }
    CosineMethod {
        /// each step where the ideal curve crosses its half-integer
        Exact = "exact", "exact";
        /// whole steps in slices of time, as in the document, with its time error
        Sliced = "sliced", "in slices";
    }
    RampShape {
        /// 1/(1 + e^-x), shifted and stretched so that it begins at rest and ends at top speed
        Sigmoid = "sigmoid", "sigmoid";
        /// 3x^2 - 2x^3
        Bezier = "bezier", "Bezier";
        /// uniform acceleration
        Straight = "straight", "straight";
        /// 1 - e^-x over the time constants
        Exponential = "exponential", "exponential";
    }
    PointUnit {
        /// steps
        Steps = "steps", "steps";
        /// millimetres
        Millimetres = "mm", "mm";
        /// degrees
        Degrees = "deg", "°";
    }
    Interpolation {
        /// from point to point
        Straight = "straight", "straight";
        /// from rest to rest
        Smooth = "smooth", "smooth";
    }
}
