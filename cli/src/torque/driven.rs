//! A motor, and what asks it for torque.

use stepscope_core::{
    inspect::{
        motion::torque::{Demand, Machine},
        plant::model_agreement::Agreement,
    },
    motion::AxisPlan,
    peripheral::trace::Step,
};

/// An axis, or a channel that no plan is known of, with its motor.
pub(crate) struct Driven {
    pub(crate) axis: usize,
    pub(crate) machine: Machine,
    pub(crate) asked: MotionSource,
    pub(crate) demand: Demand,
    /// What the plant says, where it was run.
    pub(crate) agreement: Option<Agreement>,
}

/// What asks for torque.
pub(crate) enum MotionSource {
    /// The plan of an axis.
    Plan(AxisPlan),
    /// Steps without a plan.
    Steps,
}

impl Driven {
    /// A channel by its steps, in cycles of `clock_hz`.
    pub(crate) fn of_steps(channel: u8, machine: Machine, steps: &[Step], clock_hz: u32) -> Self {
        let demand = Demand::of_steps(&machine, steps, clock_hz);
        Self { axis: channel.into(), machine, asked: MotionSource::Steps, demand, agreement: None }
    }
}
