//! The file arguments of all commands. Checks before a command starts that no output is an input or another output.

use crate::{
    failure::Failure,
    output::{Outputs, STANDARD},
};
use clap::ArgMatches;
use std::path::{Path, PathBuf};

/// A command and its arguments that are inputs, outputs, or neither.
pub(crate) struct Paths {
    pub(crate) command: &'static str,
    pub(crate) read: &'static [&'static str],
    pub(crate) written: &'static [&'static str],
    #[cfg_attr(not(test), expect(dead_code, reason = "a test finds arguments that nobody has classified"))]
    pub(crate) other: &'static [&'static str],
}

/// Every command with a path; a test fails if one is missing.
pub(crate) const PATHS: &[Paths] = &[
    // The driver's limits may be a file.
    of("run", &["scenario", "driver"], &["trace", "vcd", "csv", "packets", "panel", "line", "violations"]),
    // A device is opened, not created.
    Paths { other: &["port"], ..of("serve", &["scenario"], &["record", "pty"]) },
    Paths { other: &["port"], ..of("send", &["scenario"], &[]) },
    of("faults", &["file"], &[]),
    of("tables", &["scenario", "steps"], &["out"]),
    of("measures", &["scenario"], &[]),
    of("torque", &["scenario"], &["out"]),
    of("plant", &["scenario"], &["csv", "vcd"]),
    of("settling", &["scenario"], &["write"]),
    of("limits", &["scenario"], &[]),
    of("resonance", &["scenario"], &[]),
    of(
        "capture",
        &["file", "against", "driver"],
        &["late", "scenario", "steps", "bytes", "packets", "trace", "vcd", "csv", "violations"],
    ),
    of("powercut", &["scenario"], &[]),
    of("calibrate", &["table"], &[]),
    of("sine sweep", &[], &["out"]),
    of("sine best", &[], &["out"]),
    of("sine vertices", &[], &["out"]),
    of("sine segments", &["scenario"], &["out"]),
    of("points", &["table"], &[]),
    // A folder of files with fixed names.
    Paths { other: &["dir"], ..of("man", &[], &[]) },
];

const fn of(command: &'static str, read: &'static [&'static str], written: &'static [&'static str]) -> Paths {
    Paths { command, read, written, other: &[] }
}

/// Checks the paths of a command line.
///
/// # Errors
/// [`Failure::Output`] if an output is an input or another output, [`Failure::Option`] if two inputs are standard
/// input.
pub(crate) fn check(matches: &ArgMatches) -> Result<(), Failure> {
    let (mut name, mut inner) = (String::new(), matches);
    while let Some((command, arguments)) = inner.subcommand() {
        name = format!("{name} {command}");
        inner = arguments;
    }
    let Some(paths) = PATHS.iter().find(|paths| paths.command == name.trim_start()) else { return Ok(()) };
    let given = |ids: &'static [&'static str]| {
        ids.iter()
            .filter_map(|id| inner.try_get_many::<PathBuf>(id).ok().flatten())
            .flatten()
            .map(PathBuf::as_path)
    };
    if let Some(path) = given(&["pty", "dir"]).find(|path| *path == Path::new(STANDARD)) {
        let detail = "is standard output, but a link or a folder is needed; give its name";
        return Err(Failure::Output(path.to_owned(), detail));
    }
    if given(paths.read).filter(|path| *path == Path::new(STANDARD)).count() > 1 {
        let why = "-: standard input can be read once; give a file for all inputs but one";
        return Err(Failure::Option(why.to_owned()));
    }
    // JSON goes to standard output unless there is --out.
    let table = inner.try_get_one::<bool>("json").ok().flatten().is_some_and(|json| *json);
    let table = (table && !paths.written.contains(&"out")).then_some(Path::new(STANDARD));
    Outputs::judge(given(paths.read), given(paths.written).chain(table)).map(drop)
}
