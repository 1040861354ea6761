//! Packages of npm that checks and builds use; none is shipped. Each version has its own folder in the tools' cache.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use tokio::process::Command;

use crate::aside::say;
use crate::tools::{cache, find, version_answer};
use crate::{apt, run};

const AXE: Npm = Npm { package: "axe-core", version: "4.14.1" };

pub(crate) struct Npm {
    pub(crate) package: &'static str,
    pub(crate) version: &'static str,
}

impl Npm {
    pub(crate) fn modules(&self, cache: &Path) -> PathBuf {
        self.home(cache).join("node_modules")
    }

    fn home(&self, cache: &Path) -> PathBuf {
        cache.join("tools").join(format!("{}-{}", self.package, self.version))
    }

    pub(crate) async fn install(&self, cache: &Path) -> Result<()> {
        let (home, name) = (self.home(cache), format!("{}@{}", self.package, self.version));
        say(format_args!("installing {name} (once)"));
        std::fs::create_dir_all(&home).with_context(|| format!("{} can't be made", home.display()))?;
        let mut command = Command::new(which::which("npm").context("npm is not on PATH")?);
        command.args(["install", "--no-audit", "--no-fund", "--no-update-notifier", "--prefix"]).arg(&home);
        command.arg(name);
        run::to_end(command).await
    }

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

    /// The path of the package's command `program`, which must report the package's version; installs it if missing.
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

pub(crate) async fn node_program(name: &str) -> Result<PathBuf> {
    apt::require("this step", &[name], &["nodejs", "npm"]).await?;
    which::which(name).with_context(|| format!("{name} is gone"))
}

pub(crate) async fn axe() -> Result<PathBuf> {
    let cache = cache()?;
    let script = AXE.modules(&cache).join("axe-core").join("axe.min.js");
    if !script.is_file() {
        AXE.install_with_npm(&cache).await?;
        ensure!(script.is_file(), "axe-core was installed, but {} is not there", script.display());
    }
    Ok(script)
}
