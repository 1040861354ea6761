//! Runs in which something goes wrong: line faults and power cuts.

pub mod fault_sweep;
pub mod power_cut;
