//! The table of names. A handle is a number that looks like a pointer: it is looked up and never followed, so one that was
//! freed, invented or is of another kind is an error.

use crate::device::DeviceState;
use crate::error::Error;
use crate::run::StoredRun;
use crate::status::{BUSY, Failure, HANDLE, NULL};
use std::collections::BTreeMap;
use std::ptr;
use std::sync::{Arc, Mutex, PoisonError, RwLock, TryLockError};
use stepscope_core::sim::ValidatedScenario;

#[derive(Clone)]
pub(crate) enum Object {
    Scenario(Arc<ValidatedScenario>),
    Run(Arc<StoredRun>),
    Device(Arc<Mutex<DeviceState>>),
    Error(Arc<Error>),
}

/// A kind of object, and the type of its handles.
pub(crate) trait Kind: Sized {
    type Handle;
    const NAME: &'static str;
    fn object(self: Arc<Self>) -> Object;
    fn of(object: &Object) -> Option<&Arc<Self>>;
}

macro_rules! kinds {
    ($($variant:ident: $type:ty, $handle:ty, $name:literal;)*) => {$(
        impl Kind for $type {
            type Handle = $handle;
            const NAME: &'static str = $name;

            fn object(self: Arc<Self>) -> Object {
                Object::$variant(self)
            }

            fn of(object: &Object) -> Option<&Arc<Self>> {
                match object {
                    Object::$variant(found) => Some(found),
                    _ => None,
                }
            }
        }
    )*};
}

kinds! {
    Scenario: ValidatedScenario, crate::scenario::ScenarioHandle, "scenario";
    Run: StoredRun, crate::run::RunHandle, "run";
    Device: Mutex<DeviceState>, crate::device::DeviceHandle, "device";
    Error: Error, crate::error::ErrorHandle, "error";
}

/// The first name. On 64 bits no program has memory there, so a pointer to something else is never a name.
#[cfg(target_pointer_width = "64")]
const FIRST: usize = 0x5c0f_e000_0000_0001;
#[cfg(not(target_pointer_width = "64"))]
const FIRST: usize = 0x8000_0001;
/// Odd, so that no name is the address of an object.
const STRIDE: usize = 2;

struct Table {
    next: usize,
    objects: BTreeMap<usize, Object>,
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

/// Adds an object under a new name. On 32 bits they end after 10^9 objects; then it is NULL.
pub(crate) fn add<T: Kind>(object: T) -> *mut T::Handle {
    let object = Arc::new(object).object();
    write(|table| {
        let name = table.next;
        let Some(next) = name.checked_add(STRIDE) else { return ptr::null_mut() };
        table.next = next;
        table.objects.insert(name, object);
        ptr::without_provenance_mut(name)
    })
}

/// The object of a handle. It lives on if the handle is freed meanwhile.
pub(crate) fn get<T: Kind>(handle: *const T::Handle) -> Result<Arc<T>, Failure> {
    if handle.is_null() {
        return Err(Failure::new(NULL, T::NAME, "the handle is NULL; use one that a call has made"));
    }
    read(|table| table.objects.get(&handle.addr()).and_then(T::of).cloned()).ok_or_else(unknown::<T>)
}

fn unknown<T: Kind>() -> Failure {
    let message = format!("the handle was freed, never made, or is no {0}; use a {0} that is not freed", T::NAME);
    Failure::new(HANDLE, T::NAME, message)
}

/// Frees a handle; NULL is fine.
pub(crate) fn free<T: Kind>(handle: *mut T::Handle) -> Result<(), Failure> {
    if handle.is_null() {
        return Ok(());
    }
    // A large object is dropped without the lock.
    let removed = write(|table| {
        let object = table.objects.get(&handle.addr()).filter(|object| T::of(object).is_some());
        match object {
            None => Err(unknown::<T>()),
            Some(Object::Device(device)) if matches!(device.try_lock(), Err(TryLockError::WouldBlock)) => {
                Err(Failure::new(BUSY, T::NAME, "the device is in use; free it when its call has returned"))
            }
            Some(_) => Ok(table.objects.remove(&handle.addr())),
        }
    })?;
    drop(removed);
    Ok(())
}
