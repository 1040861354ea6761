//! Compares the core with DESIGN Part A edge by edge. For random configurations and line activity, in every mode of the driver
//! bus and at every speed, trace, positions, faults and tick count of the core equal those of the independent model in
//! [`stepscope_tests::oracle`].

use proptest::prelude::*;
use std::sync::Arc;
use stepscope_core::{
    peripheral::{device::Device, signal::Record, trace::Digest, units::Cycles, wire},
    scenario::{Hex, Line, LineScript, Packets, Problems, Scenario, Source},
    sim::{Experiment, Run},
};
use stepscope_tests::{
    cases::{cases, configs, every_mode},
    effort, oracle, translate,
};

/// The same configuration as types of the core.
fn scenario(config: &oracle::Config, forced: &[(u64, u64, bool)], source: Source) -> Scenario {
    Scenario {
        clock_hz: config.clock_hz as u32,
        bus: translate::bus(config),
        line: Line {
            baud: config.baud as u32,
            receiver_baud: Some(config.receiver_baud as u32),
            address: config.address,
            glitches: translate::glitches(forced),
            ..Line::default()
        },
        source,
        ..Scenario::default()
    }
}

fn experiment(
    config: &oracle::Config,
    input: &oracle::Input,
    cycles: Option<u64>,
) -> Result<Experiment, Problems> {
    let sends = translate::sends(&input.sends);
    let mut scenario = scenario(config, &input.forced, Source::Line(LineScript { sends }));
    scenario.run_cycles = cycles;
    Experiment::new(&scenario)
}

/// The core's results as types of the model.
fn outcome(device: &Device, trace: &[Record]) -> oracle::Run {
    oracle::Run {
        trace: trace.iter().map(|record| (record.cycle.0, record.levels.0)).collect(),
        positions: translate::positions(device.positions()),
        faults: device.faults().bits(),
        ticks_done: device.ticks_done(),
        ..oracle::Run::default()
    }
}

fn finished(run: &Run, trace: &[Record]) -> oracle::Run {
    outcome(run.device(), trace)
}

/// Runs from event to event, in slices of about `records` records.
fn in_slices(experiment: &Experiment, records: u64) -> oracle::Run {
    let mut trace: Vec<Record> = Vec::new();
    let mut run = experiment.start();
    while !run.advance(records, &mut trace) {}
    finished(&run, &trace)
}

/// Runs `clock` in every cycle that cannot be skipped.
fn clocked_and_skipped(experiment: &Experiment, scenario_line: wire::Line, cycles: u64) -> oracle::Run {
    let mut trace: Vec<Record> = Vec::new();
    let mut device = Device::new(experiment.config());
    let mut line = scenario_line;
    while device.now().0 < cycles {
        if line.next_change() == device.now() {
            line.change();
        }
        device.clock(line.level(true), &mut trace);
        let to_line = line.next_change().0.min(cycles).saturating_sub(device.now().0);
        let quiet = device.cycles_until_event().map_or(to_line, |quiet| quiet.0.min(to_line));
        device.advance(Cycles(quiet));
    }
    outcome(&device, &trace)
}

/// The core's line for an input, as in an [`Experiment`].
fn line(experiment: &Experiment, config: &oracle::Config, input: &oracle::Input) -> wire::Line {
    let forced: Vec<_> = input
        .forced
        .iter()
        .map(|&(start, length, level)| stepscope_core::peripheral::wire::ForcedLevel {
            start: stepscope_core::peripheral::units::Instant(start),
            end: stepscope_core::peripheral::units::Instant(start + length),
            level,
        })
        .collect();
    wire::Line::new(
        Arc::new(experiment.schedule().clone()),
        &forced,
        config.clock_hz as u32,
        config.baud as u32,
    )
}

