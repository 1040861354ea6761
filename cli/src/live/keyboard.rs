//! Standard input as the port of a stand-alone controller's buttons.

use super::port::{Port, Received};
use std::io::{self, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::{thread, time::Duration};

/// Buffered chunks; more input waits in the system.
const CHUNKS: usize = 4;
const CHUNK: usize = 1024;

/// A thread reads standard input, since not every system can wait for it with a time-out.
pub(crate) struct Keyboard {
    chunks: Receiver<Vec<u8>>,
    pending: Vec<u8>,
    ended: bool,
}

impl Keyboard {
    pub(crate) fn open() -> io::Result<Self> {
        let (sender, chunks) = sync_channel(CHUNKS);
        thread::Builder::new().name("buttons".to_owned()).spawn(move || {
            let mut buffer = [0; CHUNK];
            let mut input = io::stdin();
            // An error counts as the end.
            while let Ok(count @ 1..) = input.read(&mut buffer) {
                let chunk = buffer.get(..count).unwrap_or_default().to_vec();
                if sender.send(chunk).is_err() {
                    break;
                }
            }
        })?;
        Ok(Self { chunks, pending: Vec::new(), ended: false })
    }
}

impl Port for Keyboard {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<Received> {
        if self.ended {
            thread::sleep(wait);
            return Ok(Received::Nothing);
        }
        if self.pending.is_empty() {
            match self.chunks.recv_timeout(wait) {
                Ok(chunk) => self.pending = chunk,
                Err(RecvTimeoutError::Timeout) => return Ok(Received::Nothing),
                Err(RecvTimeoutError::Disconnected) => {
                    self.ended = true;
                    return Ok(Received::Gone);
                }
            }
        }
        let count = self.pending.len().min(buffer.len());
        let taken = self.pending.drain(..count);
        buffer.iter_mut().zip(taken).for_each(|(to, byte)| *to = byte);
        Ok(Received::Bytes(count))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(bytes.len())
    }
}
