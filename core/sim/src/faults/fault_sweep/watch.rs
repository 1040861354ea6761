//! Observes a controller in a fault sweep's run.

use crate::faults::fault_sweep::Tally;
use alloc::vec::Vec;
use stepscope_peripheral::signal::{Event, MAX_CHANNELS, PacketOutcome, Record, Sink};
use stepscope_peripheral::{protocol::FrameOutcome, units::Instant};

#[derive(Clone, Debug, Default)]
pub(super) struct Watch {
    ticks: Vec<[u8; MAX_CHANNELS]>,
    counted: Tally,
}

impl Watch {
    pub(super) fn executed(&self, channels: usize) -> Vec<u8> {
        self.ticks.iter().flat_map(|tick| tick.iter().take(channels)).copied().collect()
    }

    pub(super) fn count(&self, tally: &mut Tally) {
        *tally += self.counted;
    }
}

impl Sink for Watch {
    fn record(&mut self, _: Record) {}

    fn event(&mut self, _: Instant, event: Event) {
        let counted = &mut self.counted;
        let count = match event {
            Event::TickStart { commands } => return self.ticks.push(commands),
            Event::FramingError { .. } => &mut counted.framing,
            Event::Frame(FrameOutcome::BadCrc { .. }) => &mut counted.bad_check,
            Event::Frame(FrameOutcome::Short) | Event::Gap { cuts_packet: true } => &mut counted.short,
            Event::Frame(FrameOutcome::Overlong) => &mut counted.overlong,
            Event::Frame(FrameOutcome::Refused(_))
            | Event::Packet(
                PacketOutcome::TooManySteps | PacketOutcome::QueueFull | PacketOutcome::Booting,
            ) => &mut counted.refused,
            Event::Frame(FrameOutcome::Repeated) => &mut counted.acknowledged_again,
            Event::Reply { .. } => &mut counted.replies,
            _ => return,
        };
        *count += 1;
    }
}
