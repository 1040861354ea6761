//! A device alone, clocked by its caller: by levels of the line, by bytes, by registers.

use crate::error::{ErrorHandle, guarded};
use crate::handle;
use crate::pointer::{self, Buffer};
use crate::run::{Edge, Summary};
use crate::scenario::{ScenarioHandle, StoredScenario};
use crate::status::{BUSY, Failure, ORDER, PANIC, RANGE, Status, checked};
use std::collections::VecDeque;
use std::ffi::c_void;
use std::ptr;
use std::sync::{Mutex, TryLockError};
use stepscope_core::peripheral::signal::{Event, Sink};
use stepscope_core::peripheral::wire::{BitTimes, Schedule, Sender};
use stepscope_core::prelude::{Device, Digest, Instant, Levels, Record};
use stepscope_core::scenario::END_OF_TIME;
use stepscope_core::sim::ValidatedScenario;

/// A controller alone, clocked by its caller. One call at a time: a second one, also from its own callback, is
/// STEPSCOPE_BUSY.
pub struct DeviceHandle {
    _private: (),
}

/// Receives each edge in the cycle in which it happens, in the thread of the call. It must return: no longjmp, no exception.
pub type OnEdge = Option<unsafe extern "C" fn(context: *mut c_void, edge: Edge)>;

/// Replies that wait to be received; then the oldest is dropped.
const MAX_REPLIES: usize = 1024;

struct StoredDevice(Mutex<DeviceState>);

impl handle::Object for StoredDevice {
    type Handle = DeviceHandle;
    const NAME: &'static str = "device";

    fn is_busy(&self) -> bool {
        matches!(self.0.try_lock(), Err(TryLockError::WouldBlock))
    }
}

struct DeviceState {
    device: Device,
    output: Output,
    clock_hz: u32,
    /// The host's bit rate.
    baud: u32,
}

/// What the device has sent: edges to the digest and the callback, replies to a queue.
#[derive(Default)]
struct Output {
    digest: Digest,
    on_edge: OnEdge,
    context: Context,
    replies: VecDeque<Reply>,
    /// A call waits for a reply, and the device pauses with the rise of DE.
    awaits_reply: bool,
    de: bool,
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

struct Reply {
    /// Cycle of DE's fall.
    end: Instant,
    bytes: Vec<u8>,
}

impl Sink for Output {
    fn record(&mut self, record: Record) {
        self.digest.record(record);
        self.de = record.levels.has(Levels::DE);
        if let Some(on_edge) = self.on_edge {
            // SAFETY: the header asks for a function that can be called with the context until another one is set.
            unsafe { on_edge(self.context.0, Edge::new(record)) };
        }
    }

    fn event(&mut self, _: Instant, event: Event) {
        if let Event::Reply { end, reply, positions, .. } = event {
            if self.replies.len() == MAX_REPLIES {
                self.replies.pop_front();
            }
            self.replies.push_back(Reply { end, bytes: reply.emit(positions.as_ref()) });
        }
    }

    fn is_paused(&self) -> bool {
        self.awaits_reply && self.de
    }
}

fn out_of_range(name: &str, given: u64, min: u64, max: u64) -> Failure {
    Failure::new(RANGE, name, format!("{given} is out of range; use {min} to {max}"))
}

impl DeviceState {
    fn new(scenario: &ValidatedScenario, controller: u32) -> Result<Self, Failure> {
        let experiment = scenario.experiment().map_err(Failure::of)?;
        let config = experiment.configs().nth(controller as usize).ok_or_else(|| {
            out_of_range("controller", controller.into(), 0, experiment.controllers() as u64 - 1)
        })?;
        let (clock_hz, baud) = (config.clock_hz(), experiment.baud());
        let device = Device::new(config);
        Ok(Self { device, output: Output::default(), clock_hz, baud })
    }

    /// Runs up to cycle `until`, which has been checked.
    fn run(&mut self, line: bool, until: Instant) {
        self.device.run(line, until, &mut self.output);
    }

    fn clock(&mut self, line: bool) -> Result<u64, Failure> {
        self.check_until("cycle", self.device.now().0.saturating_add(1))?;
        Ok(self.device.clock(line, &mut self.output).0)
    }

    /// Device time has an end, far behind that of any run.
    fn check_until(&self, name: &str, until: u64) -> Result<Instant, Failure> {
        let now = self.device.now().0;
        if (now..=END_OF_TIME).contains(&until) {
            return Ok(Instant(until));
        }
        Err(out_of_range(name, until, now, END_OF_TIME))
    }

