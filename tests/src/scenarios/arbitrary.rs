//! Scenarios of the right types with any numbers: most are refused, some are huge.

use super::{grouped, segmented};
use proptest::prelude::*;
use stepscope_core::inspect::trace::drivers::DRIVERS;
use stepscope_core::{
    motion::{
        mechanics::{Acceleration, Direct, Distance, Jerk, Mechanics, Rotary, Screw, Speed, Wheel},
        motor::{Decay, Drive, Motor, Regulator},
        moves::{
            Axis, AxisLimits, Constant, Cosine, CosineMethod, Dwell, Interpolation, JerkLimited, Move, Point,
            PointUnit, Points, RampShape, Ramps, ShortMove, Sine, SineSegments, Staircase, Trapezoid,
            TrapezoidMethod,
        },
    },
    peripheral::config::{Bus, DirLine, Distribution, Protocol, PulsePhasing},
    scenario::{
        Analysis, ChannelSegments, Controller, CurrentSensor, Direction, DriverTiming, DwellSegment, Encoder,
        Glitch, Hex, Host, Line, LineScript, Motion, MotionEngine, Noise, Packets, PlantMotor, PlantSettings,
        Protection, Scenario, ScriptedSend, Segment, SegmentLists, Source, StepSegment, TimingRules,
    },
};

/// Any scenario of this version that JSON can represent, with finite numbers. Its parts are boxed, because a complete
/// scenario does not fit on a test's stack.
pub fn typed() -> BoxedStrategy<Scenario> {
    let texts = (text(), text());
    let analysis =
        (small_or_any(0), small_or_any(40), small_or_any(4096), prop::option::weighted(0.3, number(50.0)));
    let line = (line(), controllers());
    let run = (any::<Option<u64>>(), prop::option::weighted(0.3, driver()));
    (texts, small_or_any(16_000_000), bus(), line, source(), run, analysis)
        .prop_map(
            |(
                (title, note),
                clock_hz,
                bus,
                (line, controllers),
                source,
                (run_cycles, driver),
                (axis, max_harmonic, fft_length, sensor_hz),
            )| {
                Scenario {
                    title,
                    note,
                    clock_hz,
                    bus,
                    line,
                    source,
                    run_cycles,
                    analysis: Analysis { axis, max_harmonic, fft_length, sensor_hz },
                    controllers,
                    driver_timing: driver,
                    ..Scenario::default()
                }
            },
        )
        .prop_flat_map(|scenario| {
            prop::option::weighted(0.2, plant()).prop_map(move |plant| Scenario { plant, ..scenario.clone() })
        })
        .boxed()
}

/// Lists of segments for a plant of any numbers, at most 40 000 cycles long. Numbers that are mostly refused are corrected,
/// so that about a quarter of the scenarios are valid.
pub fn driven() -> BoxedStrategy<Scenario> {
    let factors =
        prop::array::uniform6(prop::sample::select(vec![0.01, 0.1, 0.5, 1.0, 1.0, 2.0, 10.0, 100.0]));
    (segmented(), plant(), factors, (1..40_000_u64, number(24.0)))
        .prop_map(|(mut scenario, mut plant, factors, (run_cycles, supply_v))| {
            plant.current_sensor.poles = plant.current_sensor.poles.clamp(1, 3);
            plant.current_sensor.adc_steps = plant.current_sensor.adc_steps.max(1);
            plant.encoder.seed &= (1 << 53) - 1;
            plant.self_test = false;
            for entry in &mut plant.motors {
                entry.microsteps = entry.microsteps.clamp(1, 512);
                let motor = &mut entry.motor;
                motor.supply_v = supply_v;
                motor.resistance_ohm *= factors[0];
                motor.inductance_mh *= factors[1];
                motor.holding_torque_mn_m *= factors[2];
                motor.rotor_inertia_g_cm2 *= factors[3];
                motor.sine_torque_mn_m *= factors[4];
                motor.friction_mn_m *= factors[5];
            }
            scenario.clock_hz = Scenario::default().clock_hz;
            Scenario { plant: Some(plant), run_cycles: Some(run_cycles), ..scenario }
        })
        .boxed()
}

