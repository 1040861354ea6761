//! A port on a half-duplex line: switches the transceiver and removes the echo (LIVE H3).

use super::port::{Port, write_all};
use std::{collections::VecDeque, io, time::Duration};

pub(super) struct Wire {
    pub(super) port: Box<dyn Port>,
    rts: bool,
    pub(super) echo: bool,
    /// Sent bytes whose echo has not been received yet.
    echo_due: VecDeque<u8>,
    collisions: u64,
}

impl Wire {
    pub(super) fn new(port: Box<dyn Port>, rts: bool, echo: bool) -> Self {
        Self { port, rts, echo, echo_due: VecDeque::new(), collisions: 0 }
    }

    pub(super) const fn collisions(&self) -> u64 {
        self.collisions
    }

    pub(super) fn write(&mut self, bytes: &[u8], within: Duration) -> io::Result<()> {
        if self.rts {
            self.port.set_rts(true)?;
        }
        if self.echo {
            // The echo of an earlier frame can no longer come.
            self.echo_due.clear();
            self.echo_due.extend(bytes);
        }
        let written = write_all(&mut *self.port, bytes, within);
        if self.rts {
            self.port.drain()?;
            self.port.set_rts(false)?;
        }
        written
    }

    /// Removes the echo. A different byte is a collision: another device is sending.
    pub(super) fn without_echo(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut others = Vec::new();
        for &byte in bytes {
            match self.echo_due.pop_front() {
                None => others.push(byte),
                Some(sent) if sent == byte => {}
                Some(_) => self.collisions += 1,
            }
        }
        others
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::port::Received;

    struct Recorder(std::rc::Rc<std::cell::RefCell<Vec<String>>>);

    impl Port for Recorder {
        fn read(&mut self, _: &mut [u8], _: Duration) -> io::Result<Received> {
            Ok(Received::Nothing)
        }

        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.borrow_mut().push(format!("{bytes:?}"));
            Ok(bytes.len().min(2))
        }

        fn drain(&mut self) -> io::Result<()> {
            self.0.borrow_mut().push("drain".to_owned());
            Ok(())
        }

        fn set_rts(&mut self, on: bool) -> io::Result<()> {
            self.0.borrow_mut().push(format!("rts {on}"));
            Ok(())
        }
    }

    #[test]
    fn rts_stays_on_until_all_bytes_are_sent() {
        let calls = std::rc::Rc::default();
        let mut wire = Wire::new(Box::new(Recorder(std::rc::Rc::clone(&calls))), true, false);
        wire.write(&[1, 2, 3], Duration::ZERO).expect("it is written");
        assert_eq!(*calls.borrow(), ["rts true", "[1, 2, 3]", "[3]", "drain", "rts false"]);
    }

    #[test]
    fn removes_the_echo_and_counts_changed_bytes_as_collisions() {
        let mut wire = Wire::new(Box::new(Recorder(std::rc::Rc::default())), false, true);
        wire.write(&[1, 2, 3], Duration::ZERO).expect("it is written");
        assert!(wire.without_echo(&[1, 9]).is_empty());
        assert_eq!((wire.without_echo(&[3, 4, 5]), wire.collisions()), (vec![4, 5], 1));
    }
}
