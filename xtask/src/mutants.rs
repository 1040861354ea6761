//! `cargo xtask mutants`: cargo-mutants changes one expression at a time (a `<` to `<=`, a result to 0) in the
//! peripheral and the motions, and the tests have to fail.
//!
//! All mutants together take days, so a run tests a random sample; the same `--seed` draws the same sample.
//! `.cargo/mutants.toml` lists what is excluded and why.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use serde::Deserialize;
use tokio::process::Command;

use crate::{files, root, run, tools};

const PACKAGES: [&str; 2] = ["stepscope-peripheral", "stepscope-motion"];
const TESTED: [&str; 4] = ["stepscope-peripheral", "stepscope-motion", "stepscope-core", "stepscope-tests"];
const TESTS: [&str; 2] = ["all", "exact_curves"];
/// Skipped: tests of other code, and slow ones that repeat checks of others.
const SKIPPED: [&str; 15] = [
    "architecture::",
    "controller_model::",
    "controller_oracle::",
    "exactness::",
    "fault_sweep::",
    "findings::",
    "hostile::",
    "links::",
    "packaging::",
    "plant::",
    "plant_model::",
    "plant_oracle::",
    "spectrum::",
    "theme::",
    "web_layers::",
];
const MIN_CAUGHT_PERCENT: usize = 95;
/// Minimum time for a mutant's tests. cargo-mutants may allow a multiple of the unchanged tests' time.
const TEST_LIMIT: Duration = Duration::from_secs(2 * 60);
/// Maximum time for the copy, its first build and the unchanged tests.
const SETUP_LIMIT: Duration = Duration::from_secs(40 * 60);
const MUTANT_LIMIT: Duration = Duration::from_secs(4 * 60);

pub(crate) struct Options {
    pub(crate) sample: usize,
    pub(crate) seed: u64,
    pub(crate) packages: Vec<String>,
}

pub(crate) async fn run(options: Options) -> Result<()> {
    let packages = chosen(&options.packages)?;
    let program = tools::cargo_mutants().await?;
    let folder = root().join("target").join("mutants");
    files::create_folder(&folder)?;
    let all = list(&program, &packages, &folder.join("list.json")).await?;
    let sample = drawn(all.clone(), options.sample, options.seed);
    println!("{} of {} mutants, drawn with seed {}", sample.len(), all.len(), options.seed);

    let results = folder.join("mutants.out");
    skip_mutants(&results, all.iter().filter(|name| !sample.contains(*name)))?;
    let limit = SETUP_LIMIT + MUTANT_LIMIT * u32::try_from(sample.len()).unwrap_or(u32::MAX);
    // It fails if it missed a mutant, so the result comes from its files.
    let result = run::within(testing(&program, &packages, &folder), limit).await;
    let Ok(text) = fs::read_to_string(results.join("outcomes.json")) else {
        return result.context("cargo-mutants ended before its first outcome");
    };
    let tally = Tally::of(&text)?;
    println!("\n{tally}");
    ensure!(
        tally.tested() == sample.len(),
        "only {} of {} mutants were tested; {} has the output of the unchanged tests",
        tally.tested(),
        sample.len(),
        results.join("log").display()
    );
    ensure!(
        tally.is_enough(),
        "less than {MIN_CAUGHT_PERCENT} % were caught; add tests for the missed ones, or, where no test is possible, a \
         line with the reason in .cargo/mutants.toml"
    );
    Ok(())
}

fn chosen(requested: &[String]) -> Result<Vec<&str>> {
    for package in requested {
        ensure!(
            PACKAGES.contains(&package.as_str()),
            "{package} is not supported; use {}, or none for both",
            PACKAGES.join(" or ")
        );
    }
    Ok(if requested.is_empty() { PACKAGES.to_vec() } else { requested.iter().map(String::as_str).collect() })
}

fn cargo_mutants(program: &Path, packages: &[&str]) -> Command {
    let mut command = Command::new(program);
    command.current_dir(root()).arg("mutants");
    for package in packages {
        command.args(["--package", package]);
    }
    command
}

async fn list(program: &Path, packages: &[&str], file: &Path) -> Result<Vec<String>> {
    #[derive(Deserialize)]
    struct Mutant {
        name: String,
    }
    let mut command = cargo_mutants(program, packages);
    let output = files::create(file)?;
    command.args(["--list", "--json"]).stdout(output);
    run::within(command, run::LIMIT).await?;
    let text = files::read(file)?;
    let mutants: Vec<Mutant> = serde_json::from_str(&text).context("cargo-mutants' list is not JSON")?;
    Ok(mutants.into_iter().map(|mutant| mutant.name).collect())
}

fn drawn(mut all: Vec<String>, sample: usize, seed: u64) -> BTreeSet<String> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    all.sort_by_cached_key(|_| random.next_u64());
    all.into_iter().take(sample).collect()
}

/// Marks mutants as caught, so that `--iterate` skips them; cargo-mutants' filters by name let some kinds through.
fn skip_mutants<'a>(results: &Path, names: impl Iterator<Item = &'a String>) -> Result<()> {
    let problem = || format!("{} can't be replaced", results.display());
    if results.exists() {
        fs::remove_dir_all(results).with_context(problem)?;
    }
    fs::create_dir_all(results).with_context(problem)?;
    let list: String = names.flat_map(|name| [name.as_str(), "\n"]).collect();
    fs::write(results.join("caught.txt"), list).with_context(problem)
}

