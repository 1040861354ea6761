//! Completion of values in a shell: names of presets, recordings, drivers.
//!
//! The shell's script calls this program, which then prints candidates instead of running a command.

use crate::{failure::Failure, output, paths, scenarios};
use clap::Command;
use clap_complete::engine::{ArgValueCompleter, CompletionCandidate, PathCompleter, ValueCompleter};
use clap_complete::{CompleteEnv, Shell, env::Shells};
use std::{ffi::OsStr, io::Write, path::Path};
use stepscope_core::{capture::samples::SAMPLES, inspect::trace::drivers::DRIVERS};

/// Set by the shell's script.
const VARIABLE: &str = "STEPSCOPE_COMPLETE";

/// If a shell requests candidates, prints them and ends the program.
pub(crate) fn print_candidates(command: fn() -> Command) {
    CompleteEnv::with_factory(command).var(VARIABLE).complete();
}

pub(crate) fn write_script(shell: Shell, out: &Path) -> Result<(), Failure> {
    let mut text = Vec::new();
    let shells = Shells::builtins();
    let writer = shells.completer(&shell.to_string()).ok_or_else(|| {
        Failure::Option(format!(
            "{shell}: completions are not available; use bash, elvish, fish, powershell or zsh"
        ))
    })?;
    let name = "stepscope";
    writer.write_registration(VARIABLE, name, name, name, &mut text).map_err(Failure::output)?;
    output::write_new(out, |out| out.write_all(&text))
}

/// How a shell completes the value of this argument, if not as a path or one of its possible values.
pub(crate) fn completer(command: &str, id: &str) -> Option<ArgValueCompleter> {
    let is_read = paths::of(command).is_some_and(|paths| paths.read.contains(&id));
    match (command, id) {
        ("check", "file") => None,
        ("presets", "id") => Some(ArgValueCompleter::new(presets)),
        ("capture", "file") => Some(ArgValueCompleter::new(|given: &OsStr| files_and(given, samples(given)))),
        (_, "driver") => Some(ArgValueCompleter::new(|given: &OsStr| files_and(given, drivers(given)))),
        (_, "scenario" | "against" | "file") if is_read => {
            Some(ArgValueCompleter::new(|given: &OsStr| files_and(given, presets(given))))
        }
        _ => None,
    }
}

fn files_and(given: &OsStr, mut names: Vec<CompletionCandidate>) -> Vec<CompletionCandidate> {
    names.extend(PathCompleter::any().complete(given));
    names
}

fn candidates<'a>(given: &OsStr, names: impl Iterator<Item = (&'a str, String)>) -> Vec<CompletionCandidate> {
    let given = given.to_string_lossy();
    let matching = names.filter(|(name, _)| name.starts_with(&*given));
    matching.map(|(name, help)| CompletionCandidate::new(name).help(Some(help.into()))).collect()
}

fn presets(given: &OsStr) -> Vec<CompletionCandidate> {
    candidates(given, scenarios::all_presets().map(|preset| (preset.id, preset.scenario().title)))
}

fn samples(given: &OsStr) -> Vec<CompletionCandidate> {
    candidates(given, SAMPLES.iter().map(|sample| (sample.id, "included recording".to_owned())))
}

fn drivers(given: &OsStr) -> Vec<CompletionCandidate> {
    candidates(given, DRIVERS.iter().map(|sheet| (sheet.id, sheet.name.to_owned())))
}