/// Often the default, otherwise small numbers, the ends of the type, or any number.
pub(super) fn small_or_any<T>(default: T) -> impl Strategy<Value = T> + Clone
where
    T: Arbitrary + Copy + TryFrom<u64> + 'static,
    T::Strategy: Clone,
{
    let number = |value: u64| T::try_from(value).ok();
    let odd = [0, 1, 2, 16, 17, 127, 128, 255, 65_536, 1 << 20, u64::from(u32::MAX), 1 << 53, u64::MAX];
    let odd: Vec<T> = odd.into_iter().filter_map(number).collect();
    prop_oneof![30 => Just(default), 2 => prop::sample::select(odd), 1 => any::<T>()]
}

/// Any finite number, often a round or an extreme one.
pub(super) fn number(default: f64) -> impl Strategy<Value = f64> + Clone {
    let odd = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.1,
        1e-9,
        1e9,
        1e300,
        -1e300,
        f64::MIN_POSITIVE,
        f64::MAX,
        5e-324,
        1e15,
        1e22,
    ];
    prop_oneof![
        30 => Just(default),
        2 => prop::sample::select(odd.to_vec()),
        1 => prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL,
    ]
}

fn text() -> impl Strategy<Value = String> {
    prop_oneof![2 => Just(String::new()), 1 => any::<String>(), 1 => "[ -~]{0,130}"]
}

fn bus() -> BoxedStrategy<Bus> {
    let modes = any::<[bool; 3]>();
    let counts = (small_or_any(1), small_or_any(100), small_or_any(16));
    let times = (small_or_any(320), small_or_any(40), small_or_any(40), small_or_any(0), small_or_any(0));
    (modes, counts, times, small_or_any(1600))
        .prop_map(|([burst, common, staggered], (channels, slots, queue_depth), times, self_test_cycles)| {
            let (step_period_cycles, pulse_width_cycles, dir_setup_cycles, dir_hold_cycles, settle_cycles) =
                times;
            Bus {
                channels,
                slots,
                step_period_cycles,
                pulse_width_cycles,
                dir_setup_cycles,
                dir_hold_cycles,
                distribution: if burst { Distribution::Burst } else { Distribution::Spread },
                dir_line: if common { DirLine::Common } else { DirLine::PerChannel },
                pulse_phasing: if staggered { PulsePhasing::Staggered } else { PulsePhasing::Simultaneous },
                settle_cycles,
                queue_depth,
                self_test_cycles,
            }
        })
        .boxed()
}

fn driver() -> BoxedStrategy<DriverTiming> {
    let models = prop::sample::select(DRIVERS.map(|sheet| sheet.model).to_vec());
    let nanos = || small_or_any(0);
    let rules = (nanos(), nanos(), nanos(), nanos(), nanos()).prop_map(
        |(step_high_ns, step_low_ns, dir_setup_ns, dir_hold_ns, enable_wake_ns)| TimingRules {
            step_high_ns,
            step_low_ns,
            dir_setup_ns,
            dir_hold_ns,
            enable_wake_ns,
        },
    );
    prop_oneof![models.prop_map(DriverTiming::Preset), rules.prop_map(DriverTiming::Rules)].boxed()
}

fn line() -> BoxedStrategy<Line> {
    let glitch = (small_or_any(1), small_or_any(1), small_or_any(0))
        .prop_map(|(start_cycle, length_cycles, level)| Glitch { start_cycle, length_cycles, level });
    let glitches = prop::collection::vec(glitch, 0..4);
    let receiver_baud = prop::option::weighted(0.2, small_or_any(115_200));
    let address = prop::option::weighted(0.2, any::<u8>());
    let protocol = prop_oneof![Just(Protocol::Raw), Just(Protocol::Framed)];
    (small_or_any(115_200), receiver_baud, address, glitches, protocol, host(), noise())
        .prop_map(|(baud, receiver_baud, address, glitches, protocol, host, noise)| Line {
            baud,
            receiver_baud,
            address,
            glitches,
            protocol,
            host,
            noise,
        })
        .boxed()
}

