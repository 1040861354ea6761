//! Ctrl-C, and a request to end, as something that a loop looks at.

use crate::failure::Failure;
use std::sync::atomic::{AtomicUsize, Ordering};

static COUNT: AtomicUsize = AtomicUsize::new(0);
/// After so many the command ends at once, whatever it does.
const AT_ONCE: usize = 3;

/// From now on they are counted.
pub(crate) fn watch() -> Result<(), Failure> {
    // Also where it is ignored, as a shell has it for what runs in the background: a session is to have its end, and motors
    // their STOP.
    ctrlc::set_handler(|| {
        if COUNT.fetch_add(1, Ordering::SeqCst) + 1 >= AT_ONCE {
            std::process::exit(130);
        }
    })
    .map_err(|error| Failure::Port("Ctrl-C".to_owned(), error.to_string()))
}

/// How often there was one.
pub(crate) fn count() -> usize {
    COUNT.load(Ordering::SeqCst)
}