    fn advance(&mut self, cycles: u64) -> Result<(), Failure> {
        let until = self.check_until("cycles", self.device.now().0.saturating_add(cycles))?;
        match self.device.cycles_until_event() {
            Some(max) if cycles > max.0 => Err(out_of_range("cycles", cycles, 0, max.0)),
            _ => {
                self.device.advance(until - self.device.now());
                Ok(())
            }
        }
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        if bytes.is_empty() {
            return Ok(());
        }
        let start = self.device.now().max(Instant(1));
        let length = BitTimes::new(self.clock_hz, self.baud).bytes(bytes.len() as u64);
        let end = self.check_until("length", start.0.saturating_add(length.0))?;
        let mut schedule = Schedule::default();
        schedule.push(start, bytes);
        let mut sender = Sender::new(schedule.into(), self.clock_hz, self.baud);
        while sender.next_edge() != Instant::NEVER {
            self.run(sender.level(), sender.next_edge());
            sender.pass();
        }
        self.run(sender.level(), end);
        Ok(())
    }

    /// Waits for the oldest reply and for its last stop bit; false if DE does not rise in time.
    fn await_reply(&mut self, timeout: u64) -> Result<bool, Failure> {
        let now = self.device.now();
        // Forever: until nothing can change any more, but not up to the end of time.
        let until = match timeout {
            u64::MAX => Instant::NEVER,
            _ => self.check_until("timeout_cycles", now.0.saturating_add(timeout))?,
        };
        if self.output.replies.front().is_some_and(|reply| reply.end < now) {
            return Ok(true); // it was sent before this call
        }
        if !self.output.de {
            self.output.awaits_reply = true;
            self.device.run(true, until, &mut self.output);
            self.output.awaits_reply = false;
        }
        let Some(end) = self.output.replies.front().filter(|_| self.output.de).map(|reply| reply.end) else {
            return Ok(false);
        };
        self.run(true, end.next());
        Ok(true)
    }

    fn summary(&self) -> Summary {
        Summary {
            size: 0,
            controllers: 1,
            clock_hz: self.clock_hz,
            channels: self.device.positions().len() as u32,
            cycles: self.device.now().0,
            records: self.output.digest.records(),
            digest: self.output.digest.value(),
            ticks_done: self.device.ticks_done(),
            faults: self.device.faults().bits().into(),
            positions: Summary::all_positions(self.device.positions()),
        }
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
                DeviceState::new(&ValidatedScenario::from_json("{}"), controller)?
            } else {
                DeviceState::new(&handle::get::<StoredScenario>(scenario)?.0, controller)?
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
        let found = with(device, |state| state.clock(line))?;
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
        let until = with(device, |state| Ok(state.device.cycles_until_event()))?;
        // SAFETY: the header asks for NULL or a valid pointer.
        unsafe { pointer::put("cycles", cycles, until.map_or(u64::MAX, |cycles| cycles.0)) }
    })
}

/// Skips `cycles` cycles without change.
///
/// Returns STEPSCOPE_RANGE (more than stepscope_device_cycles_until_event(); nothing is done), _BUSY, _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_device_advance(device: *mut DeviceHandle, cycles: u64) -> Status {
    checked(|| with(device, |state| state.advance(cycles)))
}

/// Runs until `cycle` is the next one, with the line at `line`; cycles without change are skipped.
///
/// Returns STEPSCOPE_RANGE (the cycle is past, or above 9*10^15), _BUSY, _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_device_run_until(device: *mut DeviceHandle, cycle: u64, line: bool) -> Status {
    checked(|| {
        with(device, |state| {
            let until = state.check_until("cycle", cycle)?;
            state.run(line, until);
            Ok(())
        })
    })
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
        with(device, |state| state.send(bytes))
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
            if !state.await_reply(timeout_cycles)? {
                return Ok(());
            }
            let only_counts = buffer.only_counts();
            let bytes = state.output.replies.front().map_or(&[][..], |reply| &reply.bytes);
            buffer.fill(bytes.iter().copied())?;
            if !only_counts {
                state.output.replies.pop_front();
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
        let found = with(device, |state| Ok(state.device.read(offset)))?;
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
    checked(|| {
        with(device, |state| {
            if state.device.now() == Instant::RESET {
                return Err(Failure::new(ORDER, "device", "no cycle has run; clock the device first"));
            }
            state.device.write(offset, value, &mut state.output);
            Ok(())
        })
    })
}

/// The summary of the device so far.
///
/// Returns STEPSCOPE_RANGE (out->size), _BUSY, _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_device_summary(device: *const DeviceHandle, out: *mut Summary) -> Status {
    checked(|| {
        let summary = with(device, |state| Ok(state.summary()))?;
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
            (state.output.on_edge, state.output.context) = (on_edge, Context(context));
            Ok(())
        })
    })
}

/// Frees a device. NULL is OK; a second time is STEPSCOPE_HANDLE; during a call of the device STEPSCOPE_BUSY.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_device_free(device: *mut DeviceHandle) -> Status {
    checked(|| handle::free::<StoredDevice>(device))
}
