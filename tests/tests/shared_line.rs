//! Several controllers on one line, raw and framed, with noise: all speeds have the same results, a run can be
//! replayed, and on a framed line no tick is wrong, duplicated or out of order.

use proptest::prelude::*;
use stepscope_core::{
    peripheral::{
        config::Protocol,
        signal::{Event, Record},
        wire::{ForcedLevel, schedule::Sent},
    },
    scenario::{Glitch, Hex, LineScript, Noise, Scenario, ScriptedSend, Source},
    sim::{Experiment, Run, framed_host::Progress},
};
use stepscope_tests::{
    effort,
    equivalence::{self, Left, Ways},
    scenarios::shared,
};

/// The commands of the ticks that began.
fn executed(left: &Left, channels: usize) -> Vec<u8> {
    let ticks = left.events.iter().filter_map(|(_, event)| match event {
        Event::TickStart { commands } => Some(commands[..channels].to_vec()),
        _ => None,
    });
    ticks.flatten().collect()
}

/// The same controllers on a line with exactly the bytes and levels of `run`.
fn again(scenario: &Scenario, run: &Run) -> Scenario {
    let mut again = scenario.clone();
    let send = |send: Sent<'_>| ScriptedSend {
        start_cycle: send.start.0,
        bytes: Hex(send.bytes.to_vec()),
        ..ScriptedSend::default()
    };
    let glitch = |forced: &ForcedLevel| Glitch {
        start_cycle: forced.start.0,
        length_cycles: forced.end.0 - forced.start.0,
        level: forced.level.into(),
    };
    again.source = Source::Line(LineScript { sends: run.schedule().iter().map(send).collect() });
    again.line.glitches = run.forced().iter().map(glitch).collect();
    again.line.noise = Noise::default();
    for controller in &mut again.controllers {
        controller.axes.clear();
        controller.packets.clear();
    }
    again.run_cycles = Some(run.cycles().0);
    again
}

/// A run that pauses at its last record, DE's fall after a reply, has ended: the forced level changes nothing.
#[test]
fn a_level_forced_after_the_last_reply_lengthens_no_run() {
    let scenario = Scenario::from_json(
        r#"{ "bus": { "channels": 1 }, "controllers": [{ "address": 2 }],
            "line": { "protocol": "framed",
                "glitches": [{ "start_cycle": 1000000000, "length_cycles": 100, "level": 1 }] },
            "source": { "line": { "sends": [{ "start_cycle": 1602, "bytes": "010604cde0fb3600" }] } } }"#,
    )
    .expect("a scenario");
    let experiment = Experiment::new(&scenario).expect("no problems");
    equivalence::check(&scenario, &experiment, Ways { slices: &[1], hurry: 100, most_clocked: 400_000 });
}

proptest! {
    #![proptest_config(effort::cases(600))]

    #[test]
    fn slices_and_speeds_do_not_change_a_shared_line(scenario in shared(), slice in 1..50_u64) {
        let Ok(experiment) = Experiment::new(&scenario) else { return Ok(()) };
        equivalence::check(&scenario, &experiment, Ways { slices: &[slice], hurry: 100, most_clocked: 400_000 });
    }

    #[test]
    fn replayed_bytes_and_levels_reproduce_every_trace(scenario in shared()) {
        let Ok(experiment) = Experiment::new(&scenario) else { return Ok(()) };
        let mut first: Vec<Vec<Record>> = vec![Vec::new(); experiment.controllers()];
        let run = experiment.run_each(&mut first);
        let again = Experiment::new(&again(&scenario, &run));
        let again = again.map_err(|problems| TestCaseError::fail(format!("{problems:?}")))?;
        let mut second = vec![Vec::new(); experiment.controllers()];
        again.run_each(&mut second);
        prop_assert_eq!(first, second);
    }

    #[test]
    fn a_framed_host_executes_each_tick_once_despite_noise(scenario in shared()) {
        let Ok(experiment) = Experiment::new(&scenario) else { return Ok(()) };
        let waits = scenario.line.protocol == Protocol::Framed && !matches!(scenario.source, Source::Line(_));
        if !waits || scenario.run_cycles.is_some() {
            return Ok(());
        }
        let mut left: Vec<Left> = experiment.configs().map(|_| Left::default()).collect();
        let run = experiment.run_each(&mut left);
        let mut reached = run.host().into_iter().flat_map(|host| host.conversation().progress());
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
