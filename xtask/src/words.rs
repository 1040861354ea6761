//! Finds words in texts for users that have a better replacement: `words.txt` lists both.
//!
//! Checked texts are Markdown files, the page's HTML and scripts, presets, string literals of the shipped crates, and the
//! command's doc comments, which are its help.

use std::path::Path;
use std::str::FromStr;

use anyhow::{Context, Result, bail, ensure};
use proc_macro2::{TokenStream, TokenTree};
use walkdir::WalkDir;

use crate::root;

const WORDS: &str = include_str!("words.txt");
const ARROW: &str = " => ";
const FOLDERS: [&str; 7] = ["bindings/c/src", "cli/src", "core", "docs", "firmware", "wasm/src", "web"];
/// Built from sources that are checked.
const EXCEPT: [&str; 2] = ["web/pkg", "web/pkg-recordings"];

struct Rule {
    word: String,
    replacement: &'static str,
}

/// A text and the number of its first line.
type Part = (usize, String);

pub(crate) fn check() -> Result<()> {
    let rules = rules(WORDS)?;
    let mut found = Vec::new();
    let files = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md"].map(|file| root().join(file));
    for file in files.into_iter().chain(all_files()?) {
        let name = file.strip_prefix(root()).unwrap_or(&file).to_string_lossy().into_owned();
        let text = || std::fs::read_to_string(&file).with_context(|| format!("{name} can't be read"));
        for (line, text) in parts(&name, text)? {
            for (line, rule) in matches(&rules, line, &text) {
                found.push(format!("{name}:{line}: \"{}\": write \"{}\"", rule.word, rule.replacement));
            }
        }
    }
    ensure!(found.is_empty(), "words with a better replacement (xtask/src/words.txt):\n{}", found.join("\n"));
    Ok(())
}

fn all_files() -> Result<Vec<std::path::PathBuf>> {
    let mut files = Vec::new();
    for folder in FOLDERS {
        let entries = WalkDir::new(root().join(folder)).sort_by_file_name().into_iter();
        let wanted = |path: &Path| !EXCEPT.iter().any(|except| path.starts_with(root().join(except)));
        for entry in entries.filter_entry(|entry| wanted(entry.path())) {
            let entry = entry.with_context(|| format!("{folder} can't be read"))?;
            if entry.file_type().is_file() {
                files.push(entry.into_path());
            }
        }
    }
    Ok(files)
}

fn rules(list: &'static str) -> Result<Vec<Rule>> {
    let lines = list.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines
        .map(|line| {
            let Some((word, replacement)) = line.split_once(ARROW) else {
                bail!("xtask/src/words.txt: write `word{ARROW}replacement`, not {line:?}");
            };
            Ok(Rule { word: word.to_lowercase(), replacement })
        })
        .collect()
}

/// The texts of a file that users read.
fn parts(name: &str, text: impl FnOnce() -> Result<String>) -> Result<Vec<Part>> {
    let is_test = ["/tests/", "/tests.rs", "_tests.rs", "/examples/"].iter().any(|part| name.contains(part));
    match name.rsplit_once('.').map(|(_, extension)| extension) {
        Some("md" | "html") => Ok(vec![(1, text()?)]),
        Some("json") if name.contains("/presets/") => Ok(vec![(1, text()?)]),
        Some("js") => {
            let comment =
                |line: &str| ["//", "*", "/*"].iter().any(|mark| line.trim_start().starts_with(mark));
            Ok(vec![(
                1,
                text()?
                    .lines()
                    .map(|line| if comment(line) { "" } else { line })
                    .collect::<Vec<_>>()
                    .join("\n"),
            )])
        }
        Some("rs") if !is_test => {
            let Ok(tokens) = TokenStream::from_str(&text()?) else { bail!("{name} is not Rust source") };
            let mut found = Vec::new();
            literals(tokens, name.starts_with("cli/"), &mut found);
            Ok(found)
        }
        _ => Ok(Vec::new()),
    }
}

/// Collects string literals, and doc comments if `docs`.
fn literals(tokens: TokenStream, docs: bool, found: &mut Vec<Part>) {
    let mut is_doc = false;
    for token in tokens {
        match token {
            TokenTree::Group(group) => literals(group.stream(), docs, found),
            TokenTree::Ident(ident) => is_doc = ident == "doc",
            TokenTree::Literal(literal) => {
                let text = literal.to_string();
                if text.contains('"') && (docs || !is_doc) {
                    // A backslash at a line's end joins the lines.
                    found.push((literal.span().start().line, text.replace("\\\n", "\n")));
                }
                is_doc = false;
            }
            TokenTree::Punct(_) => {}
        }
    }
}

/// Each match of a rule with its line. A word at a line's end may continue in the next line.
fn matches<'r>(rules: &'r [Rule], first: usize, text: &str) -> Vec<(usize, &'r Rule)> {
    let (mut flat, mut starts) = (String::new(), Vec::new());
    for line in text.lines() {
        starts.push(flat.len());
        flat.push_str(&line.trim().to_lowercase());
        flat.push(' ');
    }
    let ends = |next: Option<char>| next.is_none_or(|c| !c.is_alphanumeric() && c != '_');
    let mut found = Vec::new();
    for rule in rules {
        for (at, word) in flat.match_indices(&rule.word) {
            let (before, after) = (flat[..at].chars().next_back(), flat[at + word.len()..].chars().next());
            if ends(before) && ends(after) {
                found.push((first + starts.partition_point(|start| *start <= at) - 1, rule));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIST: &str = "# comment\nsteps a second => steps per second\nbeside => next to\n";

    fn found(name: &str, text: &str) -> Vec<(usize, String)> {
        let rules = rules(LIST).unwrap();
        let parts = parts(name, || Ok(text.to_owned())).unwrap();
        let found = parts.iter().flat_map(|(line, text)| matches(&rules, *line, text));
        found.map(|(line, rule)| (line, rule.replacement.to_owned())).collect()
    }

    #[test]
    fn words_are_found_with_their_line_and_replacement() {
        let steps = |line| vec![(line, "steps per second".to_owned())];
        let none = Vec::new();
        for (name, text, expected) in [
            ("docs/a.md", "one\nSteps a second.", steps(2)),
            ("docs/a.md", "one\nsteps a\n  second", steps(2)),
            ("docs/a.md", "besides, steps a seconds", none.clone()),
            ("web/a.js", "// steps a second\nx(\"steps a second\");", steps(2)),
            (
                "core/a/src/b.rs",
                "/// beside\n// beside\nfn beside() { f(\"a\\\n steps a second\") }",
                steps(4),
            ),
            ("cli/src/a.rs", "/// Beside\nstruct A;", vec![(1, "next to".to_owned())]),
            ("core/a/src/tests.rs", "f(\"beside\")", none.clone()),
            ("core/scenario/presets/a.json", "\"beside\"", vec![(1, "next to".to_owned())]),
            ("web/a.png", "beside", none),
        ] {
            assert_eq!(found(name, text), expected, "{name}: {text}");
        }
    }

    #[test]
    fn all_texts_of_the_project_pass() {
        check().unwrap();
    }

    #[test]
    fn a_line_without_a_replacement_is_refused() {
        assert!(rules("beside\n").is_err());
        assert!(rules(WORDS).unwrap().len() > 20);
    }
}