fn host() -> impl Strategy<Value = Host> {
    (small_or_any(8), prop::option::weighted(0.2, any::<u32>()), small_or_any(10)).prop_map(
        |(ticks_per_frame, reply_timeout_cycles, max_attempts)| Host {
            ticks_per_frame,
            reply_timeout_cycles,
            max_attempts,
        },
    )
}

fn noise() -> impl Strategy<Value = Noise> {
    let rate = || small_or_any(0_u32);
    (small_or_any(0), rate(), rate(), rate(), rate(), rate(), rate()).prop_map(
        |(seed, flipped, lost, duplicated, glitches, replies, crashes)| Noise {
            seed,
            flipped_bits_ppm: flipped,
            lost_bytes_ppm: lost,
            duplicated_bytes_ppm: duplicated,
            glitches_ppm: glitches,
            lost_replies_ppm: replies,
            host_crashes_ppm: crashes,
        },
    )
}

fn controllers() -> BoxedStrategy<Vec<Controller>> {
    let hex = prop::collection::vec(any::<u8>(), 0..3).prop_map(Hex);
    let (axes, packets) = (prop::collection::vec(axis(), 0..2), prop::collection::vec(hex, 0..2));
    let receiver_baud = prop::option::weighted(0.2, small_or_any(115_200));
    let controller = (small_or_any(1), receiver_baud, bus(), axes, packets).prop_map(
        |(address, receiver_baud, bus, axes, packets)| Controller {
            address,
            receiver_baud,
            bus,
            axes,
            packets,
        },
    );
    prop_oneof![4 => Just(Vec::new()), 1 => prop::collection::vec(controller, 0..3)].boxed()
}

fn source() -> BoxedStrategy<Source> {
    let hex = prop_oneof![
        3 => prop::collection::vec(any::<u8>(), 1),
        1 => prop::collection::vec(any::<u8>(), 0..40),
    ];
    let hex = hex.prop_map(Hex);
    // Address, kind and body: all kinds and an unknown one, mostly valid.
    let body = prop_oneof![3 => Just(Vec::new()), 1 => prop::collection::vec(any::<u8>(), 0..4)];
    let frame = (prop::sample::select(vec![0, 1, 255]), 1..=8_u8, body)
        .prop_map(|(address, kind, body)| Hex([vec![address, kind], body].concat()));
    let frame = prop_oneof![1 => hex.clone(), 2 => frame];
    let send = (small_or_any(1), hex.clone(), prop::option::weighted(0.2, frame))
        .prop_map(|(start_cycle, bytes, frame)| ScriptedSend { start_cycle, bytes, frame });
    let segment = prop_oneof![
        3 => (small_or_any(1), small_or_any(16_000 << 16), small_or_any(0), any::<bool>()).prop_map(
            |(count, interval_q16, add_q16, right)| {
                let direction = Direction::of_dir(right);
                Segment::Steps(StepSegment { count, interval_q16, add_q16, direction })
            }
        ),
        1 => small_or_any(0).prop_map(|length_q16| Segment::Dwell(DwellSegment { length_q16 })),
    ];
    let list = (small_or_any(1), prop::collection::vec(segment, 0..5))
        .prop_map(|(start_cycle, segments)| ChannelSegments { start_cycle, segments });
    let groups = prop_oneof![3 => Just(Vec::new()), 1 => prop::collection::vec(grouped::group(), 1..3)];
    let engine = prop_oneof![Just(MotionEngine::Ticks), Just(MotionEngine::Segments)];
    prop_oneof![
        4 => (prop::collection::vec(axis(), 0..3), engine, groups)
            .prop_map(|(axes, engine, groups)| Source::Motion(Motion { axes, engine, groups })),
        1 => prop::collection::vec(list, 0..3).prop_map(|channels| Source::Segments(SegmentLists { channels })),
        1 => prop::collection::vec(hex, 0..20).prop_map(|packets| Source::Packets(Packets { packets })),
        1 => prop::collection::vec(send, 0..6).prop_map(|sends| Source::Line(LineScript { sends })),
    ]
    .boxed()
}

