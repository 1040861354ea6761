//! Installs missing tools of fixed versions into the user cache; a tool of that version on PATH is used instead.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use etcetera::BaseStrategy;
use serde::Deserialize;
use tokio::process::Command;

use crate::output_buffer::print_line;
use crate::{files, root, run, toolchain, wasm_opt};

const WASM_PACK: &str = "0.15.1";
const CARGO_FUZZ: &str = "0.13.2";
const CARGO_MUTANTS: &str = "27.1.0";
const GECKODRIVER: &str = "0.37.1";

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Optimize {
    Yes,
    /// The user opted out, or the result is not for users.
    No,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum WasmOpt {
    Found,
    FetchedByWasmPack,
    NotUsed,
}

pub(crate) struct WasmTools {
    wasm_pack: PathBuf,
    folders: Vec<PathBuf>,
    /// Must exist, or wasm-pack fails with a bare "os error 2".
    wasm_pack_cache: PathBuf,
    wasm_opt: WasmOpt,
    wasm_opt_version: String,
}

impl WasmTools {
    pub(crate) async fn ready(optimize: Optimize) -> Result<Self> {
        toolchain::target(toolchain::WASM).await?;
        let cache = cache()?;
        let wasm_pack_cache = cache.join("wasm-pack");
        files::create_folder(&wasm_pack_cache)?;

        let lock = std::fs::read_to_string(root().join("Cargo.lock")).context("Cargo.lock can't be read")?;
        // wasm-bindgen's command and library must have exactly the same version.
        let wasm_bindgen = locked_version(&lock, "wasm-bindgen")?;
        let wasm_pack = Tool { package: "wasm-pack", program: "wasm-pack", version: WASM_PACK.to_owned() };
        let wasm_bindgen =
            Tool { package: "wasm-bindgen-cli", program: "wasm-bindgen", version: wasm_bindgen };
        let mut programs = ready(&cache, &[wasm_pack, wasm_bindgen]).await?;
        let wasm_pack = programs[0].clone();
        let mut wasm_opt_version = String::new();
        let wasm_opt = match optimize {
            Optimize::No => WasmOpt::NotUsed,
            Optimize::Yes => match wasm_opt::ready(&cache).await? {
                Some(program) => {
                    wasm_opt_version = version_output(&program).await.unwrap_or_default();
                    programs.push(program);
                    WasmOpt::Found
                }
                None => WasmOpt::FetchedByWasmPack,
            },
        };
        // Tools on PATH are not added: their folder may contain another cargo.
        let own = programs.iter().filter(|program| program.starts_with(&cache));
        let folders = own.filter_map(|program| program.parent()).map(Path::to_owned).collect();
        Ok(Self { wasm_pack, folders, wasm_pack_cache, wasm_opt, wasm_opt_version })
    }

    pub(crate) fn wasm_pack(&self) -> Result<Command> {
        let mut command = Command::new(&self.wasm_pack);
        command.current_dir(root()).env("WASM_PACK_CACHE", &self.wasm_pack_cache).env("PATH", self.path()?);
        Ok(command)
    }

    pub(crate) fn build_options(&self) -> &'static [&'static str] {
        match self.wasm_opt {
            WasmOpt::Found => &["--mode", "no-install"],
            WasmOpt::FetchedByWasmPack => &["--mode", "normal"],
            WasmOpt::NotUsed => &["--mode", "no-install", "--no-opt"],
        }
    }

    /// Identifies the build: the options, and the tools' folders, whose names contain versions.
    pub(crate) fn identity(&self) -> Vec<&str> {
        let folders = self.folders.iter().filter_map(|folder| folder.to_str());
        self.build_options().iter().copied().chain(folders).chain([self.wasm_opt_version.as_str()]).collect()
    }

    /// wasm-pack reports success even if wasm-opt did not run, so this checks for it.
    pub(crate) fn check(&self, result: Result<()>) -> Result<()> {
        let result = result.context("the page was not built");
        match self.wasm_opt {
            WasmOpt::Found | WasmOpt::NotUsed => result,
            WasmOpt::FetchedByWasmPack => wasm_opt::check_fetch(result, &self.wasm_pack_cache),
        }
    }

    fn path(&self) -> Result<OsString> {
        let path = env::var_os("PATH").unwrap_or_default();
        let folders = self.folders.iter().cloned().chain(env::split_paths(&path));
        env::join_paths(folders).context("a folder's name can't be part of PATH")
    }
}

