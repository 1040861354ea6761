//! The experiments of the kernels.

use stepscope_core::{
    motion::{
        mechanics::{Acceleration, Distance, Speed},
        moves::{Axis, Constant, Cosine, Move, Trapezoid, TrapezoidMethod},
    },
    peripheral::{
        config::{Bus, DirLine, Protocol, PulsePhasing},
        wire::schedule::Sent,
    },
    plant::parameters::{self, CurrentControl, Setup},
    scenario::{
        ChannelSegments, Controller, Hex, Line, LineScript, Motion, PlantSettings, Problems, Scenario,
        ScriptedSend, Segment, SegmentLists, Source, StepSegment,
    },
    sim::Experiment,
};

/// Sixteen channels, 100 slots of 10 us in a tick of 1 ms: at most 100 kHz per channel.
fn sixteen(axes: Vec<Axis>) -> Scenario {
    Scenario {
        bus: Bus {
            channels: 16,
            slots: 100,
            step_period_cycles: 160,
            pulse_width_cycles: 40,
            dir_setup_cycles: 40,
            ..Bus::default()
        },
        line: Line { baud: 1_000_000, ..Line::default() },
        source: Source::Motion(Motion { axes, ..Motion::default() }),
        ..Scenario::default()
    }
}

/// Four channels, 100 slots of 100 us in a tick of 10 ms; all times are whole microseconds at every
/// clock. The line is slow enough for a clock of 1 MHz.
fn four(clock_hz: u32, axes: Vec<Axis>) -> Scenario {
    let micros = clock_hz / 1_000_000;
    Scenario {
        clock_hz,
        bus: Bus {
            channels: 4,
            slots: 100,
            step_period_cycles: 100 * micros,
            pulse_width_cycles: 10 * micros,
            dir_setup_cycles: 10 * micros,
            self_test_cycles: 1000 * micros,
            ..Bus::default()
        },
        line: Line { baud: 50_000, ..Line::default() },
        source: Source::Motion(Motion { axes, ..Motion::default() }),
        ..Scenario::default()
    }
}

fn constant(steps: f64, steps_s: f64) -> Axis {
    let (distance, speed) = (Distance::Steps(steps), Speed::StepsPerSecond(steps_s));
    Axis { moves: vec![Move::Constant(Constant { distance, speed })], ..Axis::default() }
}

/// A move up to 200 000 steps/s with 200 000 steps/s^2, exact to the cycle, for measuring the compression of
/// step times.
pub(crate) fn table_axis(steps: u32) -> Axis {
    let speed = Speed::StepsPerSecond;
    let trapezoid = Trapezoid {
        distance: Distance::Steps(steps.into()),
        start_speed: Some(speed(1.0)),
        max_speed: speed(200_000.0),
        max_acceleration: Acceleration::StepsPerSecond2(200_000.0),
        method: TrapezoidMethod::Exact,
        ..Trapezoid::default()
    };
    Axis { moves: vec![Move::Trapezoid(trapezoid)], ..Axis::default() }
}

/// An S-curve without a plateau and with a peak of `top_speed` steps/s.
fn s_curve(duration_s: f64, top_speed: f64) -> Axis {
    let ramp_s = duration_s / 2.0;
    let distance = Distance::Steps((top_speed * ramp_s).round());
    Axis {
        moves: vec![Move::Cosine(Cosine { distance, duration_s, ramp_s, ..Cosine::default() })],
        ..Axis::default()
    }
}

/// Sixteen channels at 100 kHz each for 10 s: all ticks are the same.
///
/// # Errors
/// None while the rules of scenarios do not change.
pub fn steady() -> Result<Experiment, Problems> {
    Experiment::new(&sixteen(vec![constant(1e6, 1e5); 16]))
}

