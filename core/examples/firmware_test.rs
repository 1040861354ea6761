//! Tests firmware: the code for the chip runs on the model of the peripheral.
//!
//! `cargo run -p stepscope-core --example firmware_test`

use stepscope_core::{
    peripheral::{
        config::{Bus, Config, ConfigProblem, SerialLine},
        device::ModelBus,
        signal::Record,
        trace::steps,
        units::Cycles,
    },
    registers::{RegisterBus, control, orders, push, result, status, ticks_done},
};

/// The firmware: a ramp of ticks on channel 0, from 1 step in the first to 8 in the eighth. It only uses registers; on a
/// chip `bus` makes volatile accesses.
fn ramp(bus: &mut impl RegisterBus) {
    while status::STATE.extract(bus.read(status::OFFSET)) == status::STATE_BUSY {} // the self-test after reset
    for steps in 1..=8 {
        bus.write(orders::OFFSET, 0x80 | steps); // bit 7: to the right
        bus.write(push::OFFSET, 1);
        assert_eq!(bus.read(result::OFFSET), result::CODE_DONE, "the queue has 16 places");
    }
    while bus.read(ticks_done::OFFSET) < 8 {}
    bus.write(control::OFFSET, control::DISABLE.mask());
}

fn main() -> Result<(), Vec<ConfigProblem>> {
    // Default peripheral: a tick has 100 slots of 320 cycles, 2 ms at 16 MHz.
    let config = Config::new(16_000_000, &Bus::default(), &SerialLine::default())?;
    // The trace is a list of records; an access takes 8 cycles.
    let mut bus = ModelBus::new(&config, Cycles(8), Vec::<Record>::new());
    ramp(&mut bus);
    bus.wait(Cycles(1));

    // The trace has every edge with its cycle.
    assert_eq!(bus.device().positions()[0], 36);
    assert!(
        !bus.sink()
            .last()
            .is_some_and(|last| last.levels.has(stepscope_core::peripheral::signal::Levels::EN))
    );
    let steps = steps(bus.sink(), 0);
    let shortest = steps.windows(2).map(|pair| pair[1].cycle - pair[0].cycle).min();
    println!("{} steps, the closest {} cycles apart", steps.len(), shortest.unwrap_or_default());
    Ok(())
}
