//! A move of about a million steps for every planner, to measure how fast its step times are computed.

use stepscope_core::{
    motion::{AxisPlan, Cause, plan_axis},
    scenario::{Problem, Problems, Scenario, Source, of_motion},
};

/// A planner for one kind of move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Planner {
    /// B2 by the paper's table.
    TrapezoidTable,
    /// B2 by the ideal curve.
    TrapezoidExact,
    /// B3.
    Staircase,
    /// B4.
    Cosine,
    /// B4 by the paper's slices.
    Sliced,
    /// B4 with a sigmoid for a ramp.
    Sigmoid,
    /// B4 with a Bezier curve for a ramp.
    Bezier,
    /// B4 with a straight ramp.
    Straight,
    /// B4 with an exponential for a ramp.
    Exponential,
    /// B5.
    SineSegments,
    /// B6.
    Sine,
    /// B6.
    JerkLimited,
    /// B6, a smooth curve.
    Points,
    /// B6.
    Constant,
}

impl Planner {
    /// All planners.
    pub const ALL: [Self; 14] = [
        Self::TrapezoidTable,
        Self::TrapezoidExact,
        Self::Staircase,
        Self::Cosine,
        Self::Sliced,
        Self::Sigmoid,
        Self::Bezier,
        Self::Straight,
        Self::Exponential,
        Self::SineSegments,
        Self::Sine,
        Self::JerkLimited,
        Self::Points,
        Self::Constant,
    ];

    /// The name of its kernel, and its move.
    const fn row(self) -> (&'static str, &'static str) {
        match self {
            Self::TrapezoidTable => (
                "plan_trapezoid_table",
                r#"{"trapezoid":{"distance":{"steps":1000000},"top_speed":{"steps_s":20000}}}"#,
            ),
            Self::TrapezoidExact => (
                "plan_trapezoid_exact",
                r#"{"trapezoid":{"distance":{"steps":1000000},"top_speed":{"steps_s":20000},"method":"exact"}}"#,
            ),
            Self::Staircase => (
                "plan_staircase",
                r#"{"staircase":{"distance":{"steps":1000000},"top_speed":{"steps_s":20000},"level":5}}"#,
            ),
            Self::Cosine => {
                ("plan_cosine", r#"{"cosine":{"distance":{"steps":1000000},"duration_s":10,"ramp_s":5}}"#)
            }
            Self::Sliced => (
                "plan_cosine_sliced",
                r#"{"cosine":{"distance":{"steps":1000000},"duration_s":10,"ramp_s":5,"method":"sliced"}}"#,
            ),
            Self::Sigmoid => (
                "plan_ramps_sigmoid",
                r#"{"ramps":{"distance":{"steps":1000000},"duration_s":10,"ramp_s":5}}"#,
            ),
            Self::Bezier => (
                "plan_ramps_bezier",
                r#"{"ramps":{"distance":{"steps":1000000},"duration_s":10,"ramp_s":5,"shape":"bezier"}}"#,
            ),
            Self::Straight => (
                "plan_ramps_straight",
                r#"{"ramps":{"distance":{"steps":1000000},"duration_s":10,"ramp_s":5,"shape":"straight"}}"#,
            ),
            Self::Exponential => (
                "plan_ramps_exponential",
                r#"{"ramps":{"distance":{"steps":1000000},"duration_s":10,"ramp_s":5,"shape":"exponential"}}"#,
            ),
            Self::SineSegments => (
                "plan_sine_segments",
                r#"{"sine_segments":{"amplitude":{"steps":1000},"period_s":0.5,"periods":250}}"#,
            ),
            Self::Sine => {
                ("plan_sine", r#"{"sine":{"amplitude":{"steps":1000},"period_s":0.5,"periods":250}}"#)
            }
            Self::JerkLimited => (
                "plan_jerk_limited",
                r#"{"jerk_limited":{"distance":{"steps":1000000},"max_speed":{"steps_s":200000},"max_acceleration":{"steps_s2":200000},"max_jerk":{"steps_s3":1000000}}}"#,
            ),
            Self::Points => {
                ("plan_points", r#"{"points":{"points":[[0,0],[3,250000],[5,600000],[9,1000000]]}}"#)
            }
            Self::Constant => {
                ("plan_constant", r#"{"constant":{"distance":{"steps":1000000},"speed":{"steps_s":100000}}}"#)
            }
        }
    }

    /// The name of its kernel.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().0
    }

    /// What its kernel does.
    #[must_use]
    pub const fn what(self) -> &'static str {
        match self {
            Self::TrapezoidTable => "every step of a trapezoid, by the paper's table",
            Self::TrapezoidExact => "every step of a trapezoid, by the ideal curve",
            Self::Staircase => "every step of a staircase",
            Self::Cosine => "every step of cosine ramps",
            Self::Sliced => "every step of cosine ramps in slices",
            Self::Sigmoid => "every step of sigmoid ramps",
            Self::Bezier => "every step of Bezier ramps",
            Self::Straight => "every step of straight ramps",
            Self::Exponential => "every step of exponential ramps",
            Self::SineSegments => "every step of a sine by segments",
            Self::Sine => "every step of a sine",
            Self::JerkLimited => "every step of a jerk-limited move",
            Self::Points => "every step of a smooth curve through points",
            Self::Constant => "every step at a constant rate",
        }
    }

    /// The plan of its move.
    ///
    /// # Errors
    /// None while the rules of scenarios do not change.
    pub fn plan(self) -> Result<AxisPlan, Problems> {
        let (_, given) = self.row();
        let scenario = format!(r#"{{"source":{{"motion":{{"axes":[{{"moves":[{given}]}}]}}}}}}"#);
        match Scenario::from_json(&scenario)?.source {
            Source::Motion(motion) => motion
                .axes
                .iter()
                .map(|axis| plan_axis(axis, "axis"))
                .collect::<Result<Vec<_>, _>>()
                .map_err(of_motion)?
                .pop(),
            _ => None,
        }
        .ok_or_else(|| Problem::new("axis", Cause::EmptySegment).into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_planner_has_a_million_steps() {
        for planner in Planner::ALL {
            let plan = planner.plan().unwrap();
            assert_eq!(plan.step_count(), 1_000_000, "{planner:?}");
            assert_eq!(plan.due_steps(16_000_000).count(), 1_000_000, "{planner:?}");
        }
    }
}
