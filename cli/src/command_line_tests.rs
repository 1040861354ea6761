//! Tests that every option of every command is classified: its paths in `paths.rs`, its numbers in `quantity.rs`.

use crate::{
    failure::Failure,
    paths::{PATHS, check},
};
use clap::Command;
use std::{any::TypeId, collections::BTreeSet, fs, path::PathBuf};

/// Command lines with every path of their commands, each as `{NAME}`.
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

fn commands(command: &Command, name: &str, found: &mut Vec<(String, Command)>) {
    if !command.has_subcommands() {
        found.push((name.trim_start().to_owned(), command.clone()));
    }
    command
        .get_subcommands()
        .for_each(|inner| commands(inner, &format!("{name} {}", inner.get_name()), found));
}

/// Arguments with a path type, or named as files in the help.
fn paths_of(command: &Command) -> BTreeSet<String> {
    const NAMES: [&str; 5] = ["FILE", "FOLDER", "TABLE", "DEVICE", "PORT"];
    let is_path = |argument: &&clap::Arg| {
        let named =
            argument.get_value_names().unwrap_or_default().iter().any(|name| NAMES.contains(&name.as_str()));
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
        let known = paths.map(|paths| [paths.read, paths.written, paths.other].concat()).unwrap_or_default();
        let known: BTreeSet<String> = known.into_iter().map(str::to_owned).collect();
        assert_eq!(paths_of(&command), known, "{name}: classify its paths in cli/src/paths.rs");
    }
}

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
                    assert!(matches!(found, Err(Failure::Output(..))), "{template}: {written} over {read}");
                }
                for other in paths.written.iter().filter(|other| *other != written) {
                    let found = judged(line(template, file, Some((written, file(other)))));
                    assert!(matches!(found, Err(Failure::Output(..))), "{template}: {written} over {other}");
                }
            }
        }
        let is_tried = LINES.iter().any(|line| line.starts_with(paths.command));
        assert!(is_tried || paths.written.is_empty(), "{}", paths.command);
        let tried: String = LINES.iter().filter(|line| line.starts_with(paths.command)).copied().collect();
        let mut names = paths.read.iter().chain(paths.written);
        assert!(!is_tried || names.all(|name| tried.contains(&format!("{{{name}}}"))), "{tried}");
    }
    let twice = ["stepscope", "capture", "-", "--against", "-"].map(str::to_owned).to_vec();
    assert!(matches!(judged(twice), Err(Failure::Option(_))));
}

/// A new numeric option needs a type of quantity.rs.
#[test]
fn every_option_of_a_number_refuses_what_is_none() {
    let mut all = Vec::new();
    commands(&crate::command_line(), "", &mut all);
    let mut tried = 0;
    for (name, command) in all {
        for argument in command.get_opts() {
            let parsed = argument.get_value_parser().type_id();
            let is_text = parsed == TypeId::of::<PathBuf>() || parsed == TypeId::of::<String>();
            if is_text || !argument.get_action().takes_values() {
                continue;
            }
            let option = argument.get_long().expect("every option has a long name");
            for given in ["-1", "NaN", "-nan", "inf", "-inf", "1e999", "", "99999999999999999999999999"] {
                let option = format!("--{option}={given}");
                let words = ["stepscope"].into_iter().chain(name.split(' ')).chain([option.as_str()]);
                let error = crate::command_line().try_get_matches_from(words).expect_err(&option);
                let error = error.to_string();
                // clap itself refuses an empty one.
                let is_told = ["use ", "give ", "possible values", "lists them"];
                assert!(
                    error.contains(&format!("--{}", argument.get_long().unwrap_or_default()))
                        && (given.is_empty() || error.contains(given))
                        && (given.is_empty() || is_told.iter().any(|told| error.contains(told))),
                    "{name} {option}: {error}"
                );
            }
            tried += 1;
        }
    }
    assert!(tried >= 50, "{tried}");
}
