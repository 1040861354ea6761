//! What was made of what: whether a folder of built files is still what the same build would make again.
//!
//! Binding and optimising the page's wasm takes minutes, and so does building the library crates from their packages;
//! most changes are of neither.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use twox_hash::XxHash64;
use walkdir::WalkDir;

use crate::{THIS_PROGRAM, root, toolchain};

/// What decides, beside its sources, what becomes of any crate of the workspace.
const WORKSPACE: [&str; 3] = ["Cargo.toml", "Cargo.lock", ".cargo/config.toml"];

/// A folder, and the hash of all that it is made of.
pub(crate) struct Made {
    folder: PathBuf,
    /// Where it is kept what the folder was made of last, and what it was then.
    note: PathBuf,
    from: u64,
}

impl Made {
    /// `folder`, made by this program and this Rust of what lies in these folders of the workspace, by `how`.
    pub(crate) async fn of(folder: &Path, sources: &[&str], how: &[&str]) -> Result<Self> {
        let this = THIS_PROGRAM.as_ref().context("this program's own path is unknown")?;
        let mut held = Vec::new();
        hold_file(&mut held, this)?;
        for name in WORKSPACE {
            hold_file(&mut held, &root().join(name))?;
        }
        for source in sources {
            hold_folder(&mut held, &root().join(source))?;
        }
        for word in how.iter().copied().chain([toolchain::version().await?.as_str()]) {
            hold(&mut held, word.as_bytes());
        }
        let name = folder.strip_prefix(root()).unwrap_or(folder).to_string_lossy().replace(['/', '\\'], "-");
        let note = root().join("target").join("made").join(name);
        Ok(Self { folder: folder.to_owned(), note, from: XxHash64::oneshot(0, &held) })
    }

    /// Whether the folder was made of the same and nobody has changed it since.
    pub(crate) fn stands(&self) -> Result<bool> {
        let Ok(noted) = fs::read_to_string(&self.note) else { return Ok(false) };
        Ok(self.folder.is_dir() && noted == self.words()?)
    }

    /// Keeps that the folder is made.
    pub(crate) fn keep(&self) -> Result<()> {
        let at = self.note.parent().context("a note has a folder")?;
        let problem = || format!("{} can't be written", self.note.display());
        fs::create_dir_all(at).with_context(problem)?;
        fs::write(&self.note, self.words()?).with_context(problem)
    }

    fn words(&self) -> Result<String> {
        let mut held = Vec::new();
        hold_folder(&mut held, &self.folder)?;
        Ok(format!("{:016x} {:016x}\n", self.from, XxHash64::oneshot(0, &held)))
    }
}

/// Adds all files of a folder, by their names and what they hold.
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

/// Adds the length and the hash of a part, so that nothing can move from one to the next unseen.
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
        let made = async |how: &str| Made::of(&folder, &[&sources], &[how]).await.unwrap();
        assert!(!made("how").await.stands().unwrap(), "nobody has kept it yet");
        made("how").await.keep().unwrap();
        assert!(made("how").await.stands().unwrap());
        assert!(!made("else").await.stands().unwrap());

        fs::write(&source, "another").unwrap();
        assert!(!made("how").await.stands().unwrap());
        fs::write(&source, "source").unwrap();
        assert!(made("how").await.stands().unwrap());

        fs::write(folder.join("b.js"), "more").unwrap();
        assert!(!made("how").await.stands().unwrap());
        fs::remove_dir_all(&folder).unwrap();
        assert!(!made("how").await.stands().unwrap());
        fs::remove_file(&made("how").await.note).unwrap();
        fs::remove_dir_all(root().join(&home)).unwrap();
    }
}
