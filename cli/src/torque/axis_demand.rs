//! An axis, or a channel without a plan, with its motor and its demand for torque.

use stepscope_core::inspect::motion::torque::{Demand, Machine};
use stepscope_core::inspect::plant::model_agreement::Agreement;
use stepscope_core::{motion::AxisPlan, peripheral::trace::Step};

pub(crate) struct AxisDemand {
    pub(crate) axis: usize,
    pub(crate) machine: Machine,
    pub(crate) source: MotionSource,
    pub(crate) demand: Demand,
    /// Comparison with the plant, if it was run.
    pub(crate) agreement: Option<Agreement>,
}

pub(crate) enum MotionSource {
    Plan(AxisPlan),
    Steps,
}

impl AxisDemand {
    pub(crate) fn of_steps(channel: u8, machine: Machine, steps: &[Step], clock_hz: u32) -> Self {
        let demand = Demand::of_steps(&machine, steps, clock_hz);
        Self { axis: channel.into(), machine, source: MotionSource::Steps, demand, agreement: None }
    }
}
