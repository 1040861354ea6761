//! Compares the core with DESIGN Part A edge by edge on shared lines and for segments. For random conversations with framed
//! controllers, several raw controllers, and lists of segments, the core's results at every speed equal those of the
//! independent model in [`stepscope_tests::oracle`].

use proptest::prelude::*;
use stepscope_core::{
    peripheral::{config::Protocol, protocol::State, signal::Record},
    scenario::{
        ChannelSegments, Controller, Direction, DwellSegment, Line, LineScript, Problems, Scenario, Segment,
        SegmentLists, Source, StepSegment,
    },
    sim::{Experiment, Run},
};
use stepscope_tests::{
    cases::{SegmentCase, every_mode, framed_lines, framed_lines_of_one_address, raw_lines, segment_lists},
    effort, oracle, translate,
};

/// The same line as types of the core.
fn experiment(line: &[oracle::Config], input: &oracle::Input) -> Result<Experiment, Problems> {
    let (first, additional) = (&line[0], &line[1..]);
    let controller = |config: &oracle::Config| Controller {
        address: config.address.unwrap_or(0),
        receiver_baud: Some(config.receiver_baud as u32),
        bus: translate::bus(config),
        ..Controller::default()
    };
    Experiment::new(&Scenario {
        clock_hz: first.clock_hz as u32,
        bus: translate::bus(first),
        line: Line {
            baud: first.baud as u32,
            receiver_baud: Some(first.receiver_baud as u32),
            address: first.address,
            protocol: if first.framed { Protocol::Framed } else { Protocol::Raw },
            glitches: translate::glitches(&input.forced),
            ..Line::default()
        },
        source: Source::Line(LineScript { sends: translate::sends(&input.sends) }),
        run_cycles: Some(input.cycles),
        controllers: additional.iter().map(controller).collect(),
        ..Scenario::default()
    })
}

/// The core's results as types of the model, without the status of a raw controller.
fn outcomes(run: &Run, traces: &[Vec<Record>]) -> Vec<oracle::Run> {
    let one = |(device, trace): (&stepscope_core::peripheral::device::Device, &Vec<Record>)| {
        let status = device.status();
        oracle::Run {
            trace: trace.iter().map(|record| (record.cycle.0, record.levels.0)).collect(),
            positions: translate::positions(device.positions()),
            faults: device.faults().bits(),
            ticks_done: device.ticks_done(),
            expected_seq: status.map_or(0, |status| status.expected_seq),
            state: status.map_or(oracle::State::Busy, |status| match status.state {
                State::Busy => oracle::State::Busy,
                State::Ready => oracle::State::Ready,
                State::Moving => oracle::State::Moving,
                State::Stopped => oracle::State::Stopped,
            }),
            free: status.map_or(0, |status| status.free.into()),
        }
    };
    run.devices().zip(traces).map(one).collect()
}

/// Compares the results; a message names the first different record.
fn same(speed: &str, core: &[oracle::Run], model: &[oracle::Run]) -> Result<(), TestCaseError> {
    prop_assert_eq!(core.len(), model.len());
    for (at, (core, model)) in core.iter().zip(model).enumerate() {
        for index in 0..core.trace.len().max(model.trace.len()) {
            let (core, model) = (core.trace.get(index), model.trace.get(index));
            prop_assert!(
                core == model,
                "{speed}: controller {at}: record {index} is {} in the core and {} in the model",
                show(core),
                show(model)
            );
        }
        prop_assert_eq!(core, model, "{}: controller {}", speed, at);
    }
    Ok(())
}

fn show(record: Option<&(u64, u64)>) -> String {
    record.map_or("none".into(), |(cycle, levels)| format!("cycle {cycle} levels {levels:#011x}"))
}

