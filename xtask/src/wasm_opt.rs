//! Finds a wasm-opt that does not break the page.
//!
//! Up to binaryen 108 it exports the wrong table and the page does not start; up to 116 it cannot read wasm-bindgen's
//! `table.fill`, which rules out the `wasm-opt` crate. In this order: a recent one on PATH, binaryen's npm package,
//! the one that wasm-pack downloads. An old one on PATH without npm is an error, because wasm-pack would use it.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail, ensure};

use crate::npm::NpmPackage;
use crate::output_buffer::print_line;
use crate::tools::{find, version_output};

const BINARYEN: &str = "132.0.0";
/// As wasm-pack 0.15.1 downloads.
const MIN_VERSION: u32 = 130;

pub(crate) async fn ready(cache: &Path) -> Result<Option<PathBuf>> {
    let npm = NpmPackage { package: "binaryen", version: BINARYEN };
    let own = npm.modules(cache).join(".bin");
    let on_path = which::which("wasm-opt").ok();
    for program in [find("wasm-opt", &own), on_path.clone()].into_iter().flatten() {
        if is_recent(&program).await {
            return Ok(Some(program));
        }
    }
    if which::which("npm").is_ok() {
        npm.install(cache).await.with_context(remedy)?;
        let program = find("wasm-opt", &own).with_context(remedy)?;
        ensure!(is_recent(&program).await, "{} does not run; {}", program.display(), remedy());
        return Ok(Some(program));
    }
    if let Some(old) = on_path {
        bail!("{} is too old and would silently break the page; {}", old.display(), remedy());
    }
    print_line("neither wasm-opt nor npm is installed, so wasm-pack will fetch wasm-opt");
    Ok(None)
}

/// On platforms without a download wasm-pack continues without wasm-opt and only prints a note.
pub(crate) fn check_fetch(result: Result<()>, wasm_pack_cache: &Path) -> Result<()> {
    result.map_err(|error| anyhow!("{error:#}\nif wasm-opt could not be fetched: {}", remedy()))?;
    let entries = std::fs::read_dir(wasm_pack_cache).context("wasm-pack's cache can't be read")?;
    let fetched = entries.flatten().any(|entry| entry.file_name().to_string_lossy().starts_with("wasm-opt"));
    ensure!(fetched, "wasm-pack has no wasm-opt for this platform; {}", remedy());
    Ok(())
}

fn remedy() -> String {
    format!("install Node.js with npm, or binaryen {MIN_VERSION} or later, or use --no-opt")
}

async fn is_recent(program: &Path) -> bool {
    version_output(program).await.is_some_and(|output| version(&output) >= Some(MIN_VERSION))
}

fn version(output: &str) -> Option<u32> {
    output.split_whitespace().nth(2)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_is_read_from_the_output_of_wasm_opt() {
        for (output, expected) in [
            ("wasm-opt version 132 (version_132)\n", Some(132)),
            ("wasm-opt version 108\n", Some(108)),
            ("wasm-opt", None),
            ("something else entirely", None),
        ] {
            assert_eq!(version(output), expected, "{output}");
        }
    }
}
