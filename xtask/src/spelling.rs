//! Checks the spelling of all tracked text files by codespell, which knows common misspellings.

use std::path::PathBuf;

use anyhow::{Context, Result};
use tokio::process::Command;

use crate::output_buffer::print_line;
use crate::tools::cache;
use crate::{root, run};

const CODESPELL: &str = "codespell==2.4.3";
/// The folder's number changes with the version.
const HOME: &str = "codespell-1";
/// Terms of the field and names that codespell takes for misspellings.
const TERMS: &str = "xtask/src/spelling.txt";
/// Data, not text.
const SKIPPED: [&str; 6] = [
    "Cargo.lock",
    "fuzz/Cargo.lock",
    "tests/golden",
    "tests/findings",
    "tests/links",
    "cli/tests/recordings",
];

pub(crate) async fn check() -> Result<()> {
    let codespell = codespell().await?;
    let mut git = Command::new("git");
    git.current_dir(root()).args(["ls-files", "-z"]);
    let files = run::output(git).await.context("git ls-files failed: the spelling check needs a clone")?;
    let files = files.split('\0').filter(|file| {
        let data = [".png", ".sr", ".vcd"].iter().any(|ending| file.ends_with(ending));
        // A tracked file may be deleted in the working tree.
        !data && !SKIPPED.iter().any(|skipped| file.starts_with(skipped)) && root().join(file).is_file()
    });
    let mut command = Command::new(codespell);
    command.current_dir(root()).args(["--ignore-words", TERMS]).args(files);
    run::to_end(command)
        .await
        .with_context(|| format!("misspelled words; add a term of the field to {TERMS}"))
}

/// codespell in a Python environment in the tools' cache.
async fn codespell() -> Result<PathBuf> {
    let home = cache()?.join("tools").join(HOME);
    let program = home.join("bin").join("codespell");
    if program.exists() {
        return Ok(program);
    }
    print_line(format_args!("installing {CODESPELL} (once)"));
    let remedy = "the spelling check needs Python 3.9 or newer with venv and pip (Debian: `apt-get install python3-venv` as root)";
    let mut command = Command::new(which::which("python3").context(remedy)?);
    command.args(["-m", "venv", "--clear"]).arg(&home);
    run::to_end(command).await.context(remedy)?;
    let mut command = Command::new(home.join("bin").join("python"));
    command.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", CODESPELL]);
    run::to_end(command).await.context(remedy)?;
    Ok(program)
}
