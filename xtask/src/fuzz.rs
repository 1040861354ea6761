//! `cargo xtask fuzz` runs libFuzzer on the checks of `tests/src/fuzzing.rs`, through cargo-fuzz.
//!
//! Sanitizers need a nightly Rust and find what safe Rust cannot contain. With `--sanitizer none` stable Rust counts
//! coverage, too; debug assertions and overflow checks are on.
//!
//! Every run starts with the same inputs: seeds made from the repository, and earlier findings. So the same `--seed`
//! repeats a run. Without one a run draws a seed and prints it.

mod report;

use std::fs::{self, File};
use std::hash::{BuildHasher as _, RandomState};
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;
use tokio::process::Command;

use crate::{root, run, toolchain, tools};
use report::Report;

const GRACE: Duration = Duration::from_secs(120);
const INPUT_SECONDS: u32 = 10;
const MEMORY_MB: u32 = 2048;

pub(crate) struct Options {
    pub(crate) targets: Vec<String>,
    pub(crate) seconds: u32,
    /// Not 0, which libFuzzer takes as "any".
    pub(crate) seed: u32,
}

pub(crate) fn new_seed() -> u32 {
    let chance = RandomState::new().hash_one(std::process::id());
    (chance as u32).max(1)
}

pub(crate) async fn run(options: Options) -> Result<()> {
    let manifest = root().join("fuzz").join("Cargo.toml");
    let text =
        fs::read_to_string(&manifest).with_context(|| format!("{} can't be read", manifest.display()))?;
    let targets = chosen(&names(&text)?, &options.targets)?;
    let home = root().join("target").join("fuzz");
    let programs = build(&manifest, &home.join("build")).await?;
    inputs(&home).await?;

    let mut found = Vec::new();
    for target in &targets {
        println!("\n=== {target}: {} s, seed {}", options.seconds, options.seed);
        let folder = home.join(target);
        let report = fuzz(&programs.join(target), &folder, &options).await?;
        println!("{report}");
        if let Some(input) = &report.finding {
            let input = folder.join(input);
            println!("{}", advice(target, &input, &programs.join(target)));
            found.push(target.as_str());
        }
    }
    ensure!(found.is_empty(), "something was found in: {}", found.join(", "));
    println!("\n{} run, nothing found", targets.join(", "));
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
    let manifest: Manifest = toml::from_str(manifest).context("fuzz/Cargo.toml is not what it should be")?;
    Ok(manifest.bin.into_iter().map(|bin| bin.name).collect())
}

fn chosen(all: &[String], asked: &[String]) -> Result<Vec<String>> {
    if let Some(unknown) = asked.iter().find(|name| !all.contains(name)) {
        bail!("{unknown} is no fuzz target; give {}, or none for all", all.join(", "));
    }
    Ok(if asked.is_empty() { all.to_vec() } else { asked.to_vec() })
}

async fn build(manifest: &Path, folder: &Path) -> Result<PathBuf> {
    let cargo_fuzz = tools::cargo_fuzz().await?;
    let mut fetch = toolchain::cargo();
    fetch.args(["fetch", "--quiet", "--locked", "--manifest-path"]).arg(manifest);
    run::to_end(fetch).await.context(
        "if fuzz/Cargo.lock does not fit any more, `cargo update --workspace --manifest-path fuzz/Cargo.toml` mends it",
    )?;
    let triple = toolchain::host().await?;
    let mut command = Command::new(cargo_fuzz);
    command.current_dir(root()).args(["build", "--sanitizer", "none"]);
    // libFuzzer may compare addresses, which differ between runs; coverage alone finds as much.
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
    let file = File::create(&log).with_context(|| format!("{} can't be written", log.display()))?;

    let mut command = Command::new(program);
    command.current_dir(folder).stderr(file);
    command.args(["-print_final_stats=1", "-seed_inputs=@inputs.list", "-artifact_prefix=findings/"]);
    command.arg(format!("-max_total_time={}", options.seconds)).arg(format!("-seed={}", options.seed));
    command.arg(format!("-timeout={INPUT_SECONDS}")).arg(format!("-rss_limit_mb={MEMORY_MB}"));
    if folder.join("dictionary").exists() {
        command.arg("-dict=dictionary");
    }
    let ended = run::within(command, Duration::from_secs(options.seconds.into()) + GRACE).await;

    let text = fs::read(&log).with_context(|| format!("{} can't be read", log.display()))?;
    let report = Report::of(&String::from_utf8_lossy(&text));
    match ended {
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
    fn what_is_not_named_is_all_and_what_is_no_target_is_refused_with_the_names() {
        let text = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
        let all = text(&["line", "link"]);
        assert_eq!(chosen(&all, &[]).unwrap(), all);
        assert_eq!(chosen(&all, &text(&["link"])).unwrap(), text(&["link"]));
        let error = chosen(&all, &text(&["lin"])).unwrap_err().to_string();
        assert_eq!(error, "lin is no fuzz target; give line, link, or none for all");
    }
}
