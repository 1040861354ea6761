//! Packs and builds the library crates and the npm package as users get them; publishes nothing.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use tokio::process::Command;
use walkdir::{DirEntry, WalkDir};

use crate::build_record::BuildRecord;
use crate::npm::node_program;
use crate::output_buffer::print_line;
use crate::{files, page, root, run, toolchain};

const LIBRARIES: [&str; 10] = [
    "registers",
    "peripheral",
    "motion",
    "plant",
    "controller",
    "capture",
    "scenario",
    "sim",
    "inspect",
    "core",
];
/// Files that wasm-pack does not list: the types and the licenses.
const UNLISTED: [&str; 4] = ["stepscope_wasm_bg.wasm.d.ts", "README.md", "LICENSE-MIT", "LICENSE-APACHE"];
/// The oldest version that the test's program supports.
const NODE: &str = ">=20.6";

pub(crate) async fn test() -> Result<()> {
    crates().await?;
    npm().await
}

async fn crates() -> Result<()> {
    // cargo assumes that a version of a package never changes, but here it does, so copies from earlier runs are removed.
    let folder = root().join("target").join("packages");
    let packages = folder.join("package");
    let record = BuildRecord::of(&packages, &["core", "LICENSE-MIT", "LICENSE-APACHE"], &[]).await?;
    if record.is_current()? {
        print_line("the library crates are up to date");
        return Ok(());
    }
    record.clear()?;
    clear_own(&folder)?;
    for unpacked in unpacked(&cargo_home()?.join("registry").join("src")) {
        files::remove_folder(&unpacked)?;
    }
    let mut command = toolchain::cargo();
    command.args(["package", "--locked", "--allow-dirty", "--target-dir"]).arg(&folder);
    for library in LIBRARIES {
        command.args(["--package", &format!("stepscope-{library}")]);
    }
    run::compile(command).await?;
    record.save()
}

fn cargo_home() -> Result<PathBuf> {
    match env::var_os("CARGO_HOME") {
        Some(home) => Ok(home.into()),
        None => Ok(etcetera::home_dir().context("the user has no home folder")?.join(".cargo")),
    }
}

/// Our crates in `sources`. A registry in a folder has no host, so its folder's name begins with a hyphen.
fn unpacked(sources: &Path) -> Vec<PathBuf> {
    let registries = fs::read_dir(sources).into_iter().flatten().flatten();
    let own = registries.filter(|registry| registry.file_name().to_string_lossy().starts_with('-'));
    let names = LIBRARIES.map(|library| format!("stepscope-{library}-{}", env!("CARGO_PKG_VERSION")));
    own.flat_map(|registry| names.clone().map(|name| registry.path().join(name)))
        .filter(|package| package.exists())
        .collect()
}

/// Removes our crates, but not the builds of third-party crates.
fn clear_own(folder: &Path) -> Result<()> {
    if !folder.exists() {
        return Ok(());
    }
    let is_own = |entry: &DirEntry| entry.file_name().to_string_lossy().contains("stepscope");
    let mut all = WalkDir::new(folder).into_iter();
    while let Some(entry) = all.next() {
        let entry = entry.with_context(|| format!("{} can't be read", folder.display()))?;
        if !is_own(&entry) {
            continue;
        }
        if entry.file_type().is_dir() {
            all.skip_current_dir();
            files::remove_folder(entry.path())?;
        } else {
            files::remove(entry.path())?;
        }
    }
    Ok(())
}

async fn npm() -> Result<()> {
    let npm = node_program("npm").await?;
    let home = root().join("target").join("npm");
    let built = home.join("pkg");
    page::npm(&built).await?;
    let folder = home.join("trial");
    files::remove_folder(&folder)?;
    let user = folder.join("user");
    files::create_folder(&user)?;

    let mut pack = Command::new(&npm);
    pack.current_dir(&built).args(["pack", "--pack-destination"]).arg(&folder);
    run::to_end(pack).await?;
    let package = packed(&folder)?;

    let mut install = Command::new(&npm);
    install.args(["install", "--offline", "--no-audit", "--no-fund", "--prefix"]).arg(&user).arg(&package);
    run::to_end(install).await?;

    let tests = root().join("tests");
    let script = user.join("preset.mjs");
    fs::copy(tests.join("npm").join("preset.mjs"), &script).context("preset.mjs can't be copied")?;
    let mut node = Command::new(node_program("node").await?);
    node.arg(&script).arg(tests.join("golden"));
    run::to_end(node).await.with_context(|| format!("the program needs Node {NODE}"))
}

fn packed(folder: &Path) -> Result<PathBuf> {
    let files = fs::read_dir(folder).with_context(|| format!("{} can't be read", folder.display()))?;
    let mut packages = files.filter_map(|entry| entry.ok().map(|entry| entry.path()));
    packages.find(|path| path.extension().is_some_and(|end| end == "tgz")).context("npm created no package")
}

/// Adds what wasm-pack leaves out of `package.json`.
pub(crate) fn complete(folder: &Path) -> Result<()> {
    let file = folder.join("package.json");
    let text = files::read(&file)?;
    for name in UNLISTED {
        ensure!(folder.join(name).is_file(), "{name} is missing in {}", folder.display());
    }
    files::write(&file, completed(&text)?)
}

fn completed(text: &str) -> Result<String> {
    let mut package: Value = serde_json::from_str(text).context("wasm-pack's package.json is not JSON")?;
    let files = package.get_mut("files").and_then(Value::as_array_mut);
    let files = files.context("wasm-pack's package.json lists no files")?;
    for name in UNLISTED {
        if !files.iter().any(|file| file == name) {
            files.push(json!(name));
        }
    }
    let fields = package.as_object_mut().context("wasm-pack's package.json is not an object")?;
    fields.insert("engines".to_owned(), json!({ "node": NODE }));
    Ok(serde_json::to_string_pretty(&package)? + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unpacked_crates_are_those_of_registries_without_a_host() {
        let sources = env::temp_dir().join(format!("stepscope-unpacked-{}", std::process::id()));
        let version = env!("CARGO_PKG_VERSION");
        for name in ["-1f/stepscope-motion", "-1f/other", "index-2f/stepscope-motion"] {
            fs::create_dir_all(sources.join(format!("{name}-{version}"))).unwrap();
        }
        let expected = sources.join("-1f").join(format!("stepscope-motion-{version}"));
        assert_eq!(unpacked(&sources), [expected]);
        fs::remove_dir_all(&sources).unwrap();
        assert!(unpacked(&sources).is_empty());
    }

    #[test]
    fn missing_files_are_added_to_package_json_once() {
        let once = completed(r#"{ "name": "a", "files": ["a.js", "README.md"] }"#).unwrap();
        let package: Value = serde_json::from_str(&once).unwrap();
        let expected = ["a.js", "README.md", "stepscope_wasm_bg.wasm.d.ts", "LICENSE-MIT", "LICENSE-APACHE"];
        assert_eq!(package["files"], json!(expected));
        assert_eq!(package["engines"]["node"], NODE);
        assert_eq!(completed(&once).unwrap(), once);
        let error = completed(r#"{ "name": "a" }"#).unwrap_err().to_string();
        assert_eq!(error, "wasm-pack's package.json lists no files");
    }
}