fn axis() -> BoxedStrategy<Axis> {
    let shaft = || (number(1.8), small_or_any(16));
    let mechanics = prop_oneof![
        3 => shaft().prop_map(|(full_step_deg, microsteps)| Mechanics::Rotary(Rotary { full_step_deg, microsteps })),
        1 => (shaft(), number(10.0)).prop_map(|((full_step_deg, microsteps), radius_mm)| {
            Mechanics::Wheel(Wheel { full_step_deg, microsteps, radius_mm })
        }),
        1 => (shaft(), number(8.0)).prop_map(|((full_step_deg, microsteps), lead_mm)| {
            Mechanics::Screw(Screw { full_step_deg, microsteps, lead_mm })
        }),
        1 => number(0.01).prop_map(|step_mm| Mechanics::Direct(Direct { step_mm })),
    ];
    let limits = prop_oneof![3 => Just(AxisLimits::default()), 1 => grouped::limits()];
    let shaper = prop::option::weighted(0.2, grouped::shaper());
    let moves = prop::collection::vec(prop_oneof![4 => one_move(), 1 => grouped::continued()], 0..4);
    (mechanics, moves, prop::option::weighted(0.2, motor()), limits, shaper)
        .prop_map(|(mechanics, moves, motor, limits, input_shaper)| Axis {
            mechanics,
            moves,
            motor,
            limits,
            input_shaper,
        })
        .boxed()
}

fn motor() -> BoxedStrategy<Motor> {
    let data = (number(1.5), number(1.6), number(4.3), number(400.0), number(45.0));
    let driven = (
        number(24.0),
        prop::option::of(number(1.5)),
        number(100.0),
        number(50.0),
        prop::option::of(number(1e4)),
    );
    (data, driven)
        .prop_map(|(data, driven)| {
            let (rated_current_a, resistance_ohm, inductance_mh, holding_torque_mn_m, rotor_inertia_g_cm2) =
                data;
            let (supply_v, peak_current_a, load_inertia_g_cm2, load_torque_mn_m, working_rate_hz) = driven;
            Motor {
                rated_current_a,
                resistance_ohm,
                inductance_mh,
                holding_torque_mn_m,
                rotor_inertia_g_cm2,
                supply_v,
                peak_current_a,
                load_inertia_g_cm2,
                load_torque_mn_m,
                working_rate_hz,
                ..Motor::default()
            }
        })
        .prop_flat_map(|motor| prop_oneof![2 => Just(motor.clone()), 1 => in_plant(motor)])
        .boxed()
}

/// Additional parameters of a motor in a plant.
fn in_plant(motor: Motor) -> impl Strategy<Value = Motor> {
    let friction = (number(5.0), prop::option::of(number(8.0)), number(300.0), number(20.0), number(-50.0));
    let load = (number(30.0), number(2.0), number(90.0), prop::option::of(number(20.0)), number(100.0));
    (friction, load, drive()).prop_map(move |(friction, load, drive)| {
        let (friction_mn_m, stiction_mn_m, viscous_un_m_s, detent_torque_mn_m, gravity_torque_mn_m) =
            friction;
        let (sine_torque_mn_m, sine_per_turn, sine_phase_deg, coupling_n_m_rad, coupling_un_m_s) = load;
        Motor {
            friction_mn_m,
            stiction_mn_m,
            viscous_un_m_s,
            detent_torque_mn_m,
            gravity_torque_mn_m,
            sine_torque_mn_m,
            sine_per_turn,
            sine_phase_deg,
            coupling_n_m_rad,
            coupling_un_m_s,
            drive,
            ..motor.clone()
        }
    })
}

