//! The packages as others would get them: the library crates, packed and built from what was packed; and the npm package,
//! packed, installed, and used by a plain Node program. Nothing is published.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use tokio::process::Command;
use walkdir::{DirEntry, WalkDir};

use crate::aside::say;
use crate::made::Made;
use crate::npm::node_program;
use crate::{page, root, run, toolchain};

/// What others may use, each after what it needs.
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
/// What the npm package has beside what wasm-pack lists: whose types its own are, and under which terms it comes.
const BESIDE: [&str; 4] = ["stepscope_wasm_bg.wasm.d.ts", "README.md", "LICENSE-MIT", "LICENSE-APACHE"];
/// The oldest Node that the test's program is written for.
const NODE: &str = ">=20.6";

/// Packs, builds and uses all of them.
pub(crate) async fn test() -> Result<()> {
    crates().await?;
    npm().await
}

/// Packs the library crates and builds each from its package, with the packages of the others.
async fn crates() -> Result<()> {
    // cargo takes a package of one name and version for one that never changes. Here it changes with the sources, so what
    // was unpacked and built of it before must go.
    let folder = root().join("target").join("packages");
    let packages = folder.join("package");
    let made = Made::of(&packages, &["core", "LICENSE-MIT", "LICENSE-APACHE"], &[]).await?;
    if made.stands()? {
        say("the library crates are those that were packed and built last");
        return Ok(());
    }
    made.clear()?;
    clear_own(&folder)?;
    for unpacked in unpacked(&cargo_home()?.join("registry").join("src")) {
        clear(&unpacked)?;
    }
    let mut command = toolchain::cargo();
    // Packages are made of work in progress, too.
    command.args(["package", "--locked", "--allow-dirty", "--target-dir"]).arg(&folder);
    for library in LIBRARIES {
        command.args(["--package", &format!("stepscope-{library}")]);
    }
    run::to_end(command).await?;
    made.keep()
}

/// Where cargo keeps what it has unpacked.
fn cargo_home() -> Result<PathBuf> {
    match env::var_os("CARGO_HOME") {
        Some(home) => Ok(home.into()),
        None => Ok(etcetera::home_dir().context("the user has no home folder")?.join(".cargo")),
    }
}

/// The library crates among what is unpacked in `sources`, in the folders of registries that are folders themselves: these
/// have no host, so their names begin with the hyphen that follows it.
fn unpacked(sources: &Path) -> Vec<PathBuf> {
    let registries = fs::read_dir(sources).into_iter().flatten().flatten();
    let own = registries.filter(|registry| registry.file_name().to_string_lossy().starts_with('-'));
    let names = LIBRARIES.map(|library| format!("stepscope-{library}-{}", env!("CARGO_PKG_VERSION")));
    own.flat_map(|registry| names.clone().map(|name| registry.path().join(name)))
        .filter(|package| package.exists())
        .collect()
}

fn clear(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("{} can't be cleared", folder.display()))?;
    }
    Ok(())
}

/// Clears what was made of the library crates; what they need of others stays.
fn clear_own(folder: &Path) -> Result<()> {
    if !folder.exists() {
        return Ok(());
    }
    let own = |entry: &DirEntry| entry.file_name().to_string_lossy().contains("stepscope");
    let mut all = WalkDir::new(folder).into_iter();
    while let Some(entry) = all.next() {
        let entry = entry.with_context(|| format!("{} can't be read", folder.display()))?;
        if !own(&entry) {
            continue;
        }
        if entry.file_type().is_dir() {
            all.skip_current_dir();
            clear(entry.path())?;
        } else {
            let problem = || format!("{} can't be removed", entry.path().display());
            fs::remove_file(entry.path()).with_context(problem)?;
        }
    }
    Ok(())
}

/// Packs the npm package, installs it where nothing else is, and runs a program that uses it.
async fn npm() -> Result<()> {
    let npm = node_program("npm").await?;
    let home = root().join("target").join("npm");
    let made = home.join("pkg");
    page::npm(&made).await?;
    let folder = home.join("trial");
    clear(&folder)?;
    let user = folder.join("user");
    fs::create_dir_all(&user).with_context(|| format!("{} can't be made", user.display()))?;

    let mut pack = Command::new(&npm);
    pack.current_dir(&made).args(["pack", "--pack-destination"]).arg(&folder);
    run::to_end(pack).await?;
    let package = packed(&folder)?;

    let mut install = Command::new(&npm);
    install.args(["install", "--offline", "--no-audit", "--no-fund", "--prefix"]).arg(&user).arg(&package);
    run::to_end(install).await?;

    let tests = root().join("tests");
    let script = user.join("preset.mjs");
    fs::copy(tests.join("npm").join("preset.mjs"), &script).context("the test's program can't be copied")?;
    let mut node = Command::new(node_program("node").await?);
    node.arg(&script).arg(tests.join("golden"));
    run::to_end(node).await.with_context(|| format!("the program needs Node {NODE}"))
}

/// The one package in a folder.
fn packed(folder: &Path) -> Result<PathBuf> {
    let files = fs::read_dir(folder).with_context(|| format!("{} can't be read", folder.display()))?;
    let mut packages = files.filter_map(|entry| entry.ok().map(|entry| entry.path()));
    packages.find(|path| path.extension().is_some_and(|end| end == "tgz")).context("npm packed nothing")
}

/// Adds to the npm package in `folder` what wasm-pack does not know of.
pub(crate) fn complete(folder: &Path) -> Result<()> {
    let file = folder.join("package.json");
    let text = fs::read_to_string(&file).with_context(|| format!("{} can't be read", file.display()))?;
    for name in BESIDE {
        ensure!(folder.join(name).is_file(), "{name} is not in {}", folder.display());
    }
    fs::write(&file, completed(&text)?).with_context(|| format!("{} can't be written", file.display()))
}

/// The text of package.json, with all that is to be packed and the Node that it is tested with.
fn completed(text: &str) -> Result<String> {
    let mut package: Value = serde_json::from_str(text).context("wasm-pack's package.json is no JSON")?;
    let files = package.get_mut("files").and_then(Value::as_array_mut);
    let files = files.context("wasm-pack's package.json lists no files")?;
    for name in BESIDE {
        if !files.iter().any(|file| file == name) {
            files.push(json!(name));
        }
    }
    let fields = package.as_object_mut().context("wasm-pack's package.json is no object")?;
    fields.insert("engines".to_owned(), json!({ "node": NODE }));
    Ok(serde_json::to_string_pretty(&package)? + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_library_crates_of_registries_without_a_host_are_taken_for_unpacked() {
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
    fn what_wasm_pack_leaves_out_is_added_once() {
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
