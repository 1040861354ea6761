//! Runs: every edge of a scenario, from reset to its end.

use crate::error::{ErrorHandle, guarded};
use crate::pointer::{self, Buffer, Sized32};
use crate::scenario::{ScenarioHandle, StoredScenario};
use crate::status::{FILE, Failure, ORDER, RANGE, STOPPED, Status, checked};
use crate::{handle, steps::Step};
use std::ffi::{c_char, c_void};
use std::fs::File;
use std::io::BufWriter;
use std::mem::offset_of;
use std::ops::ControlFlow;
use std::ptr;
use stepscope_core::inspect::export::vcd::VcdWriter;
use stepscope_core::peripheral::{signal::Sink, trace::steps_in};
use stepscope_core::prelude::{ControllerRun, FinishedRun, Record};
use stepscope_core::sim::run_watched;

/// A run that has ended. It never changes, and any number of threads may use it.
pub struct RunHandle {
    _private: (),
}

pub(crate) struct StoredRun {
    run: FinishedRun,
    has_edges: bool,
}

impl handle::Object for StoredRun {
    type Handle = RunHandle;
    const NAME: &'static str = "run";
}

/// An edge: the levels of all signals from a cycle on, as STEPSCOPE_LEVEL_ bits.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Edge {
    /// Cycles since reset.
    pub cycle: u64,
    /// Levels from this cycle on.
    pub levels: u64,
}

// A run's edges are the core's own records, without a copy.
const _: () = assert!(size_of::<Edge>() == size_of::<Record>() && align_of::<Edge>() == align_of::<Record>());
const _: () = assert!(offset_of!(Edge, cycle) == offset_of!(Record, cycle));
const _: () = assert!(offset_of!(Edge, levels) == offset_of!(Record, levels));

impl Edge {
    pub(crate) const fn new(record: Record) -> Self {
        Self { cycle: record.cycle.0, levels: record.levels.0 }
    }
}

/// Reports how many cycles a run has made: 0 at the start, then from time to time, and all of them at the end. false stops the run. It is
/// called in the thread of the run, and must return: no longjmp, no exception.
pub type Progress = Option<unsafe extern "C" fn(context: *mut c_void, cycles: u64) -> bool>;

/// Options of a run; initialize with STEPSCOPE_RUN_OPTIONS.
#[repr(C)]
pub struct RunOptions {
    /// sizeof(stepscope_run_options)
    pub size: u32,
    /// true: edges are stored, 16 bytes each, at most 48000000. false: only the summary; no limit.
    pub keep_edges: bool,
    /// NULL: none.
    pub progress: Progress,
    /// First argument of `progress`.
    pub context: *mut c_void,
}

/// As [`RunOptions`], for bytes that come from outside: each is valid.
#[repr(C)]
struct RawOptions {
    size: u32,
    keep_edges: u8,
    progress: Progress,
    context: *mut c_void,
}

const _: () = assert!(size_of::<RawOptions>() == size_of::<RunOptions>());
const _: () = assert!(offset_of!(RawOptions, keep_edges) == offset_of!(RunOptions, keep_edges));
const _: () = assert!(offset_of!(RawOptions, progress) == offset_of!(RunOptions, progress));

// SAFETY: plain old data of which every value is valid: a callback is NULL or an address. It begins with its size.
unsafe impl Sized32 for RawOptions {
    const MIN: usize = offset_of!(Self, context) + size_of::<*mut c_void>();
}

/// State of a controller at the end of a run, or of a device now; initialize with STEPSCOPE_SUMMARY.
#[repr(C)]
pub struct Summary {
    /// sizeof(stepscope_summary)
    pub size: u32,
    /// Controllers of the run, 1 to 32; 1 for a device.
    pub controllers: u32,
    /// Cycles per second.
    pub clock_hz: u32,
    /// Channels in use, 1 to 16.
    pub channels: u32,
    /// Cycles of the run; of a device, the next cycle.
    pub cycles: u64,
    /// Number of edges.
    pub records: u64,
    /// Digest of all edges; print it as 16 hexadecimal digits.
    pub digest: u64,
    /// Ticks that have ended.
    pub ticks_done: u32,
    /// Bits of the register FAULTS.
    pub faults: u32,
    /// Position of each channel in steps since reset, right positive; unused channels have 0.
    pub positions: [i32; 16],
}

