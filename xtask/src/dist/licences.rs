//! The page that lists the other authors' crates in the wasm, with their licenses.

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
struct Part {
    name: String,
    version: String,
    licence: String,
    /// If the license offers a choice, only the texts of the shortest option.
    texts: Vec<String>,
}

pub(super) async fn page() -> Result<String> {
    let own = std::fs::read_to_string(root().join("LICENSE-MIT")).context("LICENSE-MIT can't be read")?;
    Ok(print(&parts().await?, &own))
}

async fn parts() -> Result<Vec<Part>> {
    let mut tree = toolchain::cargo();
    tree.args(["tree", "--locked", "--package", PACKAGE, "--target", WASM]);
    tree.args(["--edges", "normal,no-proc-macro", "--prefix", "none", "--format", "{p}"]);
    let mut metadata = toolchain::cargo();
    metadata.args(["metadata", "--locked", "--format-version", "1", "--filter-platform", WASM]);
    let (tree, metadata) = (answer(tree).await?, answer(metadata).await?);
    let wanted: BTreeSet<(&str, &str)> = tree.lines().filter_map(named).collect();

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
    let mut parts = Vec::new();
    for Package { name, version, license, manifest_path, source } in metadata.packages {
        if source.is_some() && wanted.contains(&(&name, &version)) {
            let licence = license.with_context(|| format!("{name} {version} names no licence"))?;
            let folder = manifest_path.parent().with_context(|| format!("{name} lies nowhere"))?;
            let texts =
                texts(folder, &licence).with_context(|| format!("the licence of {name} {version}"))?;
            parts.push(Part { name, version, licence, texts });
        }
    }
    ensure!(!parts.is_empty(), "cargo tree names no crate of others in {PACKAGE}");
    parts.sort();
    Ok(parts)
}

async fn answer(command: Command) -> Result<String> {
    run::output(command).await.context("cargo does not say of which crates the page is made")
}

fn named(line: &str) -> Option<(&str, &str)> {
    let mut words = line.split_whitespace();
    Some((words.next()?, words.next()?.strip_prefix('v')?))
}

/// If the license offers a choice that includes MIT, only MIT's text.
fn texts(folder: &Path, licence: &str) -> Result<Vec<String>> {
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
    for file in chosen(&files, licence) {
        let text = std::fs::read_to_string(folder.join(file)).with_context(|| file.to_owned())?;
        let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
        texts.push(lines.join("\n").trim_matches('\n').to_owned());
    }
    Ok(texts)
}

fn chosen<'a>(files: &'a [String], licence: &str) -> Vec<&'a str> {
    let has = |file: &str, word: &str| file.to_uppercase().contains(word);
    let of_mit = files.iter().any(|file| has(file, "MIT")) && licence.contains("MIT");
    let wanted = |file: &&str| match (of_mit, licence.contains(" AND ")) {
        (false, _) => true,
        (true, false) => has(file, "MIT"),
        (true, true) => !has(file, "APACHE"),
    };
    files.iter().map(String::as_str).filter(wanted).collect()
}

fn print(parts: &[Part], own: &str) -> String {
    let mut page = String::from(HEAD);
    let _ = write!(page, "<pre>{}</pre>\n<h2>What it is made of</h2>\n<ul>\n", escaped(own.trim()));
    for Part { name, version, licence, .. } in parts {
        let _ = writeln!(page, "<li>{} {}: {}</li>", escaped(name), escaped(version), escaped(licence));
    }
    page.push_str("<li>the Rust standard library: MIT OR Apache-2.0</li>\n</ul>\n");
    let mut shared: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for part in parts {
        for text in &part.texts {
            shared.entry(text).or_default().push(&part.name);
        }
    }
    let mut shared: Vec<(Vec<&str>, &str)> = shared.into_iter().map(|(text, names)| (names, text)).collect();
    shared.sort();
    for (names, text) in shared {
        let _ = writeln!(page, "<h3>{}</h3>\n<pre>{}</pre>", escaped(&names.join(", ")), escaped(text));
    }
    page.push_str("</body>\n</html>\n");
    page
}

const HEAD: &str = "<!doctype html>
<html lang=\"en\">
<head>
<meta charset=\"utf-8\">
<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; base-uri 'none'; form-action 'none'\">
<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">
<meta name=\"referrer\" content=\"no-referrer\">
<meta name=\"color-scheme\" content=\"light dark\">
<title>Licences – Stepscope</title>
<link rel=\"icon\" href=\"data:,\">
</head>
<body>
<p><a href=\"./\">Back to Stepscope</a></p>
<h1>Licences</h1>
<p>Stepscope is licensed under MIT or Apache-2.0, at your choice.</p>
";

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_choice_mit_goes_along_and_of_both_all() {
        for (files, licence, expected) in [
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
            assert_eq!(chosen(&files, licence), expected, "{licence}");
        }
    }

    #[test]
    fn a_text_stands_once_under_all_that_share_it() {
        let part = |name: &str, text: &str| Part {
            name: name.to_owned(),
            version: "1.0.0".to_owned(),
            licence: "MIT".to_owned(),
            texts: vec![text.to_owned()],
        };
        let page = print(&[part("a", "one <b>"), part("b", "two"), part("c", "one <b>")], "own & all");
        assert_eq!(page.matches("one &lt;b&gt;").count(), 1, "{page}");
        assert!(page.contains("<h3>a, c</h3>") && page.contains("<h3>b</h3>"), "{page}");
        assert!(page.contains("<li>b 1.0.0: MIT</li>") && page.contains("own &amp; all"), "{page}");
    }

    #[tokio::test]
    async fn the_wasms_own_crates_are_found_with_their_texts() {
        let parts = parts().await.unwrap();
        let rustfft = parts.iter().find(|part| part.name == "rustfft").unwrap();
        assert!(rustfft.licence.contains("MIT") && !rustfft.texts.is_empty(), "{rustfft:?}");
        assert!(parts.iter().all(|part| !part.name.starts_with("stepscope") && part.name != "serde_derive"));
    }
}
