//! The file arguments of all commands. Checks before a command starts that no output is an input or another output.

use crate::failure::Failure;
use crate::output::{Outputs, STANDARD};
use clap::ArgMatches;
use std::path::{Path, PathBuf};

pub(crate) struct Paths {
    pub(crate) command: &'static str,
    pub(crate) read: &'static [&'static str],
    pub(crate) written: &'static [&'static str],
    #[cfg_attr(not(test), expect(dead_code, reason = "a test finds arguments that are missing here"))]
    pub(crate) other: &'static [&'static str],
}

/// Every command with a path; a test fails if one is missing.
pub(crate) const PATHS: &[Paths] = &[
    row("run", &["scenario", "driver"], &["trace", "vcd", "csv", "packets", "panel", "line", "violations"]),
    // A device is opened, not created.
    Paths { other: &["port"], ..row("serve", &["scenario"], &["record", "pty"]) },
    Paths { other: &["port"], ..row("send", &["scenario"], &[]) },
    row("faults", &["file"], &["write_scenario"]),
    row("tables", &["scenario", "steps", "check"], &["out"]),
    row("measures", &["scenario"], &["out"]),
    row("steps", &["scenario"], &["out"]),
    row("curve", &["scenario"], &["out"]),
    row("spectrum", &["scenario"], &["out"]),
    row("torque", &["scenario"], &["out"]),
    row("plant", &["scenario"], &["csv", "vcd"]),
    row("settling", &["scenario"], &["write_scenario"]),
    row("limits", &["scenario"], &[]),
    row("resonance", &["scenario"], &["out"]),
    row(
        "capture",
        &["file", "against", "driver"],
        &["late", "write_scenario", "steps", "bytes", "packets", "trace", "vcd", "csv", "violations"],
    ),
    row("check", &["file"], &["junit", "summary"]),
    row("powercut", &["scenario"], &[]),
    row("calibrate", &["table"], &[]),
    row("sine sweep", &[], &["out"]),
    row("sine best", &[], &["out"]),
    row("sine vertices", &[], &["out"]),
    row("sine segments", &["scenario"], &["out"]),
    row("points", &["table"], &["out"]),
    row("open", &[], &["out"]),
    row("presets", &[], &["out"]),
    row("schema", &[], &["out"]),
    row("completions", &[], &["out"]),
    // A folder of files with fixed names.
    Paths { other: &["dir"], ..row("man", &[], &[]) },
];

const fn row(
    command: &'static str,
    read: &'static [&'static str],
    written: &'static [&'static str],
) -> Paths {
    Paths { command, read, written, other: &[] }
}

pub(crate) fn of(command: &str) -> Option<&'static Paths> {
    PATHS.iter().find(|paths| paths.command == command)
}

/// Errors: [`Failure::Option`] if an output is an input or another output, or if two inputs are standard input.
pub(crate) fn check(matches: &ArgMatches) -> Result<(), Failure> {
    let (mut name, mut inner) = (String::new(), matches);
    while let Some((command, arguments)) = inner.subcommand() {
        name = format!("{name} {command}");
        inner = arguments;
    }
    let Some(paths) = of(name.trim_start()) else { return Ok(()) };
    let given = |ids: &'static [&'static str]| {
        ids.iter().flat_map(|id| {
            let values = inner.try_get_many::<PathBuf>(id).ok().flatten();
            values.into_iter().flatten().map(|path| (*id, path.as_path()))
        })
    };
    let is_standard = |(_, path): &(&str, &Path)| *path == Path::new(STANDARD);
    if let Some((option, _)) = given(&["pty", "dir"]).find(is_standard) {
        let why = format!("--{option}: standard output is not a link or a folder; use the name of one");
        return Err(Failure::Option(why));
    }
    if given(paths.read).filter(is_standard).count() > 1 {
        let why = "-: standard input can be read only once; use files for the other inputs";
        return Err(Failure::Option(why.to_owned()));
    }
    // JSON goes to standard output unless there is --out.
    let table = inner.try_get_one::<bool>("json").ok().flatten().is_some_and(|json| *json);
    let table = (table && !paths.written.contains(&"out")).then_some(("json", Path::new(STANDARD)));
    Outputs::check(given(paths.read).map(|(_, path)| path), given(paths.written).chain(table)).map(drop)
}
