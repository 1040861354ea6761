//! Runs the commands of README.md and docs/, page by page, each in an empty folder with a copy of docs/samples.
//!
//! | block | meaning |
//! | --- | --- |
//! | `sh` | runs; a comment `# exit code N` states the exit code of its line |
//! | `sh no-run: REASON` | does not run |
//! | `text output` | lines of the output of the block before it, in this order |
//! | `json scenario` | runs without problems |

use crate::program::stepscope;
use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

/// Every block needs one of these: `rustdoc` would compile one without a language as Rust.
const LANGUAGES: [&str; 9] = ["sh", "text", "json", "rust", "python", "toml", "c", "cpp", "cmake"];
const EXIT_CODE: &str = "# exit code ";

#[derive(Debug, PartialEq)]
struct Block<'t> {
    /// The number of its first line, from 1.
    line: usize,
    language: &'t str,
    /// What follows the language.
    note: &'t str,
    text: String,
}

fn blocks(page: &str) -> Vec<Block<'_>> {
    let mut found: Vec<Block> = Vec::new();
    let mut open = false;
    for (index, line) in page.lines().enumerate() {
        match (line.trim_start().strip_prefix("```"), open) {
            (Some(info), false) => {
                let (language, note) = info.split_once(' ').unwrap_or((info, ""));
                found.push(Block { line: index + 2, language, note, text: String::new() });
                open = true;
            }
            (Some(_), true) => open = false,
            (None, true) => {
                let text = &mut found.last_mut().expect("an open block").text;
                text.push_str(line);
                text.push('\n');
            }
            (None, false) => {}
        }
    }
    found
}

/// The shell script of a page's blocks. The output of each block goes to a file with the number of its line.
fn script(blocks: &[Block], outputs: &Path) -> String {
    let mut script = "set -eu -o pipefail\n".to_owned();
    for block in blocks.iter().filter(|block| block.language == "sh" && block.note.is_empty()) {
        script.push_str(&format!(
            "echo line {} >&2\nexec > '{}/{}'\n",
            block.line,
            outputs.display(),
            block.line
        ));
        for line in block.text.lines() {
            match line.split_once(EXIT_CODE) {
                // An expected failure in a list of commands does not end the shell.
                Some((command, code)) => {
                    script.push_str(&format!("{command} && exit 99 || [ $? -eq {} ]\n", code.trim()));
                }
                None => script.push_str(&format!("{line}\n")),
            }
        }
    }
    script
}

fn copy_samples(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("docs/samples") {
        let file = entry.expect("an entry").path();
        fs::copy(&file, to.join(file.file_name().expect("a name"))).expect("a copy");
    }
}

/// The problems of one page, in an empty folder.
fn check(name: &str, page: &str, root: &Path) -> Vec<String> {
    let blocks = blocks(page);
    let mut problems = Vec::new();
    for block in &blocks {
        let Block { line, language, note, .. } = block;
        let known = match *language {
            "sh" => note.is_empty() || note.strip_prefix("no-run: ").is_some_and(|reason| !reason.is_empty()),
            "text" => ["", "output"].contains(note),
            "json" => ["", "scenario"].contains(note),
            other => note.is_empty() && LANGUAGES.contains(&other),
        };
        if !known {
            problems.push(format!("{name}:{line}: a block can't be `{language} {note}`"));
        }
    }
    let home = Path::new(env!("CARGO_TARGET_TMPDIR")).join("documents").join(name.replace('/', "-"));
    let _ = fs::remove_dir_all(&home);
    let outputs = home.with_extension("out");
    fs::create_dir_all(&outputs).expect("a folder");
    copy_samples(&root.join("docs/samples"), &home.join("docs/samples"));
    let folder = Path::new(env!("CARGO_BIN_EXE_stepscope")).parent().expect("its folder").to_owned();
    let path =
        env::join_paths([folder].into_iter().chain(env::split_paths(&env::var_os("PATH").expect("PATH"))));
    let ran = Command::new("bash")
        .args(["-c", &script(&blocks, &outputs)])
        .current_dir(&home)
        .env("PATH", path.expect("a path"))
        .env("HOME", &home)
        .stdin(Stdio::null())
        .output()
        .expect("bash");
    if !ran.status.success() {
        let errors = String::from_utf8_lossy(&ran.stderr);
        let code = ran.status.code();
        problems.push(format!("{name}: ends with {code:?}; the last line names the block\n{errors}"));
        return problems;
    }
    for pair in blocks.windows(2).filter(|pair| pair[1].note == "output") {
        let output = fs::read_to_string(outputs.join(pair[0].line.to_string())).unwrap_or_default();
        let mut lines = output.lines();
        for expected in pair[1].text.lines() {
            if !lines.any(|line| line == expected) {
                problems.push(format!("{name}:{}: not in the output: {expected}\n{output}", pair[1].line));
            }
        }
    }
    for block in blocks.iter().filter(|block| block.note == "scenario") {
        let (code, _, errors) = stepscope(&["run", "-"], &block.text);
        if code != Some(0) {
            problems.push(format!("{name}:{}: {errors}", block.line));
        }
    }
    problems
}

fn pages(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            pages(&path, into);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            into.push(path);
        }
    }
}

#[test]
fn every_command_of_the_documentation_runs_as_printed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the workspace");
    let mut files = vec![root.join("README.md")];
    pages(&root.join("docs"), &mut files);
    files.sort();
    let mut problems = Vec::new();
    let mut commands = 0;
    for file in files {
        let page = fs::read_to_string(&file).expect("a page");
        let name = file.strip_prefix(&root).expect("in the workspace").to_string_lossy().into_owned();
        commands +=
            blocks(&page).iter().filter(|block| block.language == "sh" && block.note.is_empty()).count();
        problems.extend(check(&name, &page, &root));
    }
    assert!(commands > 40, "only {commands} blocks were found");
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn a_page_with_a_failing_command_is_reported() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for (page, expected) in [
        ("```sh\nstepscope presets\n```\n", ""),
        ("```sh\nstepscope run none.json    # exit code 2\n```\n", "ends with Some(1)"),
        ("```sh\nstepscope run none.json\n```\n", "ends with Some(1)"),
        ("```sh\nstepscope run docs/samples/turn.json    # exit code 3\n```\n", "ends with Some(99)"),
        ("```sh\necho one; echo two\n```\n```text output\ntwo\n```\n", ""),
        ("```sh\necho one; echo two\n```\n```text output\ntwo\none\n```\n", "not in the output: one"),
        ("```json scenario\n{ \"clock\": 1 }\n```\n", "clock"),
        ("```\nno language\n```\n", "a block can't be"),
        ("```sh no-run\nfalse\n```\n", "a block can't be"),
        ("```sh no-run: needs a port\nfalse\n```\n", ""),
    ] {
        let found = check("own.md", page, &root).join("\n");
        assert!(
            if expected.is_empty() { found.is_empty() } else { found.contains(expected) },
            "{page}\n{found}"
        );
    }
}
