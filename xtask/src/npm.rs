//! Packages of the npm registry that checks and builds use; none of them is shipped. Each version has a folder
//! of its own in the tools' cache.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use tokio::process::Command;

use crate::aside::say;
use crate::tools::{cache, find, version_answer};
use crate::{apt, run};

/// The accessibility rules that a page test runs in the page.
const AXE: Npm = Npm { package: "axe-core", version: "4.14.1" };

/// A package in one version.
pub(crate) struct Npm {
    pub(crate) package: &'static str,
    pub(crate) version: &'static str,
}

impl Npm {
    /// Where it and what it needs lie.
    pub(crate) fn modules(&self, cache: &Path) -> PathBuf {
        self.home(cache).join("node_modules")
    }

    fn home(&self, cache: &Path) -> PathBuf {
        cache.join("tools").join(format!("{}-{}", self.package, self.version))
    }

    /// Installs it by the npm that is on PATH.
    pub(crate) async fn install(&self, cache: &Path) -> Result<()> {
        let (home, name) = (self.home(cache), format!("{}@{}", self.package, self.version));
        say(format_args!("installing {name} (once)"));
        std::fs::create_dir_all(&home).with_context(|| format!("{} can't be made", home.display()))?;
        let mut command = Command::new(which::which("npm").context("npm is not on PATH")?);
        command.args(["install", "--no-audit", "--no-fund", "--no-update-notifier", "--prefix"]).arg(&home);
        command.arg(name);
        run::to_end(command).await
    }

    /// The same, after npm itself where that is one command.
    async fn install_with_npm(&self, cache: &Path) -> Result<()> {
        let remedy = || {
            format!(
                "{} {} comes from npm: install Node.js with npm so that it is on PATH",
                self.package, self.version
            )
        };
        if which::which("npm").is_err() {
            apt::install(&["nodejs", "npm"]).await.with_context(remedy)?;
        }
        self.install(cache).await.with_context(remedy)
    }

    /// The path of the package's command `program`, which answers with the package's version; installs it if it is
    /// missing.
    pub(crate) async fn program(&self, program: &str) -> Result<PathBuf> {
        let cache = cache()?;
        let folder = self.modules(&cache).join(".bin");
        if find(program, &folder).is_none() {
            self.install_with_npm(&cache).await?;
        }
        let path = find(program, &folder)
            .with_context(|| format!("{} was installed, but has no {program}", self.package))?;
        let answer = version_answer(&path).await.unwrap_or_default();
        ensure!(
            answer.contains(self.version),
            "{} does not run: it answers `{}`",
            path.display(),
            answer.trim()
        );
        Ok(path)
    }
}

/// The path of one of Node's programs; installs the system's packages where it is missing.
pub(crate) async fn node_program(name: &str) -> Result<PathBuf> {
    let remedy = || format!("this step needs {name}: install Node.js with npm so that it is on PATH");
    if which::which(name).is_err() {
        apt::install(&["nodejs", "npm"]).await.with_context(remedy)?;
    }
    which::which(name).with_context(remedy)
}

/// The path of axe-core's script, installing it if it is missing.
pub(crate) async fn axe() -> Result<PathBuf> {
    let cache = cache()?;
    let script = AXE.modules(&cache).join("axe-core").join("axe.min.js");
    if !script.is_file() {
        AXE.install_with_npm(&cache).await?;
        ensure!(script.is_file(), "axe-core was installed, but {} is not there", script.display());
    }
    Ok(script)
}
