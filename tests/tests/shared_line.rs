//! Several controllers on one line, raw and framed, with noise: every speed gives each of them the same run, what was
//! sent can be sent again, and on a framed line no tick is wrong, doubled or out of order.
#![cfg(not(target_arch = "wasm32"))]

use proptest::{prelude::*, test_runner::FileFailurePersistence};
use stepscope_core::{
    run::{Experiment, Run},
    scenario::{Protocol, Source},
    signal::{Event, Record, Sink},
    units::Instant,
    wire::framed_host::Progress,
};
use stepscope_tests::scenarios::shared;

fn cases(cases: u32) -> ProptestConfig {
    let told = ProptestConfig::default();
    ProptestConfig {
        cases: if std::env::var_os("PROPTEST_CASES").is_some() { told.cases } else { cases },
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("regressions"))),
        ..told
    }
}

/// All that one controller leaves.
#[derive(Clone, Default, PartialEq)]
struct Left {
    trace: Vec<Record>,
    events: Vec<(Instant, Event)>,
}

impl Sink for Left {
    fn record(&mut self, record: Record) {
        self.trace.push(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.events.push((at, event));
    }
}

fn same(way: &str, left: &[Left], fast: &[Left], (run, other): (&Run, &Run)) -> Result<(), TestCaseError> {
    for (index, (left, fast)) in left.iter().zip(fast).enumerate() {
        for at in 0..left.trace.len().max(fast.trace.len()) {
            prop_assert_eq!(
                left.trace.get(at),
                fast.trace.get(at),
                "{}: controller {} record {}",
                way,
                index,
                at
            );
        }
        prop_assert_eq!(&left.events, &fast.events, "{}: events of controller {}", way, index);
    }
    for (device, other) in run.devices().zip(other.devices()) {
        prop_assert_eq!(device.positions(), other.positions(), "{}: positions", way);
        prop_assert_eq!(device.faults(), other.faults(), "{}: faults", way);
        prop_assert_eq!(device.ticks_done(), other.ticks_done(), "{}: ticks done", way);
        prop_assert_eq!(device.status(), other.status(), "{}: status", way);
    }
    prop_assert_eq!(run.schedule(), other.schedule(), "{}: what was sent", way);
    prop_assert_eq!(run.cycles(), other.cycles(), "{}: cycles", way);
    Ok(())
}

/// The orders of the ticks that began.
fn executed(left: &Left, channels: usize) -> Vec<u8> {
    let ticks = left.events.iter().filter_map(|(_, event)| match event {
        Event::TickStart { orders } => Some(orders[..channels].to_vec()),
        _ => None,
    });
    ticks.flatten().collect()
}

proptest! {
    #![proptest_config(cases(600))]

    #[test]
    fn every_way_through_a_shared_line_leaves_the_same(scenario in shared(), slice in 1..50_u64) {
        let Ok(experiment) = Experiment::new(&scenario) else { return Ok(()) };
        let none = vec![Left::default(); experiment.controllers()];
        let (mut fast, mut sliced, mut slow) = (none.clone(), none.clone(), none);
        let run = experiment.run_each(&mut fast);
        prop_assert!(run.is_done());
        let mut in_slices = experiment.start();
        while !in_slices.advance_each(slice, &mut sliced) {}
        same("in slices", &sliced, &fast, (&in_slices, &run))?;
        if run.cycles().0 < 400_000 {
            let clocked = experiment.run_each_clock_by_clock(&mut slow);
            same("clock by clock", &slow, &fast, (&clocked, &run))?;
        }
    }

    #[test]
    fn a_framed_host_makes_each_tick_once_and_in_order_whatever_the_noise(scenario in shared()) {
        let Ok(experiment) = Experiment::new(&scenario) else { return Ok(()) };
        let waits = scenario.line.protocol == Protocol::Framed && !matches!(scenario.source, Source::Line(_));
        if !waits || scenario.run_cycles.is_some() {
            return Ok(());
        }
        let mut left = vec![Left::default(); experiment.controllers()];
        let run = experiment.run_each(&mut left);
        let mut reached = run.host().into_iter().flat_map(|host| host.progress());
        for (index, left) in left.iter().enumerate() {
            let ordered = experiment.ticks_of(index);
            let executed = executed(left, experiment.configs().nth(index).map_or(1, |c| c.channels().into()));
            prop_assert!(ordered.starts_with(&executed), "controller {}", index);
            if !ordered.is_empty() && reached.next() == Some(Progress::Done) {
                prop_assert_eq!(ordered, &executed[..], "controller {}", index);
            }
        }
    }
}
