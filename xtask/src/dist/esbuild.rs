//! Runs esbuild, which minifies modules and style sheets and puts a hash of the file and its imports into each name.
//!
//! esbuild puts code that several entries share into one file per set of entries: twenty small files, larger in sum than
//! one. So it gets a copy of the sources in which each later part imports the page's script. Shared code then stays in
//! that script and loads with it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::Deserialize;
use tokio::process::Command;
use walkdir::WalkDir;

use super::ASSETS;
use crate::npm::NpmPackage;
use crate::{files, run};

const ESBUILD: NpmPackage = NpmPackage { package: "esbuild", version: "0.28.2" };

struct SourceCopy {
    folder: PathBuf,
}

impl SourceCopy {
    fn new(web: &Path) -> Result<Self> {
        let folder = std::env::temp_dir().join(format!("stepscope-web-{}", std::process::id()));
        let copy = Self { folder };
        for entry in WalkDir::new(web) {
            let entry = entry.with_context(|| format!("{} can't be read", web.display()))?;
            let target = copy.web().join(entry.path().strip_prefix(web)?);
            let done = if entry.file_type().is_dir() {
                std::fs::create_dir_all(&target)
            } else {
                std::fs::copy(entry.path(), &target).map(drop)
            };
            done.with_context(|| format!("{} can't be created", target.display()))?;
        }
        Ok(copy)
    }

    fn web(&self) -> PathBuf {
        self.folder.join("web")
    }
}

impl Drop for SourceCopy {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// Bundles `sources` into the folder `out`; returns the metafile of esbuild.
async fn esbuild(web: &Path, sources: &BTreeSet<&str>, out: &Path) -> Result<String> {
    let metafile = out.with_extension("json");
    let path = |option: &str, path: &Path| format!("--{option}={}", path.display());
    let mut command = Command::new(ESBUILD.program("esbuild").await?);
    command.current_dir(web).args(sources).args(["--bundle", "--splitting", "--format=esm", "--minify"]);
    command.args(["--charset=utf8", "--legal-comments=none", "--log-level=warning"]);
    command.args(["--entry-names=[name].[hash]", "--chunk-names=[name].[hash]"]);
    command.args(["wasm", "png", "svg"].map(|ending| format!("--loader:.{ending}=copy")));
    command.arg(path("outdir", out)).arg(path("metafile", &metafile));
    run::to_end(command).await?;
    let text = files::read(&metafile)?;
    files::remove(&metafile)?;
    Ok(text)
}

/// The sources that only the page's `script` loads, and only later. A part that another page or a worker also needs
/// must not import that script.
pub(super) fn later_parts(
    metafile: &str,
    sources: &BTreeSet<&str>,
    script: &str,
) -> Result<BTreeSet<String>> {
    #[derive(Deserialize)]
    struct Metafile {
        inputs: BTreeMap<String, Input>,
    }
    let Metafile { inputs } = serde_json::from_str(metafile).context("inputs in esbuild's metafile")?;
    let imports = |source: &str| inputs.get(source).map_or(&[][..], |input| &input.imports);
    let elsewhere = reached(&inputs, sources.iter().copied().filter(|source| *source != script).collect());
    let later =
        reached(&inputs, vec![script]).into_iter().flat_map(imports).filter(|import| import.is_dynamic());
    let parts = later.map(|import| &import.path).filter(|path| !elsewhere.contains(path.as_str()));
    Ok(parts.cloned().collect())
}

#[derive(Debug, Deserialize)]
struct Input {
    imports: Vec<Import>,
}

/// The sources, and all that they import.
fn reached<'a>(inputs: &'a BTreeMap<String, Input>, mut queue: Vec<&'a str>) -> BTreeSet<&'a str> {
    let mut found = BTreeSet::new();
    while let Some(source) = queue.pop() {
        if let Some(input) = inputs.get(source)
            && found.insert(source)
        {
            queue.extend(input.imports.iter().map(|import| import.path.as_str()));
        }
    }
    found
}

#[derive(Debug)]
pub(super) struct Bundles(BTreeMap<String, Output>);

#[derive(Debug, Deserialize)]
struct Output {
    imports: Vec<Import>,
    /// `None` for code that several entries share.
    #[serde(rename = "entryPoint")]
    entry: Option<String>,
}

#[derive(Debug, Deserialize)]
struct Import {
    path: String,
    kind: String,
}

impl Import {
    fn is_dynamic(&self) -> bool {
        self.kind == "dynamic-import"
    }
}

impl Bundles {
    /// Bundles `sources` of `web` and their imports into `dist`'s folder of assets; `script` is the page's own.
    pub(super) async fn make(
        web: &Path,
        sources: &BTreeSet<&str>,
        script: &str,
        dist: &Path,
    ) -> Result<Self> {
        let copy = SourceCopy::new(web)?;
        let draft = esbuild(&copy.web(), sources, &copy.folder.join("draft")).await?;
        for part in later_parts(&draft, sources, script)? {
            let file = copy.web().join(&part);
            let up = "../".repeat(part.matches('/').count());
            let text = files::read(&file)?;
            files::write(&file, format!("{text}import \"./{up}{script}\";\n"))?;
        }
        Self::parse(&esbuild(&copy.web(), sources, &dist.join(ASSETS)).await?)
    }

    pub(super) fn parse(metafile: &str) -> Result<Self> {
        #[derive(Deserialize)]
        struct Metafile {
            outputs: BTreeMap<String, Output>,
        }
        let in_assets = |path: &str| format!("{ASSETS}/{}", path.rsplit('/').next().unwrap_or(path));
        let Metafile { outputs } = serde_json::from_str(metafile).context("outputs in esbuild's metafile")?;
        let outputs = outputs.into_iter().map(|(path, mut output)| {
            for import in &mut output.imports {
                import.path = in_assets(&import.path);
            }
            (in_assets(&path), output)
        });
        Ok(Self(outputs.collect()))
    }

    pub(super) fn files(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    pub(super) fn file_of(&self, source: &str) -> Option<&str> {
        let found = self.0.iter().find(|(_, output)| output.entry.as_deref() == Some(source));
        found.map(|(path, _)| path.as_str())
    }

    /// All files that load before this file runs, including it.
    pub(super) fn with_imports(&self, file: &str) -> BTreeSet<&str> {
        let mut loaded = BTreeSet::new();
        let mut queue = vec![file];
        while let Some(path) = queue.pop() {
            if let Some((path, output)) = self.0.get_key_value(path)
                && loaded.insert(path.as_str())
            {
                let static_imports = output.imports.iter().filter(|import| !import.is_dynamic());
                queue.extend(static_imports.map(|import| import.path.as_str()));
            }
        }
        loaded
    }

    /// Dynamic imports of these files: source and file.
    pub(super) fn dynamic_imports<'a>(&'a self, files: &BTreeSet<&str>) -> BTreeMap<&'a str, &'a str> {
        let imports = files.iter().filter_map(|file| self.0.get(*file)).flat_map(|output| &output.imports);
        let paths = imports.filter(|import| import.is_dynamic()).map(|import| import.path.as_str());
        paths
            .map(|path| (self.0.get(path).and_then(|output| output.entry.as_deref()).unwrap_or(path), path))
            .collect()
    }
}
