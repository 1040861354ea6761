//! Small valid scenarios: slow clocks, short ticks, a few packets, so that every cycle can be run.

use proptest::prelude::*;
use stepscope_core::peripheral::wire::schedule::line_time;
use stepscope_core::{
    motion::{
        mechanics::{Acceleration, Distance, Jerk, Speed},
        moves::{
            Axis, Constant, Cosine, Dwell, Interpolation, JerkLimited, Move, Point, PointUnit, Points,
            ShortMove, Sine, SineSegments, Staircase, Trapezoid, TrapezoidMethod,
        },
    },
    peripheral::config::{Bus, DirLine, Distribution, PulsePhasing},
    scenario::{Glitch, Hex, Line, LineScript, Motion, Packets, Scenario, ScriptedSend, Source},
};

/// Scenarios of all three sources, nearly all valid, of some ten thousand cycles.
pub fn small() -> impl Strategy<Value = Scenario> {
    (peripheral(), prop::option::weighted(0.3, 1..20_000_u64), prop::collection::vec(glitch(), 0..4))
        .prop_flat_map(|(peripheral, run_cycles, glitches)| {
            source(&peripheral).prop_map(move |source| {
                let mut scenario = Scenario { source, run_cycles, ..peripheral.clone() };
                scenario.line.glitches = glitches.clone();
                scenario
            })
        })
}

/// A peripheral whose ticks are long enough for a packet.
fn peripheral() -> impl Strategy<Value = Scenario> {
    let line =
        (1_000..200_000_u32, 11..=40_u32, prop::option::weighted(0.3, 930..1_070_u32), any::<Option<u8>>());
    let counts = (prop_oneof![3 => 1..=3_u8, 1 => 1..=16_u8], 1..=12_u8, 1..=4_u8);
    let times = (1..=6_u32, 0..=5_u32, 0..=5_u32, 0..40_u32, 0..40_u32, prop_oneof![Just(0), 0..3_000_u32]);
    (line, counts, times, any::<[bool; 3]>()).prop_map(
        |(
            (clock_hz, bit, off, address),
            (channels, slots, depth),
            (width, setup, hold, spare, settle, boot),
            modes,
        )| {
            let [burst, common, staggered] = modes;
            let baud = clock_hz / bit;
            let address = address.filter(|address| *address < 255);
            let room = width + (setup + hold).max(1);
            let pulses = if staggered { u32::from(channels) } else { 1 + u32::from(common) };
            let packet = line_time(u64::from(channels) + u64::from(address.is_some()), clock_hz, baud);
            let period = (room * pulses).max(packet.div_ceil(slots.into()) as u32);
            Scenario {
                clock_hz,
                bus: Bus {
                    channels,
                    slots,
                    step_period_cycles: period + spare,
                    pulse_width_cycles: width,
                    dir_setup_cycles: setup,
                    dir_hold_cycles: hold,
                    distribution: if burst { Distribution::Burst } else { Distribution::Spread },
                    dir_line: if common { DirLine::Common } else { DirLine::PerChannel },
                    pulse_phasing: if staggered {
                        PulsePhasing::Staggered
                    } else {
                        PulsePhasing::Simultaneous
                    },
                    settle_cycles: room + settle,
                    queue_depth: depth,
                    self_test_cycles: boot,
                },
                line: Line {
                    baud,
                    receiver_baud: off.map(|off| baud * off / 1_000),
                    address,
                    ..Line::default()
                },
                ..Scenario::default()
            }
        },
    )
}

fn glitch() -> impl Strategy<Value = Glitch> {
    (1..12_000_u64, prop_oneof![3 => 1..60_u64, 1 => 1..3_000_u64], 0..=1_u8)
        .prop_map(|(start_cycle, length_cycles, level)| Glitch { start_cycle, length_cycles, level })
}

fn source(peripheral: &Scenario) -> impl Strategy<Value = Source> + use<> {
    let channels = usize::from(peripheral.bus.channels);
    prop_oneof![
        2 => prop::collection::vec(axis(peripheral), 1..=channels.min(3))
            .prop_map(|axes| Source::Motion(Motion { axes, ..Motion::default() })),
        2 => prop::collection::vec(packet(peripheral), 0..10)
            .prop_map(|packets| Source::Packets(Packets { packets })),
        3 => script(peripheral),
    ]
}

/// Bytes that rarely exceed the steps of a tick; on an addressed line mostly for this controller.
fn packet(peripheral: &Scenario) -> impl Strategy<Value = Hex> + use<> {
    let (slots, address) = (peripheral.bus.slots, peripheral.line.address);
    let order = (any::<bool>(), prop_oneof![20 => 0..=slots, 1 => 0..=127_u8]);
    let orders = prop::collection::vec(order, usize::from(peripheral.bus.channels));
    let to = move |other: Option<u8>| address.map(|own| other.unwrap_or(own));
    (prop::option::weighted(0.3, any::<u8>()).prop_map(to), orders).prop_map(|(address, orders)| {
        let orders = orders.into_iter().map(|(right, steps)| u8::from(right) << 7 | steps);
        Hex(address.into_iter().chain(orders).collect())
    })
}

