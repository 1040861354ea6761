//! Peaks of a whole axis.

use super::{axis, plan_axis};
use stepscope_core::motion::Peaks;

fn peaks(moves: &str) -> Peaks {
    plan_axis(&axis(&format!(r#"{{"moves":[{moves}]}}"#)), "axis").expect("plans").peaks()
}

#[test]
fn an_axis_finds_the_jumps_between_its_moves() {
    let cosine = r#"{"cosine":{"distance":{"steps":6400},"duration_s":0.4,"ramp_s":0.2}}"#;
    let pi = std::f64::consts::PI;
    let smooth = peaks(cosine);
    assert!((smooth.jerk / (32_000.0 * pi * pi / 0.08) - 1.0).abs() < 1e-15, "{smooth:?}");
    // The acceleration starts and ends at 0, except for the rounding of pi.
    assert_eq!((smooth.jump, smooth.acceleration_jump), (0.0, 0.0));
    // The acceleration of 8000 jumps by 8000 in a trapezoid, and by twice that at the tip of a triangle.
    let trapezoid = |steps: u32, way: &str| {
        format!(
            r#"{{"trapezoid":{{"distance":{{"steps":{way}{steps}}},"start_speed":{{"steps_s":1000}},"top_speed":{{"steps_s":5000}},"acceleration":{{"steps_s2":8000}},"method":"exact"}}}}"#
        )
    };
    let jumps = |peaks: Peaks| (peaks.jump, peaks.acceleration_jump, peaks.jerk);
    assert_eq!(jumps(peaks(&trapezoid(10_000, ""))), (1000.0, 8000.0, 0.0));
    assert_eq!(jumps(peaks(&trapezoid(800, ""))), (1000.0, 16_000.0, 0.0));
    // Decelerating to the right and accelerating to the left are the same acceleration.
    let there_and_back = format!("{},{}", trapezoid(10_000, ""), trapezoid(10_000, "-"));
    assert_eq!(jumps(peaks(&there_and_back)), (2000.0, 8000.0, 0.0));
    let constant = r#"{"constant":{"distance":{"steps":100},"speed":{"steps_s":1000}}}"#;
    assert_eq!(jumps(peaks(constant)), (1000.0, 0.0, 0.0));
    assert_eq!(jumps(peaks(r#"{"staircase":{}}"#)).2, 0.0);
    let table = peaks(r#"{"trapezoid":{"distance":{"steps":2000}}}"#);
    assert!(table.acceleration_jump > 9000.0 && table.jerk == 0.0, "{table:?}");
}
