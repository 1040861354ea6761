//! Standard input as where a stand-alone controller's buttons come from.

use super::port::{Heard, Port};
use std::{
    io::{self, Read},
    sync::mpsc::{Receiver, RecvTimeoutError, sync_channel},
    thread,
    time::Duration,
};

/// Chunks that wait to be taken; what goes beyond them waits in the system.
const CHUNKS: usize = 4;
const CHUNK: usize = 1024;

/// Standard input, read by a thread of its own: a system does not wait for it and for time together everywhere.
pub(crate) struct Keyboard {
    chunks: Receiver<Vec<u8>>,
    /// What did not fit when it was read.
    rest: Vec<u8>,
    ended: bool,
}

impl Keyboard {
    /// From now on it is read.
    pub(crate) fn open() -> io::Result<Self> {
        let (sender, chunks) = sync_channel(CHUNKS);
        thread::Builder::new().name("buttons".to_owned()).spawn(move || {
            let mut buffer = [0; CHUNK];
            let mut input = io::stdin();
            // What cannot be read has ended.
            while let Ok(count @ 1..) = input.read(&mut buffer) {
                let chunk = buffer.get(..count).unwrap_or_default().to_vec();
                if sender.send(chunk).is_err() {
                    break;
                }
            }
        })?;
        Ok(Self { chunks, rest: Vec::new(), ended: false })
    }
}

impl Port for Keyboard {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<Heard> {
        if self.ended {
            thread::sleep(wait);
            return Ok(Heard::Nothing);
        }
        if self.rest.is_empty() {
            match self.chunks.recv_timeout(wait) {
                Ok(chunk) => self.rest = chunk,
                Err(RecvTimeoutError::Timeout) => return Ok(Heard::Nothing),
                Err(RecvTimeoutError::Disconnected) => {
                    self.ended = true;
                    return Ok(Heard::Gone);
                }
            }
        }
        let count = self.rest.len().min(buffer.len());
        let taken = self.rest.drain(..count);
        buffer.iter_mut().zip(taken).for_each(|(place, byte)| *place = byte);
        Ok(Heard::Bytes(count))
    }

    /// Nothing is written to a panel.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(bytes.len())
    }
}
