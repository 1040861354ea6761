//! Ctrl-C and requests to end: SIGINT, SIGTERM and SIGHUP, or what the system has in their place.
//!
//! From its first line on, a command that is ended so removes its temporary files and ends with exit code 130. A live session
//! counts them instead ([`watch`]): it has motors to stop.

use crate::{
    failure::{Failure, INTERRUPTED},
    output,
};
use std::{
    io,
    sync::atomic::{AtomicBool, AtomicUsize, Ordering},
};

/// After this many a command ends at once, whatever it does.
const AT_ONCE: usize = 3;

static WATCHED: AtomicBool = AtomicBool::new(false);
static COUNT: AtomicUsize = AtomicUsize::new(0);

/// Ends the command in order from now on, also while it waits for a file or plans a long motion. A signal that was ignored
/// when the command started, as by `nohup`, stays ignored.
pub(crate) fn install() {
    // Without a handler the system ends the command by itself.
    let _ = system::install();
}

/// Counts from now on. Signals that were ignored count, too: a session in the background needs an end, and motors their STOP.
pub(crate) fn watch() -> Result<(), Failure> {
    WATCHED.store(true, Ordering::SeqCst);
    system::listen_to_all().map_err(|error| Failure::Port("Ctrl-C".to_owned(), error.to_string()))
}

/// How many there were.
pub(crate) fn count() -> usize {
    COUNT.load(Ordering::SeqCst)
}

fn came() {
    let at_once = COUNT.fetch_add(1, Ordering::SeqCst) + 1 >= AT_ONCE;
    if WATCHED.load(Ordering::SeqCst) && !at_once {
        return;
    }
    // Held until the end of the process: no file is renamed meanwhile. Where files are in place already, the command ends by itself.
    let committed = output::committed();
    if *committed && !at_once {
        return;
    }
    output::remove_temporary();
    std::process::exit(INTERRUPTED.into());
}

#[cfg(unix)]
mod system {
    use super::{came, io};
    use signal_hook::{
        consts::{SIGHUP, SIGINT, SIGTERM},
        iterator::{Handle, Signals},
    };
    use std::{sync::OnceLock, thread};

    const ALL: [i32; 3] = [SIGHUP, SIGINT, SIGTERM];
    static HANDLE: OnceLock<Handle> = OnceLock::new();

    pub(super) fn install() -> io::Result<()> {
        let ignored = ignored();
        let mut signals = Signals::new(ALL.into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0))?;
        let _ = HANDLE.set(signals.handle());
        thread::Builder::new().name("signals".to_owned()).spawn(move || {
            signals.forever().for_each(|_| came());
        })?;
        Ok(())
    }

    pub(super) fn listen_to_all() -> io::Result<()> {
        let handle = HANDLE.get().ok_or(io::ErrorKind::Unsupported)?;
        ALL.into_iter().try_for_each(|signal| handle.add_signal(signal))
    }

    /// The signals that are ignored, a bit for each; none where the system does not tell.
    fn ignored() -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
    }
}

#[cfg(not(unix))]
mod system {
    use super::{came, io};

    pub(super) fn install() -> io::Result<()> {
        ctrlc::set_handler(came).map_err(io::Error::other)
    }

    pub(super) fn listen_to_all() -> io::Result<()> {
        Ok(())
    }
}
