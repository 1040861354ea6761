//! Records what a folder was built from, to skip a build that would not change it. Optimizing the page's wasm and building
//! the packages take minutes, and most changes touch neither.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::{env, fs};

use anyhow::{Context, Result};
use twox_hash::XxHash64;

use crate::{THIS_PROGRAM, files, root, toolchain};

const WORKSPACE: [&str; 3] = ["Cargo.toml", "Cargo.lock", ".cargo/config.toml"];

/// Prefixes of environment variables that change cargo's or rustc's result.
const VARIABLES: [&str; 6] =
    ["CARGO_PROFILE_", "CARGO_TARGET_", "CARGO_BUILD_", "CARGO_ENCODED_", "RUSTC", "RUSTFLAGS"];

/// Hashed at the start: this program may be rebuilt while it runs.
pub(crate) static PROGRAM: LazyLock<Option<u64>> = LazyLock::new(|| {
    let program = fs::read(THIS_PROGRAM.as_ref().ok()?).ok()?;
    Some(XxHash64::oneshot(0, &program))
});

pub(crate) struct BuildRecord<'a> {
    folder: &'a Path,
    sources: &'a [&'a str],
    /// Options, version of Rust, and environment variables.
    options: Vec<String>,
    file: PathBuf,
    /// Hash of all inputs at the start.
    inputs: u64,
}

impl<'a> BuildRecord<'a> {
    /// `folder`, built by this program and this Rust from these folders of the workspace with these options.
    pub(crate) async fn of(folder: &'a Path, sources: &'a [&'a str], options: &[&str]) -> Result<Self> {
        let mut options: Vec<_> = options.iter().map(|&option| option.to_owned()).collect();
        options.push(toolchain::version().await?);
        let mut variables: Vec<_> = env::vars_os()
            .map(|(name, value)| (name.to_string_lossy().into_owned(), value))
            .filter(|(name, _)| VARIABLES.iter().any(|prefix| name.starts_with(prefix)))
            .map(|(name, value)| format!("{name}={}", value.to_string_lossy()))
            .collect();
        variables.sort();
        options.extend(variables);
        let name = folder.strip_prefix(root()).unwrap_or(folder).to_string_lossy().replace(['/', '\\'], "-");
        let file = root().join("target").join("build-records").join(name);
        let inputs = hash_of_inputs(sources, &options)?;
        Ok(Self { folder, sources, options, file, inputs })
    }

    pub(crate) fn is_current(&self) -> Result<bool> {
        let Ok(saved) = fs::read_to_string(&self.file) else { return Ok(false) };
        Ok(self.folder.is_dir() && saved == self.text()?)
    }

    pub(crate) fn clear(&self) -> Result<()> {
        if self.file.exists() {
            files::remove(&self.file)?;
        }
        files::remove_folder(self.folder)
    }

    /// Saves the record, unless an input has changed meanwhile.
    pub(crate) fn save(&self) -> Result<()> {
        if hash_of_inputs(self.sources, &self.options)? != self.inputs {
            return Ok(());
        }
        files::create_folder(self.file.parent().context("a record has a folder")?)?;
        files::write(&self.file, self.text()?)
    }

    fn text(&self) -> Result<String> {
        let mut hashed = Vec::new();
        add_folder(&mut hashed, self.folder)?;
        Ok(format!("{:016x} {:016x}\n", self.inputs, XxHash64::oneshot(0, &hashed)))
    }
}

fn hash_of_inputs(sources: &[&str], options: &[String]) -> Result<u64> {
    let mut hashed = PROGRAM.context("this program's own file can't be read")?.to_le_bytes().to_vec();
    for name in WORKSPACE {
        add_file(&mut hashed, &root().join(name))?;
    }
    for source in sources {
        add_folder(&mut hashed, &root().join(source))?;
    }
    for option in options {
        add(&mut hashed, option.as_bytes());
    }
    Ok(XxHash64::oneshot(0, &hashed))
}

fn add_folder(hashed: &mut Vec<u8>, folder: &Path) -> Result<()> {
    files::below(folder)?.iter().try_for_each(|file| add_file(hashed, file.path()))
}

fn add_file(hashed: &mut Vec<u8>, file: &Path) -> Result<()> {
    add(hashed, file.to_string_lossy().as_bytes());
    add(hashed, &files::read_bytes(file)?);
    Ok(())
}

/// Adds length and hash of a part, so that moving a byte from one part to the next changes the result.
fn add(hashed: &mut Vec<u8>, part: &[u8]) {
    hashed.extend_from_slice(&part.len().to_le_bytes());
    hashed.extend_from_slice(&XxHash64::oneshot(0, part).to_le_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_record_is_current_until_folder_sources_or_options_change() {
        let home = format!("target/build-record-test-{}", std::process::id());
        let (folder, sources) = (root().join(&home).join("pkg"), format!("{home}/sources"));
        let source = root().join(&sources).join("a.rs");
        fs::create_dir_all(&folder).unwrap();
        fs::create_dir_all(root().join(&sources)).unwrap();
        fs::write(&source, "source").unwrap();
        fs::write(folder.join("a.js"), "made").unwrap();
        let parts = [sources.as_str()];
        let record = async |option: &str| BuildRecord::of(&folder, &parts, &[option]).await.unwrap();
        assert!(!record("option").await.is_current().unwrap(), "no record is saved");
        record("option").await.save().unwrap();
        assert!(record("option").await.is_current().unwrap());
        assert!(!record("other").await.is_current().unwrap());

        fs::write(&source, "another").unwrap();
        assert!(!record("option").await.is_current().unwrap());
        fs::write(&source, "source").unwrap();
        assert!(record("option").await.is_current().unwrap());

        let during_change = record("option").await;
        during_change.clear().unwrap();
        fs::create_dir_all(&folder).unwrap();
        fs::write(&source, "another").unwrap();
        during_change.save().unwrap();
        fs::write(&source, "source").unwrap();
        assert!(!record("option").await.is_current().unwrap(), "the sources changed during the build");
        record("option").await.save().unwrap();

        fs::write(folder.join("b.js"), "more").unwrap();
        assert!(!record("option").await.is_current().unwrap());
        fs::remove_dir_all(&folder).unwrap();
        assert!(!record("option").await.is_current().unwrap());
        fs::remove_file(&record("option").await.file).unwrap();
        fs::remove_dir_all(root().join(&home)).unwrap();
    }
}
