//! Compares the cost of each kind of motion for the same steps, time and ramps (DESIGN B3, B4).
//!
//! Other parameters follow from n, t_i and t_s (Zhang 2012); v is the speed of the plateau:
//!
//! ```text
//! trapezoid      v = (n - t_s*v_0)/(t_i - t_s),  a = (v - v_0)/t_s
//! staircase      n + (v - f_1)^2/a = t_i*v, with the a of the level whose ramps are nearest to t_s
//! jerk-limited   v = n/(t_i - t_s), a = 1.5*v/t_s: the acceleration rises, is constant and falls for t_s/3 each
//! points         two points and a smooth curve: 3x^2 - 2x^3
//! constant       v = n/t_i
//! ```
//!
//! Rates of a table or staircase are whole numbers, so these moves end early or late. Peaks include the jumps at start
//! and end.

use crate::motion::torque::{Demand, Machine, Moment};
use alloc::{vec, vec::Vec};
use stepscope_motion::mechanics::{Acceleration, Distance, Jerk, Mechanics, Speed};
use stepscope_motion::moves::{
    Axis, Constant, Cosine, CosineMethod, Interpolation, JerkLimited, Move, Point, PointUnit, Points,
    RampShape, Ramps, Staircase, Trapezoid, TrapezoidMethod,
};
use stepscope_motion::{AxisPlan, Peaks, Problems, Profile, motor::Motor, plan_axis};

/// Acceleration of a staircase's first level in steps/s^2; the others are multiples.
const LEVEL_STEPS_S2: f64 = 1000.0;
const LEVELS: u8 = 5;

/// The move to compare: n steps in t_i with ramps of t_s, and parameters of some kinds.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    pub mechanics: Mechanics,
    pub motor: Option<Motor>,
    pub steps: i64,
    pub duration_s: f64,
    pub ramp_s: f64,
    pub slice_s: f64,
    pub sigmoid_range: f64,
    pub time_constants: f64,
    /// First rate of trapezoid and staircase in steps/s; at most half of the average rate is used.
    pub start_speed: f64,
    pub timer_hz: u32,
}

impl Request {
    /// A request with default values of all other parameters.
    pub fn new(steps: i64, duration_s: f64, ramp_s: f64) -> Self {
        let (Cosine { slice_s, .. }, Ramps { sigmoid_range, time_constants, .. }) =
            (Cosine::default(), Ramps::default());
        let Trapezoid { start_speed, timer_hz, .. } = Trapezoid::default();
        Self {
            mechanics: Mechanics::default(),
            motor: None,
            steps,
            duration_s,
            ramp_s,
            slice_s,
            sigmoid_range,
            time_constants,
            start_speed: start_speed.map_or(0.0, |speed| speed.value()),
            timer_hz,
        }
    }

    /// The request for move `index` of an axis; `None` if it ends where it begins.
    pub fn of(axis: &Axis, plan: &AxisPlan, index: usize, ramp_s: f64) -> Option<Self> {
        let (requested, planned) = (axis.moves.get(index)?, plan.moves().get(index)?);
        // An input shaper makes one curve of all moves.
        if matches!(planned.profile, Profile::Shaped(_)) {
            return None;
        }
        let steps = planned.profile.steps();
        let duration_s = requested.requested_s().unwrap_or_else(|| planned.profile.duration_s());
        let request = Self {
            mechanics: axis.mechanics.clone(),
            motor: axis.motor.clone(),
            ..Self::new(steps, duration_s, ramp_s)
        };
        let speed = |speed: &Speed| speed.in_steps(&axis.mechanics).unwrap_or(request.start_speed);
        let request = match requested {
            Move::Cosine(Cosine { slice_s, .. }) => Self { slice_s: *slice_s, ..request },
            Move::Ramps(Ramps { sigmoid_range, time_constants, .. }) => {
                Self { sigmoid_range: *sigmoid_range, time_constants: *time_constants, ..request }
            }
            Move::Trapezoid(Trapezoid { start_speed, timer_hz, .. }) => {
                let start_speed = start_speed.as_ref().map_or(0.0, speed);
                Self { start_speed, timer_hz: *timer_hz, ..request }
            }
            Move::Staircase(Staircase { start_speed, .. }) => {
                Self { start_speed: speed(start_speed), ..request }
            }
            _ => request,
        };
        (steps != 0).then_some(request)
    }

