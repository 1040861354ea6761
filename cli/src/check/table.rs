//! A table of a project, exported again with the command in its head.

use std::ffi::OsString;
use stepscope_core::inspect::export::source_code::unquoted;

const MADE_BY: &str = "Made by stepscope ";
/// A head comes with its file, so that no other option, such as one that writes a file, is passed on.
const OPTIONS: [&str; 10] = [
    "--steps",
    "--axis",
    "--form",
    "--error-us",
    "--interval-part",
    "--window",
    "--search",
    "--entries",
    "--format",
    "--name",
];

/// The arguments that export a table again; `run` replaces the scenario in its head.
///
/// # Errors
/// Why there are none.
pub(super) fn arguments(table: &str, run: Option<&str>) -> Result<Vec<OsString>, String> {
    let command = table.lines().find_map(|line| made_by(line)?.strip_prefix("stepscope tables "));
    let command = command
        .ok_or("the table has no line with its command; write it with stepscope tables of this version")?;
    let unreadable = || "the command of the table can't be read; export the table again".to_owned();
    let mut words = unquoted(command).ok_or_else(unreadable)?.into_iter().peekable();
    let mut scenario = words.next_if(|word| !word.starts_with(b"--"));
    let mut arguments: Vec<OsString> = vec!["tables".into(), "--out=-".into()];
    while let Some(option) = words.next() {
        let Some(option) = OPTIONS.into_iter().find(|allowed| allowed.as_bytes() == option) else {
            let (given, allowed) = (String::from_utf8_lossy(&option), OPTIONS.join(", "));
            return Err(format!("the command of the table has {given}; use only {allowed}"));
        };
        if option == "--steps" && run.is_some() {
            return Err("run: the table was made with --steps, not from a scenario; omit run".to_owned());
        }
        // One word, so that no value is taken for an option.
        let mut argument = OsString::from(format!("{option}="));
        argument.push(words.next().and_then(os_string).ok_or_else(unreadable)?);
        arguments.push(argument);
    }
    if let Some(run) = run {
        scenario = Some(run.as_bytes().to_vec());
    }
    match &scenario {
        Some(path) if path == b"-" => {
            Err("the table was made from standard input; add run, or export the table from a file".to_owned())
        }
        Some(path) if path.starts_with(b"-") => Err(unreadable()),
        _ => {
            arguments.extend(scenario.and_then(os_string));
            Ok(arguments)
        }
    }
}

#[cfg(unix)]
fn os_string(word: Vec<u8>) -> Option<OsString> {
    Some(std::os::unix::ffi::OsStringExt::from_vec(word))
}

#[cfg(not(unix))]
fn os_string(word: Vec<u8>) -> Option<OsString> {
    String::from_utf8(word).ok().map(OsString::from)
}

/// The command in a line of a head.
fn made_by(line: &str) -> Option<&str> {
    Some(without_comment(line).strip_prefix(MADE_BY)?.split_once(": ")?.1)
}

fn without_comment(line: &str) -> &str {
    line.trim_start_matches([' ', '*', '/'])
}

/// What is compared of a line: not the version, and with another scenario (`is_other`) not where it is from.
fn compared(line: &str, is_other: bool) -> &str {
    match made_by(line) {
        Some(_) if is_other => MADE_BY,
        Some(command) => command,
        None if is_other && without_comment(line).starts_with("Scenario ") => "Scenario ",
        None => line,
    }
}

/// From 1; line ends of another system are the same. `is_other`: `expected` was made from another scenario.
pub(super) fn first_different_line(expected: &str, found: &str, is_other: bool) -> Option<usize> {
    let lines = |text| str::lines(text).map(move |line| compared(line, is_other));
    let (mut expected, mut found) = (lines(expected), lines(found));
    (1..).find_map(|line| match (expected.next(), found.next()) {
        (None, None) => Some(None),
        (expected, found) if expected != found => Some(Some(line)),
        _ => None,
    })?
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(command: &str) -> String {
        format!(
            "/* turn: 3200 steps.\n * Made by stepscope 0.1.9: stepscope tables {command}\n * Scenario x */\n"
        )
    }

    #[test]
    fn only_options_of_a_head_are_passed_on() {
        let head = r"$'a\'s \057.json' --axis all --form compressed --error-us 25 --name turn";
        let options =
            ["tables", "--out=-", "--axis=all", "--form=compressed", "--error-us=25", "--name=turn"];
        let expected = |scenario: &str| -> Result<Vec<OsString>, String> {
            Ok(options.iter().chain([&scenario]).map(OsString::from).collect())
        };
        assert_eq!(arguments(&table(head), None), expected("a's /.json"));
        assert_eq!(arguments(&table(head), Some("b c.json")), expected("b c.json"));
        let list = ["tables", "--out=-", "--steps=a b.csv"].map(OsString::from).to_vec();
        assert_eq!(arguments(&table("--steps 'a b.csv'"), None), Ok(list));
        assert_eq!(arguments(&table("- --form exact"), Some("a.json")).map(|words| words.len()), Ok(4));
        for (command, run, expected) in [
            ("a.json --out=b", None, "the command of the table has --out=b; use only --steps, --axis, "),
            ("a.json -ob", None, "the command of the table has -ob; use only "),
            ("a.json --out b", None, "the command of the table has --out; use only "),
            ("a.json --with-walker", None, "the command of the table has --with-walker; use only "),
            ("a.json b.json", None, "the command of the table has b.json; use only "),
            ("-ob --form exact", None, "the command of the table can't be read; "),
            ("a.json --form", None, "the command of the table can't be read; "),
            ("a.json; rm b", None, "the command of the table can't be read; "),
            ("- --form exact", None, "the table was made from standard input; add run"),
            ("--steps a.csv", Some("a.json"), "run: the table was made with --steps, "),
            ("a.json --steps a.csv", Some("a.json"), "run: the table was made with --steps, "),
        ] {
            let found = arguments(&table(command), run).expect_err(command);
            assert!(found.starts_with(expected), "{command}: {found}");
        }
        // A value is no option, whatever it is.
        let words = arguments(&table("a.json --name --out=b"), None).expect("arguments");
        assert!(words.contains(&OsString::from("--name=--out=b")), "{words:?}");
        for other in ["cycle,dir\n1,1\n", " * Made by stepscope 0.2.0: the page, form exact\n"] {
            let why = "the table has no line with its command; ";
            assert!(arguments(other, None).expect_err(other).starts_with(why));
        }
    }

    #[test]
    fn lines_are_compared_without_their_ends_and_versions() {
        let made = |version: &str, path: &str| {
            format!(
                " * Made by stepscope {version}: stepscope tables {path}\n * Scenario {path}, CRC-32 1. */\n1\n"
            )
        };
        for (expected, found, lines) in [
            ("a\nb\n", "a\r\nb\r\n", [None, None]),
            ("a\nb\n", "a\nc\n", [Some(2), Some(2)]),
            ("a\n", "a\nb\n", [Some(2), Some(2)]),
            ("", "", [None, None]),
            (made("0.2.0", "a").as_str(), made("0.1.9", "a").as_str(), [None, None]),
            (made("0.2.0", "a").as_str(), made("0.2.0", "b").as_str(), [Some(1), None]),
            (
                made("0.2.0", "a").as_str(),
                made("0.2.0", "b").replace("\n1", "\n2").as_str(),
                [Some(1), Some(3)],
            ),
        ] {
            let line = |is_other| first_different_line(expected, found, is_other);
            assert_eq!([line(false), line(true)], lines, "{expected:?} {found:?}");
        }
    }
}
