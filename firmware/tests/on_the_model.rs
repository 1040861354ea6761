//! Tests the unchanged driver on the model: STEP lines follow its commands.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use stepscope_core::peripheral::{
    config::{Bus, Config, Protocol, SerialLine},
    device::ModelBus,
    signal::{Levels, Record},
    trace::steps,
    units::Cycles,
};
use stepscope_firmware::{ChannelCommand, Driver, Error};
use stepscope_registers::{RegisterBus, faults};

type Model = ModelBus<Vec<Record>>;

/// Ticks of 10 slots of 100 cycles, a queue of 4. In the framed protocol a gap between ticks is an UNDERRUN.
fn bus() -> Bus {
    Bus {
        channels: 3,
        slots: 10,
        step_period_cycles: 100,
        pulse_width_cycles: 20,
        dir_setup_cycles: 10,
        queue_depth: 4,
        self_test_cycles: 500,
        ..Bus::default()
    }
}

/// Cycles per tick.
const TICK: u64 = 1_000;

/// `access`: cycles per bus access.
fn driver(access: u64) -> Driver<Model> {
    let line = SerialLine { protocol: Protocol::Framed, ..SerialLine::default() };
    let config = Config::new(16_000_000, &bus(), &line).expect("a valid configuration");
    let mut driver = Driver::new(ModelBus::new(&config, Cycles(access), Vec::new())).expect("the peripheral");
    driver.wait_for_self_test();
    driver
}

/// A ramp up, plateau and ramp down over 40 ticks.
fn ramp(tick: u8, top: u8) -> u8 {
    tick.min(39 - tick).min(top)
}

/// The last tick has no steps.
fn three_axes() -> impl Iterator<Item = [ChannelCommand; 3]> {
    (0..40).map(|tick| {
        [
            ChannelCommand::right(ramp(tick, 9)),
            ChannelCommand::left(ramp(tick, 4)),
            ChannelCommand::right(tick % 2),
        ]
    })
}

fn positions(driver: &mut Driver<Model>) -> [i32; 3] {
    [0, 1, 2].map(|channel| driver.position(channel))
}

#[test]
fn three_axes_reach_their_positions_without_a_gap() {
    // From one cycle per access to a push that takes half a tick.
    for access in [1, 7, 100] {
        let mut driver = driver(access);
        let mut ticks = three_axes().chain([[ChannelCommand::default(); 3]]);
        while driver.ticks_done() < 41 {
            driver.fill(&mut ticks).expect("valid ticks");
        }
        assert!(driver.is_done().expect("not stopped"));
        let sum = |top| (0..40).map(|tick| i32::from(ramp(tick, top))).sum::<i32>();
        assert_eq!(positions(&mut driver), [sum(9), -sum(4), 20], "{access} cycles per access");
        assert_eq!(driver.faults(), 0, "{access} cycles per access");

        let trace = driver.bus().sink();
        let first = steps(trace, 2)[0].cycle;
        for (index, step) in steps(trace, 2).iter().enumerate() {
            assert_eq!(step.cycle, first + 2 * TICK * index as u64, "one step every second tick");
        }
    }
}

#[test]
fn the_queue_covers_polls_up_to_four_ticks_apart() {
    // The queue covers four ticks between two polls.
    for (pause, has_underrun) in [(2 * TICK, false), (3 * TICK + TICK / 2, false), (5 * TICK, true)] {
        let mut driver = driver(2);
        let mut ticks = three_axes().chain([[ChannelCommand::default(); 3]]);
        while driver.ticks_done() < 41 {
            driver.fill(&mut ticks).expect("valid ticks");
            driver.bus().wait(Cycles(pause));
        }
        let expected = if has_underrun { faults::UNDERRUN.mask() } else { 0 };
        assert_eq!(driver.clear_faults(), expected, "polled every {pause} cycles");
        assert_eq!(driver.faults(), 0);
        assert_eq!(positions(&mut driver)[2], 20);
    }
}

