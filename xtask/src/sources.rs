//! What is asked of the page's sources by themselves, before any browser: their form, lints and types.

use anyhow::Result;
use tokio::process::Command;

use crate::npm::Npm;
use crate::{root, run};

/// Formatter and linter; `web/biome.jsonc` says how it is meant.
const BIOME: Npm = Npm { package: "@biomejs/biome", version: "2.6.8" };
/// The compiler whose checker reads the page's modules and their JSDoc types.
const TYPESCRIPT: Npm = Npm { package: "typescript", version: "7.0.2" };

/// Writes scripts, style sheets and JSON files in the one form, imports in order.
pub(crate) async fn format() -> Result<()> {
    biome(&["check", "--linter-enabled=false", "--write"]).await
}

/// An error where `format` would change something.
pub(crate) async fn check_format() -> Result<()> {
    biome(&["check", "--linter-enabled=false", "--error-on-warnings"]).await
}

/// An error where the linter has anything to say.
pub(crate) async fn lint() -> Result<()> {
    biome(&["lint", "--error-on-warnings"]).await
}

/// Checks the types of the page's modules; `web/pkg` must be built, for they use it.
pub(crate) async fn check_types() -> Result<()> {
    let mut command = Command::new(TYPESCRIPT.program("tsc").await?);
    command.arg("--project").arg(root().join("web").join("jsconfig.json"));
    run::to_end(command).await
}

async fn biome(arguments: &[&str]) -> Result<()> {
    let mut command = Command::new(BIOME.program("biome").await?);
    command.current_dir(root().join("web")).args(arguments).arg(".");
    run::to_end(command).await
}
