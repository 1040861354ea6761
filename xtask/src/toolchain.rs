//! The Rust tool chain that runs this: calling its cargo, and adding what it lacks.

use std::env;
use std::path::Path;

use anyhow::{Context, Result};
use tokio::process::Command;

use crate::{root, run};

/// The page's target.
pub(crate) const WASM: &str = "wasm32-unknown-unknown";
/// A Cortex-M3, on which the core must run without an operating system.
pub(crate) const BARE_METAL: &str = "thumbv7m-none-eabi";

/// A cargo call in the workspace's folder.
pub(crate) fn cargo() -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root());
    command
}

/// Cargo's call of tests that ask programs of others, which all other calls leave out. The whole workspace, so that its packages
/// keep the features, and with them the builds, of the native step.
pub(crate) fn ignored_tests(names: &[&str]) -> Command {
    let mut command = cargo();
    command.args(["test", "--workspace", "--locked"]);
    command.args(names.iter().flat_map(|name| ["--test", name])).args(["--", "--ignored"]);
    command
}

/// What rustc says of itself: version, commit and this machine's target, a line each.
pub(crate) async fn version() -> Result<String> {
    let mut command = Command::new("rustc");
    command.current_dir(root()).arg("-vV");
    run::output(command).await.context("rustc does not answer")
}

/// The target of this machine, such as `x86_64-unknown-linux-gnu`.
pub(crate) async fn host() -> Result<String> {
    let answer = version().await?;
    let host = answer.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).context("rustc does not name its host")
}

/// Makes sure that the tool chain can build for `target`.
pub(crate) async fn target(target: &str) -> Result<()> {
    let mut command = Command::new("rustc");
    command.current_dir(root()).args(["--print", "target-libdir", "--target", target]);
    let folder = run::output(command).await.context("rustc does not answer")?;
    if Path::new(folder.trim()).exists() {
        return Ok(());
    }
    rustup(&["target", "add", target]).await
}

/// Makes sure that `cargo fmt` and `cargo clippy` are there.
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
        .with_context(|| format!("add it by your Rust's own means: {}", arguments.join(" ")))
}
