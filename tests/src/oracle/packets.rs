//! A5: raw packets, committed byte by byte, the gap between them, and A9's paced host.

use super::sequencer::Sequencer;
use super::{Config, FRAMING, QUEUE_OVERFLOW, RxEvent, SHORT_PACKET, TOO_MANY_STEPS, bit_time};

/// Raw host, paced (A9): "packet j starts at boot + 1 + j*M*Ts".
///
/// The caller checks whether the line can carry a packet in M*Ts cycles.
pub fn packets_schedule(config: &Config, packets: &[Vec<u8>]) -> Vec<(u64, Vec<u8>)> {
    let mut schedule = Vec::new();
    for (j, packet) in packets.iter().enumerate() {
        let start = config.boot + 1 + j as u64 * config.slots * config.step_period;
        schedule.push((start, packet.clone()));
    }
    schedule
}

/// The bytes received so far (A5).
#[derive(Default)]
pub(super) struct Packets {
    /// A5's d, the cycle of the last delivery or framing error.
    last_heard: Option<u64>,
    partial: Vec<u8>,
    ignoring: bool,
}

impl Packets {
    /// The gap timer's part of `cycle`; returns the fault that it sets, 0 for none.
    pub(super) fn gap(&mut self, config: &Config, cycle: u64) -> u16 {
        if self.last_heard.is_none_or(|d| cycle != d + 45 * bit_time(config) + 1) {
            return 0;
        }
        self.ignoring = false;
        if self.partial.is_empty() {
            return 0;
        }
        self.partial.clear();
        SHORT_PACKET
    }

    /// The receiver's result in `cycle`; returns the fault that it sets, 0 for none.
    ///
    /// Reading: a framing error has the same place in the order as a delivered byte, after the gap timer. So in cycle d +
    /// 45*B + 1 a partial packet is SHORT_PACKET first, and then the error is FRAMING.
    pub(super) fn hear(
        &mut self,
        config: &Config,
        heard: RxEvent,
        cycle: u64,
        device: &mut Sequencer,
    ) -> u16 {
        self.last_heard = Some(cycle);
        match heard {
            RxEvent::FramingError => {
                self.partial.clear();
                self.ignoring = true;
                FRAMING
            }
            RxEvent::Byte(_) if self.ignoring => 0,
            RxEvent::Byte(byte) => {
                self.partial.push(byte);
                if self.partial.len() < config.channels + usize::from(config.address.is_some()) {
                    return 0;
                }
                commit(config, &std::mem::take(&mut self.partial), cycle, device)
            }
        }
    }
}

/// Checks a complete packet committed in cycle `p`; returns the fault that it sets, 0 for none.
fn commit(config: &Config, packet: &[u8], p: u64, device: &mut Sequencer) -> u16 {
    let orders = match config.address {
        None => packet,
        Some(own) if packet[0] == own || packet[0] == 255 => &packet[1..],
        Some(_) => return 0,
    };
    // Reading: "One with p < boot is dropped without a fault" applies to any contents, so boot is checked
    // first.
    if p < config.boot {
        return 0;
    }
    // "dropped whole (fault TOO_MANY_STEPS, and no other)": checked before the queue.
    if too_many_steps(config, orders) {
        return TOO_MANY_STEPS;
    }
    if device.free(config) == 0 {
        return QUEUE_OVERFLOW;
    }
    device.queue(orders);
    0
}

/// Whether "a byte orders more steps than the tick has slots".
pub(super) fn too_many_steps(config: &Config, orders: &[u8]) -> bool {
    orders.iter().any(|order| u64::from(order & 0x7F) > config.slots)
}
