//! Fault injection: line faults and power cuts.

pub mod fault_sweep;
pub mod power_cut;
