//! A device alone, clocked by its caller: by levels of the line, by bytes, by registers.

use crate::error::{ErrorHandle, guarded};
use crate::handle;
use crate::pointer::{self, Buffer};
use crate::run::{Edge, Summary};
use crate::scenario::{ScenarioHandle, StoredScenario};
use crate::status::{BUSY, Failure, ORDER, PANIC, RANGE, Status, checked};
use std::ffi::c_void;
use std::ptr;
use std::sync::{Mutex, TryLockError};
use stepscope_core::peripheral::signal::Sink;
use stepscope_core::prelude::Record;
use stepscope_core::sim::{ClockedDevice, ClockedDeviceError, ValidatedScenario};

/// A controller alone, clocked by its caller. One call at a time: a second one, also from its own callback, is
/// STEPSCOPE_BUSY.
pub struct DeviceHandle {
    _private: (),
}

/// Receives each edge in the cycle in which it happens, in the thread of the call. It must return: no longjmp, no exception.
pub type OnEdge = Option<unsafe extern "C" fn(context: *mut c_void, edge: Edge)>;

struct StoredDevice(Mutex<DeviceState>);

impl handle::Object for StoredDevice {
    type Handle = DeviceHandle;
    const NAME: &'static str = "device";

    fn is_busy(&self) -> bool {
        matches!(self.0.try_lock(), Err(TryLockError::WouldBlock))
    }
}

type DeviceState = ClockedDevice<Watcher>;

/// Passes edges to the caller's callback.
#[derive(Default)]
struct Watcher {
    on_edge: OnEdge,
    context: Context,
}

struct Context(*mut c_void);

impl Default for Context {
    fn default() -> Self {
        Self(ptr::null_mut())
    }
}

// SAFETY: the library never follows it. The caller's callback gets it in the thread that clocks the device, as the header
// states.
unsafe impl Send for Context {}

impl Sink for Watcher {
    fn record(&mut self, record: Record) {
        if let Some(on_edge) = self.on_edge {
            // SAFETY: the header asks for a function that can be called with the context until another one is set.
            unsafe { on_edge(self.context.0, Edge::new(record)) };
        }
    }
}

fn refused(error: ClockedDeviceError) -> Failure {
    let status = match error {
        ClockedDeviceError::NotRun => ORDER,
        ClockedDeviceError::Range { .. } => RANGE,
    };
    Failure::new(status, error.name(), error.to_string())
}

fn before_reset(scenario: &ValidatedScenario, controller: u32) -> Result<DeviceState, Failure> {
    let experiment = scenario.experiment().map_err(Failure::of)?;
    ClockedDevice::new(experiment, controller as usize, Watcher::default()).map_err(refused)
}

fn summary(device: &DeviceState) -> Summary {
    Summary {
        size: 0,
        controllers: 1,
        clock_hz: device.clock_hz(),
        channels: device.positions().len() as u32,
        cycles: device.cycles(),
        records: device.digest().records(),
        digest: device.digest().value(),
        ticks_done: device.ticks_done(),
        faults: device.faults().bits().into(),
        positions: Summary::all_positions(device.positions()),
    }
}

/// Calls `work` with the device, if no other call has it.
fn with<T>(
    handle: *const DeviceHandle,
    work: impl FnOnce(&mut DeviceState) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let device = handle::get::<StoredDevice>(handle)?;
    let mut state = device.0.try_lock().map_err(|error| match error {
        TryLockError::WouldBlock => Failure::new(BUSY, "device", "in use; use one device per thread"),
        TryLockError::Poisoned(_) => Failure::new(PANIC, "device", "unusable after a bug; make a new one"),
    })?;
    work(&mut state)
}

/// A device before cycle 0, with clock, bus and line of a controller of the scenario; its motion is not used. `scenario` NULL:
/// the defaults. `controller` counts from 0.
///
/// Returns STEPSCOPE_PROBLEMS (the scenario is refused), _RANGE (no such controller), _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_device_new(
    scenario: *const ScenarioHandle,
    controller: u32,
    out: *mut *mut DeviceHandle,
    error: *mut *mut ErrorHandle,
) -> Status {
    // SAFETY: the header asks for pointers that are NULL or valid.
    unsafe {
        guarded(error, || {
            pointer::put("out", out, ptr::null_mut())?;
            let state = if scenario.is_null() {
                before_reset(&ValidatedScenario::from_json("{}"), controller)?
            } else {
                before_reset(&handle::get::<StoredScenario>(scenario)?.0, controller)?
            };
            pointer::put("out", out, handle::add(StoredDevice(Mutex::new(state))))
        })
    }
}

/// Runs one cycle with the line at `line`, as others drive it; true is idle. In cycle 0, reset, the line counts as high.
/// Writes the levels of all signals in this cycle; `levels` may be NULL.
///
/// Returns STEPSCOPE_BUSY, _RANGE (the end of time, cycle 9*10^15), _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_device_clock(
    device: *mut DeviceHandle,
    line: bool,
    levels: *mut u64,
) -> Status {
    checked(|| {
        let found = with(device, |state| state.clock(line).map_err(refused))?.0;
        if levels.is_null() {
            return Ok(());
        }
        // SAFETY: not NULL, so the header asks for a valid pointer.
        unsafe { pointer::put("levels", levels, found) }
    })
}

