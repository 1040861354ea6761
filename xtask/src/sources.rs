//! Checks the page's sources outside of a browser: format, lints, types, and the unit tests of its models.

use std::path::PathBuf;

use anyhow::{Result, ensure};
use tokio::process::Command;

use crate::npm::{self, NpmPackage};
use crate::{files, root, run};

const TESTS: &str = "tests/scripts";
const TEST_ENDING: &str = ".test.mjs";
const BIOME: NpmPackage = NpmPackage { package: "@biomejs/biome", version: "2.6.8" };
const TYPESCRIPT: NpmPackage = NpmPackage { package: "typescript", version: "7.0.2" };

pub(crate) async fn format() -> Result<()> {
    biome(&["check", "--linter-enabled=false", "--write"]).await
}

pub(crate) async fn check_format() -> Result<()> {
    biome(&["check", "--linter-enabled=false", "--error-on-warnings"]).await
}

pub(crate) async fn lint() -> Result<()> {
    biome(&["lint", "--error-on-warnings"]).await
}

pub(crate) async fn check_types() -> Result<()> {
    let mut command = Command::new(TYPESCRIPT.program("tsc").await?);
    command.arg("--project").arg(root().join("web").join("jsconfig.json"));
    run::to_end(command).await
}

pub(crate) async fn test() -> Result<()> {
    // Node's versions differ in how they search a folder, so each file is named.
    let files = tests()?;
    ensure!(!files.is_empty(), "{TESTS} contains no *{TEST_ENDING}");
    let mut command = Command::new(npm::node_program("node").await?);
    command.args(["--test", "--test-reporter=spec"]).args(files);
    run::to_end(command).await
}

fn tests() -> Result<Vec<PathBuf>> {
    let paths = files::below(&root().join(TESTS))?.into_iter().map(walkdir::DirEntry::into_path);
    Ok(paths.filter(|path| path.to_string_lossy().ends_with(TEST_ENDING)).collect())
}

async fn biome(arguments: &[&str]) -> Result<()> {
    let mut command = Command::new(BIOME.program("biome").await?);
    command
        .current_dir(root().join("web"))
        .args(arguments)
        .args([".".as_ref(), root().join(TESTS).as_path()]);
    run::to_end(command).await
}
