//! Validated controllers.

use crate::parameters::{Parameters, Setup};
use crate::refusal::Warned;
use alloc::{sync::Arc, vec::Vec};
use stepscope_peripheral::segment::PulseTimes;

/// Validated controllers, the result of [`Setup::check`]. Cheap to clone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CheckedSetup {
    clock_hz: u32,
    channels: u8,
    pulse: PulseTimes,
    controllers: Arc<[Arc<Parameters>]>,
    warned: Arc<[Warned]>,
}

impl CheckedSetup {
    pub(crate) fn new(setup: Setup, warned: Vec<Warned>) -> Self {
        let Setup { clock_hz, channels, pulse, controllers } = setup;
        let controllers = controllers.into_iter().map(Arc::new).collect();
        Self { clock_hz, channels, pulse, controllers, warned: warned.into() }
    }

    /// A copy of the parameters, to change and validate again.
    pub fn setup(&self) -> Setup {
        let Self { clock_hz, channels, pulse, .. } = *self;
        let controllers = self.controllers.iter().map(|one| Parameters::clone(one)).collect();
        Setup { clock_hz, channels, pulse, controllers }
    }

    pub const fn clock_hz(&self) -> u32 {
        self.clock_hz
    }

    /// Channels of the bus, 1 to 16.
    pub const fn channels(&self) -> u8 {
        self.channels
    }

    /// Width of a STEP pulse, and setup and hold time of DIR.
    pub const fn pulse(&self) -> PulseTimes {
        self.pulse
    }

    /// The parameters of each controller; the index is the channel.
    pub fn controllers(&self) -> &[Arc<Parameters>] {
        &self.controllers
    }

    /// Valid values that may be unintended.
    pub fn warnings(&self) -> &[Warned] {
        &self.warned
    }
}
