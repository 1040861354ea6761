//! What a fresh machine lacks. Tools are installed once per user, each version in a folder of its own
//! under the user's cache folder, so that another clone of the project finds them; a tool of the right
//! version on PATH is used as it is.
//!
//! wasm-opt is the delicate one. Up to binaryen 108 it breaks the page while saying that all went well
//! (it exports the wrong table), and up to 116 it can't read the `table.fill` that wasm-bindgen emits,
//! which rules out the `wasm-opt` crate. So: a recent one on PATH, else binaryen's npm package, else the
//! one that wasm-pack fetches by itself. An old one on PATH without npm is an error, because wasm-pack
//! would take it.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use etcetera::BaseStrategy;
use serde::Deserialize;
use tokio::process::Command;

use crate::{root, run};

const WASM_TARGET: &str = "wasm32-unknown-unknown";
const WASM_PACK: &str = "0.15.1";
/// The binaryen of the npm registry.
const BINARYEN: &str = "132.0.0";
/// Oldest binaryen seen to leave the page whole.
const BINARYEN_AT_LEAST: u32 = 130;

/// Whether the page's wasm goes through wasm-opt.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Optimise {
    /// It must; what is missing for it is an error.
    Yes,
    /// The user asked to leave it out, or the result is not a page for users.
    No,
}

/// Where wasm-opt comes from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum WasmOpt {
    /// It lies in one of the tools' folders.
    Found,
    /// wasm-pack downloads its own.
    FetchedByWasmPack,
    /// It is not used.
    LeftOut,
}

/// The tools that turn the wasm crate into the page's files.
pub(crate) struct WasmTools {
    wasm_pack: PathBuf,
    /// Folders to stand first on PATH.
    folders: Vec<PathBuf>,
    /// wasm-pack's own cache: it must exist, or wasm-pack fails with a bare "os error 2".
    wasm_pack_cache: PathBuf,
    wasm_opt: WasmOpt,
}

impl WasmTools {
    /// Finds the tools, installing what is missing.
    pub(crate) async fn ready(optimise: Optimise) -> Result<Self> {
        target(WASM_TARGET).await?;
        let cache = cache()?;
        let wasm_pack_cache = cache.join("wasm-pack");
        std::fs::create_dir_all(&wasm_pack_cache)
            .with_context(|| format!("{} can't be made", wasm_pack_cache.display()))?;

        let lock = std::fs::read_to_string(root().join("Cargo.lock")).context("Cargo.lock can't be read")?;
        let wasm_pack = Tool { package: "wasm-pack", program: "wasm-pack", version: WASM_PACK.to_owned() };
        // The command and the library must be equal to the last digit.
        let version = locked_version(&lock, "wasm-bindgen")?;
        let wasm_bindgen = Tool { package: "wasm-bindgen-cli", program: "wasm-bindgen", version };
        let mut folders = vec![wasm_pack.ready(&cache).await?, wasm_bindgen.ready(&cache).await?];
        let build = build_folder(&cache);
        if build.exists() {
            std::fs::remove_dir_all(&build)
                .with_context(|| format!("{} can't be removed", build.display()))?;
        }

        let wasm_opt = match optimise {
            Optimise::No => WasmOpt::LeftOut,
            Optimise::Yes => match wasm_opt(&cache).await? {
                Some(folder) => {
                    folders.push(folder);
                    WasmOpt::Found
                }
                None => WasmOpt::FetchedByWasmPack,
            },
        };
        let wasm_pack = find("wasm-pack", &folders[0]).context("wasm-pack vanished")?;
        Ok(Self { wasm_pack, folders, wasm_pack_cache, wasm_opt })
    }

    /// A wasm-pack call in the workspace's folder, with its helpers first on PATH.
    pub(crate) fn wasm_pack(&self) -> Result<Command> {
        let mut command = Command::new(&self.wasm_pack);
        command.current_dir(root()).env("WASM_PACK_CACHE", &self.wasm_pack_cache).env("PATH", self.path()?);
        Ok(command)
    }

