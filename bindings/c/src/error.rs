//! Errors: what is wrong, one line per problem.

use crate::status::{Failure, OK, Status, caught, checked};
use crate::{handle, pointer};
use std::ffi::{CString, c_char};
use std::ptr;

/// Why a call failed. Any number of threads may read it.
pub struct ErrorHandle {
    _private: (),
}

pub(crate) struct Error {
    text: CString,
    lines: Vec<(CString, CString)>,
}

impl handle::Object for Error {
    type Handle = ErrorHandle;
    const NAME: &'static str = "error";
}

/// A text for C; it ends at its first 0.
fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', "\u{fffd}")).unwrap_or_default()
}

impl Error {
    pub(crate) fn new(failure: Failure) -> Self {
        let line = |(path, message): &(String, String)| match path.as_str() {
            "" => message.clone(),
            path => format!("{path}: {message}"),
        };
        let text: Vec<String> = failure.lines.iter().map(line).collect();
        let lines = failure.lines.iter().map(|(path, message)| (c_text(path), c_text(message)));
        Self { text: c_text(&text.join("\n")), lines: lines.collect() }
    }
}

/// As [`checked`], and with an error where the caller has room for one.
///
/// # Safety
/// `error` is NULL, or valid for reads and writes.
pub(crate) unsafe fn guarded(
    error: *mut *mut ErrorHandle,
    call: impl FnOnce() -> Result<(), Failure>,
) -> Status {
    match caught(call) {
        Ok(()) => OK,
        Err(failure) => {
            let status = failure.status;
            // SAFETY: as of this function.
            unsafe { pointer::put_first(error, || handle::add(Error::new(failure))) };
            status
        }
    }
}

/// Number of problems, 1 to 100; 0 for NULL and for a handle that is no error.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_error_count(error: *const ErrorHandle) -> usize {
    let mut count = 0;
    checked(|| {
        count = handle::get::<Error>(error)?.lines.len();
        Ok(())
    });
    count
}

/// All problems, one line per problem: `path: what is wrong, and what to use instead`. The text lives as long as the error. It is ""
/// for NULL and for a handle that is no error; never NULL.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_error_text(error: *const ErrorHandle) -> *const c_char {
    let mut text = c"".as_ptr();
    checked(|| {
        // The table holds the error until it is freed, so its texts stay where they are.
        text = handle::get::<Error>(error)?.text.as_ptr();
        Ok(())
    });
    text
}

fn part(error: *const ErrorHandle, index: usize, is_path: bool) -> *const c_char {
    let mut found = ptr::null();
    checked(|| {
        let error = handle::get::<Error>(error)?;
        let line = error.lines.get(index).map(|(path, message)| if is_path { path } else { message });
        found = line.map_or(ptr::null(), |text| text.as_ptr());
        Ok(())
    });
    found
}

/// Path of problem `index`, which counts from 0, such as "bus.slots"; "" if it is the whole scenario. NULL beyond the last.
/// The text lives as long as the error.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_error_path(error: *const ErrorHandle, index: usize) -> *const c_char {
    part(error, index, true)
}

/// Message of problem `index`, such as "0 is out of range; use 1 to 127". NULL beyond the last. The text lives as long as
/// the error.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_error_message(error: *const ErrorHandle, index: usize) -> *const c_char {
    part(error, index, false)
}

/// Frees an error, and with it its texts. NULL is OK; a second time is STEPSCOPE_HANDLE.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_error_free(error: *mut ErrorHandle) -> Status {
    checked(|| handle::free::<Error>(error))
}
