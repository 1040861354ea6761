//! Replays a serial line from a script: bytes at cycles, one of them broken, and the outcome of each packet.
//!
//! `cargo run -p stepscope-core --example line_script`

use stepscope_core::inspect::trace::stored_run::StoredRun;
use stepscope_core::{scenario::Problems, sim::Experiment};

/// Two channels, so two bytes per packet: bit 7 is the direction, the other bits are the steps. A byte takes 1388 cycles
/// at 115200 baud and 16 MHz; the glitch holds the line low during a stop bit of the second packet.
const SCENARIO: &str = r#"{
    "title": "three packets, the second one broken",
    "bus": { "channels": 2 },
    "source": { "line": { "sends": [
        { "start_cycle": 2000, "bytes": "85 03" },
        { "start_cycle": 40000, "bytes": "8a 06" },
        { "start_cycle": 80000, "bytes": "85 83" }
    ] } },
    "line": { "glitches": [ { "start_cycle": 41200, "length_cycles": 400, "level": 0 } ] }
}"#;

fn main() -> Result<(), Problems> {
    let experiment = Experiment::from_json(SCENARIO)?;
    let mut recording = StoredRun::default();
    let run = experiment.run(&mut recording);

    for (index, row) in recording.packets.rows().iter().enumerate() {
        println!("cycle {:6}: {:02x?} {}", row.start.0, recording.packets.bytes(index), row.outcome);
    }
    // The first packet moves 5 right and 3 left, the third 5 and 3 right; the second is dropped.
    assert_eq!(run.positions()[..2], [10, 0]);
    println!("digest {:016x}", recording.digest.value());
    Ok(())
}
