//! So many steps in so much time: what each shape of the ramps costs (DESIGN B4, "so that a user can compare
//! them side by side").
//!
//! ```text
//! the same n, t_i, t_s ->  cosine exact | cosine sliced | sigmoid | Bezier | straight | exponential
//!                          peak rate, acceleration, jerk, jumps; time error; time of the last step
//! ```
//!
//! The peaks are those of the axis: a move from rest to rest, with what it jumps by at its start and end.
//!
//! ```
//! use stepscope_inspect::ramp_costs::{RampRequest, compare};
//!
//! // The same way in the same time, with ramps of every shape.
//! let rows = compare(&RampRequest::new(3200, 0.4, 0.1));
//! let accelerations = rows.iter().filter_map(|row| row.cost.as_ref().ok()).map(|cost| cost.peaks.acceleration);
//! assert!(accelerations.into_iter().all(|acceleration| acceleration >= 0.0));
//! assert!(rows.len() > 4);
//! ```

use alloc::{vec, vec::Vec};
use stepscope_motion::Problem;
use stepscope_motion::{
    Curve, Peaks,
    mechanics::Distance,
    moves::{Axis, Cosine, CosineMethod, Move, RampShape, Ramps},
    plan_axis,
};

/// What is compared: n steps in t_i with ramps of t_s, and what only some of the shapes need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RampRequest {
    /// Steps, left negative.
    pub steps: i64,
    /// t_i in s.
    pub duration_s: f64,
    /// t_s in s.
    pub ramp_s: f64,
    /// Slice of the sliced cosine in s.
    pub slice_s: f64,
    /// Range of the sigmoid.
    pub sigmoid_range: f64,
    /// Time constants of the exponential.
    pub time_constants: f64,
}

impl RampRequest {
    /// So many steps in so much time, all else as a scenario has it by default.
    #[must_use]
    pub fn new(steps: i64, duration_s: f64, ramp_s: f64) -> Self {
        let (Cosine { slice_s, .. }, Ramps { sigmoid_range, time_constants, .. }) =
            (Cosine::default(), Ramps::default());
        Self { steps, duration_s, ramp_s, slice_s, sigmoid_range, time_constants }
    }

    /// The move of a candidate, as a scenario asks for it.
    #[must_use]
    pub fn ask(&self, candidate: Candidate) -> Move {
        let Self { duration_s, ramp_s, slice_s, sigmoid_range, time_constants, .. } = *self;
        let distance = Distance::Steps(self.steps as f64);
        let cosine =
            |method| Move::Cosine(Cosine { distance: distance.clone(), duration_s, ramp_s, method, slice_s });
        match candidate {
            Candidate::CosineExact => cosine(CosineMethod::Exact),
            Candidate::CosineSliced => cosine(CosineMethod::Sliced),
            Candidate::Ramps(shape) => {
                Move::Ramps(Ramps { distance, duration_s, ramp_s, shape, sigmoid_range, time_constants })
            }
        }
    }
}

/// Who takes part in the comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Candidate {
    /// The cosine S-curve, every step in its place.
    CosineExact,
    /// The cosine S-curve in slices, as the document runs it.
    CosineSliced,
    /// Ramps of another shape.
    Ramps(RampShape),
}

/// All that take part, in the order of the rows.
pub const CANDIDATES: [Candidate; 6] = [
    Candidate::CosineExact,
    Candidate::CosineSliced,
    Candidate::Ramps(RampShape::Sigmoid),
    Candidate::Ramps(RampShape::Bezier),
    Candidate::Ramps(RampShape::Straight),
    Candidate::Ramps(RampShape::Exponential),
];

/// What a candidate costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// The greatest values of the axis, in steps and s.
    pub peaks: Peaks,
    /// End of the move less t_i, in s; negative is early. Only slices have one.
    pub time_error_s: f64,
    /// The same in parts of t_i.
    pub time_error: f64,
    /// When the last step falls due, in s, not rounded to a clock.
    pub last_step_s: f64,
}

