//! The rules for configurations (DESIGN A4, A7) at their limits, and the values of a valid configuration.

use stepscope_peripheral::{
    config::{
        Bus, Config, ConfigError, ConfigProblem, DirLine, Distribution, Field, Protocol, PulsePhasing,
        SerialLine, max_baud,
    },
    segment::PulseTimes,
    units::{Cycles, Instant},
};

const CLOCK_HZ: u32 = 1_000_000;

/// L = 3 + max(2 + 1, 1) = 6.
const BUS: Bus = Bus {
    channels: 3,
    slots: 4,
    step_period_cycles: 30,
    pulse_width_cycles: 3,
    dir_setup_cycles: 2,
    dir_hold_cycles: 1,
    distribution: Distribution::Burst,
    dir_line: DirLine::PerChannel,
    pulse_phasing: PulsePhasing::Simultaneous,
    settle_cycles: 0,
    queue_depth: 5,
    self_test_cycles: 7,
};

fn line() -> SerialLine {
    SerialLine { baud: 10_000, ..SerialLine::default() }
}

fn fields(clock_hz: u32, bus: &Bus, line: &SerialLine) -> Vec<Field> {
    let problems = Config::new(clock_hz, bus, line).err().unwrap_or_default();
    problems.iter().map(|problem| problem.field).collect()
}

#[test]
fn pulses_may_fill_their_slot_but_not_exceed_it() {
    use {
        DirLine::{Common, PerChannel},
        PulsePhasing::{Simultaneous, Staggered},
    };
    // Mode, minimum slot and settling time.
    let rows = [
        (PerChannel, Simultaneous, 6, 0),
        (Common, Simultaneous, 12, 0),
        (PerChannel, Staggered, 18, 0),
        (Common, Staggered, 18, 6),
    ];
    for (dir_line, pulse_phasing, step_period_cycles, settle_cycles) in rows {
        let bus = Bus { dir_line, pulse_phasing, step_period_cycles, settle_cycles, ..BUS };
        assert_eq!(fields(CLOCK_HZ, &bus, &line()), [], "{bus:?}");
        let short = Bus { step_period_cycles: step_period_cycles - 1, ..bus.clone() };
        assert_eq!(fields(CLOCK_HZ, &short, &line()), [Field::Bus("step_period_cycles")], "{short:?}");
        if settle_cycles > 0 {
            let close = Bus { settle_cycles: settle_cycles - 1, ..bus };
            assert_eq!(fields(CLOCK_HZ, &close, &line()), [Field::Bus("settle_cycles")], "{close:?}");
        }
    }
    // Without set-up and hold times a cycle remains between two pulses: L = W + 1.
    let bare = Bus { dir_setup_cycles: 0, dir_hold_cycles: 0, step_period_cycles: 4, ..BUS };
    assert_eq!(fields(CLOCK_HZ, &bare, &line()), []);
    let problems = Config::new(CLOCK_HZ, &Bus { step_period_cycles: 3, ..bare }, &line()).unwrap_err();
    let error = ConfigError::PulseTooLong {
        width: 3,
        setup: 0,
        hold: 0,
        needed: 4,
        pulses: 1,
        phasing: "all channels at once",
        period: 3,
    };
    assert_eq!(problems, [ConfigProblem { field: Field::Bus("step_period_cycles"), error }]);
    assert_eq!(
        problems[0].to_string(),
        "bus.step_period_cycles: a pulse needs width 3 + max(setup 0 + hold 0, 1) = 4 cycles; a slot of 3 cycles must hold 1 \
         (all channels at once); use a step period of at least 4, or shorter times"
    );
}