fn drive() -> impl Strategy<Value = Drive> {
    let regulator = prop::sample::select(vec![Regulator::Averaged, Regulator::Chopper]);
    let decay = prop::sample::select(vec![Decay::Slow, Decay::Fast, Decay::Mixed, Decay::Auto]);
    let times = (number(0.31), number(20.0), number(1.0));
    (regulator, decay, times, prop::option::of(0_u16..1100), (number(0.5), number(0.7))).prop_map(
        |(regulator, decay, (decay_share, off_us, blank_us), dac_levels, (bridge_ohm, diode_v))| Drive {
            regulator,
            decay,
            decay_share,
            off_us,
            blank_us,
            dac_levels,
            bridge_ohm,
            diode_v,
        },
    )
}

fn plant() -> impl Strategy<Value = PlantSettings> {
    let supply = (number(0.1), prop::option::of(number(470.0)), any::<bool>(), number(10.0), number(0.1));
    let sensor = (number(3000.0), 0_u8..5, 0_u32..9, number(0.02), 0_u32..5000);
    let encoder = (0_u32..2000, number(0.0), number(1.0), number(1.0), 0..1_u64 << 54);
    let protection = prop::option::of((number(2.0), 0_u32..9));
    let motors = prop::collection::vec((number(1.8), 0_u16..600, motor()), 0..3);
    (prop::option::of(0_u32..500), supply, sensor, encoder, (protection, any::<bool>()), motors).prop_map(
        |(step_cycles, supply, sensor, encoder, (protection, self_test), motors)| PlantSettings {
            step_cycles,
            source_ohm: supply.0,
            buffer_uf: supply.1,
            source_sinks: supply.2,
            idle_ma: supply.3,
            tail_s: supply.4,
            current_sensor: CurrentSensor {
                bandwidth_hz: sensor.0,
                poles: sensor.1,
                adc_steps: sensor.2,
                lsb_a: sensor.3,
                adc_max: sensor.4,
            },
            encoder: Encoder {
                period_steps: encoder.0,
                offset_lsb: encoder.1,
                noise_lsb: encoder.2,
                hysteresis_lsb: encoder.3,
                seed: encoder.4,
            },
            protection: protection.map(|(threshold_a, samples)| Protection { threshold_a, samples }),
            self_test,
            motors: motors
                .into_iter()
                .map(|(full_step_deg, microsteps, motor)| PlantMotor { full_step_deg, microsteps, motor })
                .collect(),
        },
    )
}

pub(super) fn distance(steps: f64) -> impl Strategy<Value = Distance> + Clone {
    prop_oneof![
        4 => number(steps).prop_map(Distance::Steps),
        1 => number(1.0).prop_map(Distance::Millimeters),
        1 => number(90.0).prop_map(Distance::Degrees),
    ]
}

pub(super) fn speed(steps_s: f64) -> impl Strategy<Value = Speed> + Clone {
    prop_oneof![
        4 => number(steps_s).prop_map(Speed::StepsPerSecond),
        1 => number(1.0).prop_map(Speed::MillimetersPerSecond),
        1 => number(90.0).prop_map(Speed::DegreesPerSecond),
        1 => number(60.0).prop_map(Speed::TurnsPerMinute),
    ]
}

pub(super) fn acceleration() -> impl Strategy<Value = Acceleration> + Clone {
    prop_oneof![
        4 => number(9000.0).prop_map(Acceleration::StepsPerSecond2),
        1 => number(10.0).prop_map(Acceleration::MillimetersPerSecond2),
        1 => number(90.0).prop_map(Acceleration::DegreesPerSecond2),
    ]
}

fn ramp_shape() -> impl Strategy<Value = RampShape> {
    use RampShape::{Bezier, Exponential, Sigmoid, Straight};
    prop::sample::select(vec![Sigmoid, Bezier, Straight, Exponential])
}

