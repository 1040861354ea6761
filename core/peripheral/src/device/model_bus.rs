//! The model on a firmware's bus: what is written against [`RegisterBus`] runs on it unchanged.

use crate::device::Device;
use crate::{
    config::Config,
    signal::{Event, Record, Sink},
    units::{Cycles, Instant},
};
use stepscope_registers::RegisterBus;

/// The peripheral on the bus of a processor, with its serial line at rest.
///
/// Time passes with the accesses, as it does on a chip: each takes so many cycles, and has its effect
/// in the last of them. What happens meanwhile goes to `sink`.
///
/// ```
/// use stepscope_peripheral::{
///     config::{Bus, Config, SerialLine},
///     device::ModelBus,
///     signal::Record,
///     units::Cycles,
/// };
/// use stepscope_registers::{RegisterBus, control, status};
///
/// let config = Config::new(16_000_000, &Bus::default(), &SerialLine::default()).expect("the defaults hold");
/// let mut bus = ModelBus::new(&config, Cycles(8), Vec::<Record>::new());
/// bus.write(control::OFFSET, control::STOP.mask());
/// assert_eq!(status::STATE.of(bus.read(status::OFFSET)), status::STATE_STOPPED);
/// assert_eq!(bus.device().now().0, 16);
/// ```
#[derive(Clone, Debug)]
pub struct ModelBus<S> {
    device: Device,
    access: Cycles,
    sink: S,
}

impl<S: Sink> ModelBus<S> {
    /// A peripheral before cycle 0, on a bus whose accesses take `access` cycles, 1 at least.
    #[must_use]
    pub fn new(config: &Config, access: Cycles, sink: S) -> Self {
        Self { device: Device::new(config), access: access.max(Cycles(1)), sink }
    }

    /// The peripheral.
    #[must_use]
    pub const fn device(&self) -> &Device {
        &self.device
    }

    /// What took the trace.
    #[must_use]
    pub const fn sink(&self) -> &S {
        &self.sink
    }

    /// Time passes: the processor does something else for so many cycles.
    pub fn wait(&mut self, cycles: Cycles) {
        let until = Instant(self.device.now().0.saturating_add(cycles.0));
        self.device.run(true, until, &mut Unpaused(&mut self.sink));
    }
}

impl<S: Sink> RegisterBus for ModelBus<S> {
    fn read(&mut self, offset: u32) -> u32 {
        self.wait(self.access);
        self.device.read(offset)
    }

    fn write(&mut self, offset: u32, value: u32) {
        self.wait(self.access);
        self.device.write(offset, value, &mut self.sink);
    }
}

/// A sink that never asks for a pause: time passes on a bus whatever is done with the trace.
struct Unpaused<'a, S>(&'a mut S);

impl<S: Sink> Sink for Unpaused<'_, S> {
    fn record(&mut self, record: Record) {
        self.0.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.0.event(at, event);
    }
}