    /// The options with which `wasm-pack build` treats wasm-opt as was decided.
    pub(crate) fn build_options(&self) -> &'static [&'static str] {
        match self.wasm_opt {
            WasmOpt::Found => &["--mode", "no-install"],
            WasmOpt::FetchedByWasmPack => &["--mode", "normal"],
            WasmOpt::LeftOut => &["--mode", "no-install", "--no-opt"],
        }
    }

    /// After a build: where wasm-pack was to fetch wasm-opt, did it? It skips it with a mere note on
    /// platforms that it has none for.
    pub(crate) fn check_optimised(&self) -> Result<()> {
        if self.wasm_opt != WasmOpt::FetchedByWasmPack {
            return Ok(());
        }
        let entries = std::fs::read_dir(&self.wasm_pack_cache).context("wasm-pack's cache can't be read")?;
        let fetched =
            entries.flatten().any(|entry| entry.file_name().to_string_lossy().starts_with("wasm-opt"));
        ensure!(fetched, "wasm-pack has no wasm-opt for this platform; {}", remedy());
        Ok(())
    }

    fn path(&self) -> Result<OsString> {
        let rest = env::var_os("PATH").unwrap_or_default();
        let folders = self.folders.iter().cloned().chain(env::split_paths(&rest));
        env::join_paths(folders).context("a folder on PATH can't be written there")
    }
}

/// A command that cargo can install.
struct Tool {
    package: &'static str,
    program: &'static str,
    version: String,
}

impl Tool {
    /// The folder that holds the tool, after installing it if need be.
    async fn ready(&self, cache: &Path) -> Result<PathBuf> {
        let home = cache.join("tools").join(format!("{}-{}", self.package, self.version));
        let own = home.join("bin");
        if self.fits(find(self.program, &own)).await {
            return Ok(own);
        }
        let on_path = which::which(self.program).ok();
        if self.fits(on_path.clone()).await
            && let Some(folder) = on_path.as_deref().and_then(Path::parent)
        {
            return Ok(folder.to_owned());
        }
        println!("installing {} {} (once; a minute or two)", self.package, self.version);
        let mut command = cargo();
        command.args(["install", "--locked", self.package, "--version", &self.version, "--root"]).arg(&home);
        // As fast in use as the full profile, and built in half its time; what the tools share is built once.
        command
            .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "1")
            .env("CARGO_PROFILE_RELEASE_LTO", "off")
            .env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16")
            .env("CARGO_TARGET_DIR", build_folder(cache));
        run::to_end(command, run::LIMIT)
            .await
            .with_context(|| format!("{} {} was not installed", self.package, self.version))?;
        ensure!(
            self.fits(find(self.program, &own)).await,
            "{} was installed to {} but does not answer as version {}",
            self.program,
            own.display(),
            self.version
        );
        Ok(own)
    }

    async fn fits(&self, program: Option<PathBuf>) -> bool {
        let Some(answer) = version_answer(program).await else { return false };
        answer.split_whitespace().nth(1) == Some(self.version.as_str())
    }
}

/// The folder of a wasm-opt that is recent enough, installing it by npm if need be; `None` if it is
/// left to wasm-pack to fetch one.
async fn wasm_opt(cache: &Path) -> Result<Option<PathBuf>> {
    let home = cache.join("tools").join(format!("binaryen-{BINARYEN}"));
    let own = home.join("node_modules").join(".bin");
    if wasm_opt_fits(find("wasm-opt", &own)).await {
        return Ok(Some(own));
    }
    let on_path = which::which("wasm-opt").ok();
    if wasm_opt_fits(on_path.clone()).await {
        return Ok(on_path.as_deref().and_then(Path::parent).map(Path::to_owned));
    }
    if let Ok(npm) = which::which("npm") {
        println!("installing binaryen {BINARYEN} for its wasm-opt (once)");
        std::fs::create_dir_all(&home).with_context(|| format!("{} can't be made", home.display()))?;
        let mut command = Command::new(npm);
        command.args(["install", "--no-audit", "--no-fund", "--no-update-notifier", "--prefix"]).arg(&home);
        command.arg(format!("binaryen@{BINARYEN}"));
        run::to_end(command, run::LIMIT).await.context("binaryen was not installed")?;
        ensure!(
            wasm_opt_fits(find("wasm-opt", &own)).await,
            "wasm-opt was installed to {} but does not run there; its node may be too old",
            own.display()
        );
        return Ok(Some(own));
    }
    if let Some(old) = on_path {
        bail!("{} is too old and would break the page without a word; {}", old.display(), remedy());
    }
    println!(
        "neither wasm-opt nor npm is here: wasm-pack will fetch wasm-opt itself; if it can't, {}",
        remedy()
    );
    Ok(None)
}

fn remedy() -> String {
    format!(
        "install Node.js with npm, or a wasm-opt of version {BINARYEN_AT_LEAST} or later, and run this again \
         (--no-opt does without)"
    )
}

async fn wasm_opt_fits(program: Option<PathBuf>) -> bool {
    version_answer(program).await.is_some_and(|answer| wasm_opt_version(&answer) >= Some(BINARYEN_AT_LEAST))
}

