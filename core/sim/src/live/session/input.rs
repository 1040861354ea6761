//! A bounded buffer of bytes for the line (LIVE H1). While it is full, nothing is read from the port, so the host waits.

use super::Session;
use alloc::{collections::VecDeque, vec::Vec};
use stepscope_peripheral::units::Instant;

/// Bytes on their way from a port to a session's line.
///
/// ```
/// use stepscope_scenario::Scenario;
/// use stepscope_sim::session::{Input, Session};
///
/// let scenario = Scenario::from_json(r#"{ "line": { "protocol": "framed" } }"#).expect("reads");
/// let mut session = Session::new(&scenario).expect("it has no problems");
/// let mut input = Input::default();
/// assert_eq!(input.push(&[0; 100_000]), Input::CAPACITY);
/// // A byte takes 1389 cycles at 115200 baud.
/// let until = session.now() + stepscope_peripheral::units::Cycles(10_000);
/// input.feed(&mut session, until);
/// assert_eq!((session.received(), input.len()), (8, Input::CAPACITY - 8));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Input {
    /// Invariant: at most [`Self::CAPACITY`].
    bytes: VecDeque<u8>,
}

impl Input {
    /// Maximum number of bytes that wait: 1.4 s of a line at 115200 baud.
    pub const CAPACITY: usize = 16 << 10;

    /// Number of bytes that still fit.
    pub fn room(&self) -> usize {
        Self::CAPACITY.saturating_sub(self.bytes.len())
    }

    pub fn len(&self) -> usize {
        self.bytes.len()
    }

    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Adds bytes; returns how many fit.
    pub fn push(&mut self, bytes: &[u8]) -> usize {
        let count = bytes.len().min(self.room());
        self.bytes.extend(bytes.iter().take(count));
        count
    }

    /// Passes the bytes that begin on the line by cycle `until` to the session. If this is called before each
    /// [`Session::advance`], every byte has the same cycle as if all had been received immediately.
    pub fn feed(&mut self, session: &mut Session, until: Instant) {
        let count = session.fits_until(until, self.bytes.len());
        if count > 0 {
            let bytes: Vec<u8> = self.bytes.drain(..count).collect();
            session.receive(&bytes);
        }
    }

    /// Drops all bytes; returns how many.
    pub fn clear(&mut self) -> usize {
        let count = self.bytes.len();
        self.bytes.clear();
        count
    }
}