/// Sixteen S-curves of different lengths, 7 to 10 s: hardly any tick equals the previous one.
///
/// # Errors
/// None while the rules of scenarios do not change.
pub fn varied() -> Result<Experiment, Problems> {
    let axes = (0..16).map(|axis| s_curve(10.0 - 0.2 * f64::from(axis), 95_000.0 - 500.0 * f64::from(axis)));
    Experiment::new(&sixteen(axes.collect()))
}

/// Sixteen channels at 10 kHz each for 10 s in slots of 100 us, which have space for staggered
/// pulses.
fn with_room(bus: Bus) -> Result<Experiment, Problems> {
    let mut scenario = sixteen(vec![constant(1e5, 1e4); 16]);
    let (channels, slots) = (scenario.bus.channels, scenario.bus.slots);
    scenario.bus = Bus {
        channels,
        slots,
        step_period_cycles: 1600,
        pulse_width_cycles: 40,
        dir_setup_cycles: 40,
        ..bus
    };
    Experiment::new(&scenario)
}

/// With one DIR line for all channels.
///
/// # Errors
/// None while the rules of scenarios do not change.
pub fn common_dir() -> Result<Experiment, Problems> {
    with_room(Bus { dir_line: DirLine::Common, ..Bus::default() })
}

/// With staggered pulses.
///
/// # Errors
/// None while the rules of scenarios do not change.
pub fn staggered() -> Result<Experiment, Problems> {
    with_room(Bus { pulse_phasing: PulsePhasing::Staggered, settle_cycles: 100, ..Bus::default() })
}

/// The constant motion over the framed protocol; the line is fast enough for frames and replies.
///
/// # Errors
/// None while the rules of scenarios do not change.
pub fn framed() -> Result<Experiment, Problems> {
    // Ticks of 1.5 ms: the bytes of a tick, with their part of frames and replies, take more than 1 ms.
    let mut scenario = sixteen(vec![constant(1e6, 1e5 * 160.0 / 240.0); 16]);
    scenario.line = Line { baud: 1_400_000, protocol: Protocol::Framed, ..Line::default() };
    scenario.line.host.ticks_per_frame = 32;
    (scenario.bus.queue_depth, scenario.bus.step_period_cycles) = (64, 240);
    Experiment::new(&scenario)
}

/// The constant motion by lists of segments.
///
/// # Errors
/// None while the rules of scenarios do not change.
pub fn segments() -> Result<Experiment, Problems> {
    let steps = StepSegment { count: 1_000_000, interval_q16: 160 << 16, ..StepSegment::default() };
    let list = ChannelSegments { segments: vec![Segment::Steps(steps)], ..ChannelSegments::default() };
    let mut scenario = sixteen(Vec::new());
    scenario.source = Source::Segments(SegmentLists { channels: vec![list; 16] });
    Experiment::new(&scenario)
}

/// Sixteen motors behind such lists, 4000 steps/s each for a tenth of a second: a run with all measures of a plant.
///
/// # Errors
/// None while the rules of scenarios do not change.
pub fn plant_run() -> Result<Experiment, Problems> {
    let steps = StepSegment { count: 400, interval_q16: 4000 << 16, ..StepSegment::default() };
    let list = ChannelSegments { segments: vec![Segment::Steps(steps)], ..ChannelSegments::default() };
    let mut scenario = sixteen(Vec::new());
    scenario.source = Source::Segments(SegmentLists { channels: vec![list; 16] });
    scenario.plant = Some(PlantSettings { tail_s: 0.0, ..PlantSettings::default() });
    Experiment::new(&scenario)
}

/// The plant of sixteen motors, with or without choppers.
#[must_use]
pub fn plant(regulator: CurrentControl) -> Setup {
    let motor = parameters::MotorModel {
        drive: parameters::DriverModel {
            regulator,
            decay: parameters::CurrentDecay::Mixed(0.31),
            ..Default::default()
        },
        ..Default::default()
    };
    Setup { motors: vec![motor; 16], ..Setup::default() }
}