/// Compares two results; a message names the first different record.
fn same(speed: &str, core: &oracle::Run, model: &oracle::Run) -> Result<(), TestCaseError> {
    for index in 0..core.trace.len().max(model.trace.len()) {
        let (core, model) = (core.trace.get(index), model.trace.get(index));
        prop_assert!(
            core == model,
            "{speed}: record {index} is {} in the core and {} in the model",
            show(core),
            show(model)
        );
    }
    prop_assert_eq!(core.positions, model.positions, "{}: positions", speed);
    prop_assert_eq!(core.faults, model.faults, "{}: faults", speed);
    prop_assert_eq!(core.ticks_done, model.ticks_done, "{}: ticks done", speed);
    Ok(())
}

fn show(record: Option<&(u64, u64)>) -> String {
    record.map_or("none".into(), |(cycle, levels)| format!("cycle {cycle} levels {levels:#011x}"))
}

proptest! {
    #![proptest_config(effort::cases(2_048))]

    #[test]
    fn runs_match_the_independent_model_at_every_speed((config, input) in cases(every_mode())) {
        let experiment = match experiment(&config, &input, Some(input.cycles)) {
            Ok(experiment) => experiment,
            Err(problems) => {
                prop_assert!(oracle::refused(&config), "the core alone refuses: {problems:?}");
                return Ok(());
            }
        };
        prop_assert!(!oracle::refused(&config), "the core does not refuse");

        let model = oracle::run(&config, &input);
        let mut slow: Vec<Record> = Vec::new();
        let run = experiment.run_clock_by_clock(&mut slow);
        same("clock by clock", &finished(&run, &slow), &model)?;
        let mut fast = (Vec::<Record>::new(), Digest::default());
        let run = experiment.run(&mut fast);
        same("fast", &finished(&run, &fast.0), &model)?;
        prop_assert_eq!(fast.1.value(), Digest::of(&slow));
        same("in slices of one record", &in_slices(&experiment, 1), &model)?;
        same("in slices of seven records", &in_slices(&experiment, 7), &model)?;
        let line = line(&experiment, &config, &input);
        same("clocked and skipped", &clocked_and_skipped(&experiment, line, input.cycles), &model)?;
    }

    #[test]
    fn a_run_without_an_end_stops_after_its_last_change(
        (config, input) in cases(every_mode())
    ) {
        let Ok(experiment) = experiment(&config, &input, None) else { return Ok(()) };
        let mut trace: Vec<Record> = Vec::new();
        let run = experiment.run(&mut trace);
        let fast = finished(&run, &trace);
        let cycles = run.cycles().0;
        let model = oracle::run(&config, &oracle::Input { cycles, ..input.clone() });
        same("to the end", &fast, &model)?;
        let model = oracle::run(&config, &oracle::Input { cycles: cycles + 5_000, ..input });
        same("and beyond it", &fast, &model)?;
    }

    #[test]
    fn the_paced_host_sends_packet_j_at_boot_plus_1_plus_j_ticks(
        config in configs(every_mode()),
        bytes in prop::collection::vec(any::<u8>(), 0..200),
    ) {
        let packet_length = config.channels + usize::from(config.address.is_some());
        let packets: Vec<Vec<u8>> = bytes.chunks_exact(packet_length).map(<[u8]>::to_vec).collect();
        let source = Source::Packets(Packets { packets: packets.iter().cloned().map(Hex).collect() });
        let last = packet_length as u64 - 1;
        let on_the_line = oracle::byte_start(&config, 0, last) + oracle::byte_start(&config, 0, 1);
        match Experiment::new(&scenario(&config, &[], source)) {
            Ok(experiment) => {
                prop_assert!(!oracle::refused(&config) && on_the_line <= config.slots * config.step_period);
                let sends: Vec<_> =
                    experiment.schedule().iter().map(|sent| (sent.start.0, sent.bytes.to_vec())).collect();
                prop_assert_eq!(sends, oracle::packets_schedule(&config, &packets));
            }
            Err(problems) => prop_assert!(
                oracle::refused(&config) || on_the_line > config.slots * config.step_period,
                "the core alone refuses: {problems:?}"
            ),
        }
    }
}