/// The number in `wasm-opt version 132 (version_132)`.
fn wasm_opt_version(answer: &str) -> Option<u32> {
    answer.split_whitespace().nth(2)?.parse().ok()
}

async fn version_answer(program: Option<PathBuf>) -> Option<String> {
    let mut command = Command::new(program?);
    command.arg("--version");
    run::output(command).await
}

/// `program` in `folder`, with whatever ending the system gives to programs.
fn find(program: &str, folder: &Path) -> Option<PathBuf> {
    which::which_in(program, Some(folder), root()).ok()
}

/// Where the tools lie, for all clones of the project of this user.
fn cache() -> Result<PathBuf> {
    let strategy =
        etcetera::base_strategy::choose_native_strategy().context("the user has no home folder")?;
    Ok(strategy.cache_dir().join("stepscope"))
}

fn build_folder(cache: &Path) -> PathBuf {
    cache.join("build")
}

/// The version of `package` in the text of a Cargo.lock; an error unless there is exactly one.
fn locked_version(lock: &str, package: &str) -> Result<String> {
    #[derive(Deserialize)]
    struct Lock {
        package: Vec<Package>,
    }
    #[derive(Deserialize)]
    struct Package {
        name: String,
        version: String,
    }
    let lock: Lock = toml::from_str(lock).context("Cargo.lock is not what it should be")?;
    let mut versions = lock.package.into_iter().filter(|it| it.name == package).map(|it| it.version);
    let version = versions.next().with_context(|| format!("Cargo.lock has no {package}"))?;
    ensure!(versions.next().is_none(), "Cargo.lock has {package} in two versions; the page can use only one");
    Ok(version)
}

/// A cargo call in the workspace's folder, of the tool chain that runs this.
pub(crate) fn cargo() -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root());
    command
}

/// Makes sure that the tool chain can build for `target`.
pub(crate) async fn target(target: &str) -> Result<()> {
    let mut command = Command::new("rustc");
    command.current_dir(root()).args(["--print", "target-libdir", "--target", target]);
    let folder = run::output(command).await.context("rustc does not answer")?;
    if Path::new(folder.trim()).exists() {
        return Ok(());
    }
    rustup(&["target", "add", target]).await
}

/// Makes sure that `cargo fmt` and `cargo clippy` are there.
pub(crate) async fn components() -> Result<()> {
    for (subcommand, component) in [("fmt", "rustfmt"), ("clippy", "clippy")] {
        let mut command = cargo();
        command.args([subcommand, "--version"]);
        if run::output(command).await.is_none() {
            rustup(&["component", "add", component]).await?;
        }
    }
    Ok(())
}

async fn rustup(arguments: &[&str]) -> Result<()> {
    let mut command = Command::new("rustup");
    command.current_dir(root()).args(arguments);
    run::to_end(command, run::LIMIT).await.with_context(|| {
        format!("`rustup {}` did not work; do it by hand, or by your Rust's own means", arguments.join(" "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lock_file_tells_the_one_version() {
        let entry =
            |name: &str, version: &str| format!("[[package]]\nname = \"{name}\"\nversion = \"{version}\"\n");
        let lock = |entries: &[(&str, &str)]| {
            let entries: String = entries.iter().map(|(name, version)| entry(name, version)).collect();
            format!("version = 4\n\n{entries}")
        };
        let one = lock(&[("wasm-bindgen-macro", "0.2.1"), ("wasm-bindgen", "0.2.129")]);
        assert_eq!(locked_version(&one, "wasm-bindgen").unwrap(), "0.2.129");
        for (text, expected) in [
            (lock(&[("libm", "0.2.16")]), "Cargo.lock has no wasm-bindgen"),
            (
                lock(&[("wasm-bindgen", "0.2.1"), ("wasm-bindgen", "0.2.2")]),
                "Cargo.lock has wasm-bindgen in two versions",
            ),
            ("package = 1".to_owned(), "Cargo.lock is not what it should be"),
        ] {
            let error = locked_version(&text, "wasm-bindgen").unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }

    #[test]
    fn the_workspace_lock_file_is_read() {
        let lock = std::fs::read_to_string(root().join("Cargo.lock")).unwrap();
        assert!(locked_version(&lock, "wasm-bindgen").unwrap().starts_with("0.2."));
    }

    #[test]
    fn an_old_wasm_opt_is_told_from_a_recent_one() {
        for (answer, expected) in [
            ("wasm-opt version 132 (version_132)\n", Some(132)),
            ("wasm-opt version 108\n", Some(108)),
            ("wasm-opt", None),
            ("something else entirely", None),
        ] {
            assert_eq!(wasm_opt_version(answer), expected, "{answer}");
        }
    }
}
