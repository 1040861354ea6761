//! One controller, cycle by cycle, in A7's order within a cycle; and the record of its run.

use super::frames::Frames;
use super::line::{Receiver, byte_start, send};
use super::orders::Device;
use super::packets::Packets;
use super::{Config, FRAMING, Run, RxEvent, State, UNDERRUN, bit_time, bits};

/// A reply: DE is high, and TX has the given levels, from `de_rises` on.
struct Reply {
    de_rises: u64,
    tx: Vec<bool>,
}

/// "DE rises at p + 10*B, the first start bit falls at p + 11*B, the bytes follow back to back by A4's sender rule at
/// `receiver_baud` (not B); DE falls at t + floor(10*clock_hz/receiver_baud), t being the start of the last byte."
fn reply(config: &Config, p: u64, bytes: &[u8]) -> Reply {
    let sender = Config { baud: config.receiver_baud, ..config.clone() };
    let (de_rises, t0) = (p + 10 * bit_time(config), p + 11 * bit_time(config));
    let last = byte_start(&sender, t0, bytes.len() as u64 - 1);
    let de_falls = last + 10 * config.clock_hz / config.receiver_baud;
    let mut tx = vec![true; (de_falls - de_rises) as usize];
    send(&sender, t0, bytes, |from, to, level| {
        for cycle in from..to {
            tx[(cycle - de_rises) as usize] = level;
        }
    });
    Reply { de_rises, tx }
}

/// Levels that a controller puts on the line in a cycle.
#[derive(Clone, Copy)]
pub(super) struct Driven {
    pub(super) de: bool,
    pub(super) tx: bool,
}

/// The kind of framing.
enum Framing {
    Raw(Packets),
    Framed(Frames),
}

/// A controller between two cycles.
pub(super) struct Controller<'a> {
    config: &'a Config,
    receiver: Receiver,
    framing: Framing,
    device: Device,
    reply: Option<Reply>,
    recorder: Recorder,
}

impl<'a> Controller<'a> {
    pub(super) fn new(config: &'a Config) -> Self {
        Controller {
            config,
            receiver: Receiver::Armed,
            framing: if config.framed {
                Framing::Framed(Frames::default())
            } else {
                Framing::Raw(Packets::default())
            },
            device: Device::new(),
            reply: None,
            recorder: Recorder::default(),
        }
    }

    /// DE and TX in `cycle`. They do not depend on the line in the same cycle, because a reply starts 10 bit times later.
    pub(super) fn driven(&self, cycle: u64) -> Driven {
        let tx = self.reply.as_ref().and_then(|reply| {
            let index = cycle.checked_sub(reply.de_rises)?;
            reply.tx.get(index as usize).copied()
        });
        // "TX = 1 while DE = 0."
        Driven { de: tx.is_some(), tx: tx.unwrap_or(true) }
    }

    /// One cycle: the sequencer, the gap timer, the byte, and finally the status. `rx` is the line as this controller receives
    /// it.
    pub(super) fn clock(&mut self, cycle: u64, rx: bool, driven: Driven) {
        let config = self.config;
        let underrun = self.device.sequencer.advance(config, cycle);
        if underrun && config.framed {
            self.device.faults |= UNDERRUN;
        }
        // "What a frame does to EN, STEP and to the start of ticks shows from cycle p + 1 on": these levels are taken
        // before the byte.
        let step = self.device.sequencer.step(cycle);
        let levels = step << bits::STEP
            | self.device.sequencer.dir << bits::DIR
            | u64::from(self.device.enabled) << bits::EN
            | u64::from(rx) << bits::RX
            | u64::from(driven.tx) << bits::TX
            | u64::from(driven.de) << bits::DE;
        self.recorder.record(cycle, levels);

        if let Framing::Raw(packets) = &mut self.framing {
            self.device.faults |= packets.gap(config, cycle);
        }
        let Some(heard) = self.receiver.hear(config, cycle, rx) else { return };
        match &mut self.framing {
            Framing::Raw(packets) => {
                self.device.faults |= packets.hear(config, heard, cycle, &mut self.device.sequencer);
            }
            Framing::Framed(frames) => match heard {
                // "A byte with a framing error is missing (FRAMING)". Reading: as if it had not been sent. The other bytes
                // of its run are checked like any run ("the frame then fails its check" follows from
                // this and is no separate rule), so an error before the first byte of a valid frame does not affect the frame.
                // The flag is also set while OVERLONG drops bytes: "no further flag" refers to flags of the run.
                RxEvent::FramingError => self.device.faults |= FRAMING,
                RxEvent::Byte(byte) => match frames.hear(byte) {
                    Err(fault) => self.device.faults |= fault,
                    Ok(None) => {}
                    Ok(Some(good)) => {
                        // The levels of this cycle are recorded: its rises count.
                        let positions = &self.recorder.positions;
                        if let Some(bytes) = self.device.take(config, &good, cycle, positions) {
                            let before = self.reply.as_ref().map_or(0, |r| r.de_rises + r.tx.len() as u64);
                            assert!(before <= cycle, "a second reply falls due: {config:?}, cycle {cycle}");
                            self.reply = Some(reply(config, cycle, &bytes));
                        }
                    }
                },
            },
        }
    }

    /// The results after `cycles` cycles.
    pub(super) fn finish(self, cycles: u64) -> Run {
        Run {
            trace: self.recorder.trace,
            positions: self.recorder.positions,
            faults: self.device.faults,
            ticks_done: self.device.sequencer.ticks_done,
            expected_seq: self.device.expected_seq,
            state: if cycles == 0 { State::default() } else { self.device.state(self.config, cycles - 1) },
            free: self.device.sequencer.free(self.config),
        }
    }
}

/// A3: records and positions, from each cycle's levels.
#[derive(Default)]
pub(super) struct Recorder {
    levels_before: Option<u64>,
    pub(super) trace: Vec<(u64, u64)>,
    pub(super) positions: [i32; 16],
}

impl Recorder {
    pub(super) fn record(&mut self, cycle: u64, levels: u64) {
        let rises = levels & !self.levels_before.unwrap_or(levels);
        for channel in 0..16 {
            if rises >> bits::STEP >> channel & 1 == 1 {
                let right = levels >> bits::DIR >> channel & 1 == 1;
                self.positions[channel] += if right { 1 } else { -1 };
            }
        }
        if self.levels_before != Some(levels) {
            self.trace.push((cycle, levels));
            self.levels_before = Some(levels);
        }
    }
}