    /// The move of a candidate with the requested steps, time and ramps.
    pub fn to_move(&self, candidate: Candidate) -> Move {
        let Self { duration_s, ramp_s, slice_s, sigmoid_range, time_constants, timer_hz, .. } = *self;
        let distance = Distance::Steps(self.steps as f64);
        let rate = self.steps.unsigned_abs() as f64 / duration_s;
        let start = libm::fmin(self.start_speed, rate / 2.0);
        match candidate {
            Candidate::Cosine(method) => {
                Move::Cosine(Cosine { distance, duration_s, ramp_s, method, slice_s, ..Cosine::default() })
            }
            Candidate::Ramps(shape) => Move::Ramps(Ramps {
                distance,
                duration_s,
                ramp_s,
                shape,
                sigmoid_range,
                time_constants,
                ..Ramps::default()
            }),
            Candidate::Trapezoid(method) => {
                let top = (rate * duration_s - ramp_s * start) / (duration_s - ramp_s);
                Move::Trapezoid(Trapezoid {
                    distance,
                    start_speed: Some(Speed::StepsPerSecond(start)),
                    max_speed: Speed::StepsPerSecond(top),
                    max_acceleration: Acceleration::StepsPerSecond2((top - start) / ramp_s),
                    method,
                    timer_hz,
                    ..Trapezoid::default()
                })
            }
            Candidate::Staircase => {
                let (level, top) = self.level(rate, start);
                Move::Staircase(Staircase {
                    distance,
                    top_speed: Speed::StepsPerSecond(top),
                    level,
                    start_speed: Speed::StepsPerSecond(start),
                    ..Staircase::default()
                })
            }
            Candidate::JerkLimited => {
                let speed = rate * duration_s / (duration_s - ramp_s);
                let acceleration = 1.5 * speed / ramp_s;
                Move::JerkLimited(JerkLimited {
                    distance,
                    max_speed: Speed::StepsPerSecond(speed),
                    max_acceleration: Acceleration::StepsPerSecond2(acceleration),
                    max_jerk: Jerk::StepsPerSecond3(3.0 * acceleration / ramp_s),
                    ..JerkLimited::default()
                })
            }
            Candidate::Points => Move::Points(Points {
                unit: PointUnit::Steps,
                interpolation: Interpolation::Smooth,
                points: vec![
                    Point { time_s: 0.0, position: 0.0 },
                    Point { time_s: duration_s, position: self.steps as f64 },
                ],
            }),
            Candidate::Constant => Move::Constant(Constant { distance, speed: Speed::StepsPerSecond(rate) }),
        }
    }

    /// Level and top speed of a staircase: ramps nearest to t_s, or else the steepest without a plateau.
    fn level(&self, rate: f64, start: f64) -> (u8, f64) {
        let top = |level: u8| {
            // n + (v - f_1)^2/a = t_i*v as v^2 - 2*half*v + product = 0.
            let acceleration = LEVEL_STEPS_S2 * f64::from(level);
            let half = start + acceleration * self.duration_s / 2.0;
            let product = start * start + acceleration * rate * self.duration_s;
            let root = half * half - product;
            (root >= 0.0).then(|| half - libm::sqrt(root))
        };
        let off = |level: u8, top: f64| {
            libm::fabs((top - start) / (LEVEL_STEPS_S2 * f64::from(level)) - self.ramp_s)
        };
        let possible = (1..=LEVELS).filter_map(|level| Some((level, top(level)?)));
        possible
            .reduce(|best, other| if off(other.0, other.1) < off(best.0, best.1) { other } else { best })
            .unwrap_or((LEVELS, start + LEVEL_STEPS_S2 * f64::from(LEVELS) * self.duration_s / 2.0))
    }
}

/// A kind of motion that is compared with the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Candidate {
    Cosine(CosineMethod),
    Ramps(RampShape),
    Trapezoid(TrapezoidMethod),
    Staircase,
    JerkLimited,
    Points,
    Constant,
}

impl Candidate {
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cosine(CosineMethod::Exact) => "Cosine, exact",
            Self::Cosine(CosineMethod::Sliced) => "Cosine, in slices",
            Self::Ramps(RampShape::Sigmoid) => "Sigmoid",
            Self::Ramps(RampShape::Bezier) => "Bezier",
            Self::Ramps(RampShape::Straight) => "Straight",
            Self::Ramps(RampShape::Exponential) => "Exponential",
            Self::Trapezoid(TrapezoidMethod::Table) => "Trapezoid, table",
            Self::Trapezoid(TrapezoidMethod::Exact) => "Trapezoid, exact",
            Self::Staircase => "Staircase",
            Self::JerkLimited => "Jerk-limited",
            Self::Points => "Points, smooth",
            Self::Constant => "Constant speed",
        }
    }
}

pub const CANDIDATES: [Candidate; 12] = [
    Candidate::Cosine(CosineMethod::Exact),
    Candidate::Cosine(CosineMethod::Sliced),
    Candidate::Ramps(RampShape::Sigmoid),
    Candidate::Ramps(RampShape::Bezier),
    Candidate::Ramps(RampShape::Straight),
    Candidate::Ramps(RampShape::Exponential),
    Candidate::Trapezoid(TrapezoidMethod::Table),
    Candidate::Trapezoid(TrapezoidMethod::Exact),
    Candidate::Staircase,
    Candidate::JerkLimited,
    Candidate::Points,
    Candidate::Constant,
];

