//! Tests that every option of every command is classified: its paths in `paths.rs`, its numbers in `quantity.rs`.

use crate::{
    failure::Failure,
    help::PAGES,
    paths::{PATHS, check},
};
use clap::Command;
use std::{any::TypeId, collections::BTreeSet, fs, path::PathBuf};

/// Command lines with every path of their commands, each as `{NAME}`.
const LINES: &[&str] = &[
    "run {scenario} --driver {driver} --trace {trace} --vcd {vcd} --csv {csv} --packets {packets} --panel {panel} --line {line} --violations {violations}",
    "serve {scenario} --record {record} --pty {pty}",
    "faults {file} --seed 1 --write-scenario {write_scenario}",
    "tables {scenario} --steps {steps} --check {check} --out {out}",
    "measures {scenario} --out {out}",
    "steps {scenario} --out {out}",
    "curve {scenario} --out {out}",
    "spectrum {scenario} --out {out}",
    "torque {scenario} --out {out}",
    "plant {scenario} --csv {csv} --vcd {vcd}",
    "settling {scenario} --write-scenario {write_scenario}",
    "limits {scenario}",
    "resonance {scenario} --out {out}",
    "capture {file} --against {against} --driver {driver} --late {late} --write-scenario {write_scenario} --steps {steps} --bytes {bytes} --packets {packets} --trace {trace} --vcd {vcd} --csv {csv} --violations {violations}",
    "check {file} --junit {junit} --summary {summary}",
    "powercut {scenario}",
    "calibrate {table}",
    "sine sweep --out {out}",
    "sine best --out {out}",
    "sine vertices --segments 3 --out {out}",
    "sine segments {scenario} --out {out}",
    "points {table} --out {out}",
    "open link --out {out}",
    "presets --out {out}",
    "schema --out {out}",
    "completions bash --out {out}",
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
fn no_output_may_be_an_input_or_another_output() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name).display().to_string();
    let checked =
        |words: Vec<String>| check(&crate::command_line().try_get_matches_from(words).expect("a line"));
    for paths in PATHS {
        let templates = LINES.iter().filter(|line| line.starts_with(paths.command));
        for template in templates {
            for name in paths.read {
                fs::write(file(name), "input").expect("a file");
            }
            checked(line(template, file, None)).expect("each has its own file");
            for written in paths.written {
                for read in paths.read {
                    let found = checked(line(template, file, Some((written, file(read)))));
                    assert!(matches!(found, Err(Failure::Option(_))), "{template}: {written} over {read}");
                }
                for other in paths.written.iter().filter(|other| *other != written) {
                    let found = checked(line(template, file, Some((written, file(other)))));
                    assert!(matches!(found, Err(Failure::Option(_))), "{template}: {written} over {other}");
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
    assert!(matches!(checked(twice), Err(Failure::Option(_))));
}

/// A new numeric option needs a type of quantity.rs.
#[test]
fn every_number_option_rejects_invalid_numbers() {
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
                let allowed = ["use ", "give ", "possible values", "lists the reserved names"];
                assert!(
                    error.contains(&format!("--{}", argument.get_long().unwrap_or_default()))
                        && (given.is_empty() || error.contains(given))
                        && (given.is_empty() || allowed.iter().any(|allowed| error.contains(allowed))),
                    "{name} {option}: {error}"
                );
            }
            tried += 1;
        }
    }
    assert!(tried >= 50, "{tried}");
}

/// One line in sentence case without a full stop; details are in the long help.
fn is_one_line(text: &str) -> bool {
    let first = text.chars().next().unwrap_or(' ');
    !text.contains('\n') && !text.ends_with('.') && (first.is_uppercase() || first == '`')
}

#[test]
fn every_help_page_has_groups_exit_codes_and_examples() {
    let mut all = vec![(String::new(), crate::command_line())];
    commands(&crate::command_line(), "", &mut all);
    all.extend(
        crate::command_line().get_subcommands().map(|inner| (inner.get_name().to_owned(), inner.clone())),
    );
    for (name, command) in all {
        let about = command.get_about().map(ToString::to_string).unwrap_or_default();
        assert!(is_one_line(&about) && about.len() <= 80, "{name}: {about}");
        for argument in command.get_arguments().filter(|argument| !argument.is_hide_set()) {
            let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
            assert!(is_one_line(&help) && help.len() <= 100, "{name} {}: {help}", argument.get_id());
            let is_option = argument.get_long().is_some();
            assert!(!is_option || argument.get_help_heading().is_some(), "{name} {}", argument.get_id());
        }
        let page = PAGES.iter().find(|page| page.command == name).expect(&name);
        let ending = command.get_after_help().map(ToString::to_string).unwrap_or_default();
        assert!(ending.starts_with("Exit codes:\n  0    success"), "{name}: {ending}");
        let examples = format!("\n\nExamples:\n  {}\n  {}", page.examples[0], page.examples[1]);
        assert!(ending.ends_with(&examples), "{name}: {ending}");
        assert!(
            page.examples.iter().all(|line| line.contains(format!("stepscope {name}").trim_end())),
            "{name}"
        );
    }
}

#[test]
fn former_names_of_options_work_and_are_hidden() {
    let rows: &[(&str, &str)] = &[
        ("plant x --drive a4988", "--motor-driver"),
        ("settling x --drive a4988", "--motor-driver"),
        ("limits x --drive a4988", "--motor-driver"),
        ("resonance x --drive a4988", "--motor-driver"),
        ("resonance x --rung 5", "--step"),
        ("settling x --write y", "--write-scenario"),
        ("capture x --scenario y --of-steps --error-us 5", "--write-scenario"),
        ("faults --seed 1 --scenario", "--write-scenario"),
        ("serve x --tcp 127.0.0.1:0 --open", "--allow-remote"),
    ];
    for (line, name) in rows {
        let words: Vec<&str> = std::iter::once("stepscope").chain(line.split(' ')).collect();
        assert!(crate::command_line().try_get_matches_from(&words).is_ok(), "{line}");
        let former =
            words.iter().find(|word| ["--drive", "--rung", "--write", "--scenario", "--open"].contains(word));
        let mut help = crate::command_line();
        let inner = help.find_subcommand_mut(words[1]).expect(line);
        let help = inner.render_long_help().to_string();
        let is_shown =
            |name: &str| help.split_whitespace().any(|word| word.trim_end_matches([',', ';']) == name);
        assert!(is_shown(name) && !is_shown(former.expect(line)), "{line}: {help}");
    }
}