/// Number of cycles without change while the line keeps its level; STEPSCOPE_NEVER if nothing can change any more.
///
/// Returns STEPSCOPE_BUSY, _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_device_cycles_until_event(
    device: *const DeviceHandle,
    cycles: *mut u64,
) -> Status {
    checked(|| {
        let until = with(device, |state| Ok(state.cycles_until_event()))?;
        // SAFETY: the header asks for NULL or a valid pointer.
        unsafe { pointer::put("cycles", cycles, until.map_or(u64::MAX, |cycles| cycles.0)) }
    })
}

/// Skips `cycles` cycles without change.
///
/// Returns STEPSCOPE_RANGE (more than stepscope_device_cycles_until_event(); nothing is done), _BUSY, _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_device_advance(device: *mut DeviceHandle, cycles: u64) -> Status {
    checked(|| with(device, |state| state.advance(cycles).map_err(refused)))
}

/// Runs until `cycle` is the next one, with the line at `line`; cycles without change are skipped.
///
/// Returns STEPSCOPE_RANGE (the cycle is past, or above 9*10^15), _BUSY, _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_device_run_until(device: *mut DeviceHandle, cycle: u64, line: bool) -> Status {
    checked(|| with(device, |state| state.run_until(cycle, line).map_err(refused)))
}

/// Sends bytes to the device, back to back at the bit rate of the scenario's line, from the next cycle on (at least cycle 1).
/// Runs to the end of the last stop bit.
///
/// Returns STEPSCOPE_RANGE (more bytes than time), _BUSY, _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_device_send(
    device: *mut DeviceHandle,
    bytes: *const u8,
    length: usize,
) -> Status {
    checked(|| {
        // SAFETY: the header asks for NULL, or for as many bytes.
        let bytes = unsafe { pointer::items("bytes", bytes, length)? };
        with(device, |state| state.send(bytes).map_err(refused))
    })
}

/// The oldest reply that was not received yet, with its closing 0x00; 600 bytes hold any. Runs on with an idle line until DE
/// falls. Where DE does not rise within `timeout_cycles`, `*count` is 0 and as many cycles have run; STEPSCOPE_NEVER waits
/// until nothing can change any more. 1024 replies are kept; then the oldest are dropped.
///
/// Returns STEPSCOPE_BUFFER (the reply is kept, for a larger buffer), _RANGE (the end of time), _BUSY, _NULL, _HANDLE.
/// `out` NULL with capacity 0 returns only the count, and keeps the reply.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_device_receive(
    device: *mut DeviceHandle,
    timeout_cycles: u64,
    out: *mut u8,
    capacity: usize,
    count: *mut usize,
) -> Status {
    checked(|| {
        // SAFETY: the header asks for pointers that are NULL or valid, `out` for `capacity` bytes.
        let buffer = unsafe { Buffer::new(out, capacity, count)? };
        with(device, |state| {
            let only_counts = buffer.only_counts();
            let reply = state.await_reply(Some(timeout_cycles)).map_err(refused)?;
            let Some(bytes) = reply else { return Ok(()) };
            buffer.fill(bytes.iter().copied())?;
            if !only_counts {
                state.take_reply();
            }
            Ok(())
        })
    })
}

/// Reads the register at a byte offset (STEPSCOPE_REG_) in the last cycle that was run, or as in reset. Where there is no
/// register the value is 0.
///
/// Returns STEPSCOPE_BUSY, _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_device_read(
    device: *const DeviceHandle,
    offset: u32,
    value: *mut u32,
) -> Status {
    checked(|| {
        let found = with(device, |state| Ok(state.read(offset)))?;
        // SAFETY: the header asks for NULL or a valid pointer.
        unsafe { pointer::put("value", value, found) }
    })
}

/// Writes the register at a byte offset (STEPSCOPE_REG_) in the last cycle that was run, after everything else in it. Where there is
/// no register, or a read-only one, nothing happens.
///
/// Returns STEPSCOPE_ORDER (the device has not run), _BUSY, _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_device_write(device: *mut DeviceHandle, offset: u32, value: u32) -> Status {
    checked(|| with(device, |state| state.write(offset, value).map_err(refused)))
}

/// The summary of the device so far.
///
/// Returns STEPSCOPE_RANGE (out->size), _BUSY, _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_device_summary(device: *const DeviceHandle, out: *mut Summary) -> Status {
    checked(|| {
        let summary = with(device, |state| Ok(summary(state)))?;
        // SAFETY: the header asks for NULL, or a struct of the size that it states.
        unsafe { pointer::put_sized("out", out, &summary) }
    })
}

/// Calls `on_edge` for each edge from now on; NULL stops it. `context` is its first argument. The call comes
/// in the thread that clocks the device.
///
/// Returns STEPSCOPE_BUSY, _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_device_watch(
    device: *mut DeviceHandle,
    on_edge: OnEdge,
    context: *mut c_void,
) -> Status {
    checked(|| {
        with(device, |state| {
            *state.sink_mut() = Watcher { on_edge, context: Context(context) };
            Ok(())
        })
    })
}

/// Frees a device. NULL is OK; a second time is STEPSCOPE_HANDLE; during a call of the device STEPSCOPE_BUSY.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_device_free(device: *mut DeviceHandle) -> Status {
    checked(|| handle::free::<StoredDevice>(device))
}
