//! Handles Ctrl-C and requests to end: SIGINT, SIGTERM and SIGHUP, or the system's equivalents.
//!
//! A command removes its temporary files and ends with exit code 130. A live session counts the signals instead
//! ([`watch`]): it has to stop motors first.

use crate::failure::{Failure, INTERRUPTED};
use crate::output;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// This many signals end even a live session at once.
const FORCED: usize = 3;

static WATCHED: AtomicBool = AtomicBool::new(false);
static COUNT: AtomicUsize = AtomicUsize::new(0);

/// Ends the command on a signal, even while it waits for a file. Signals ignored at the start, as by `nohup`, stay
/// ignored.
pub(crate) fn install() {
    let _ = system::install();
}

/// Counts signals from now on. Includes ignored ones, because a session in the background must be stoppable.
pub(crate) fn watch() -> Result<(), Failure> {
    WATCHED.store(true, Ordering::SeqCst);
    system::listen_to_all().map_err(|error| Failure::Unusable("Ctrl-C".to_owned(), error.to_string()))
}

pub(crate) fn count() -> usize {
    COUNT.load(Ordering::SeqCst)
}

fn handle_signal() {
    let is_forced = COUNT.fetch_add(1, Ordering::SeqCst) + 1 >= FORCED;
    if WATCHED.load(Ordering::SeqCst) && !is_forced {
        return;
    }
    // Locked until the process ends, so that no file is renamed meanwhile. After the renames the command ends by itself.
    let committed = output::committed();
    if *committed && !is_forced {
        return;
    }
    output::remove_temporary();
    std::process::exit(INTERRUPTED.into());
}

#[cfg(unix)]
mod system {
    use super::{handle_signal, io};
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::{Handle, Signals};
    use std::{sync::OnceLock, thread};

    const ALL: [i32; 3] = [SIGHUP, SIGINT, SIGTERM];
    static HANDLE: OnceLock<Handle> = OnceLock::new();

    pub(super) fn install() -> io::Result<()> {
        let ignored = ignored();
        let mut signals = Signals::new(ALL.into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0))?;
        let _ = HANDLE.set(signals.handle());
        thread::Builder::new().name("signals".to_owned()).spawn(move || {
            signals.forever().for_each(|_| handle_signal());
        })?;
        Ok(())
    }

    pub(super) fn listen_to_all() -> io::Result<()> {
        let handle = HANDLE.get().ok_or(io::ErrorKind::Unsupported)?;
        ALL.into_iter().try_for_each(|signal| handle.add_signal(signal))
    }

    /// A bit per ignored signal; 0 if the system does not report them.
    fn ignored() -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
    }
}

#[cfg(not(unix))]
mod system {
    use super::{handle_signal, io};

    pub(super) fn install() -> io::Result<()> {
        ctrlc::set_handler(handle_signal).map_err(io::Error::other)
    }

    pub(super) fn listen_to_all() -> io::Result<()> {
        Ok(())
    }
}