fn compare(line: &[oracle::Config], input: &oracle::Input) -> Result<(), TestCaseError> {
    let experiment = match experiment(line, input) {
        Ok(experiment) => experiment,
        Err(problems) => {
            prop_assert!(line.iter().any(oracle::refused), "the core alone refuses: {problems:?}");
            return Ok(());
        }
    };
    prop_assert!(!line.iter().any(oracle::refused), "the core does not refuse");
    let mut model = oracle::run_line(line, input);
    if !line[0].framed {
        // Raw controllers report nothing.
        for run in &mut model {
            (run.state, run.free) = (oracle::State::Busy, 0);
        }
    }
    let none = || vec![Vec::<Record>::new(); line.len()];
    let mut traces = none();
    let run = experiment.run_each_clock_by_clock(&mut traces);
    same("clock by clock", &outcomes(&run, &traces), &model)?;
    traces = none();
    let run = experiment.run_each(&mut traces);
    same("fast", &outcomes(&run, &traces), &model)?;
    for records in [1, 7] {
        traces = none();
        let mut run = experiment.start();
        while !run.advance_each(records, &mut traces) {}
        same("in slices", &outcomes(&run, &traces), &model)?;
    }
    Ok(())
}

/// The lists as types of the core.
fn segments(case: &SegmentCase) -> Result<Experiment, Problems> {
    let segment = |segment: &oracle::segments::Segment| match *segment {
        oracle::segments::Segment::Steps { steps, interval, add, dir } => Segment::Steps(StepSegment {
            count: steps,
            interval_q16: interval,
            add_q16: add,
            direction: Direction::of_dir(dir),
        }),
        oracle::segments::Segment::Dwell(length_q16) => Segment::Dwell(DwellSegment { length_q16 }),
    };
    let channel = |(start, list): &(u64, Vec<oracle::segments::Segment>)| ChannelSegments {
        start_cycle: *start,
        segments: list.iter().map(segment).collect(),
    };
    Experiment::new(&Scenario {
        clock_hz: case.config.clock_hz as u32,
        bus: translate::bus(&case.config),
        source: Source::Segments(SegmentLists { channels: case.lists.iter().map(channel).collect() }),
        run_cycles: Some(case.cycles),
        ..Scenario::default()
    })
}

proptest! {
    #![proptest_config(effort::cases(400))]

    #[test]
    fn framed_controllers_match_the_model((line, input) in framed_lines(every_mode())) {
        compare(&line, &input)?;
    }

    #[test]
    fn framed_controllers_with_the_same_address_match_the_model(
        (line, input) in framed_lines_of_one_address(every_mode())
    ) {
        // A controller without an address has address 0; additional ones need an explicit address.
        let line: Vec<_> = line
            .into_iter()
            .map(|config| oracle::Config { address: Some(config.address.unwrap_or(0)), ..config })
            .collect();
        compare(&line, &input)?;
    }

    #[test]
    fn raw_controllers_on_one_line_match_the_model((line, input) in raw_lines(every_mode())) {
        compare(&line, &input)?;
    }

    #[test]
    fn segments_match_the_model(case in segment_lists(every_mode())) {
        let model = oracle::segments::run_segments(&case.config, &case.lists, case.cycles);
        let experiment = match segments(&case) {
            Ok(experiment) => experiment,
            Err(problems) => {
                prop_assert!(model.is_err(), "the core alone refuses: {problems:?}");
                return Ok(());
            }
        };
        let model = model.map_err(|refused| TestCaseError::fail(format!("the model alone refuses: {refused:?}")))?;
        type Way = fn(&Experiment, &mut Vec<Record>) -> Run;
        let ways: [(&str, Way); 2] = [
            ("clock by clock", |experiment, trace| experiment.run_clock_by_clock(trace)),
            ("fast", |experiment, trace| experiment.run(trace)),
        ];
        for (speed, go) in ways {
            let mut trace = Vec::new();
            let run = go(&experiment, &mut trace);
            let trace = trace.iter().map(|record| (record.cycle.0, record.levels.0)).collect();
            let core = oracle::Run { trace, positions: run.positions(), ..oracle::Run::default() };
            same(speed, &[core], std::slice::from_ref(&model))?;
        }
    }
}
