//! `cargo xtask fuzz` runs libFuzzer on the checks of `tests/src/fuzzing.rs`, through cargo-fuzz.
//!
//! Sanitizers need a nightly Rust and find errors that safe Rust cannot contain. With `--sanitizer none` stable Rust also
//! measures coverage; debug assertions and overflow checks are on.
//!
//! Every run starts with the same inputs: seeds made from the repository, and earlier findings. So the same `--seed`
//! repeats a run. Without one, a random seed is used and printed.

mod report;

use std::fs;
use std::hash::{BuildHasher as _, RandomState};
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;
use tokio::process::Command;

use crate::{files, root, run, toolchain, tools};
use report::Report;

const GRACE: Duration = Duration::from_secs(120);
const INPUT_SECONDS: u32 = 10;
const MEMORY_MB: u32 = 2048;

pub(crate) struct Options {
    pub(crate) targets: Vec<String>,
    pub(crate) seconds: u32,
    /// Not 0, which libFuzzer replaces by a random seed.
    pub(crate) seed: u32,
}

pub(crate) fn new_seed() -> u32 {
    let random = RandomState::new().hash_one(std::process::id());
    (random as u32).max(1)
}

pub(crate) async fn run(options: Options) -> Result<()> {
    let manifest = root().join("fuzz").join("Cargo.toml");
    let text = files::read(&manifest)?;
    let targets = chosen(&names(&text)?, &options.targets)?;
    let home = root().join("target").join("fuzz");
    let programs = build(&manifest, &home.join("build")).await?;
    inputs(&home).await?;

    let mut failed = Vec::new();
    for target in &targets {
        println!("\n=== {target}: {} s, seed {}", options.seconds, options.seed);
        let folder = home.join(target);
        let report = fuzz(&programs.join(target), &folder, &options).await?;
        println!("{report}");
        if let Some(input) = &report.finding {
            let input = folder.join(input);
            println!("{}", advice(target, &input, &programs.join(target)));
            failed.push(target.as_str());
        }
    }
    ensure!(failed.is_empty(), "failing inputs in: {}", failed.join(", "));
    println!("\nno failing input in {}", targets.join(", "));
    Ok(())
}

fn names(manifest: &str) -> Result<Vec<String>> {
    #[derive(Deserialize)]
    struct Manifest {
        bin: Vec<Bin>,
    }
    #[derive(Deserialize)]
    struct Bin {
        name: String,
    }
    let manifest: Manifest = toml::from_str(manifest).context("fuzz/Cargo.toml is invalid")?;
    Ok(manifest.bin.into_iter().map(|bin| bin.name).collect())
}

fn chosen(all: &[String], requested: &[String]) -> Result<Vec<String>> {
    if let Some(unknown) = requested.iter().find(|name| !all.contains(name)) {
        bail!("unknown fuzz target {unknown}; use one of {}, or none for all", all.join(", "));
    }
    Ok(if requested.is_empty() { all.to_vec() } else { requested.to_vec() })
}

async fn build(manifest: &Path, folder: &Path) -> Result<PathBuf> {
    let cargo_fuzz = tools::cargo_fuzz().await?;
    let mut fetch = toolchain::cargo();
    fetch.args(["fetch", "--quiet", "--locked", "--manifest-path"]).arg(manifest);
    run::to_end(fetch).await.context(
        "if fuzz/Cargo.lock is out of date, run `cargo update --workspace --manifest-path fuzz/Cargo.toml`",
    )?;
    let triple = toolchain::host().await?;
    let mut command = Command::new(cargo_fuzz);
    command.current_dir(root()).args(["build", "--sanitizer", "none"]);
    // Traced comparisons may include addresses, which differ between runs; coverage alone finds as much.
    command.args(["--no-trace-compares", "--target", &triple, "--target-dir"]).arg(folder);
    run::compile(command).await.context(
        "the fuzz targets were not built; libFuzzer needs a C++ compiler (Debian: apt-get install g++)",
    )?;
    Ok(folder.join(triple).join("release"))
}

async fn inputs(home: &Path) -> Result<()> {
    let mut command = toolchain::cargo();
    command.args(["run", "--quiet", "--locked", "--package", "stepscope-tests", "--example", "fuzz-inputs"]);
    command.arg("--").arg(home);
    run::to_end(command).await
}

async fn fuzz(program: &Path, folder: &Path, options: &Options) -> Result<Report> {
    fs::create_dir_all(folder.join("findings"))?;
    let mut names = Vec::new();
    for entry in fs::read_dir(folder.join("inputs")).context("the target's inputs are missing")? {
        names.push(format!("inputs/{}", entry?.file_name().to_string_lossy()));
    }
    names.sort();
    fs::write(folder.join("inputs.list"), names.join(","))?;
    let log = folder.join("log");
    let file = files::create(&log)?;

    let mut command = Command::new(program);
    command.current_dir(folder).stderr(file);
    command.args(["-print_final_stats=1", "-seed_inputs=@inputs.list", "-artifact_prefix=findings/"]);
    command.arg(format!("-max_total_time={}", options.seconds)).arg(format!("-seed={}", options.seed));
    command.arg(format!("-timeout={INPUT_SECONDS}")).arg(format!("-rss_limit_mb={MEMORY_MB}"));
    if folder.join("dictionary").exists() {
        command.arg("-dict=dictionary");
    }
    let result = run::within(command, Duration::from_secs(options.seconds.into()) + GRACE).await;

    let text = files::read_bytes(&log)?;
    let report = Report::of(&String::from_utf8_lossy(&text));
    match result {
        Err(error) if report.finding.is_none() => {
            Err(error.context(format!("the target failed without a finding; see {}", log.display())))
        }
        _ => Ok(report),
    }
}

fn advice(target: &str, input: &Path, program: &Path) -> String {
    let short = |path: &Path| path.strip_prefix(root()).unwrap_or(path).display().to_string();
    let (input, program) = (short(input), short(program));
    format!(
        "input:      {input}\n\
         reproduce:  {program} {input}\n\
         shorten:    {program} -minimize_crash=1 -max_total_time=60 {input}\n\
         keep:       mkdir -p tests/findings/{target} && cp {input} tests/findings/{target}/what-is-wrong\n\
         as a test:  cargo test -p stepscope-tests findings::"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_targets_are_the_fuzz_packages_binaries() {
        let text = fs::read_to_string(root().join("fuzz").join("Cargo.toml")).unwrap();
        let all = names(&text).unwrap();
        for target in ["line", "frames", "scenario", "link", "capture"] {
            assert!(all.iter().any(|name| name == target), "{target} in {all:?}");
        }
    }

    #[test]
    fn without_names_all_targets_run_and_unknown_names_are_refused() {
        let text = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
        let all = text(&["line", "link"]);
        assert_eq!(chosen(&all, &[]).unwrap(), all);
        assert_eq!(chosen(&all, &text(&["link"])).unwrap(), text(&["link"]));
        let error = chosen(&all, &text(&["lin"])).unwrap_err().to_string();
        assert_eq!(error, "unknown fuzz target lin; use one of line, link, or none for all");
    }
}
