//! Runs one turn, and compares its step times with the output of a step generator.
//!
//! `cargo run -p stepscope-core --example turn`

use stepscope_core::prelude::*;

fn main() -> Result<(), Problems> {
    let scenario: Scenario = include_str!("turn.json").parse()?;
    let due = step_times(&scenario, 0)?; // planned steps of axis 0, in cycles from the start
    let run = run(&scenario)?; // the actual pulses, cycle by cycle
    println!("{} steps, digest {:016x}", due.len(), run.digest());
    assert_eq!(run.positions(), [3200]);
    // Replace the second `due` with the steps of your own generator.
    assert_eq!(first_difference(&due, &due, Cycles(16)), None);
    Ok(())
}
