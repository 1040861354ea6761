//! The caller's memory: the only reads and writes through its pointers.
//!
//! Every function takes pointers that are NULL or valid for what their name says; NULL is an error where it is not allowed.

use crate::status::{BUFFER, Failure, NULL, RANGE, UTF8};
use std::ffi::{CStr, c_char};
use std::{ptr, slice};

fn null(name: &str) -> Failure {
    Failure::new(NULL, name, "the pointer is NULL; use the address of a variable or of a text")
}

/// Writes a result.
///
/// # Safety
/// `to` is NULL, or valid for a write.
pub(crate) unsafe fn put<T>(name: &str, to: *mut T, value: T) -> Result<(), Failure> {
    if to.is_null() {
        return Err(null(name));
    }
    // SAFETY: not NULL, so valid for a write.
    unsafe { to.write(value) };
    Ok(())
}

/// Writes a handle where the caller has none yet, so that the first error of a chain is kept.
///
/// # Safety
/// `to` is NULL, or valid for reads and writes.
pub(crate) unsafe fn put_first<T>(to: *mut *mut T, make: impl FnOnce() -> *mut T) {
    // SAFETY: not NULL, so valid for reads and writes.
    if !to.is_null() && unsafe { to.read() }.is_null() {
        // SAFETY: as before.
        unsafe { to.write(make()) };
    }
}

/// Reads a list. NULL is fine for one without items.
///
/// # Safety
/// `from` is NULL, or `count` items can be read there for as long as `'a`.
pub(crate) unsafe fn items<'a, T>(name: &str, from: *const T, count: usize) -> Result<&'a [T], Failure> {
    if count == 0 {
        return Ok(&[]);
    }
    if from.is_null() {
        return Err(null(name));
    }
    let max = isize::MAX.unsigned_abs() / size_of::<T>().max(1);
    if count > max {
        let message = format!("{count} items are out of range; use at most {max}");
        return Err(Failure::new(RANGE, name, message));
    }
    // SAFETY: not NULL, so `count` items can be read, and their size was checked.
    Ok(unsafe { slice::from_raw_parts(from, count) })
}

/// Reads a text of `length` bytes, or up to its closing 0 if that is `usize::MAX`.
///
/// # Safety
/// `from` is NULL, or the text can be read there for as long as `'a`.
pub(crate) unsafe fn text<'a>(name: &str, from: *const c_char, length: usize) -> Result<&'a str, Failure> {
    let bytes = if from.is_null() {
        return Err(null(name));
    } else if length == usize::MAX {
        // SAFETY: not NULL, and of this length the caller says that there is a closing 0.
        unsafe { CStr::from_ptr(from) }.to_bytes()
    } else {
        // SAFETY: as of this function.
        unsafe { items(name, from.cast::<u8>(), length)? }
    };
    str::from_utf8(bytes).map_err(|error| {
        let message = format!("byte {} is not UTF-8; use UTF-8 text", error.valid_up_to());
        Failure::new(UTF8, name, message)
    })
}

/// The caller's buffer `(out, capacity, count)`.
pub(crate) struct Buffer<T> {
    out: *mut T,
    capacity: usize,
    count: *mut usize,
}

impl<T> Buffer<T> {
    /// Sets `*count` to 0.
    ///
    /// # Safety
    /// `count` is NULL or valid for writes, and `out` is NULL or valid for `capacity` writes, until the buffer is dropped.
    pub(crate) unsafe fn new(out: *mut T, capacity: usize, count: *mut usize) -> Result<Self, Failure> {
        // SAFETY: as of this function.
        unsafe { put("count", count, 0)? };
        if out.is_null() && capacity > 0 {
            return Err(null("out"));
        }
        Ok(Self { out, capacity, count })
    }

    /// Writes items as far as the buffer goes, and their number. Without a buffer, writes only the number.
    pub(crate) fn fill(self, items: impl IntoIterator<Item = T>) -> Result<(), Failure> {
        let mut number = 0_usize;
        for item in items {
            if number < self.capacity {
                // SAFETY: below `capacity`, where the buffer is valid for writes.
                unsafe { self.out.add(number).write(item) };
            }
            number += 1;
        }
        // SAFETY: checked and written in `new`.
        unsafe { self.count.write(number) };
        if number <= self.capacity || self.out.is_null() {
            return Ok(());
        }
        let message = format!("a capacity of {} is too small; use at least {number}", self.capacity);
        Err(Failure::new(BUFFER, "capacity", message))
    }

    /// Whether the caller has no buffer, and only wants the number of items.
    pub(crate) fn only_counts(&self) -> bool {
        self.out.is_null()
    }
}

/// A struct that begins with its size in bytes, which the caller sets: a later version of it is longer.
///
/// # Safety
/// Only plain old data, `repr(C)`, whose first field is a `u32`.
pub(crate) unsafe trait Sized32 {
    /// Size in the first release.
    const MIN: usize;
}

/// Size of the caller's version of a struct.
///
/// # Safety
/// `at` is NULL, or a `u32` can be read there.
unsafe fn size<T: Sized32>(name: &str, at: *const T) -> Result<usize, Failure> {
    if at.is_null() {
        return Err(null(name));
    }
    // SAFETY: not NULL, so its first field can be read.
    let size = unsafe { at.cast::<u32>().read() } as usize;
    if size < T::MIN {
        let message = format!("{size} is out of range; use sizeof, {} or more", T::MIN);
        return Err(Failure::new(RANGE, &format!("{name}.size"), message));
    }
    Ok(size)
}

/// Writes a struct as far as the caller's version goes, except for its size.
///
/// # Safety
/// `to` is NULL, or begins with a size, and as many bytes can be written there.
pub(crate) unsafe fn put_sized<T: Sized32>(name: &str, to: *mut T, value: &T) -> Result<(), Failure> {
    // SAFETY: as of this function.
    let size = unsafe { size(name, to)? }.min(size_of::<T>());
    let (skipped, from) = (size_of::<u32>(), ptr::from_ref(value).cast::<u8>());
    // SAFETY: both have at least `size` bytes, which are more than that of the first field; no reference to `to` exists.
    unsafe { ptr::copy(from.add(skipped), to.cast::<u8>().add(skipped), size - skipped) };
    Ok(())
}

/// Reads the bytes of a struct, as far as the caller's version goes, over those of `default`.
///
/// # Safety
/// `from` is NULL, or begins with a size, and as many bytes can be read there.
pub(crate) unsafe fn get_sized<T: Sized32>(name: &str, from: *const T, mut default: T) -> Result<T, Failure> {
    // SAFETY: as of this function.
    let size = unsafe { size(name, from)? }.min(size_of::<T>());
    // SAFETY: both have at least `size` bytes, and every value of them is one of T, which is plain old data.
    unsafe { ptr::copy(from.cast::<u8>(), ptr::from_mut(&mut default).cast(), size) };
    Ok(default)
}