/// The same number of records by lists of segments with different starts: each record has one edge.
///
/// # Errors
/// None while the rules of scenarios do not change.
pub fn segments_apart() -> Result<Experiment, Problems> {
    let steps = StepSegment { count: 62_500, interval_q16: 160 << 16, ..StepSegment::default() };
    let list = |channel: u64| ChannelSegments {
        start_cycle: 1 + 10 * channel,
        segments: vec![Segment::Steps(steps.clone())],
    };
    let mut scenario = sixteen(Vec::new());
    // No multiple of the starts.
    scenario.bus.pulse_width_cycles = 45;
    scenario.source = Source::Segments(SegmentLists { channels: (0..16).map(list).collect() });
    Experiment::new(&scenario)
}

/// 32 controllers of 16 motors on one addressed line, each motor at 10 kHz for 0.5 s.
fn motors() -> Scenario {
    let mut scenario = sixteen(vec![constant(5000.0, 1e4); 16]);
    scenario.bus.step_period_cycles = 1600;
    scenario.line.address = Some(0);
    let controller = |address| Controller {
        address,
        bus: scenario.bus.clone(),
        axes: vec![constant(5000.0, 1e4); 16],
        ..Controller::default()
    };
    scenario.controllers = (1..32).map(controller).collect();
    scenario
}

/// 32 controllers of 16 motors on one addressed line.
///
/// # Errors
/// None, as long as the scenario's rules stay as they are.
pub fn motors_512() -> Result<Experiment, Problems> {
    Experiment::new(&motors())
}

/// The first of them alone, on a line on which the same is sent.
///
/// # Errors
/// None, as long as the scenario's rules stay as they are.
pub fn motors_16() -> Result<Experiment, Problems> {
    let all = motors_512()?;
    let send = |send: Sent<'_>| ScriptedSend {
        start_cycle: send.start.0,
        bytes: Hex(send.bytes.to_vec()),
        ..ScriptedSend::default()
    };
    let sends = all.schedule().iter().map(send).collect();
    let source = Source::Line(LineScript { sends });
    Experiment::new(&Scenario { controllers: Vec::new(), source, ..motors() })
}

/// Four S-curves of some 10 s, the same in time at every clock.
///
/// # Errors
/// None for whole MHz, as long as the scenario's rules stay as they are.
pub fn at_clock(clock_hz: u32) -> Result<Experiment, Problems> {
    let axes = (0..4).map(|axis| s_curve(10.0 - 0.25 * f64::from(axis), 9500.0 - 50.0 * f64::from(axis)));
    Experiment::new(&four(clock_hz, axes.collect()))
}

/// Four channels at 10 kHz each for 0.05 s, short enough to run clock by clock.
///
/// # Errors
/// None, as long as the scenario's rules stay as they are.
pub fn short() -> Result<Experiment, Problems> {
    Experiment::new(&four(16_000_000, vec![constant(500.0, 1e4); 4]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_constant_motion_steps_every_channel_in_every_slot() {
        let experiment = steady().unwrap();
        let ticks: Vec<&[u8]> = experiment.schedule().iter().map(|send| send.bytes).collect();
        assert_eq!(ticks, vec![&[0x80 | 100; 16]; 10_000]);
    }

    #[test]
    fn nearly_every_tick_of_the_varied_motion_differs_from_the_last() {
        let experiment = varied().unwrap();
        let ticks: Vec<&[u8]> = experiment.schedule().iter().map(|send| send.bytes).collect();
        let same = ticks.windows(2).filter(|pair| pair[0] == pair[1]).count();
        assert!(ticks.len() >= 10_000 && same * 20 < ticks.len(), "{same} of {} repeat", ticks.len());
    }

    #[test]
    fn a_motion_has_the_same_packets_at_every_clock() {
        let orders = |clock_hz| {
            let experiment = at_clock(clock_hz).unwrap();
            experiment.schedule().iter().map(|send| send.bytes.to_vec()).collect::<Vec<_>>()
        };
        let expected = orders(16_000_000);
        assert!(orders(1_000_000) == expected && orders(200_000_000) == expected);
    }
}
