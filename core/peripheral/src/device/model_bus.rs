//! The model on a firmware's bus: code written for [`RegisterBus`] runs on it unchanged.

use crate::device::Device;
use crate::{
    config::Config,
    signal::{Sink, Unpaused},
    units::{Cycles, Instant},
};
use stepscope_registers::RegisterBus;

/// The peripheral on the bus of a processor, with an idle serial line.
///
/// Time passes with the accesses: each takes some cycles and has its effect in the last of them. The trace goes to
/// `sink`.
///
/// ```
/// use stepscope_peripheral::{config::{Bus, Config, SerialLine}, device::ModelBus, signal::Record, units::Cycles};
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
    /// A peripheral before cycle 0; each access takes `access` cycles, at least 1.
    #[must_use]
    pub fn new(config: &Config, access: Cycles, sink: S) -> Self {
        Self { device: Device::new(config), access: access.max(Cycles(1)), sink }
    }

    #[must_use]
    pub const fn device(&self) -> &Device {
        &self.device
    }

    #[must_use]
    pub const fn sink(&self) -> &S {
        &self.sink
    }

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        config::{Bus, SerialLine},
        signal::{Event, Record},
    };
    use alloc::vec::Vec;
    use stepscope_registers::{orders, push, status, ticks_done};

    /// Pauses at once, and is asked to in vain.
    #[derive(Default)]
    struct Pausing(Vec<Record>, u32);

    impl Sink for Pausing {
        fn record(&mut self, record: Record) {
            self.0.record(record);
        }

        fn event(&mut self, _: Instant, _: Event) {
            self.1 += 1;
        }

        fn paused(&self) -> bool {
            true
        }
    }

    #[test]
    fn time_passes_with_accesses_and_waits_and_with_nothing_else() {
        let bus = Bus { slots: 4, boot_cycles: 0, ..Bus::default() };
        let config = Config::new(16_000_000, &bus, &SerialLine::default()).expect("it holds");
        // Cycles of an access as given, and as they are.
        for (given, access) in [(0, 1), (1, 1), (8, 8)] {
            let mut bus = ModelBus::new(&config, Cycles(given), Pausing::default());
            bus.write(orders::OFFSET, 0x82);
            bus.write(push::OFFSET, 0);
            assert_eq!(bus.device().now(), Instant(2 * access));
            assert_eq!(status::STATE.of(bus.read(status::OFFSET)), status::STATE_MOVING);
            bus.wait(Cycles(1000));
            assert_eq!(bus.device().now(), Instant(3 * access + 1000));
            bus.wait(config.tick());
            assert_eq!(bus.read(ticks_done::OFFSET), 1);
            assert_eq!(bus.device().positions()[0], 2);
            let sink = bus.sink();
            assert_eq!((sink.0.len(), sink.1), (1 + 1 + 4, 3), "reset, DIR, two pulses; pushed, start, end");
        }
    }
}
