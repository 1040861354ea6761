//! The files of the command line: which of them a command reads, and which it writes. No command overwrites what it reads,
//! or writes a file twice; that is checked here, for all commands at once, before one begins.

use crate::{
    failure::Failure,
    output::{Outputs, STANDARD},
};
use clap::ArgMatches;
use std::path::{Path, PathBuf};

/// A command, the arguments that it reads files from, those that it writes files to, and paths that are neither.
struct Paths {
    command: &'static str,
    read: &'static [&'static str],
    written: &'static [&'static str],
    #[cfg_attr(not(test), expect(dead_code, reason = "a test finds arguments that nobody has classified"))]
    other: &'static [&'static str],
}

/// Every command that takes a path. A test walks all commands and fails at a path that is missing here.
const PATHS: &[Paths] = &[
    // A driver's limits may be a file.
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
    // A folder for files with names of their own.
    Paths { other: &["dir"], ..of("man", &[], &[]) },
];

const fn of(command: &'static str, read: &'static [&'static str], written: &'static [&'static str]) -> Paths {
    Paths { command, read, written, other: &[] }
}

/// Checks the paths of a command line.
///
/// # Errors
/// [`Failure::Output`] if an output is an input or another output, and [`Failure::Option`] if two inputs are standard input.
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
    if given(paths.read).filter(|path| *path == Path::new(STANDARD)).count() > 1 {
        let why = "-: standard input can be read once; give a file for all inputs but one";
        return Err(Failure::Option(why.to_owned()));
    }
    // A table as JSON goes to standard output, but where --out says where.
    let table = inner.try_get_one::<bool>("json").ok().flatten().is_some_and(|json| *json);
    let table = (table && !paths.written.contains(&"out")).then_some(Path::new(STANDARD));
    Outputs::judge(given(paths.read), given(paths.written).chain(table)).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Command;
    use std::{any::TypeId, collections::BTreeSet, fs};

    /// Command lines that together have every path of their command, each as NAME of a file of its own: `{NAME}`.
    const LINES: &[&str] = &[
        "run {scenario} --driver {driver} --trace {trace} --vcd {vcd} --csv {csv} --packets {packets} --panel {panel} --line {line} --violations {violations}",
        "serve {scenario} --record {record} --pty {pty}",
        "faults {file}",
        "tables {scenario} --steps {steps} --out {out}",
        "measures {scenario}",
        "torque {scenario} --out {out}",
        "plant {scenario} --csv {csv} --vcd {vcd}",
        "settling {scenario} --write {write}",
        "limits {scenario}",
        "resonance {scenario}",
        "capture {file} --against {against} --driver {driver} --late {late} --scenario {scenario} --steps {steps} --bytes {bytes} --packets {packets} --trace {trace} --vcd {vcd} --csv {csv} --violations {violations}",
        "powercut {scenario}",
        "calibrate {table}",
        "sine sweep --out {out}",
        "sine best --out {out}",
        "sine vertices --segments 3 --out {out}",
        "sine segments {scenario} --out {out}",
        "points {table}",
    ];

    /// Every command without commands of its own, and its name.
    fn commands(command: &Command, name: &str, found: &mut Vec<(String, Command)>) {
        if !command.has_subcommands() {
            found.push((name.trim_start().to_owned(), command.clone()));
        }
        command
            .get_subcommands()
            .for_each(|inner| commands(inner, &format!("{name} {}", inner.get_name()), found));
    }

    /// Arguments that are paths by their type, or files by their name in the help.
    fn paths_of(command: &Command) -> BTreeSet<String> {
        const NAMES: [&str; 5] = ["FILE", "FOLDER", "TABLE", "DEVICE", "PORT"];
        let is_path = |argument: &&clap::Arg| {
            let named = argument
                .get_value_names()
                .unwrap_or_default()
                .iter()
                .any(|name| NAMES.contains(&name.as_str()));
            argument.get_value_parser().type_id() == TypeId::of::<PathBuf>() || named
        };
        command.get_arguments().filter(is_path).map(|argument| argument.get_id().to_string()).collect()
    }

    #[test]
    fn every_path_of_every_command_is_classified() {
        let mut all = Vec::new();
        commands(&crate::command_line(), "", &mut all);
        assert!(all.len() >= 20, "{}", all.len());
        for (name, command) in all {
            let paths = PATHS.iter().find(|paths| paths.command == name);
            let known =
                paths.map(|paths| [paths.read, paths.written, paths.other].concat()).unwrap_or_default();
            let known: BTreeSet<String> = known.into_iter().map(str::to_owned).collect();
            assert_eq!(paths_of(&command), known, "{name}: classify its paths in cli/src/paths.rs");
        }
    }

    /// The command line, with `file` of each name but where `instead` says otherwise.
    fn line(template: &str, file: impl Fn(&str) -> String, instead: Option<(&str, String)>) -> Vec<String> {
        let word = |word: &str| match word.strip_prefix('{').and_then(|word| word.strip_suffix('}')) {
            None => word.to_owned(),
            Some(name) => match &instead {
                Some((other, path)) if *other == name => path.clone(),
                _ => file(name),
            },
        };
        std::iter::once("stepscope".to_owned()).chain(template.split(' ').map(word)).collect()
    }

    #[test]
    fn no_output_of_any_command_may_be_one_of_its_inputs_or_another_output() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = |name: &str| folder.path().join(name).display().to_string();
        let judged =
            |words: Vec<String>| check(&crate::command_line().try_get_matches_from(words).expect("a line"));
        for paths in PATHS {
            let templates = LINES.iter().filter(|line| line.starts_with(paths.command));
            for template in templates {
                for name in paths.read {
                    fs::write(file(name), "input").expect("a file");
                }
                judged(line(template, file, None)).expect("each has a file of its own");
                for written in paths.written {
                    for read in paths.read {
                        let found = judged(line(template, file, Some((written, file(read)))));
                        assert!(
                            matches!(found, Err(Failure::Output(..))),
                            "{template}: {written} over {read}"
                        );
                    }
                    for other in paths.written.iter().filter(|other| *other != written) {
                        let found = judged(line(template, file, Some((written, file(other)))));
                        assert!(
                            matches!(found, Err(Failure::Output(..))),
                            "{template}: {written} over {other}"
                        );
                    }
                }
            }
            let is_tried = LINES.iter().any(|line| line.starts_with(paths.command));
            assert!(is_tried || paths.written.is_empty(), "{}", paths.command);
            let tried: String =
                LINES.iter().filter(|line| line.starts_with(paths.command)).copied().collect();
            let mut names = paths.read.iter().chain(paths.written);
            assert!(!is_tried || names.all(|name| tried.contains(&format!("{{{name}}}"))), "{tried}");
        }
        let twice = ["stepscope", "capture", "-", "--against", "-"].map(str::to_owned).to_vec();
        assert!(matches!(judged(twice), Err(Failure::Option(_))));
    }
}
