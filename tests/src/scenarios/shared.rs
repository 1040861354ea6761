//! Scenarios of one to four controllers on a line, raw and framed, with and without noise: short
//! enough to run every cycle.

use super::small;
use proptest::prelude::*;
use stepscope_core::{
    motion::moves::Axis,
    peripheral::config::Protocol,
    scenario::{Controller, Hex, Host, Noise, Scenario, ScriptedSend, Source},
};

/// Nearly all scenarios are valid, and run for some ten thousand to some hundred thousand cycles.
pub fn shared() -> impl Strategy<Value = Scenario> {
    let one = (any::<u8>(), prop::option::weighted(0.3, 970..1_030_u32), share());
    let additional = prop::collection::vec(one, 0..4);
    (small(), additional, any::<bool>(), host(), noise(), any::<u64>()).prop_map(
        |(scenario, additional, framed, host, noise, choice)| {
            let mut scenario = scenario;
            let protocol = if framed { Protocol::Framed } else { Protocol::Raw };
            let address = scenario.line.address.unwrap_or(254);
            scenario.line.address = Some(address);
            scenario.line.noise = noise;
            scenario.line.host = host;
            scenario.line.protocol = protocol;
            // A faster clock and line with ticks of the same time: there is space for the packets of all,
            // or for parts of frames.
            let faster = if framed { 20 } else { 2 } * (1 + additional.len() as u32);
            scenario.clock_hz *= faster;
            scenario.line.baud *= faster;
            scenario.line.receiver_baud = scenario.line.receiver_baud.map(|baud| baud * faster);
            scenario.bus.step_period_cycles *= faster;
            scenario.bus.self_test_cycles = scenario.bus.self_test_cycles.min(2_000);
            scenario.line.glitches.truncate(1);
            if let Source::Packets(source) = &mut scenario.source {
                for Hex(packet) in &mut source.packets {
                    packet.truncate(usize::from(scenario.bus.channels));
                    packet.resize(usize::from(scenario.bus.channels), 0);
                    if protocol == Protocol::Raw {
                        packet.insert(0, address);
                    }
                }
            }
            if let (Source::Line(script), Protocol::Framed) = (&mut scenario.source, protocol) {
                script.sends.iter_mut().enumerate().for_each(|(index, send)| seal(send, index, address));
                script.sends.truncate(1 + (choice % 4) as usize);
            }
            let controllers = additional.into_iter().enumerate().map(|(index, (bits, off, share))| {
                let mut bus = scenario.bus.clone();
                if framed {
                    bus.channels = 1 + bits % 3;
                }
                bus.queue_depth = 1 + bits / 64;
                let (axes, packets) = orders(&scenario, index as u8, bus.channels, share);
                let receiver_baud = off.map(|off| scenario.line.baud / 1_000 * off);
                Controller { address: other_address(address, index), receiver_baud, bus, axes, packets }
            });
            scenario.controllers = controllers.collect();
            scenario
        },
    )
}

/// The address of the `index`th additional controller.
fn other_address(first: u8, index: usize) -> u8 {
    ((usize::from(first) + 1 + index) % 255) as u8
}

/// Number of another controller's commands, in quarters of the first one's: mostly equal, otherwise fewer or none.
fn share() -> impl Strategy<Value = usize> {
    prop_oneof![2 => Just(4_usize), 3 => 0..4_usize]
}

/// The source of an additional controller, on its own channels: equal to the first one's, or some quarters of it.
fn orders(scenario: &Scenario, index: u8, channels: u8, share: usize) -> (Vec<Axis>, Vec<Hex>) {
    let address = other_address(scenario.line.address.unwrap_or(0), index.into());
    match &scenario.source {
        Source::Motion(_) if share == 0 => (Vec::new(), Vec::new()),
        Source::Motion(motion) => {
            let some = |axis: &Axis| {
                let moves = axis.moves.iter().take((axis.moves.len() * share).div_ceil(4)).cloned().collect();
                Axis { moves, ..axis.clone() }
            };
            (motion.axes.iter().take(channels.into()).map(some).collect(), Vec::new())
        }
        Source::Packets(source) => {
            let own = |Hex(packet): &Hex| {
                let skipped = usize::from(scenario.line.protocol == Protocol::Raw);
                let mut orders: Vec<u8> = packet.iter().copied().skip(skipped).collect();
                orders.resize(channels.into(), 0x81);
                let address = (skipped == 1).then_some(address);
                Hex(address.into_iter().chain(orders).collect())
            };
            (
                Vec::new(),
                source.packets.iter().take((source.packets.len() * share).div_ceil(4)).map(own).collect(),
            )
        }
        _ => (Vec::new(), Vec::new()),
    }
}

/// Makes a frame of the bytes to send: a kind by its number, and the bytes as ticks for TICKS.
fn seal(send: &mut ScriptedSend, index: usize, address: u8) {
    let Hex(bytes) = std::mem::take(&mut send.bytes);
    let kind = [1, 1, 2, 5, 4, 3, 6, 9].get(index).copied().unwrap_or(4);
    let mut frame = vec![if index % 5 == 4 { 255 } else { address }, kind];
    if kind == 1 {
        frame.extend([index as u8, 1]);
        frame.extend(bytes);
    }
    send.frame = Some(Hex(frame));
    send.start_cycle *= 20;
}

fn host() -> impl Strategy<Value = Host> {
    (1..=32_u8, prop::option::weighted(0.2, 100..20_000_u32), 1..12_u8).prop_map(
        |(ticks_per_frame, reply_timeout_cycles, max_attempts)| Host {
            ticks_per_frame,
            reply_timeout_cycles,
            max_attempts,
        },
    )
}

fn noise() -> impl Strategy<Value = Noise> {
    let rate = || prop_oneof![6 => Just(0), 1 => 1_000..40_000_u32];
    (any::<u32>(), rate(), rate(), rate(), rate(), rate(), rate()).prop_map(
        |(seed, flipped, lost, duplicated, glitches, replies, crashes)| Noise {
            seed,
            flipped_bits_ppm: flipped / 20,
            lost_bytes_ppm: lost,
            duplicated_bytes_ppm: duplicated,
            glitches_ppm: glitches,
            lost_replies_ppm: replies,
            host_crashes_ppm: crashes,
        },
    )
}