pub(super) fn jerk() -> impl Strategy<Value = Jerk> + Clone {
    prop_oneof![
        4 => number(2e6).prop_map(Jerk::StepsPerSecond3),
        1 => number(1e3).prop_map(Jerk::MillimetersPerSecond3),
        1 => number(1e4).prop_map(Jerk::DegreesPerSecond3),
    ]
}

fn curve() -> impl Strategy<Value = Points> {
    let point = (number(0.0), number(1000.0)).prop_map(|(time_s, position)| Point { time_s, position });
    let unit = prop::sample::select(vec![PointUnit::Steps, PointUnit::Millimeters, PointUnit::Degrees]);
    let interpolation = prop::sample::select(vec![Interpolation::Straight, Interpolation::Smooth]);
    (unit, interpolation, prop::collection::vec(point, 0..6))
        .prop_map(|(unit, interpolation, points)| Points { unit, interpolation, points })
}

pub(super) fn one_move() -> BoxedStrategy<Move> {
    prop_oneof![
        (
            distance(2000.0),
            speed(250.0),
            speed(4000.0),
            acceleration(),
            any::<bool>(),
            small_or_any(1_000_000)
        )
            .prop_map(|(distance, start_speed, top_speed, acceleration, table, timer_hz)| {
                let method = if table { TrapezoidMethod::Table } else { TrapezoidMethod::Exact };
                Move::Trapezoid(Trapezoid {
                    distance,
                    start_speed: Some(start_speed),
                    max_speed: top_speed,
                    max_acceleration: acceleration,
                    method,
                    timer_hz,
                    ..Trapezoid::default()
                })
            }),
        (distance(9000.0), speed(5000.0), small_or_any(3), any::<bool>(), speed(1000.0), speed(20_000.0))
            .prop_map(|(distance, top_speed, level, turns, start_speed, max_speed)| {
                let short_move = if turns { ShortMove::Reverse } else { ShortMove::Document };
                Move::Staircase(Staircase { distance, top_speed, level, short_move, start_speed, max_speed })
            }),
        (distance(3200.0), number(0.4), number(0.2), any::<bool>(), number(0.001)).prop_map(
            |(distance, duration_s, ramp_s, sliced, slice_s)| {
                let method = if sliced { CosineMethod::Sliced } else { CosineMethod::Exact };
                Move::Cosine(Cosine { distance, duration_s, ramp_s, method, slice_s, ..Cosine::default() })
            }
        ),
        (distance(3200.0), number(0.4), number(0.2), ramp_shape(), number(6.0), number(4.0)).prop_map(
            |(distance, duration_s, ramp_s, shape, sigmoid_range, time_constants)| {
                Move::Ramps(Ramps {
                    distance,
                    duration_s,
                    ramp_s,
                    shape,
                    sigmoid_range,
                    time_constants,
                    ..Ramps::default()
                })
            }
        ),
        (distance(1000.0), number(0.5), small_or_any(4), number(0.006)).prop_map(
            |(amplitude, period_s, periods, max_deviation)| {
                Move::SineSegments(SineSegments { amplitude, period_s, periods, max_deviation })
            }
        ),
        (distance(1000.0), number(0.5), small_or_any(4))
            .prop_map(|(amplitude, period_s, periods)| Move::Sine(Sine { amplitude, period_s, periods })),
        (distance(3200.0), speed(10_000.0), acceleration(), jerk()).prop_map(
            |(distance, max_speed, max_acceleration, max_jerk)| {
                Move::JerkLimited(JerkLimited {
                    distance,
                    max_speed,
                    max_acceleration,
                    max_jerk,
                    ..JerkLimited::default()
                })
            }
        ),
        curve().prop_map(Move::Points),
        (distance(1000.0), speed(1000.0))
            .prop_map(|(distance, speed)| Move::Constant(Constant { distance, speed })),
        number(0.1).prop_map(|duration_s| Move::Dwell(Dwell { duration_s })),
    ]
    .boxed()
}