// SAFETY: plain old data; it begins with its size.
unsafe impl Sized32 for Summary {
    const MIN: usize = offset_of!(Self, positions) + 16 * size_of::<i32>();
}

impl Summary {
    pub(crate) fn all_positions(used: &[i32]) -> [i32; 16] {
        let mut all = [0; 16];
        all.iter_mut().zip(used).for_each(|(to, from)| *to = *from);
        all
    }
}

impl StoredRun {
    fn controller(&self, controller: u32) -> Result<&ControllerRun, Failure> {
        let all = self.run.controllers();
        all.get(controller as usize).ok_or_else(|| {
            let allowed = match all.len().saturating_sub(1) {
                0 => "0".to_owned(),
                last => format!("0 to {last}"),
            };
            Failure::new(RANGE, "controller", format!("{controller} is out of range; use {allowed}"))
        })
    }

    fn trace(&self, controller: u32) -> Result<&[Record], Failure> {
        let run = self.controller(controller)?;
        if self.has_edges {
            return Ok(run.trace());
        }
        Err(Failure::new(ORDER, "run", "its edges were not stored; use options with keep_edges true"))
    }

    fn summary(&self, controller: u32) -> Result<Summary, Failure> {
        let run = self.controller(controller)?;
        let summary = self.run.summary();
        let own = summary.controllers.get(controller as usize);
        Ok(Summary {
            size: 0,
            controllers: self.run.controllers().len() as u32,
            clock_hz: summary.clock_hz,
            channels: own.map_or(0, |own| own.channels.into()),
            cycles: summary.cycles.0,
            records: own.map_or(0, |own| own.records),
            digest: run.digest(),
            ticks_done: run.ticks_done(),
            faults: run.faults().bits().into(),
            positions: Summary::all_positions(run.positions()),
        })
    }
}

/// Runs a scenario from reset to its end. `options` NULL: edges are stored, no progress.
///
/// Returns STEPSCOPE_PROBLEMS (the scenario is refused, has no end or too many edges), _STOPPED (by the callback), _RANGE
/// (options.size), _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_run_scenario(
    scenario: *const ScenarioHandle,
    options: *const RunOptions,
    out: *mut *mut RunHandle,
    error: *mut *mut ErrorHandle,
) -> Status {
    // SAFETY: the header asks for pointers that are NULL or valid, and for a callback that can be called with its context.
    unsafe {
        guarded(error, || {
            pointer::put("out", out, ptr::null_mut())?;
            let mut given = RawOptions { size: 0, keep_edges: 1, progress: None, context: ptr::null_mut() };
            if !options.is_null() {
                given = pointer::get_sized("options", options.cast(), given)?;
            }
            let scenario = handle::get::<StoredScenario>(scenario)?;
            let experiment = scenario.0.experiment().map_err(Failure::of)?;
            let has_edges = given.keep_edges != 0;
            let run = run_watched(experiment, has_edges, |cycles| match given.progress {
                Some(progress) if !progress(given.context, cycles.0) => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            });
            let run = run.map_err(|problems| Failure::of(&problems))?;
            let run = run.ok_or_else(|| {
                Failure::new(STOPPED, "", "the progress callback stopped the run; use true to go on")
            })?;
            pointer::put("out", out, handle::add(StoredRun { run, has_edges }))
        })
    }
}

