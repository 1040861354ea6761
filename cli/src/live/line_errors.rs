//! Errors of a real line, as its driver counts them (LIVE H1). They are not part of the recording.

use std::fmt;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LineErrors {
    /// Missing stop bits: the other end has another rate, or the line is bad.
    framing: u32,
    overruns: u32,
    parity: u32,
    breaks: u32,
}

impl LineErrors {
    /// The difference; the counters wrap.
    pub(crate) const fn since(self, begin: Self) -> Self {
        Self {
            framing: self.framing.wrapping_sub(begin.framing),
            overruns: self.overruns.wrapping_sub(begin.overruns),
            parity: self.parity.wrapping_sub(begin.parity),
            breaks: self.breaks.wrapping_sub(begin.breaks),
        }
    }

    pub(crate) fn is_none(self) -> bool {
        self == Self::default()
    }
}

impl fmt::Display for LineErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { framing, overruns, parity, breaks } = self;
        write!(f, "framing {framing} overrun {overruns} parity {parity} break {breaks}")
    }
}

/// `None` if the system does not count, as for pseudo-terminals.
#[cfg(all(
    target_os = "linux",
    any(target_arch = "x86", target_arch = "x86_64", target_arch = "arm", target_arch = "aarch64")
))]
pub(crate) fn counted(port: &impl std::os::fd::AsFd) -> Option<LineErrors> {
    use rustix::ioctl::{Getter, Opcode, ioctl};
    /// The value on these architectures.
    const TIOCGICOUNT: Opcode = 0x545d;
    /// `struct serial_icounter_struct` of <linux/serial.h>: twenty `int`s.
    type Counters = [i32; 20];
    const FRAME: usize = 6;
    #[allow(unsafe_code, reason = "no dependency offers this call")]
    // SAFETY: TIOCGICOUNT writes a `serial_icounter_struct`, which has the size of `Counters`; every value of its
    // ints is valid.
    let counters = unsafe { ioctl(port, Getter::<TIOCGICOUNT, Counters>::new()) }.ok()?;
    let [framing, overruns, parity, breaks, ..] = *counters.get(FRAME..)? else { return None };
    let [framing, overruns, parity, breaks] = [framing, overruns, parity, breaks].map(i32::cast_unsigned);
    Some(LineErrors { framing, overruns, parity, breaks })
}

#[cfg(not(all(
    target_os = "linux",
    any(target_arch = "x86", target_arch = "x86_64", target_arch = "arm", target_arch = "aarch64")
)))]
pub(crate) fn counted<T>(_: &T) -> Option<LineErrors> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_errors_since_the_port_was_opened_across_a_counter_overflow() {
        let begin = LineErrors { framing: u32::MAX, overruns: 2, parity: 0, breaks: 5 };
        let now = LineErrors { framing: 1, overruns: 2, parity: 0, breaks: 6 };
        assert_eq!(now.since(begin).to_string(), "framing 2 overrun 0 parity 0 break 1");
        assert!(begin.since(begin).is_none() && !now.since(begin).is_none());
    }

    #[test]
    #[cfg(unix)]
    fn a_file_that_is_no_serial_port_has_no_counters() {
        let file = std::fs::File::open("/dev/null").expect("it is there");
        assert_eq!(counted(&file), None);
    }
}
