//! Valid controllers.
use crate::{
    parameters::{Parameters, Setup},
    refusal::Warned,
};
use alloc::{rc::Rc, vec::Vec};
use stepscope_peripheral::segment::PulseTimes;

/// Valid controllers; cheap to clone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CheckedSetup {
    clock_hz: u32,
    channels: u8,
    pulse: PulseTimes,
    controllers: Rc<[Rc<Parameters>]>,
    warned: Rc<[Warned]>,
}

impl CheckedSetup {
    pub(crate) fn new(setup: Setup, warned: Vec<Warned>) -> Self {
        let Setup { clock_hz, channels, pulse, controllers } = setup;
        let controllers = controllers.into_iter().map(Rc::new).collect();
        Self { clock_hz, channels, pulse, controllers, warned: warned.into() }
    }

    /// The parameters, to be changed and validated again.
    #[must_use]
    pub fn setup(&self) -> Setup {
        let Self { clock_hz, channels, pulse, .. } = *self;
        let controllers = self.controllers.iter().map(|one| Parameters::clone(one)).collect();
        Setup { clock_hz, channels, pulse, controllers }
    }

    #[must_use]
    pub const fn clock_hz(&self) -> u32 {
        self.clock_hz
    }

    #[must_use]
    pub const fn channels(&self) -> u8 {
        self.channels
    }

    #[must_use]
    pub const fn pulse(&self) -> PulseTimes {
        self.pulse
    }

    #[must_use]
    pub fn controllers(&self) -> &[Rc<Parameters>] {
        &self.controllers
    }

    /// Valid parameters that may be unintended.
    #[must_use]
    pub fn warnings(&self) -> &[Warned] {
        &self.warned
    }
}
