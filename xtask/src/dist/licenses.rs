//! The third-party crates of a program, with their licenses: as a page for the wasm, as text for a release.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use serde::Deserialize;
use tokio::process::Command;

use crate::toolchain::{self, WASM};
use crate::{root, run};

const PACKAGE: &str = "stepscope-wasm";

#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct ThirdPartyCrate {
    name: String,
    version: String,
    license: String,
    /// If the license offers a choice, only the texts of the shortest option.
    texts: Vec<String>,
}

pub(super) async fn page() -> Result<String> {
    let own = std::fs::read_to_string(root().join("LICENSE-MIT")).context("LICENSE-MIT can't be read")?;
    Ok(html(&third_party_crates(PACKAGE, WASM).await?, &own))
}

/// The crates of `package` for `target`, then each text with the crates that have it.
pub(crate) async fn text(package: &str, target: &str) -> Result<String> {
    let crates = third_party_crates(package, target).await?;
    let mut text = String::from("Third-party code in this program\n\n");
    for ThirdPartyCrate { name, version, license, .. } in &crates {
        let _ = writeln!(text, "{name} {version}: {license}");
    }
    text.push_str("The Rust standard library: MIT OR Apache-2.0\n");
    if target.contains("musl") {
        text.push_str("musl libc: MIT\n");
    }
    for (names, shared) in shared_texts(&crates) {
        let _ = write!(text, "\n{}\n{}\n\n{shared}\n", "-".repeat(72), names.join(", "));
    }
    Ok(text)
}

async fn third_party_crates(package: &str, target: &str) -> Result<Vec<ThirdPartyCrate>> {
    let mut tree = toolchain::cargo();
    tree.args(["tree", "--locked", "--package", package, "--target", target]);
    tree.args(["--edges", "normal,no-proc-macro", "--prefix", "none", "--format", "{p}"]);
    let mut metadata = toolchain::cargo();
    metadata.args(["metadata", "--locked", "--format-version", "1", "--filter-platform", target]);
    let (tree, metadata) = (cargo_output(tree).await?, cargo_output(metadata).await?);
    let wanted: BTreeSet<(&str, &str)> = tree.lines().filter_map(name_and_version).collect();

    #[derive(Deserialize)]
    struct Metadata {
        packages: Vec<Package>,
    }
    #[derive(Deserialize)]
    struct Package {
        name: String,
        version: String,
        license: Option<String>,
        manifest_path: PathBuf,
        source: Option<String>,
    }
    let metadata: Metadata = serde_json::from_str(&metadata).context("cargo metadata")?;
    let mut crates = Vec::new();
    for Package { name, version, license, manifest_path, source } in metadata.packages {
        if source.is_some() && wanted.contains(&(&name, &version)) {
            let license = license.with_context(|| format!("{name} {version} has no license"))?;
            let folder = manifest_path.parent().with_context(|| format!("{name} has no folder"))?;
            let texts =
                texts(folder, &license).with_context(|| format!("the license of {name} {version}"))?;
            crates.push(ThirdPartyCrate { name, version, license, texts });
        }
    }
    ensure!(!crates.is_empty(), "cargo tree lists no third-party crate in {package}");
    crates.sort();
    Ok(crates)
}

async fn cargo_output(command: Command) -> Result<String> {
    run::output(command).await.context("cargo does not list the crates of the program")
}

fn name_and_version(line: &str) -> Option<(&str, &str)> {
    let mut words = line.split_whitespace();
    Some((words.next()?, words.next()?.strip_prefix('v')?))
}

/// The texts of the licenses in a crate's folder; only MIT's if the license offers it as a choice.
fn texts(folder: &Path, license: &str) -> Result<Vec<String>> {
    let mut files: Vec<String> = std::fs::read_dir(folder)?
        .flatten()
        .filter(|entry| entry.path().is_file())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    files.retain(|name| {
        let name = name.to_uppercase();
        ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "UNLICENSE"]
            .iter()
            .any(|start| name.starts_with(start))
    });
    files.sort();
    let mut texts = Vec::new();
    for file in chosen(&files, license) {
        let text = std::fs::read_to_string(folder.join(file)).with_context(|| file.to_owned())?;
        let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
        texts.push(lines.join("\n").trim_matches('\n').to_owned());
    }
    Ok(texts)
}