#[test]
fn an_emergency_stop_ends_the_move_within_the_access() {
    let mut driver = driver(4);
    let mut ticks =
        (0..100).map(|_| [ChannelCommand::right(10), ChannelCommand::left(10), ChannelCommand::right(1)]);
    while driver.ticks_done() < 5 {
        driver.fill(&mut ticks).expect("valid ticks");
    }
    driver.stop();
    let stopped_at = driver.bus().device().now().0;
    assert_eq!(driver.is_done(), Err(Error::Stopped));
    assert_eq!(driver.fill(&mut ticks), Err(Error::Stopped));
    driver.bus().wait(Cycles(10 * TICK));
    let positions = positions(&mut driver);
    let trace = driver.bus().sink();
    let last = trace.last().expect("records");
    assert_eq!((last.cycle.0, last.levels.step(), last.levels.has(Levels::EN)), (stopped_at, 0, false));
    for (channel, position) in positions.into_iter().enumerate() {
        let last = steps(trace, channel as u8).last().map(|step| step.position);
        assert_eq!(Some(position), last, "every pulse counts");
    }
    // The remaining ticks are lost; a new move starts here.
    driver.enable().expect("enabled");
    driver.push(&[ChannelCommand::right(3)]).expect("room in the queue");
    while !driver.is_done().expect("not stopped") {}
    assert_eq!(driver.position(0), positions[0] + 3);
    assert_eq!((driver.ticks_done(), driver.clear_faults()), (6, faults::UNDERRUN.mask()));
}

#[test]
fn refused_ticks_are_reported_and_do_not_move_an_axis() {
    let mut driver = driver(1);
    let one = [ChannelCommand::right(1)];
    while driver.push(&one) == Ok(()) {}
    assert_eq!(driver.push(&one), Err(Error::Full));
    assert_eq!(driver.clear_faults(), faults::QUEUE_OVERFLOW.mask());
    assert_eq!(driver.push(&[ChannelCommand::left(11)]), Err(Error::TooManySteps));
    assert_eq!(driver.push(&[ChannelCommand::left(1), ChannelCommand::right(128)]), Err(Error::TooManySteps));
    assert_eq!(
        driver.push(&[ChannelCommand::left(1); 4]),
        Err(Error::TooManySteps),
        "there are three channels"
    );
    assert_eq!(driver.clear_faults(), faults::TOO_MANY_STEPS.mask());
    assert_eq!(driver.disable(), Err(Error::Busy));
    while !driver.is_done().expect("not stopped") {}
    assert_eq!(driver.disable(), Ok(()));
    assert_eq!(driver.push(&one), Err(Error::Stopped));
    // The queue holds four ticks; the first one left it at once, so five ran.
    assert_eq!((driver.ticks_done(), positions(&mut driver)), (5, [5, 0, 0]));
}

#[test]
fn a_driver_checks_the_peripheral_and_waits_for_the_self_test() {
    struct Other(u32);
    impl RegisterBus for Other {
        fn read(&mut self, _: u32) -> u32 {
            self.0
        }
        fn write(&mut self, _: u32, _: u32) {}
    }
    assert_eq!(Driver::new(Other(0xffff_ffff)).err(), Some(Error::NotFound(0xffff_ffff)));
    assert_eq!(Driver::new(Other(0x5354_4550)).err(), Some(Error::UnknownVersion(0x50)));

    let config = Config::new(16_000_000, &bus(), &SerialLine::default()).expect("a valid configuration");
    let mut driver = Driver::new(ModelBus::new(&config, Cycles(10), Vec::new())).expect("the peripheral");
    assert_eq!(driver.push(&[ChannelCommand::right(1)]), Err(Error::Busy));
    driver.wait_for_self_test();
    assert_eq!(driver.push(&[ChannelCommand::right(1)]), Ok(()));
    assert_eq!((driver.channels(), driver.slots()), (3, 10));
}