fn testing(program: &Path, packages: &[&str], folder: &Path) -> Command {
    let mut command = cargo_mutants(program, packages);
    command.args(["--iterate", "--no-times", "--colors=never", "--jobs=1", "--output"]).arg(folder);
    command.arg(format!("--minimum-test-timeout={}", TEST_LIMIT.as_secs()));
    // Both for building and testing: without it every mutant would build all tests of all packages.
    let packages = TESTED.iter().flat_map(|package| ["--package", package]);
    let tests = TESTS.iter().flat_map(|test| ["--test", test]);
    for argument in ["--locked", "--lib"].into_iter().chain(packages).chain(tests) {
        command.arg(format!("--cargo-arg={argument}"));
    }
    command.args(["--", "--"]).args(SKIPPED.iter().flat_map(|name| ["--skip", name]));
    command
}

#[derive(Debug, Default, PartialEq, Eq)]
struct Tally {
    caught: usize,
    /// The tests were stopped because they took too long, which counts as caught.
    timeouts: Vec<String>,
    unviable: usize,
    missed: Vec<String>,
}

impl Tally {
    fn of(text: &str) -> Result<Self> {
        #[derive(Deserialize)]
        struct Outcomes {
            outcomes: Vec<Outcome>,
        }
        #[derive(Deserialize)]
        struct Outcome {
            scenario: Scenario,
            summary: String,
        }
        #[derive(Deserialize)]
        enum Scenario {
            Baseline,
            Mutant { name: String },
        }
        let Outcomes { outcomes } =
            serde_json::from_str(text).context("cargo-mutants' outcomes.json is invalid")?;
        let mut tally = Self::default();
        for Outcome { scenario, summary } in outcomes {
            match (scenario, summary.as_str()) {
                (Scenario::Baseline, _) => {}
                (Scenario::Mutant { .. }, "CaughtMutant") => tally.caught += 1,
                (Scenario::Mutant { .. }, "Unviable") => tally.unviable += 1,
                (Scenario::Mutant { name }, "Timeout") => tally.timeouts.push(name),
                (Scenario::Mutant { name }, _) => tally.missed.push(name),
            }
        }
        Ok(tally)
    }

    fn viable(&self) -> usize {
        self.caught + self.timeouts.len() + self.missed.len()
    }

    fn tested(&self) -> usize {
        self.viable() + self.unviable
    }

    fn is_enough(&self) -> bool {
        (self.caught + self.timeouts.len()) * 100 >= self.viable() * MIN_CAUGHT_PERCENT
    }
}

impl std::fmt::Display for Tally {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (word, names) in [("timed out", &self.timeouts), ("missed", &self.missed)] {
            for name in names {
                writeln!(f, "{word}: {name}")?;
            }
        }
        write!(
            f,
            "{} of {} caught ({} of them timed out), {} missed; {} could not be built",
            self.caught + self.timeouts.len(),
            self.viable(),
            self.timeouts.len(),
            self.missed.len(),
            self.unviable
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sample_depends_only_on_the_seed() {
        let all: Vec<String> = (0..1000).map(|index| format!("mutant {index:04}")).collect();
        let draw = |sample, seed| drawn(all.clone(), sample, seed);
        assert_eq!(draw(60, 1), draw(60, 1));
        assert_ne!(draw(60, 1), draw(60, 2));
        assert_eq!(draw(60, 1).len(), 60);
        assert!(draw(60, 1).is_superset(&draw(6, 1)), "a smaller sample is part of a larger one");
        assert_eq!(draw(2000, 1).len(), 1000);
    }

    #[test]
    fn unviable_mutants_do_not_count_and_95_percent_are_enough() {
        let outcome = |name: usize, summary: &str| {
            format!(r#"{{"scenario": {{"Mutant": {{"name": "m{name}"}}}}, "summary": "{summary}"}}"#)
        };
        let text = |missed: usize| {
            let mut outcomes = vec![r#"{"scenario": "Baseline", "summary": "Success"}"#.to_owned()];
            outcomes.extend((0..19 - missed).map(|index| outcome(index, "CaughtMutant")));
            outcomes.extend((0..missed).map(|index| outcome(index, "MissedMutant")));
            outcomes.extend([outcome(100, "Timeout"), outcome(101, "Unviable")]);
            format!(r#"{{"outcomes": [{}]}}"#, outcomes.join(", "))
        };
        let tally = Tally::of(&text(1)).unwrap();
        assert_eq!((tally.viable(), tally.tested(), tally.is_enough()), (20, 21, true));
        assert!(!Tally::of(&text(2)).unwrap().is_enough());
        assert_eq!(
            tally.to_string(),
            "timed out: m100\nmissed: m0\n19 of 20 caught (1 of them timed out), \
             1 missed; 1 could not be built"
        );
    }

    #[test]
    fn other_packages_are_refused() {
        assert_eq!(chosen(&[]).unwrap(), PACKAGES);
        let error = chosen(&["stepscope-wasm".to_owned()]).unwrap_err().to_string();
        assert_eq!(
            error,
            "stepscope-wasm is not supported; use stepscope-peripheral or stepscope-motion, or none for both"
        );
    }
}
