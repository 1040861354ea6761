//! What was made of what: whether a folder of built files is still what the same build would make again.
//!
//! Binding and optimising the page's wasm takes minutes, and most changes are not of the core.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use twox_hash::XxHash64;
use walkdir::WalkDir;

use crate::{THIS_PROGRAM, root};

/// A folder, and the hash of all that it is made of.
pub(crate) struct Made {
    folder: PathBuf,
    /// Where it is kept what the folder was made of last, and what it was then.
    note: PathBuf,
    from: u64,
}

impl Made {
    /// `folder`, made by this program of these files, by `how`.
    pub(crate) fn of(folder: &Path, files: &[PathBuf], how: &[&str]) -> Result<Self> {
        let this = THIS_PROGRAM.as_ref().context("this program's own path is unknown")?;
        let mut held = Vec::new();
        for file in files.iter().chain([this]) {
            hold(&mut held, &file.to_string_lossy(), &read(file)?);
        }
        for word in how {
            hold(&mut held, word, &[]);
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
        for entry in WalkDir::new(&self.folder).sort_by_file_name() {
            let entry = entry.with_context(|| format!("{} can't be read", self.folder.display()))?;
            if entry.file_type().is_file() {
                hold(&mut held, &entry.path().to_string_lossy(), &read(entry.path())?);
            }
        }
        Ok(format!("{:016x} {:016x}\n", self.from, XxHash64::oneshot(0, &held)))
    }
}

fn read(file: &Path) -> Result<Vec<u8>> {
    fs::read(file).with_context(|| format!("{} can't be read", file.display()))
}

/// Adds something of this name, so that nothing can be moved from one to the next unseen.
fn hold(held: &mut Vec<u8>, name: &str, bytes: &[u8]) {
    for part in [name.as_bytes(), bytes] {
        held.extend_from_slice(&part.len().to_le_bytes());
        held.extend_from_slice(&XxHash64::oneshot(0, part).to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_stands_until_it_what_it_is_made_of_or_how_changes() {
        let home = root().join("target").join(format!("made-test-{}", std::process::id()));
        let (folder, source) = (home.join("pkg"), home.join("source"));
        fs::create_dir_all(&folder).unwrap();
        fs::write(&source, "source").unwrap();
        fs::write(folder.join("a.js"), "made").unwrap();
        let made = |how: &str| Made::of(&folder, std::slice::from_ref(&source), &[how]).unwrap();
        assert!(!made("how").stands().unwrap(), "nobody has kept it yet");
        made("how").keep().unwrap();
        assert!(made("how").stands().unwrap());
        assert!(!made("else").stands().unwrap());

        fs::write(&source, "another").unwrap();
        assert!(!made("how").stands().unwrap());
        fs::write(&source, "source").unwrap();
        assert!(made("how").stands().unwrap());

        fs::write(folder.join("b.js"), "more").unwrap();
        assert!(!made("how").stands().unwrap());
        fs::remove_dir_all(&folder).unwrap();
        assert!(!made("how").stands().unwrap());
        fs::remove_file(&made("how").note).unwrap();
        fs::remove_dir_all(&home).unwrap();
    }
}
