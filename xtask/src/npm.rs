//! Packages of npm for checks and builds; none is shipped. Each version has its own folder in the cache of tools.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use tokio::process::Command;

use crate::output_buffer::print_line;
use crate::tools::{cache, find, version_output};
use crate::{apt, files, run};

const AXE: NpmPackage = NpmPackage { package: "axe-core", version: "4.14.1" };

pub(crate) struct NpmPackage {
    pub(crate) package: &'static str,
    pub(crate) version: &'static str,
}

impl NpmPackage {
    pub(crate) fn modules(&self, cache: &Path) -> PathBuf {
        self.home(cache).join("node_modules")
    }

    fn home(&self, cache: &Path) -> PathBuf {
        cache.join("tools").join(format!("{}-{}", self.package, self.version))
    }

    pub(crate) async fn install(&self, cache: &Path) -> Result<()> {
        let (home, name) = (self.home(cache), format!("{}@{}", self.package, self.version));
        print_line(format_args!("installing {name} (once)"));
        files::create_folder(&home)?;
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

    /// The path of the package's command `program`, which must report exactly the package's version; installs it if missing.
    pub(crate) async fn program(&self, program: &str) -> Result<PathBuf> {
        let cache = cache()?;
        let folder = self.modules(&cache).join(".bin");
        if find(program, &folder).is_none() {
            self.install_with_npm(&cache).await?;
        }
        let path = find(program, &folder)
            .with_context(|| format!("{} was installed, but has no {program}", self.package))?;
        let output = version_output(&path).await.unwrap_or_default();
        ensure!(
            reports_version(&output, self.version),
            "{} must have version {}; it reports `{}`",
            path.display(),
            self.version,
            output.trim()
        );
        Ok(path)
    }
}

/// Whether the output of `--version` has exactly this version, as in `esbuild 0.28.2` or `Version: 2.6.8`.
fn reports_version(output: &str, version: &str) -> bool {
    output.split_whitespace().any(|word| word == version)
}

pub(crate) async fn node_program(name: &str) -> Result<PathBuf> {
    apt::require("this step", &[name], &["nodejs", "npm"]).await?;
    which::which(name).with_context(|| format!("{name} is not on PATH"))
}

pub(crate) async fn axe() -> Result<PathBuf> {
    let cache = cache()?;
    let script = AXE.modules(&cache).join("axe-core").join("axe.min.js");
    if !script.is_file() {
        AXE.install_with_npm(&cache).await?;
        ensure!(script.is_file(), "axe-core was installed, but has no {}", script.display());
    }
    Ok(script)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_exact_version_is_accepted() {
        for (output, expected) in [
            ("0.28.2\n", true),
            ("Version: 0.28.2\n", true),
            ("10.28.2\n", false),
            ("0.28.21\n", false),
            ("", false),
        ] {
            assert_eq!(reports_version(output, "0.28.2"), expected, "{output}");
        }
    }
}