#[test]
fn each_number_is_limited_to_its_range() {
    const SECOND: u32 = 1_000_000_000;
    type Row<'a> = (u32, Bus, SerialLine, &'a [Field]);
    // Configuration, refused fields.
    let rows: [Row<'_>; 14] = [
        (CLOCK_HZ, BUS, line(), &[]),
        (CLOCK_HZ, Bus { channels: 16, ..BUS }, line(), &[]),
        (CLOCK_HZ, Bus { channels: 17, ..BUS }, line(), &[Field::Bus("channels")]),
        (CLOCK_HZ, Bus { channels: 0, ..BUS }, line(), &[Field::Bus("channels")]),
        (CLOCK_HZ, Bus { slots: 127, ..BUS }, line(), &[]),
        (CLOCK_HZ, Bus { slots: 128, ..BUS }, line(), &[Field::Bus("slots")]),
        (CLOCK_HZ, Bus { queue_depth: 0, ..BUS }, line(), &[Field::Bus("queue_depth")]),
        (CLOCK_HZ, Bus { step_period_cycles: SECOND, ..BUS }, line(), &[]),
        (
            CLOCK_HZ,
            Bus { step_period_cycles: SECOND + 1, ..BUS },
            line(),
            &[Field::Bus("step_period_cycles")],
        ),
        (CLOCK_HZ, Bus { pulse_width_cycles: 0, ..BUS }, line(), &[Field::Bus("pulse_width_cycles")]),
        (CLOCK_HZ, BUS, SerialLine { address: Some(254), ..line() }, &[]),
        (CLOCK_HZ, BUS, SerialLine { address: Some(255), ..line() }, &[Field::Line("address")]),
        (CLOCK_HZ, BUS, SerialLine { baud: 0, ..line() }, &[Field::Line("baud")]),
        (
            CLOCK_HZ,
            BUS,
            SerialLine { receiver_baud: Some(100_000), ..line() },
            &[Field::Line("receiver_baud")],
        ),
    ];
    for (clock_hz, bus, line, expected) in rows {
        assert_eq!(fields(clock_hz, &bus, &line), expected, "{clock_hz} {bus:?} {line:?}");
    }
}

#[test]
fn a_bit_has_at_least_11_cycles() {
    // Clock, rate, B = floor((2*clock + rate)/(2*rate)), maximum rate of the clock.
    let rows = [
        (105, 10, Some(11), 10),
        (104, 10, None, 9),
        (16_000_000, 115_200, Some(139), 1_523_809),
        (16_000_000, 1_523_809, Some(11), 1_523_809),
        (16_000_000, 1_523_810, None, 1_523_809),
    ];
    for (clock_hz, baud, bit, max) in rows {
        let config = Config::new(clock_hz, &BUS, &SerialLine { baud, ..line() });
        assert_eq!(config.as_ref().ok().map(Config::bit), bit.map(Cycles), "{baud} at {clock_hz}");
        assert_eq!(max_baud(clock_hz), max);
        if let Err(problems) = config {
            let numbers = format!("{baud} baud at {clock_hz} Hz is 10 cycles per bit; the receiver needs 11");
            let text = problems[0].to_string();
            assert!(text.contains(&numbers) && text.contains(&format!("at most {max} baud")), "{text}");
        }
    }
    assert_eq!(Config::bit_of(1000, 300), Cycles(3));
}

#[test]
fn rules_for_slots_and_bit_rates_do_not_apply_to_segments() {
    let tight = Bus { step_period_cycles: 2, ..BUS };
    let silent = SerialLine { baud: 0, ..line() };
    assert!(Config::of_segments(CLOCK_HZ, &tight, &silent).is_ok());
    assert!(Config::of_segments(CLOCK_HZ, &Bus { slots: 0, ..tight }, &silent).is_err());
}

#[test]
fn a_checked_configuration_derives_its_values() {
    // Protocol, address: given, of the controller, in packets; bytes per packet.
    let rows = [
        (Protocol::Raw, None, None, None, 3),
        (Protocol::Raw, Some(9), Some(9), Some(9), 4),
        (Protocol::Framed, None, Some(0), None, 3),
        (Protocol::Framed, Some(9), Some(9), None, 3),
    ];
    for (protocol, given, address, of_packets, len) in rows {
        let serial = SerialLine { protocol, address: given, receiver_baud: Some(9_000), ..line() };
        let config = Config::new(CLOCK_HZ, &BUS, &serial).expect("a valid configuration");
        assert_eq!(
            (config.address(), config.packet_address(), config.packet_len()),
            (address, of_packets, len)
        );
        assert_eq!((config.clock_hz(), config.channels(), config.protocol()), (CLOCK_HZ, 3, protocol));
        assert_eq!((config.slots(), config.tick(), config.boot()), (4, Cycles(120), Instant(7)));
        assert_eq!((config.queue_depth(), config.reply_baud(), config.bit()), (5, 9_000, Cycles(111)));
        assert_eq!(config.bus(), &BUS);
        let times = PulseTimes { width: Cycles(3), setup: Cycles(2), hold: Cycles(1) };
        assert_eq!((PulseTimes::from(&config), PulseTimes::from(&BUS)), (times, times));
    }
}
