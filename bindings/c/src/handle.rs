//! The table of names. A handle is a number that looks like a pointer: it is looked up and never followed, so one that was
//! freed, invented or is of another kind is an error.

use crate::status::{BUSY, Failure, HANDLE, NULL};
use std::any::Any;
use std::collections::BTreeMap;
use std::ptr;
use std::sync::{Arc, PoisonError, RwLock};

/// An object with a handle. Any thread may use it.
pub(crate) trait Object: Any + Send + Sync + Sized {
    /// The type that a handle points to for C; there never is one.
    type Handle;
    /// What it is called in messages.
    const NAME: &'static str;

    /// Whether a call uses it alone, so that it cannot be freed.
    fn is_busy(&self) -> bool {
        false
    }
}

/// The first name. On 64 bits no program has memory there, so a pointer to something else is never a name.
#[cfg(target_pointer_width = "64")]
const FIRST: usize = 0x5c0f_e000_0000_0001;
#[cfg(not(target_pointer_width = "64"))]
const FIRST: usize = 0x8000_0001;
/// Odd, so that no name is the address of an object.
const STRIDE: usize = 2;

struct Entry {
    any: Arc<dyn Any + Send + Sync>,
    is_busy: fn(&(dyn Any + Send + Sync)) -> bool,
}

struct Table {
    next: usize,
    objects: BTreeMap<usize, Entry>,
}

static TABLE: RwLock<Table> = RwLock::new(Table { next: FIRST, objects: BTreeMap::new() });

/// Nothing panics while it holds the lock, so the table is whole in any case.
fn write<T>(work: impl FnOnce(&mut Table) -> T) -> T {
    work(&mut TABLE.write().unwrap_or_else(PoisonError::into_inner))
}

fn read<T>(work: impl FnOnce(&Table) -> T) -> T {
    work(&TABLE.read().unwrap_or_else(PoisonError::into_inner))
}

pub(crate) fn live() -> usize {
    read(|table| table.objects.len())
}

fn is_busy<T: Object>(any: &(dyn Any + Send + Sync)) -> bool {
    any.downcast_ref::<T>().is_some_and(T::is_busy)
}

/// Adds an object under a new name. On 32 bits they end after 10^9 objects; then it is NULL.
pub(crate) fn add<T: Object>(object: T) -> *mut T::Handle {
    let entry = Entry { any: Arc::new(object), is_busy: is_busy::<T> };
    write(|table| {
        let name = table.next;
        let Some(next) = name.checked_add(STRIDE) else { return ptr::null_mut() };
        table.next = next;
        table.objects.insert(name, entry);
        ptr::without_provenance_mut(name)
    })
}

/// The object of a handle. It lives on if the handle is freed meanwhile.
pub(crate) fn get<T: Object>(handle: *const T::Handle) -> Result<Arc<T>, Failure> {
    if handle.is_null() {
        return Err(Failure::new(NULL, T::NAME, "the handle is NULL; use one that a call has made"));
    }
    let any = read(|table| table.objects.get(&handle.addr()).map(|entry| Arc::clone(&entry.any)));
    any.and_then(|any| any.downcast().ok()).ok_or_else(unknown::<T>)
}

fn unknown<T: Object>() -> Failure {
    let message =
        format!("the handle was freed, never made, or is no {0}; use a {0} that is not freed", T::NAME);
    Failure::new(HANDLE, T::NAME, message)
}

/// Frees a handle; NULL is fine.
pub(crate) fn free<T: Object>(handle: *mut T::Handle) -> Result<(), Failure> {
    if handle.is_null() {
        return Ok(());
    }
    // A large object is dropped without the lock.
    let removed = write(|table| match table.objects.get(&handle.addr()) {
        Some(entry) if entry.any.is::<T>() => {
            if (entry.is_busy)(&*entry.any) {
                let message = format!("the {} is in use; free it when its call has returned", T::NAME);
                return Err(Failure::new(BUSY, T::NAME, message));
            }
            Ok(table.objects.remove(&handle.addr()))
        }
        _ => Err(unknown::<T>()),
    })?;
    drop(removed);
    Ok(())
}