/// A row of the comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Who.
    pub candidate: Candidate,
    /// What it costs, or why it cannot be; paths begin with `comparison.moves[0]`.
    pub cost: Result<Cost, Vec<Problem>>,
}

/// A row for each of [`CANDIDATES`], in their order.
///
/// Each is planned as a scenario's move, with its ranges; one that cannot be says why in its row.
#[must_use]
pub fn compare(request: &RampRequest) -> Vec<Row> {
    CANDIDATES.iter().map(|&candidate| Row { candidate, cost: cost(request, candidate) }).collect()
}

fn cost(request: &RampRequest, candidate: Candidate) -> Result<Cost, Vec<Problem>> {
    let axis = Axis { moves: vec![request.ask(candidate)], ..Axis::default() };
    let plan = plan_axis(&axis, "comparison")?;
    let last = request.steps.unsigned_abs() as f64 - 0.5;
    let last_step_s = plan.moves().first().map_or(0.0, |planned| planned.profile.time_s(last));
    let time_error_s = plan.duration_s() - request.duration_s;
    let time_error = time_error_s / request.duration_s;
    Ok(Cost { peaks: plan.peaks(), time_error_s, time_error, last_step_s })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn costs(request: &RampRequest) -> Vec<Cost> {
        compare(request).into_iter().map(|row| row.cost.unwrap()).collect()
    }

    /// 6400 steps in 0.4 s with ramps of 0.1 s: f_max = 64000/3 but for slices and the exponential, whose area
    /// is 1/(1 - e^-4) - 1/4; the numbers of f_max/t_s and f_max/t_s^2 by a calculator.
    #[test]
    fn the_documents_move_costs_what_a_calculator_says() {
        let rows = [
            // rate, acceleration, jerk, jump of acceleration
            [21_333.333_333_333, 335_103.216_382_91, 10_527_578.027_829, 0.0],
            [22_000.0, 0.0, 0.0, 0.0],
            [21_333.333_333_333, 643_180.686_920_76, 29_707_243.418_502, 6_345.644_561_253_6],
            [21_333.333_333_333, 320_000.0, 12_800_000.0, 0.0],
            [21_333.333_333_333, 213_333.333_333_33, 0.0, 213_333.333_333_33],
            [18_092.820_416_85, 737_215.387_494_53, 29_488_615.499_781, 737_215.387_494_53],
        ];
        let found = costs(&RampRequest::new(6400, 0.4, 0.1));
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
        let found = costs(&RampRequest::new(-6400, 0.4, 0.2));
        assert!((found[4].last_step_s - 0.3975).abs() < 1e-12, "{found:?}");
        // A gentler end has its last step sooner, a steeper one later.
        let last = |index: usize| found[index].last_step_s;
        let by_their_last: Vec<f64> = [1, 2, 0, 3, 4, 5].map(last).to_vec();
        assert!(by_their_last.is_sorted_by(|a, b| a < b), "{found:?}");
    }

    #[test]
    fn one_that_cannot_be_says_so_in_its_row() {
        let rows = compare(&RampRequest::new(100, 0.4, 0.2));
        let wrong: Vec<_> = rows.iter().filter(|row| row.cost.is_err()).map(|row| row.candidate).collect();
        assert_eq!(wrong, [Candidate::CosineSliced]);
        let rows = compare(&RampRequest { sigmoid_range: 0.0, ..RampRequest::new(6400, 0.4, 0.2) });
        let wrong: Vec<_> = rows.iter().filter(|row| row.cost.is_err()).map(|row| row.candidate).collect();
        assert_eq!(wrong, [Candidate::Ramps(RampShape::Sigmoid)]);
        assert!(compare(&RampRequest::new(0, 0.4, 0.3)).iter().all(|row| row.cost.is_err()));
    }
}
