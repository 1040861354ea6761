//! Prints the register map with the values after reset.
//!
//! `cargo run -p stepscope-core --example registers`

use stepscope_core::{
    peripheral::{
        config::{Bus, Config, ConfigProblem, SerialLine},
        device::ModelBus,
        trace::Digest,
        units::Cycles,
    },
    registers::{MAP, RegisterBus, id, table::Reset},
};

fn main() -> Result<(), Vec<ConfigProblem>> {
    let config = Config::new(16_000_000, &Bus::default(), &SerialLine::default())?;
    let mut bus = ModelBus::new(&config, Cycles(1), Digest::default());
    for register in MAP {
        let value = bus.read(register.offset);
        if let Reset::Fixed(expected) = register.reset {
            assert_eq!(value, expected, "{}", register.name);
        }
        println!("{:#05x} {:12} {:3} {value:#010x}", register.offset, register.name, register.access.name());
        for field in register.fields {
            println!("      {:>2}..={:<2} {} = {}", field.low, field.high, field.name, field.extract(value));
        }
    }
    assert_eq!(bus.read(id::OFFSET).to_be_bytes(), *b"STEP");
    Ok(())
}
