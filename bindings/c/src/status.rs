//! Statuses, failures, and the border: no panic crosses it.

use std::any::Any;
use std::ffi::c_char;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;
use stepscope_core::Problems;

/// Result of a call: a STEPSCOPE_ constant.
pub type Status = i32;

/// Declares the statuses, and their texts for [`stepscope_status_text`].
macro_rules! statuses {
    ($($name:ident = $value:literal, $text:literal;)*) => {
        $(pub(crate) const $name: Status = $value;)*

        fn text(status: Status) -> &'static str {
            match status {
                $($value => concat!($text, "\0"),)*
                _ => "unknown status\0",
            }
        }
    };
}

statuses! {
    OK = 0, "no error";
    PROBLEMS = 1, "the scenario is refused";
    NULL = 2, "a pointer that must not be NULL is NULL";
    HANDLE = 3, "the handle was freed, never made, or is of another kind";
    RANGE = 4, "a number or a name is out of range";
    BUFFER = 5, "the buffer is too small";
    UTF8 = 6, "the text is not UTF-8";
    BUSY = 7, "the device is in use by another thread or by its own callback";
    ORDER = 8, "not possible now: the edges were not kept, or the device has not run";
    STOPPED = 9, "the progress callback stopped the run";
    FILE = 10, "the file could not be read or written";
    PANIC = 11, "a bug in the library";
}

/// What a status means, in a few words. Never NULL; the text lives as long as the program.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_status_text(status: Status) -> *const c_char {
    text(status).as_ptr().cast()
}

/// A path, and what is wrong there.
pub(crate) type Line = (String, String);

/// Why a call failed: its status, and the lines of its error.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) status: Status,
    pub(crate) lines: Vec<Line>,
}

impl Failure {
    /// `path` is the argument or file that is wrong.
    pub(crate) fn new(status: Status, path: &str, message: impl Into<String>) -> Self {
        Self { status, lines: vec![(path.to_owned(), message.into())] }
    }

    pub(crate) fn of(problems: &Problems) -> Self {
        let line = |problem: &stepscope_core::Problem| (problem.path.clone(), problem.cause.to_string());
        Self { status: PROBLEMS, lines: problems.iter().map(line).collect() }
    }
}

/// Runs a call: its failures and panics become a status.
pub(crate) fn checked(call: impl FnOnce() -> Result<(), Failure>) -> Status {
    caught(call).err().map_or(OK, |failure| failure.status)
}

pub(crate) fn caught(call: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
    // The default hook prints, and a library has no output. The library has a standard library of its own, so no other code
    // is concerned.
    static SILENCE: Once = Once::new();
    SILENCE.call_once(|| panic::set_hook(Box::new(|_| {})));
    // What a panic leaves behind is a locked device, which is unusable from then on.
    panic::catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|panic| Err(bug(&*panic)))
}

fn bug(panic: &(dyn Any + Send)) -> Failure {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message");
    Failure::new(PANIC, "", format!("a bug in the library ({text}); report it with the scenario"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::CStr;

    #[test]
    fn a_panic_is_a_status_with_its_message() {
        assert_eq!(checked(|| panic!("lost")), PANIC);
        let failure = caught(|| panic!("lost {}", 2)).expect_err("it panics");
        let expected = "a bug in the library (lost 2); report it with the scenario";
        assert_eq!((failure.status, &*failure.lines[0].1), (PANIC, expected));
        assert_eq!(checked(|| Ok(())), OK);
    }

    #[test]
    fn each_status_has_a_text() {
        let mut texts: Vec<&str> = (OK..=PANIC).map(text).collect();
        texts.push(text(-1));
        texts.sort_unstable();
        texts.dedup();
        assert_eq!(texts.len(), 13);
        for status in -1..=12 {
            // SAFETY: a literal with a closing 0.
            let found = unsafe { CStr::from_ptr(stepscope_status_text(status)) };
            assert_eq!(found.to_bytes_with_nul(), text(status).as_bytes());
        }
    }
}