/// The summary of a controller. `controller` counts from 0.
///
/// Returns STEPSCOPE_RANGE (no such controller, or out->size), _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_run_summary(
    run: *const RunHandle,
    controller: u32,
    out: *mut Summary,
) -> Status {
    checked(|| {
        let run = handle::get::<StoredRun>(run)?;
        // SAFETY: the header asks for NULL, or a struct of the size that it states.
        unsafe { pointer::put_sized("out", out, &run.summary(controller)?) }
    })
}

/// Every edge of a controller, without a copy: `*edges` is valid until the run is freed. The first is that of reset.
///
/// Returns STEPSCOPE_ORDER (they were not stored), _RANGE (no such controller), _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_run_edges(
    run: *const RunHandle,
    controller: u32,
    edges: *mut *const Edge,
    count: *mut usize,
) -> Status {
    checked(|| {
        // SAFETY: the header asks for pointers that are NULL or valid.
        unsafe {
            pointer::put("edges", edges, ptr::null())?;
            pointer::put("count", count, 0)?;
            let run = handle::get::<StoredRun>(run)?;
            let trace = run.trace(controller)?;
            // The table holds the run until it is freed, so the edges stay where they are.
            pointer::put("edges", edges, trace.as_ptr().cast())?;
            pointer::put("count", count, trace.len())
        }
    })
}

/// The steps of a channel, in cycles since reset. Writes at most `capacity` of them to `out`, and their number to `*count`.
/// `out` NULL with capacity 0 returns only the count. `controller` and `channel` count from 0; unused channels have none.
///
/// Returns STEPSCOPE_ORDER (edges were not stored), _RANGE (no such controller; channel above 15), _BUFFER (there are more
/// than `capacity`), _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_run_steps(
    run: *const RunHandle,
    controller: u32,
    channel: u32,
    out: *mut Step,
    capacity: usize,
    count: *mut usize,
) -> Status {
    checked(|| {
        // SAFETY: the header asks for pointers that are NULL or valid, `out` for `capacity` steps.
        unsafe {
            let buffer = Buffer::new(out, capacity, count)?;
            let run = handle::get::<StoredRun>(run)?;
            let trace = run.trace(controller)?;
            let channel = u8::try_from(channel).ok().filter(|channel| *channel < 16).ok_or_else(|| {
                Failure::new(RANGE, "channel", format!("{channel} is out of range; use 0 to 15"))
            })?;
            let mut position = 0_i32;
            buffer.fill(steps_in(trace, channel).map(|step| {
                let direction = step.position.wrapping_sub(position);
                position = step.position;
                Step::new(step.cycle, direction > 0)
            }))
        }
    })
}

/// Writes the signals of a controller as a Value Change Dump in ns, for GTKWave, Surfer and PulseView. `path` is UTF-8; a
/// file that is there is replaced.
///
/// Returns STEPSCOPE_FILE (it cannot be written; the error has the reason), _ORDER (edges were not stored), _RANGE (no such
/// controller), _UTF8, _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_run_write_vcd(
    run: *const RunHandle,
    controller: u32,
    path: *const c_char,
    error: *mut *mut ErrorHandle,
) -> Status {
    // SAFETY: the header asks for pointers that are NULL or valid, and for a text with a closing 0.
    unsafe {
        guarded(error, || {
            let path = pointer::text("path", path, usize::MAX)?;
            let run = handle::get::<StoredRun>(run)?;
            let (trace, summary) = (run.trace(controller)?, run.summary(controller)?);
            let write = || {
                let file = BufWriter::new(File::create(path)?);
                let mut writer = VcdWriter::new(file, summary.clock_hz, summary.channels as u8)?;
                trace.iter().for_each(|record| writer.record(*record));
                writer.finish(summary.cycles)
            };
            write().map_err(|error: std::io::Error| {
                let message = format!("cannot be written ({error}); use a path in a folder that is there");
                Failure::new(FILE, path, message)
            })
        })
    }
}

/// Frees a run, and with it its edges. NULL is OK; a second time is STEPSCOPE_HANDLE.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_run_free(run: *mut RunHandle) -> Status {
    checked(|| handle::free::<StoredRun>(run))
}
