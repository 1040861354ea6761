//! `stepscope check`: recordings, runs and tables of a project, checked as in CI.
//!
//! ```text
//! stepscope-checks.json -> one run of stepscope per check, in the folder of that file -> lines, JUnit, Markdown
//! ```

mod entry;
mod report;
mod table;

use crate::failure::{Failure, INTERRUPTED};
use crate::output::{Outputs, STANDARD};
use crate::{scenarios, terminal};
use clap::Args;
use entry::{Entry, Kind};
use report::{CheckResult, Outcome, Results};
use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Instant;

/// Number of Ctrl-C's signal; POSIX names it.
const SIGINT: i32 = 2;

#[derive(Args)]
pub(crate) struct Arguments {
    /// List of checks (format: docs/command.md); `-` reads standard input
    ///
    /// Paths in the list are relative to its folder.
    #[arg(default_value = "stepscope-checks.json")]
    file: PathBuf,
    /// Write the results as JUnit XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Write the results as a Markdown table
    #[arg(long, value_name = "FILE")]
    summary: Option<PathBuf>,
}

/// `command` is the whole command line, which validates the options of each check.
pub(crate) fn check(arguments: &Arguments, mut command: clap::Command) -> Result<(), Failure> {
    let entries = entry::read(&arguments.file, &scenarios::text(&arguments.file)?, &mut command)?;
    let mut outputs = Outputs::default();
    let mut create = |path: &Option<PathBuf>| path.as_ref().map(|path| outputs.create(path)).transpose();
    let (junit, summary) = (create(&arguments.junit)?, create(&arguments.summary)?);
    let is_report_printed =
        [&arguments.junit, &arguments.summary].into_iter().flatten().any(|path| path == Path::new(STANDARD));
    let folder = match arguments.file.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let mut results = Results::default();
    for entry in &entries {
        let start = Instant::now();
        let outcome = outcome_of(entry, folder)?;
        let result = CheckResult { entry, outcome, seconds: start.elapsed().as_secs_f64() };
        if !is_report_printed {
            writeln!(terminal::out(), "{result}").map_err(Failure::output)?;
        }
        results.add(result);
    }
    for (path, out, write) in [
        (&arguments.junit, junit, report::write_junit as report::Writer),
        (&arguments.summary, summary, report::write_markdown as report::Writer),
    ] {
        if let (Some(path), Some(mut out)) = (path, out) {
            let written = write(&results, &mut out).and_then(|()| out.flush());
            written.map_err(|error| Failure::File(path.clone(), error))?;
        }
    }
    outputs.commit()?;
    if !is_report_printed {
        writeln!(terminal::out(), "{results}").map_err(Failure::output)?;
    }
    results.failure().map_or(Ok(()), Err)
}

/// What a call of the command printed.
#[derive(Debug)]
struct Called {
    code: i32,
    out: String,
    err: String,
}

/// Calls this program itself: a check is what its user can call by hand.
fn call(folder: &Path, words: &[impl AsRef<OsStr>]) -> Result<Called, Failure> {
    let failed = |error| Failure::File(PathBuf::from("stepscope"), error);
    let program = std::env::current_exe().map_err(failed)?;
    let mut command = Command::new(program);
    command.args(words).current_dir(folder).stdin(Stdio::null());
    called(command.output().map_err(failed)?)
}

/// Only Ctrl-C ends the list; a call that crashed is an error of its check.
fn called(Output { status, stdout, stderr }: Output) -> Result<Called, Failure> {
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    let (out, mut err) = (text(stdout), text(stderr));
    #[cfg(unix)]
    let signal = std::os::unix::process::ExitStatusExt::signal(&status);
    #[cfg(not(unix))]
    let signal: Option<i32> = None;
    if status.code() == Some(INTERRUPTED.into()) || signal == Some(SIGINT) {
        return Err(Failure::Interrupted);
    }
    if let Some(signal) = signal {
        err += &format!("\nended by signal {signal}");
    }
    Ok(Called { code: status.code().unwrap_or(1), out, err })
}

fn outcome_of(entry: &Entry, folder: &Path) -> Result<Outcome, Failure> {
    Ok(match &entry.kind {
        Kind::Capture { against, .. } => {
            let is_strict = entry.driver.is_some() || has_driver(folder, against);
            let called = call(folder, &entry.capture_words(is_strict))?;
            Outcome::of_code(called.code, &called.err)
        }
        Kind::Run { scenario, digest } => {
            let is_strict = entry.driver.is_some() || has_driver(folder, scenario);
            let called = call(folder, &entry.run_words(is_strict))?;
            let found = called.out.lines().next().unwrap_or_default();
            match digest {
                Some(expected) if called.code == 0 && found != expected => {
                    Outcome::Failed(format!("the digest is {found}, not {expected}"))
                }
                _ => Outcome::of_code(called.code, &called.err),
            }
        }
        Kind::Table { table, run } => table_again(folder, table, run.as_deref())?,
    })
}

/// A scenario that cannot be read is reported by its check.
fn has_driver(folder: &Path, scenario: &str) -> bool {
    let beside = folder.join(scenario);
    let path = if beside.exists() { beside } else { PathBuf::from(scenario) };
    scenarios::read(&path).is_ok_and(|scenario| scenario.driver_timing.is_some())
}

/// Exports a table again with the command in its head; compares both.
fn table_again(folder: &Path, table: &str, run: Option<&str>) -> Result<Outcome, Failure> {
    let stored = match scenarios::text(&folder.join(table)) {
        Ok(stored) => stored,
        Err(failure @ Failure::File(..)) => return Ok(Outcome::Error(1, failure.to_string())),
        Err(failure) => return Ok(Outcome::Error(2, failure.to_string())),
    };
    let arguments = match table::arguments(&stored, run) {
        Ok(arguments) => arguments,
        Err(why) => return Ok(Outcome::Error(2, why)),
    };
    let called = call(folder, &arguments)?;
    if called.code != 0 {
        return Ok(Outcome::of_code(called.code, &called.err));
    }
    Ok(match table::first_different_line(&called.out, &stored, run.is_some()) {
        None => Outcome::Passed,
        Some(line) => Outcome::Failed(format!(
            "line {line} differs from the command's current output; export the table again"
        )),
    })
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::process::ExitStatusExt;
    use std::process::ExitStatus;

    #[test]
    fn a_crash_is_an_error_of_its_check_and_ctrl_c_ends_all() {
        let ended = |raw| {
            let status = ExitStatus::from_raw(raw);
            called(Output { status, stdout: Vec::new(), stderr: b"it panicked\n".to_vec() })
        };
        for signal in [6, 9, 15] {
            let Called { code, err, .. } = ended(signal).expect("a result");
            let Outcome::Error(1, why) = Outcome::of_code(code, &err) else { panic!("{code}: {err}") };
            assert_eq!(why, format!("it panicked; ended by signal {signal}"));
        }
        assert!(matches!(ended(2), Err(Failure::Interrupted)));
        assert!(matches!(ended(130 << 8), Err(Failure::Interrupted)));
        assert_eq!(ended(3 << 8).expect("a result").code, 3);
    }
}