pub(crate) async fn cargo_fuzz() -> Result<PathBuf> {
    let tool = Tool { package: "cargo-fuzz", program: "cargo-fuzz", version: CARGO_FUZZ.to_owned() };
    ready(&cache()?, &[tool]).await?.pop().context("cargo-fuzz is missing")
}

pub(crate) async fn cargo_mutants() -> Result<PathBuf> {
    let tool = Tool { package: "cargo-mutants", program: "cargo-mutants", version: CARGO_MUTANTS.to_owned() };
    ready(&cache()?, &[tool]).await?.pop().context("cargo-mutants is missing")
}

pub(crate) async fn geckodriver() -> Result<PathBuf> {
    let tool = Tool { package: "geckodriver", program: "geckodriver", version: GECKODRIVER.to_owned() };
    ready(&cache()?, &[tool]).await?.pop().context("geckodriver is missing")
}

async fn ready(cache: &Path, tools: &[Tool]) -> Result<Vec<PathBuf>> {
    let mut programs = Vec::new();
    let mut installed = false;
    for tool in tools {
        programs.push(match tool.find(cache).await {
            Some(program) => program,
            None => {
                installed = true;
                tool.install(cache).await?
            }
        });
    }
    if installed {
        let _ = std::fs::remove_dir_all(build_folder(cache));
    }
    Ok(programs)
}

struct Tool {
    package: &'static str,
    program: &'static str,
    version: String,
}

impl Tool {
    fn home(&self, cache: &Path) -> PathBuf {
        cache.join("tools").join(format!("{}-{}", self.package, self.version))
    }

    async fn find(&self, cache: &Path) -> Option<PathBuf> {
        let own = find(self.program, &self.home(cache).join("bin"));
        for program in [own, which::which(self.program).ok()].into_iter().flatten() {
            if self.has_version(&program).await {
                return Some(program);
            }
        }
        None
    }

    async fn install(&self, cache: &Path) -> Result<PathBuf> {
        let home = self.home(cache);
        print_line(format_args!("installing {} {} (once; a minute or two)", self.package, self.version));
        let mut command = toolchain::cargo();
        command.args(["install", "--force", "--locked", self.package]);
        command.args(["--version", &self.version, "--root"]).arg(&home);
        // As fast in use as the full profile, but built in half the time. The tools share one build folder.
        command
            .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "1")
            .env("CARGO_PROFILE_RELEASE_LTO", "off")
            .env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16")
            .env("CARGO_TARGET_DIR", build_folder(cache));
        run::compile(command).await?;
        let program = find(self.program, &home.join("bin")).context("cargo installed it elsewhere")?;
        ensure!(
            self.has_version(&program).await,
            "{} was installed but does not report version {}",
            program.display(),
            self.version
        );
        Ok(program)
    }

    async fn has_version(&self, program: &Path) -> bool {
        let output = match version_output(program).await {
            Some(output) => output,
            None => version_of_subcommand(program).await.unwrap_or_default(),
        };
        output.split_whitespace().nth(1) == Some(self.version.as_str())
    }
}

/// The output of `--version`; `None` if the program fails.
pub(crate) async fn version_output(program: &Path) -> Option<String> {
    let mut command = Command::new(program);
    command.arg("--version");
    run::output(command).await
}

/// Some subcommands report a version only if called as cargo does: `cargo-mutants mutants --version`.
async fn version_of_subcommand(program: &Path) -> Option<String> {
    let mut command = Command::new(program);
    command.args([program.file_stem()?.to_str()?.strip_prefix("cargo-")?, "--version"]);
    run::output(command).await
}

pub(crate) fn find(program: &str, folder: &Path) -> Option<PathBuf> {
    which::which_in(program, Some(folder), root()).ok()
}

pub(crate) fn cache() -> Result<PathBuf> {
    let strategy = etcetera::base_strategy::choose_native_strategy().context("there is no home folder")?;
    Ok(strategy.cache_dir().join("stepscope"))
}

fn build_folder(cache: &Path) -> PathBuf {
    cache.join("build")
}

/// The only version of a package in a lock file.
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
    let lock: Lock = toml::from_str(lock).context("Cargo.lock is invalid")?;
    let mut versions = lock.package.into_iter().filter(|one| one.name == package).map(|one| one.version);
    let version = versions.next().with_context(|| format!("Cargo.lock has no {package}"))?;
    ensure!(versions.next().is_none(), "Cargo.lock has {package} in two versions; the page can use only one");
    Ok(version)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_only_version_in_a_lock_file_is_found() {
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
            ("package = 1".to_owned(), "Cargo.lock is invalid"),
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
}
