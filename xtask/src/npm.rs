//! Packages of the npm registry that checks and builds use; none of them is shipped. Each version has a folder
//! of its own in the tools' cache.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use tokio::process::Command;

use crate::tools::{cache, find, version_answer};
use crate::{apt, root, run};

/// The compiler whose checker reads the page's modules and their JSDoc types.
const TYPESCRIPT: Npm = Npm { package: "typescript", version: "7.0.2" };
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
        println!("installing {name} (once)");
        std::fs::create_dir_all(&home).with_context(|| format!("{} can't be made", home.display()))?;
        let mut command = Command::new(which::which("npm").context("npm is not on PATH")?);
        command.args(["install", "--no-audit", "--no-fund", "--no-update-notifier", "--prefix"]).arg(&home);
        command.arg(name);
        run::to_end(command, run::LIMIT).await
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

/// Checks the types of the page's modules; `web/pkg` must be built, for they use it.
pub(crate) async fn check_types() -> Result<()> {
    let cache = cache()?;
    let programs = TYPESCRIPT.modules(&cache).join(".bin");
    if find("tsc", &programs).is_none() {
        TYPESCRIPT.install_with_npm(&cache).await?;
    }
    let tsc = find("tsc", &programs).context("typescript was installed, but has no tsc")?;
    let answer = version_answer(&tsc).await.unwrap_or_default();
    ensure!(
        answer.contains(TYPESCRIPT.version),
        "{} does not run: it answers `{}`",
        tsc.display(),
        answer.trim()
    );
    let mut command = Command::new(tsc);
    command.arg("--project").arg(root().join("web").join("jsconfig.json"));
    run::to_end(command, run::LIMIT).await
}