fn chosen<'a>(files: &'a [String], license: &str) -> Vec<&'a str> {
    let has = |file: &str, word: &str| file.to_uppercase().contains(word);
    let has_mit = files.iter().any(|file| has(file, "MIT")) && license.contains("MIT");
    let is_chosen = |file: &&str| match (has_mit, license.contains(" AND ")) {
        (false, _) => true,
        (true, false) => has(file, "MIT"),
        (true, true) => !has(file, "APACHE"),
    };
    files.iter().map(String::as_str).filter(is_chosen).collect()
}

fn html(crates: &[ThirdPartyCrate], own: &str) -> String {
    let mut page = String::from(HEAD);
    let _ = write!(page, "<pre>{}</pre>\n<h2>Third-party crates</h2>\n<ul>\n", escaped(own.trim()));
    for ThirdPartyCrate { name, version, license, .. } in crates {
        let _ = writeln!(page, "<li>{} {}: {}</li>", escaped(name), escaped(version), escaped(license));
    }
    page.push_str("<li>The Rust standard library: MIT OR Apache-2.0</li>\n</ul>\n");
    for (names, text) in shared_texts(crates) {
        let _ = writeln!(page, "<h3>{}</h3>\n<pre>{}</pre>", escaped(&names.join(", ")), escaped(text));
    }
    page.push_str("</body>\n</html>\n");
    page
}

/// Each text once, with the names of its crates.
fn shared_texts(crates: &[ThirdPartyCrate]) -> Vec<(Vec<&str>, &str)> {
    let mut shared: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for one in crates {
        for text in &one.texts {
            shared.entry(text).or_default().push(&one.name);
        }
    }
    let mut shared: Vec<(Vec<&str>, &str)> = shared.into_iter().map(|(text, names)| (names, text)).collect();
    shared.sort();
    shared
}

const HEAD: &str = "<!doctype html>
<html lang=\"en\">
<head>
<meta charset=\"utf-8\">
<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; base-uri 'none'; form-action 'none'\">
<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">
<meta name=\"referrer\" content=\"no-referrer\">
<meta name=\"color-scheme\" content=\"light dark\">
<title>Licenses – Stepscope</title>
<link rel=\"icon\" href=\"data:,\">
</head>
<body>
<p><a href=\"./\">Back to Stepscope</a></p>
<h1>Licenses</h1>
<p>Stepscope is licensed under MIT or Apache-2.0, at your choice.</p>
";

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mit_is_shown_where_it_is_a_choice_and_else_all_licenses() {
        for (files, license, expected) in [
            (vec!["LICENSE-APACHE", "LICENSE-MIT"], "MIT OR Apache-2.0", vec!["LICENSE-MIT"]),
            (vec!["LICENSE"], "MIT", vec!["LICENSE"]),
            (
                vec!["LICENSE-APACHE", "LICENSE-MIT", "LICENSE-UNICODE"],
                "(MIT OR Apache-2.0) AND Unicode-3.0",
                vec!["LICENSE-MIT", "LICENSE-UNICODE"],
            ),
            (vec!["COPYING", "LICENSE-BSD"], "0BSD", vec!["COPYING", "LICENSE-BSD"]),
        ] {
            let files: Vec<String> = files.into_iter().map(str::to_owned).collect();
            assert_eq!(chosen(&files, license), expected, "{license}");
        }
    }

    #[test]
    fn crates_with_the_same_license_text_share_it() {
        let with_text = |name: &str, text: &str| ThirdPartyCrate {
            name: name.to_owned(),
            version: "1.0.0".to_owned(),
            license: "MIT".to_owned(),
            texts: vec![text.to_owned()],
        };
        let crates = [with_text("a", "one <b>"), with_text("b", "two"), with_text("c", "one <b>")];
        let page = html(&crates, "own & all");
        assert_eq!(page.matches("one &lt;b&gt;").count(), 1, "{page}");
        assert!(page.contains("<h3>a, c</h3>") && page.contains("<h3>b</h3>"), "{page}");
        assert!(page.contains("<li>b 1.0.0: MIT</li>") && page.contains("own &amp; all"), "{page}");
    }

    #[tokio::test]
    async fn third_party_crates_of_the_wasm_are_found_with_their_texts() {
        let crates = third_party_crates(PACKAGE, WASM).await.unwrap();
        let rustfft = crates.iter().find(|one| one.name == "rustfft").unwrap();
        assert!(rustfft.license.contains("MIT") && !rustfft.texts.is_empty(), "{rustfft:?}");
        assert!(crates.iter().all(|one| !one.name.starts_with("stepscope") && one.name != "serde_derive"));
    }
}
