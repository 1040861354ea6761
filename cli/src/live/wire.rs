//! A port on a half-duplex line: switches the transceiver and removes the echo (LIVE H3).

use super::port::{Port, write_all};
use std::{collections::VecDeque, io, time::Duration};

pub(super) struct Wire {
    pub(super) port: Box<dyn Port>,
    rts: bool,
    pub(super) echo: bool,
    /// Sent bytes whose echo has not come.
    own: VecDeque<u8>,
    collisions: u64,
}

impl Wire {
    pub(super) fn new(port: Box<dyn Port>, rts: bool, echo: bool) -> Self {
        Self { port, rts, echo, own: VecDeque::new(), collisions: 0 }
    }

    pub(super) const fn collisions(&self) -> u64 {
        self.collisions
    }

    pub(super) fn write(&mut self, bytes: &[u8], within: Duration) -> io::Result<()> {
        if self.rts {
            self.port.set_rts(true)?;
        }
        if self.echo {
            // A missing echo of the last frame will not come any more.
            self.own.clear();
            self.own.extend(bytes);
        }
        let written = write_all(&mut *self.port, bytes, within);
        if self.rts {
            self.port.drain()?;
            self.port.set_rts(false)?;
        }
        written
    }

    /// Removes the echo. A different byte is a collision: someone else is sending.
    pub(super) fn without_echo(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut others = Vec::new();
        for &byte in bytes {
            match self.own.pop_front() {
                None => others.push(byte),
                Some(own) if own == byte => {}
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

    struct Noted(std::rc::Rc<std::cell::RefCell<Vec<String>>>);

    impl Port for Noted {
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
    fn rts_is_up_until_all_has_left() {
        let noted = std::rc::Rc::default();
        let mut wire = Wire::new(Box::new(Noted(std::rc::Rc::clone(&noted))), true, false);
        wire.write(&[1, 2, 3], Duration::ZERO).expect("it is written");
        assert_eq!(*noted.borrow(), ["rts true", "[1, 2, 3]", "[3]", "drain", "rts false"]);
    }

    #[test]
    fn an_echo_is_taken_out_and_a_changed_one_is_a_collision() {
        let mut wire = Wire::new(Box::new(Noted(std::rc::Rc::default())), false, true);
        wire.write(&[1, 2, 3], Duration::ZERO).expect("it is written");
        assert!(wire.without_echo(&[1, 9]).is_empty());
        assert_eq!((wire.without_echo(&[3, 4, 5]), wire.collisions()), (vec![4, 5], 1));
    }
}
