//! esbuild makes the files with hashes: what a page or worker begins with, what several of these share, and what comes
//! later, each as one minified module; style sheets, minified; and copies of the wasm and the icons. The hash in a name
//! is of the file and of all that it imports.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Context, Result};
use serde::Deserialize;
use tokio::process::Command;

use super::ASSETS;
use crate::npm::Npm;
use crate::run;

const ESBUILD: Npm = Npm { package: "esbuild", version: "0.28.2" };

/// Every file that esbuild made, by its path in `dist`.
#[derive(Debug)]
pub(super) struct Bundles(BTreeMap<String, Output>);

/// One of them, as esbuild describes it.
#[derive(Debug, Deserialize)]
struct Output {
    imports: Vec<Import>,
    /// The source that it stands for; none for what others share.
    #[serde(rename = "entryPoint")]
    entry: Option<String>,
}

#[derive(Debug, Deserialize)]
struct Import {
    path: String,
    kind: String,
}

impl Import {
    /// Whether it is loaded only when something asks for it.
    fn is_later(&self) -> bool {
        self.kind == "dynamic-import"
    }
}

impl Bundles {
    /// Makes files of these `sources` of `web`, and of all that they import, in the folder of assets of `dist`.
    pub(super) async fn make(web: &Path, sources: &BTreeSet<&str>, dist: &Path) -> Result<Self> {
        let note = dist.join("esbuild.json");
        let path = |option: &str, path: &Path| format!("--{option}={}", path.display());
        let mut command = Command::new(ESBUILD.program("esbuild").await?);
        command.current_dir(web).args(sources).args(["--bundle", "--splitting", "--format=esm", "--minify"]);
        command.args(["--charset=utf8", "--legal-comments=none", "--log-level=warning"]);
        command.args(["--entry-names=[name].[hash]", "--chunk-names=[name].[hash]"]);
        command.args(["wasm", "png", "svg"].map(|ending| format!("--loader:.{ending}=copy")));
        command.arg(path("outdir", &dist.join(ASSETS))).arg(path("metafile", &note));
        run::to_end(command, run::LIMIT).await?;
        let text = std::fs::read_to_string(&note).context("esbuild does not say what it made")?;
        std::fs::remove_file(&note).with_context(|| format!("{} can't be removed", note.display()))?;
        Self::parse(&text)
    }

    /// Reads esbuild's note of what it made.
    pub(super) fn parse(note: &str) -> Result<Self> {
        #[derive(Deserialize)]
        struct Note {
            outputs: BTreeMap<String, Output>,
        }
        // All lie in one folder, wherever that is.
        let placed = |path: &str| format!("{ASSETS}/{}", path.rsplit('/').next().unwrap_or(path));
        let Note { outputs } = serde_json::from_str(note).context("esbuild's note of what it made")?;
        let outputs = outputs.into_iter().map(|(path, mut output)| {
            for import in &mut output.imports {
                import.path = placed(&import.path);
            }
            (placed(&path), output)
        });
        Ok(Self(outputs.collect()))
    }

    /// The paths of all files.
    pub(super) fn files(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    /// The file that stands for this source.
    pub(super) fn of(&self, source: &str) -> Option<&str> {
        let found = self.0.iter().find(|(_, output)| output.entry.as_deref() == Some(source));
        found.map(|(path, _)| path.as_str())
    }

    /// All that loads before this file runs, itself included.
    pub(super) fn at_once(&self, file: &str) -> BTreeSet<&str> {
        let mut loaded = BTreeSet::new();
        let mut waiting = vec![file];
        while let Some(path) = waiting.pop() {
            if let Some((path, output)) = self.0.get_key_value(path)
                && loaded.insert(path.as_str())
            {
                let wanted = output.imports.iter().filter(|import| !import.is_later());
                waiting.extend(wanted.map(|import| import.path.as_str()));
            }
        }
        loaded
    }

    /// What one of these files loads only when something asks for it, by its source.
    pub(super) fn later<'a>(&'a self, files: &BTreeSet<&str>) -> BTreeMap<&'a str, &'a str> {
        let imports = files.iter().filter_map(|file| self.0.get(*file)).flat_map(|output| &output.imports);
        let paths = imports.filter(|import| import.is_later()).map(|import| import.path.as_str());
        paths
            .map(|path| (self.0.get(path).and_then(|it| it.entry.as_deref()).unwrap_or(path), path))
            .collect()
    }
}
