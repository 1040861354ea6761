//! Decides whether a folder of built files is up to date. Optimizing the page's wasm and building the packages take
//! minutes, and most changes touch neither.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::{env, fs};

use anyhow::{Context, Result};
use twox_hash::XxHash64;
use walkdir::WalkDir;

use crate::{THIS_PROGRAM, root, toolchain};

const WORKSPACE: [&str; 3] = ["Cargo.toml", "Cargo.lock", ".cargo/config.toml"];

/// Prefixes of environment variables that change cargo's or rustc's result.
const VARIABLES: [&str; 6] =
    ["CARGO_PROFILE_", "CARGO_TARGET_", "CARGO_BUILD_", "CARGO_ENCODED_", "RUSTC", "RUSTFLAGS"];

/// Hashed at the start: this program may be rebuilt while it runs.
pub(crate) static PROGRAM: LazyLock<Option<u64>> = LazyLock::new(|| {
    let program = fs::read(THIS_PROGRAM.as_ref().ok()?).ok()?;
    Some(XxHash64::oneshot(0, &program))
});

pub(crate) struct Made<'a> {
    folder: &'a Path,
    sources: &'a [&'a str],
    how: Vec<String>,
    note: PathBuf,
    from: u64,
}

impl<'a> Made<'a> {
    /// `folder`, built by this program and this Rust from these folders of the workspace with the options `how`.
    pub(crate) async fn of(folder: &'a Path, sources: &'a [&'a str], how: &[&str]) -> Result<Self> {
        let mut how: Vec<_> = how.iter().map(|&word| word.to_owned()).collect();
        how.push(toolchain::version().await?);
        let mut told: Vec<_> = env::vars_os()
            .map(|(name, value)| (name.to_string_lossy().into_owned(), value))
            .filter(|(name, _)| VARIABLES.iter().any(|begin| name.starts_with(begin)))
            .map(|(name, value)| format!("{name}={}", value.to_string_lossy()))
            .collect();
        told.sort();
        how.extend(told);
        let name = folder.strip_prefix(root()).unwrap_or(folder).to_string_lossy().replace(['/', '\\'], "-");
        let note = root().join("target").join("made").join(name);
        let from = from(sources, &how)?;
        Ok(Self { folder, sources, how, note, from })
    }

    pub(crate) fn stands(&self) -> Result<bool> {
        let Ok(noted) = fs::read_to_string(&self.note) else { return Ok(false) };
        Ok(self.folder.is_dir() && noted == self.words()?)
    }

    pub(crate) fn clear(&self) -> Result<()> {
        if self.note.exists() {
            fs::remove_file(&self.note)
                .with_context(|| format!("{} can't be removed", self.note.display()))?;
        }
        if self.folder.exists() {
            let problem = || format!("{} can't be cleared", self.folder.display());
            fs::remove_dir_all(self.folder).with_context(problem)?;
        }
        Ok(())
    }

    /// Records the build, unless an input has changed meanwhile.
    pub(crate) fn keep(&self) -> Result<()> {
        if from(self.sources, &self.how)? != self.from {
            return Ok(());
        }
        let at = self.note.parent().context("a note has a folder")?;
        let problem = || format!("{} can't be written", self.note.display());
        fs::create_dir_all(at).with_context(problem)?;
        fs::write(&self.note, self.words()?).with_context(problem)
    }

    fn words(&self) -> Result<String> {
        let mut held = Vec::new();
        hold_folder(&mut held, self.folder)?;
        Ok(format!("{:016x} {:016x}\n", self.from, XxHash64::oneshot(0, &held)))
    }
}

fn from(sources: &[&str], how: &[String]) -> Result<u64> {
    let mut held = PROGRAM.context("this program's own file can't be read")?.to_le_bytes().to_vec();
    for name in WORKSPACE {
        hold_file(&mut held, &root().join(name))?;
    }
    for source in sources {
        hold_folder(&mut held, &root().join(source))?;
    }
    for word in how {
        hold(&mut held, word.as_bytes());
    }
    Ok(XxHash64::oneshot(0, &held))
}

fn hold_folder(held: &mut Vec<u8>, folder: &Path) -> Result<()> {
    for entry in WalkDir::new(folder).sort_by_file_name() {
        let entry = entry.with_context(|| format!("{} can't be read", folder.display()))?;
        if entry.file_type().is_file() {
            hold_file(held, entry.path())?;
        }
    }
    Ok(())
}

fn hold_file(held: &mut Vec<u8>, file: &Path) -> Result<()> {
    hold(held, file.to_string_lossy().as_bytes());
    hold(held, &fs::read(file).with_context(|| format!("{} can't be read", file.display()))?);
    Ok(())
}

/// Adds length and hash, so that no byte can move from one part to the next unnoticed.
fn hold(held: &mut Vec<u8>, part: &[u8]) {
    held.extend_from_slice(&part.len().to_le_bytes());
    held.extend_from_slice(&XxHash64::oneshot(0, part).to_le_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_folder_stands_until_it_what_it_is_made_of_or_how_changes() {
        let home = format!("target/made-test-{}", std::process::id());
        let (folder, sources) = (root().join(&home).join("pkg"), format!("{home}/sources"));
        let source = root().join(&sources).join("a.rs");
        fs::create_dir_all(&folder).unwrap();
        fs::create_dir_all(root().join(&sources)).unwrap();
        fs::write(&source, "source").unwrap();
        fs::write(folder.join("a.js"), "made").unwrap();
        let parts = [sources.as_str()];
        let made = async |how: &str| Made::of(&folder, &parts, &[how]).await.unwrap();
        assert!(!made("how").await.stands().unwrap(), "nobody has kept it yet");
        made("how").await.keep().unwrap();
        assert!(made("how").await.stands().unwrap());
        assert!(!made("else").await.stands().unwrap());

        fs::write(&source, "another").unwrap();
        assert!(!made("how").await.stands().unwrap());
        fs::write(&source, "source").unwrap();
        assert!(made("how").await.stands().unwrap());

        let while_it_changes = made("how").await;
        while_it_changes.clear().unwrap();
        fs::create_dir_all(&folder).unwrap();
        fs::write(&source, "another").unwrap();
        while_it_changes.keep().unwrap();
        fs::write(&source, "source").unwrap();
        assert!(!made("how").await.stands().unwrap(), "nobody knows of which it was made");
        made("how").await.keep().unwrap();

        fs::write(folder.join("b.js"), "more").unwrap();
        assert!(!made("how").await.stands().unwrap());
        fs::remove_dir_all(&folder).unwrap();
        assert!(!made("how").await.stands().unwrap());
        fs::remove_file(&made("how").await.note).unwrap();
        fs::remove_dir_all(root().join(&home)).unwrap();
    }
}
