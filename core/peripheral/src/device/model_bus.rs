//! The model as a [`RegisterBus`]: firmware runs on it unchanged.

use crate::config::Config;
use crate::device::Device;
use crate::signal::{Sink, Unpaused};
use crate::units::{Cycles, Instant};
use stepscope_registers::RegisterBus;

/// The peripheral on the bus of a processor, with an idle serial line. Time passes with the accesses: each takes some cycles
/// and has its effect in the last of them.
///
/// ```
/// use stepscope_peripheral::{config::{Bus, Config, SerialLine}, device::ModelBus, signal::Record, units::Cycles};
/// use stepscope_registers::{RegisterBus, control, status};
///
/// let config = Config::new(16_000_000, &Bus::default(), &SerialLine::default()).expect("the defaults hold");
/// let mut bus = ModelBus::new(&config, Cycles(8), Vec::<Record>::new());
/// bus.write(control::OFFSET, control::STOP.mask());
/// assert_eq!(status::STATE.extract(bus.read(status::OFFSET)), status::STATE_STOPPED);
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
    pub fn new(config: &Config, access: Cycles, sink: S) -> Self {
        Self { device: Device::new(config), access: access.max(Cycles(1)), sink }
    }

    pub const fn device(&self) -> &Device {
        &self.device
    }

    /// The sink with the trace so far.
    pub const fn sink(&self) -> &S {
        &self.sink
    }

    /// Lets time pass without an access.
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

    /// A sink that always requests a pause, which a bus ignores.
    #[derive(Default)]
    struct Pausing {
        trace: Vec<Record>,
        events: u32,
    }

    impl Sink for Pausing {
        fn record(&mut self, record: Record) {
            self.trace.record(record);
        }

        fn event(&mut self, _: Instant, _: Event) {
            self.events += 1;
        }

        fn is_paused(&self) -> bool {
            true
        }
    }

    #[test]
    fn time_passes_only_with_accesses_and_waits() {
        let bus = Bus { slots: 4, self_test_cycles: 0, ..Bus::default() };
        let config = Config::new(16_000_000, &bus, &SerialLine::default()).expect("it holds");
        // Cycles per access, requested and actual.
        for (requested, access) in [(0, 1), (1, 1), (8, 8)] {
            let mut bus = ModelBus::new(&config, Cycles(requested), Pausing::default());
            bus.write(orders::OFFSET, 0x82);
            bus.write(push::OFFSET, 0);
            assert_eq!(bus.device().now(), Instant(2 * access));
            assert_eq!(status::STATE.extract(bus.read(status::OFFSET)), status::STATE_MOVING);
            bus.wait(Cycles(1000));
            assert_eq!(bus.device().now(), Instant(3 * access + 1000));
            bus.wait(config.tick());
            assert_eq!(bus.read(ticks_done::OFFSET), 1);
            assert_eq!(bus.device().positions()[0], 2);
            let sink = bus.sink();
            assert_eq!(sink.trace.len(), 1 + 1 + 4, "reset, DIR, two pulses");
            assert_eq!(sink.events, 3, "pushed, tick start, tick end");
        }
    }
}