/// Complete or truncated packets and noise, with pauses from none to more than a gap.
fn script(peripheral: &Scenario) -> impl Strategy<Value = Source> + use<> {
    let (clock_hz, baud) = (peripheral.clock_hz, peripheral.line.baud);
    let bytes = prop_oneof![
        6 => packet(peripheral).prop_map(|Hex(bytes)| bytes),
        1 => (packet(peripheral), 0..4_usize).prop_map(|(Hex(bytes), cut)| bytes.into_iter().skip(cut).collect()),
        1 => prop::collection::vec(any::<u8>(), 0..5),
    ];
    let pause = prop_oneof![3 => 0..10_u64, 2 => 0..2_000_u64];
    prop::collection::vec((pause, bytes), 0..10).prop_map(move |sends| {
        let mut free_from = 1;
        let sends = sends.into_iter().map(|(pause, bytes)| {
            let start_cycle = free_from + pause;
            free_from = start_cycle + line_time(bytes.len() as u64, clock_hz, baud);
            ScriptedSend { start_cycle, bytes: Hex(bytes), frame: None }
        });
        Source::Line(LineScript { sends: sends.collect() })
    })
}

/// Up to three moves within the bus's rate, of some ticks each.
fn axis(peripheral: &Scenario) -> impl Strategy<Value = Axis> + use<> {
    let bus = &peripheral.bus;
    let tick_s = f64::from(bus.slots) * f64::from(bus.step_period_cycles) / f64::from(peripheral.clock_hz);
    // The maximum number of steps in a tick is one above the mean rate's.
    let rate = (f64::from(bus.slots) - 0.5).max(0.5) / tick_s * 0.8;
    let steps = prop_oneof![-30..=-1_i32, 1..=30_i32].prop_map(f64::from);
    let (part, speed) = (0.2..1.0_f64, Speed::StepsPerSecond);
    let one = prop_oneof![
        (steps.clone(), part.clone()).prop_map(move |(steps, part)| {
            Move::Constant(Constant { distance: Distance::Steps(steps), speed: speed(rate * part) })
        }),
        (steps.clone(), part.clone(), 0.0..=0.5_f64).prop_map(move |(steps, part, ramp)| {
            // The top speed is steps/(duration - ramp), at most rate.
            let duration_s = steps.abs() / (rate * part * (1.0 - ramp));
            Move::Cosine(Cosine {
                distance: Distance::Steps(steps),
                duration_s,
                ramp_s: duration_s * ramp,
                ..Cosine::default()
            })
        }),
        (steps.clone(), part.clone(), part.clone(), 1.0..50.0_f64, any::<bool>()).prop_map(
            move |(steps, start, top, climb, table)| {
                let method = if table { TrapezoidMethod::Table } else { TrapezoidMethod::Exact };
                Move::Trapezoid(Trapezoid {
                    distance: Distance::Steps(steps),
                    start_speed: Some(speed((rate * start * top).max(1.0))),
                    max_speed: speed((rate * top).max(1.0)),
                    max_acceleration: Acceleration::StepsPerSecond2(climb * rate * rate),
                    method,
                    timer_hz: 1_000_000,
                    ..Trapezoid::default()
                })
            }
        ),
        (steps.clone(), 0.3..1.0_f64, 1..=5_u8, any::<bool>()).prop_map(
            move |(steps, start, level, turns)| {
                let top = rate.max(1.0);
                Move::Staircase(Staircase {
                    distance: Distance::Steps(steps),
                    top_speed: speed(top),
                    level,
                    short_move: if turns { ShortMove::Reverse } else { ShortMove::Document },
                    start_speed: speed((top * start).max(1.0)),
                    max_speed: speed(top),
                })
            }
        ),
        (steps.clone(), 1..3_u32).prop_map(move |(steps, periods)| {
            let (amplitude, period_s) = (Distance::Steps(steps), 8.0 * steps.abs() / rate);
            Move::Sine(Sine { amplitude, period_s, periods })
        }),
        (steps.clone(), part, 0.5..20.0_f64, 0.5..50.0_f64).prop_map(move |(steps, part, climb, jerk)| {
            Move::JerkLimited(JerkLimited {
                distance: Distance::Steps(steps),
                max_speed: speed(rate * part),
                max_acceleration: Acceleration::StepsPerSecond2(climb * rate * rate),
                max_jerk: Jerk::StepsPerSecond3(jerk * climb * rate * rate * rate),
                ..JerkLimited::default()
            })
        }),
        (steps.clone(), steps.clone(), any::<bool>()).prop_map(move |(there, back, smooth)| {
            // A smooth curve is up to twice as fast as a straight one.
            let time_s = |way: f64| 2.5 * way.abs() / rate;
            let points =
                [(0.0, 0.0), (time_s(there), there), (time_s(there) + time_s(back - there).max(0.01), back)];
            let points = points.map(|(time_s, position)| Point { time_s, position }).to_vec();
            let interpolation = if smooth { Interpolation::Smooth } else { Interpolation::Straight };
            Move::Points(Points { unit: PointUnit::Steps, interpolation, points })
        }),
        (steps, 1..3_u32, prop_oneof![Just(0.006), 0.001..1.0_f64]).prop_map(
            move |(steps, periods, max_deviation)| {
                let period_s = 8.0 * steps.abs() / rate;
                let amplitude = Distance::Steps(steps);
                Move::SineSegments(SineSegments { amplitude, period_s, periods, max_deviation })
            }
        ),
        (0.0..4.0_f64).prop_map(move |ticks| Move::Dwell(Dwell { duration_s: ticks * tick_s })),
    ];
    prop::collection::vec(one, 1..=3).prop_map(|moves| Axis { moves, ..Axis::default() })
}
