//! Calls cargo and adds missing parts of the Rust tool chain.

use std::env;
use std::path::Path;

use anyhow::{Context, Result};
use tokio::process::Command;

use crate::{root, run};

pub(crate) const WASM: &str = "wasm32-unknown-unknown";
pub(crate) const BARE_METAL: &str = "thumbv7m-none-eabi";

pub(crate) fn cargo() -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root());
    command
}

/// The tests that need other programs. Selects the whole workspace, so that the packages keep the features and builds
/// of the native step.
pub(crate) fn ignored_tests(names: &[&str]) -> Command {
    let mut command = cargo();
    command.args(["test", "--workspace", "--locked"]);
    command.args(names.iter().flat_map(|name| ["--test", name])).args(["--", "--ignored"]);
    command
}

pub(crate) async fn version() -> Result<String> {
    let mut command = Command::new("rustc");
    command.current_dir(root()).arg("-vV");
    run::output(command).await.context("rustc does not run")
}

pub(crate) async fn host() -> Result<String> {
    let version = version().await?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).context("rustc does not report its host")
}

pub(crate) async fn target(target: &str) -> Result<()> {
    let mut command = Command::new("rustc");
    command.current_dir(root()).args(["--print", "target-libdir", "--target", target]);
    let folder = run::output(command).await.context("rustc does not run")?;
    if Path::new(folder.trim()).exists() {
        return Ok(());
    }
    rustup(&["target", "add", target]).await
}

pub(crate) async fn components() -> Result<()> {
    for (subcommand, component) in [("fmt", "rustfmt"), ("clippy", "clippy")] {
        let mut command = cargo();
        command.args([subcommand, "--version"]);
        if run::output(command).await.is_none() {
            rustup(&["component", "add", component]).await?;
        }
    }
    Ok(())
}

async fn rustup(arguments: &[&str]) -> Result<()> {
    let mut command = Command::new("rustup");
    command.current_dir(root()).args(arguments);
    run::to_end(command)
        .await
        .with_context(|| format!("install it with your distribution of Rust: {}", arguments.join(" ")))
}
