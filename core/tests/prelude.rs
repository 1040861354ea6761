//! The prelude: first differences, and types that are `Send`.

use std::{error::Error, thread};
use stepscope_core::motion::{
    moves::{Axis, Cosine, Move},
    plan_axis,
};
use stepscope_core::prelude::*;
use stepscope_core::sim::{Run, framed_host::Conversation, session::Session};

const fn is_send<T: Send>() {}
const fn is_send_and_sync<T: Send + Sync>() {}

const _: () = {
    is_send::<Experiment>();
    is_send::<Run>();
    is_send::<FinishedRun>();
    is_send::<Device>();
    is_send::<Session>();
    is_send::<Conversation>();
    is_send_and_sync::<Scenario>();
    is_send_and_sync::<Problems>();
    is_send_and_sync::<FinishedRun>();
};

#[test]
fn an_experiment_runs_in_another_thread() {
    let experiment = Experiment::from_json("{}").expect("the default motion");
    let digest = thread::spawn(move || {
        let mut digest = Digest::default();
        experiment.run(&mut digest);
        digest.value()
    });
    let here = run(&Scenario::default()).expect("the default motion");
    assert_eq!(digest.join().expect("no panic"), here.digest());
}

/// Both functions for step times return the same error.
fn steps_of_an_axis(axis: &Axis) -> Result<Vec<ScheduledStep>, Problems> {
    stepscope_core::run(&Scenario::default())?;
    Ok(plan_axis(axis, "axis")?.due_steps(16_000_000).collect())
}

#[test]
fn plan_problems_become_scenario_problems() {
    let due = stepscope_core::step_times(&Scenario::default(), 0).expect("the default motion");
    assert_eq!(steps_of_an_axis(&Axis::default()), Ok(due));
    let cosine = Cosine { duration_s: -1.0, ..Cosine::default() };
    let refused = steps_of_an_axis(&Axis { moves: vec![Move::Cosine(cosine)], ..Axis::default() });
    let problems: stepscope_core::Problems = refused.expect_err("a negative time");
    assert!(
        problems.to_string().starts_with("axis.moves[0].cosine.duration_s: -1 s is out of range"),
        "{problems}"
    );
}

#[test]
fn an_error_has_one_line_per_problem() {
    let scenario: Scenario = r#"{"bus":{"slots":200},"clock_hz":3}"#.parse().expect("it reads");
    let problems = run(&scenario);
    let problems: Box<dyn Error + Send + Sync> = problems.expect_err("two numbers are out of range").into();
    let text = problems.to_string();
    assert_eq!(
        text.lines().map(|line| line.split(':').next()).collect::<Vec<_>>(),
        [Some("clock_hz"), Some("bus.slots")]
    );
    assert_eq!(format!("{problems:?}"), text);
    let read: Result<Scenario, Problems> = r#"{"bus":{"slot":1},"title":5}"#.parse();
    let paths: Vec<String> = read.expect_err("two fields").into_iter().map(|problem| problem.path).collect();
    assert_eq!(paths, ["bus.slot", "title"]);
}

#[test]
fn a_delay_equal_to_the_tolerance_is_within_it() {
    let step = |cycle, right| ScheduledStep { cycle, right };
    let expected = [step(100, true), step(200, true), step(300, false)];
    let rows: [(&[ScheduledStep], u64, Option<usize>); 8] = [
        (&expected, 0, None),
        (&[step(120, true), step(180, true), step(300, false)], 20, None),
        (&[step(120, true), step(179, true), step(300, false)], 20, Some(1)),
        (&[step(121, true), step(200, true), step(300, false)], 20, Some(0)),
        (&[step(100, true), step(200, false), step(300, false)], u64::MAX, Some(1)),
        (&expected[..2], 0, Some(2)),
        (&[], 0, Some(0)),
        (&[step(100, true), step(200, true), step(300, false), step(400, true)], 0, Some(3)),
    ];
    for (found, within, first) in rows {
        assert_eq!(first_difference(&expected, found, Cycles(within)), first, "{found:?} {within}");
        assert_eq!(first_difference(found, &expected, Cycles(within)), first, "{found:?} {within}");
    }
    assert_eq!(first_difference::<u64>(&[], &[], Cycles(0)), None);
}

#[test]
fn first_differences_of_times_steps_and_records() {
    let (zero, one) = ([Instant(7), Instant(9)], [Instant(7), Instant(12)]);
    assert_eq!(first_difference(&zero, &one, Cycles(2)), Some(1));
    assert_eq!(first_difference(&[7, 9], &[7, 12_u64], Cycles(3)), None);
    let step = |cycle, position| Step { cycle, position };
    let (right, back) = ([step(5, 1), step(6, 2)], [step(5, 1), step(6, 0)]);
    assert_eq!(first_difference(&right, &back, Cycles(0)), Some(1));
    assert_eq!(first_difference(&right, &right, Cycles(0)), None);
    let record = |cycle, levels| Record { cycle: Instant(cycle), levels: Levels(levels) };
    assert_eq!(first_difference(&[record(1, 1)], &[record(3, 1)], Cycles(2)), None);
    assert_eq!(first_difference(&[record(1, 1)], &[record(1, 3)], Cycles(2)), Some(0));
}

#[test]
fn a_device_reports_its_levels_and_the_positions_of_its_channels() {
    let bus = stepscope_core::peripheral::config::Bus { channels: 3, ..Default::default() };
    let config = Config::new(16_000_000, &bus, &Default::default()).expect("it is valid");
    let mut device = Device::new(&config);
    assert_eq!((device.levels(), device.positions()), (Levels(0), &[0, 0, 0][..]));
    for _ in 0..3 {
        let levels = device.clock(true, &mut Digest::default());
        assert_eq!(device.levels(), levels);
    }
    assert_eq!(device.levels(), Levels::RESET);
}
