//! Scenarios: from JSON, a file, or a preset.

use crate::error::{ErrorHandle, guarded};
use crate::status::{FILE, Failure, RANGE, Status, UTF8, checked};
use crate::{handle, pointer};
use std::ffi::c_char;
use std::fs::File;
use std::io::Read;
use std::ptr;
use stepscope_core::scenario::{MAX_TEXT_BYTES, presets};
use stepscope_core::sim::ValidatedScenario;

/// What a handle names; see [`ScenarioHandle`].
pub(crate) struct StoredScenario(pub(crate) ValidatedScenario);

impl handle::Object for StoredScenario {
    type Handle = ScenarioHandle;
    const NAME: &'static str = "scenario";
}

/// A scenario: a motion, a host, a serial line, controllers. It never changes, and any number of threads may use it.
pub struct ScenarioHandle {
    _private: (),
}

/// Reads a scenario. A text that reads but breaks a rule is refused by the calls that use it, with all its problems.
fn from_text(text: &str) -> Result<ValidatedScenario, Failure> {
    let scenario = ValidatedScenario::from_json(text);
    match (scenario.unreadable(), scenario.experiment()) {
        (Some(_), Err(problems)) => Err(Failure::of(problems)),
        _ => Ok(scenario),
    }
}

/// Writes a new handle, or NULL.
///
/// # Safety
/// `out` is NULL or valid for a write, `error` NULL or valid for reads and writes.
unsafe fn made(
    out: *mut *mut ScenarioHandle,
    error: *mut *mut ErrorHandle,
    read: impl FnOnce() -> Result<ValidatedScenario, Failure>,
) -> Status {
    // SAFETY: as of this function.
    unsafe {
        guarded(error, || {
            pointer::put("out", out, ptr::null_mut())?;
            let scenario = read()?;
            pointer::put("out", out, handle::add(StoredScenario(scenario)))
        })
    }
}

/// Reads a scenario from JSON text of `length` bytes (STEPSCOPE_TO_ZERO: up to its closing 0). Every field has a default, so
/// "{}" is a scenario. Numbers that break a rule are reported by the calls that use the scenario.
///
/// Returns STEPSCOPE_PROBLEMS (not JSON, or a wrong name or type: the error lists all problems), _UTF8, _NULL, _RANGE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_scenario_from_json(
    json: *const c_char,
    length: usize,
    out: *mut *mut ScenarioHandle,
    error: *mut *mut ErrorHandle,
) -> Status {
    // SAFETY: the header asks for a text of this length, and for pointers that are NULL or valid.
    unsafe { made(out, error, || from_text(pointer::text("json", json, length)?)) }
}

/// Reads a scenario from a JSON file. `path` is UTF-8.
///
/// Returns as stepscope_scenario_from_json(), and STEPSCOPE_FILE (it cannot be read; the error has the reason).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_scenario_from_file(
    path: *const c_char,
    out: *mut *mut ScenarioHandle,
    error: *mut *mut ErrorHandle,
) -> Status {
    // SAFETY: the header asks for a text with a closing 0, and for pointers that are NULL or valid.
    unsafe { made(out, error, || from_text(&file_text(pointer::text("path", path, usize::MAX)?)?)) }
}

fn file_text(path: &str) -> Result<String, Failure> {
    let failed = |error: std::io::Error| {
        Failure::new(FILE, path, format!("cannot be read ({error}); use the path of a scenario's JSON file"))
    };
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(failed)?;
    file.take(MAX_TEXT_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() > MAX_TEXT_BYTES {
        let message = format!("the file is too long; use at most {MAX_TEXT_BYTES} bytes");
        return Err(Failure::new(FILE, path, message));
    }
    String::from_utf8(bytes).map_err(|_| Failure::new(UTF8, path, "not UTF-8 text; save it as UTF-8"))
}

/// The scenario of a preset, such as "song-2021-one-turn".
///
/// Returns STEPSCOPE_RANGE (no such preset: the error lists all names), _UTF8, _NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_scenario_from_preset(
    name: *const c_char,
    out: *mut *mut ScenarioHandle,
    error: *mut *mut ErrorHandle,
) -> Status {
    // SAFETY: the header asks for a text with a closing 0, and for pointers that are NULL or valid.
    unsafe {
        made(out, error, || {
            let name = pointer::text("name", name, usize::MAX)?;
            let preset = presets::find(name).map_err(|why| Failure::new(RANGE, "name", why))?;
            Ok(preset.scenario().into())
        })
    }
}

/// Frees a scenario; its runs and devices live on. NULL is OK; a second time is STEPSCOPE_HANDLE.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_scenario_free(scenario: *mut ScenarioHandle) -> Status {
    checked(|| handle::free::<StoredScenario>(scenario))
}