/// What a candidate costs. Peaks are in steps and s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    pub peaks: Peaks,
    /// End of the move less t_i, in s; negative is early.
    pub time_error_s: f64,
    pub time_error: f64,
    /// Time of the last step in s, not rounded to a clock.
    pub last_step_s: f64,
    pub torque: Option<Torque>,
}

/// Whether the motor has enough torque for a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torque {
    /// Whether torque and rate suffice; jumps of speed are not checked.
    pub is_met: bool,
    pub min_margin: Option<Moment>,
}

/// One kind of motion with its cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub candidate: Candidate,
    pub requested_move: Move,
    pub plan: Option<AxisPlan>,
    /// The cost, or the problems, with paths from `comparison.moves[0]`.
    pub cost: Result<Cost, Problems>,
}

/// One row for each of [`CANDIDATES`]. Each is planned as a scenario's move, within its ranges.
pub fn compare(request: &Request) -> Vec<Row> {
    CANDIDATES.iter().map(|&candidate| row(request, candidate)).collect()
}

fn row(request: &Request, candidate: Candidate) -> Row {
    let requested_move = request.to_move(candidate);
    let Request { mechanics, motor, duration_s, .. } = request;
    let axis = Axis {
        mechanics: mechanics.clone(),
        moves: vec![requested_move.clone()],
        motor: motor.clone(),
        ..Axis::default()
    };
    let plan = match plan_axis(&axis, "comparison") {
        Ok(plan) => plan,
        Err(problems) => return Row { candidate, requested_move, plan: None, cost: Err(problems) },
    };
    let last = request.steps.unsigned_abs() as f64 - 0.5;
    let last_step_s = plan.moves().first().map_or(0.0, |planned| planned.profile.time_s(last));
    let time_error_s = plan.duration_s() - duration_s;
    let torque = Machine::of(&axis).map(|machine| {
        let demand = Demand::of(&machine, &plan);
        Torque { is_met: demand.is_met(), min_margin: demand.min_margin }
    });
    let time_error = time_error_s / duration_s;
    let cost = Cost { peaks: plan.peaks(), time_error_s, time_error, last_step_s, torque };
    Row { candidate, requested_move, plan: Some(plan), cost: Ok(cost) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn costs(request: &Request) -> Vec<Cost> {
        compare(request).into_iter().map(|row| row.cost.unwrap()).collect()
    }

    /// 6400 steps in 0.4 s with ramps of 0.1 s: f_max = 64000/3 but for slices and the exponential, whose area
    /// is 1/(1 - e^-4) - 1/4; the numbers of f_max/t_s and f_max/t_s^2 by a calculator.
    #[test]
    fn costs_equal_those_of_a_calculator() {
        let rows = [
            // rate, acceleration, jerk, jump of acceleration
            [21_333.333_333_333, 335_103.216_382_91, 10_527_578.027_829, 0.0],
            [22_000.0, 0.0, 0.0, 0.0],
            [21_333.333_333_333, 643_180.686_920_76, 29_707_243.418_502, 6_345.644_561_253_6],
            [21_333.333_333_333, 320_000.0, 12_800_000.0, 0.0],
            [21_333.333_333_333, 213_333.333_333_33, 0.0, 213_333.333_333_33],
            [18_092.820_416_85, 737_215.387_494_53, 29_488_615.499_781, 737_215.387_494_53],
        ];
        let found = costs(&Request::new(6400, 0.4, 0.1));
        for (index, (cost, expected)) in found.iter().zip(rows).enumerate() {
            let peaks = cost.peaks;
            let values = [peaks.speed, peaks.acceleration, peaks.jerk, peaks.acceleration_jump];
            for (value, expected) in values.iter().zip(expected) {
                // An acceleration of 0 at the end has the last digits of pi.
                assert!(
                    (value - expected).abs() <= 1e-9 * expected.max(1.0),
                    "row {index}: {value} {expected}"
                );
            }
        }
        // Only slices have a time error: 138 steps at 22000 steps/s.
        let errors: Vec<f64> = found.iter().map(|cost| cost.time_error_s).collect();
        assert!((errors[1] + 138.0 / 22_000.0).abs() < 1e-12, "{errors:?}");
        assert!((found[1].time_error * 0.4 - errors[1]).abs() < 1e-15);
        assert_eq!([errors[0], errors[2], errors[3], errors[4], errors[5]], [0.0; 5]);
    }

    #[test]
    fn the_last_step_is_half_a_step_before_the_end() {
        // Straight ramps of 0.2 s and 6400 steps: half a step lasts sqrt(1/160000) s = 2.5 ms.
        let found = costs(&Request::new(-6400, 0.4, 0.2));
        assert!((found[4].last_step_s - 0.3975).abs() < 1e-12, "{found:?}");
        // A gentler end has its last step sooner, a steeper one later.
        let last = |index: usize| found[index].last_step_s;
        let by_their_last: Vec<f64> = [1, 2, 0, 3, 4, 5].map(last).to_vec();
        assert!(by_their_last.is_sorted_by(|a, b| a < b), "{found:?}");
    }

    #[test]
    fn impossible_candidates_report_their_problems() {
        let rows = compare(&Request::new(100, 0.4, 0.2));
        let wrong: Vec<_> = rows.iter().filter(|row| row.cost.is_err()).map(|row| row.candidate).collect();
        assert_eq!(wrong, [Candidate::Cosine(CosineMethod::Sliced)]);
        let rows = compare(&Request { sigmoid_range: 0.0, ..Request::new(6400, 0.4, 0.2) });
        let wrong: Vec<_> = rows.iter().filter(|row| row.cost.is_err()).map(|row| row.candidate).collect();
        assert_eq!(wrong, [Candidate::Ramps(RampShape::Sigmoid)]);
        // A move without steps is impossible for every kind.
        let rows = compare(&Request::new(0, 0.4, 0.3));
        assert!(rows.iter().all(|row| row.cost.is_err()), "{rows:?}");
    }

    #[test]
    fn all_candidates_have_the_requested_steps_time_and_ramps() {
        let request = Request::new(-6400, 4.0, 1.0);
        let rows = compare(&request);
        for row in &rows {
            let cost =
                row.cost.as_ref().unwrap_or_else(|problems| panic!("{:?}: {problems:?}", row.candidate));
            let plan = row.plan.as_ref().expect("it could be planned");
            assert_eq!(plan.steps(), -6400, "{:?}", row.candidate);
            let whole_rates = [
                Candidate::Cosine(CosineMethod::Sliced),
                Candidate::Trapezoid(TrapezoidMethod::Table),
                Candidate::Staircase,
            ];
            let max = if whole_rates.contains(&row.candidate) { 0.25 } else { 1e-12 };
            assert!(cost.time_error.abs() <= max, "{:?}: {cost:?}", row.candidate);
            assert_eq!(cost.torque, None, "there is no motor");
        }
        let peak = |index: usize| rows[index].cost.as_ref().unwrap().peaks;
        // By a calculator: 6400/3, 1.5 and 4.5 times that, and from 250 steps/s (6400 - 250)/3.
        let jerk_limited = peak(9);
        let found =
            [jerk_limited.speed, jerk_limited.acceleration, jerk_limited.jerk, peak(7).speed, peak(7).jump];
        for (found, expected) in found.into_iter().zip([6400.0 / 3.0, 3200.0, 9600.0, 2050.0, 250.0]) {
            assert!((found - expected).abs() < 1e-6, "{found} is not {expected}");
        }
        assert!((peak(10).speed - 2400.0).abs() < 1e-6 && (peak(11).speed - 1600.0).abs() < 1e-9);
    }

    #[test]
    fn too_little_torque_is_reported() {
        let with = |motor: Motor| compare(&Request { motor: Some(motor), ..Request::new(3200, 0.4, 0.1) });
        let torque =
            |row: &Row| row.cost.as_ref().ok().and_then(|cost| cost.torque).expect("there is a motor");
        assert!(with(Motor::default()).iter().any(|row| row.cost.is_ok() && torque(row).is_met));
        let heavy = with(Motor { load_torque_mn_m: 4000.0, ..Motor::default() });
        for row in heavy.iter().filter(|row| row.cost.is_ok()) {
            let found = torque(row);
            let min = found.min_margin.expect("a move takes time");
            assert!(!found.is_met && min.margin_mn_m() < 0.0, "{:?}: {found:?}", row.candidate);
        }
    }

    #[test]
    fn a_move_of_an_axis_is_compared_with_its_own_numbers() {
        let own = Move::Trapezoid(Trapezoid {
            start_speed: Some(Speed::StepsPerSecond(500.0)),
            ..Trapezoid::default()
        });
        let axis = Axis { moves: vec![own], ..Axis::default() };
        let plan = plan_axis(&axis, "x").expect("it can be planned");
        let request = Request::of(&axis, &plan, 0, 0.05).expect("it goes somewhere");
        assert_eq!(
            (request.steps, request.start_speed, request.duration_s),
            (2000, 500.0, plan.duration_s())
        );
        assert_eq!(Request::of(&axis, &plan, 1, 0.05), None, "there is no second move");
    }
}
