//! `cargo xtask test` runs every check, step by step; a step that fails does not stop the others.

use std::cell::RefCell;
use std::fmt;
use std::io::Write;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use clap::ValueEnum;
use tokio::process::Command;

use crate::browser::{self, Browser};
use crate::dist::Parts;
use crate::engines::{self, Firefox, WebKit};
use crate::output_buffer::{self, print_line};
use crate::toolchain::{self, BARE_METAL, WASM};
use crate::tools::{Optimize, WasmTools};
use crate::{
    avr, bare_metal, c, dist, docs, dump_readers, judges, npm, package, page, root, run, serial_port,
    sources, spelling, words,
};

const RUSTFMT: [&str; 2] = ["fmt --all", "fmt --manifest-path fuzz/Cargo.toml"];

/// The steps in the order of [`ROWS`]; those that fail fastest come first.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Step {
    /// Format of all sources, by rustfmt and Biome
    Format,
    /// Unit tests of the page's models, in Node
    Scripts,
    /// clippy for native, wasm and bare metal; Biome; words and spelling of all texts
    Lint,
    /// rustdoc, and the links of the documentation site
    Docs,
    /// Unit, integration and documentation tests
    Native,
    /// Value change dumps, with GTKWave's and sigrok's programs
    Vcd,
    /// Firmware in simavr: its recordings, and its replies to the live commands
    Avr,
    /// The C and C++ library: warnings, valgrind, sanitizers, CMake
    C,
    /// Live commands, with a host and a device in Python and with socat
    Live,
    /// Golden cases on a bare Cortex-M3, in QEMU
    BareMetal,
    /// Tests of the wasm crate, in Chromium and Firefox
    Wasm,
    /// Types of the page's modules, by tsc
    Types,
    /// Library crates and npm package: packed, built, used by a Node program
    Package,
    /// The shipped page: its size, and its use in Chromium
    Page,
    /// The page's main functions in Chromium, Firefox and WebKit, with a serial port
    Engines,
}

impl Step {
    fn name(self) -> String {
        self.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
    }

    async fn run(self) -> Result<()> {
        match self {
            Self::Format => {
                toolchain::components().await?;
                for workspace in RUSTFMT {
                    run::to_end(cargo(&format!("{workspace} --check"))).await?;
                }
                sources::check_format().await
            }
            Self::Scripts => sources::test().await,
            Self::Lint => {
                words::check()?;
                spelling::check().await?;
                sources::lint().await?;
                // The fuzz targets are a workspace of their own, whose lock file no other step reads.
                run::to_end(cargo("fetch --quiet --locked --manifest-path fuzz/Cargo.toml")).await?;
                toolchain::components().await?;
                toolchain::target(WASM).await?;
                toolchain::target(BARE_METAL).await?;
                clippy("--workspace --all-targets --all-features").await?;
                clippy(&format!("--package stepscope-wasm --all-targets --target {WASM}")).await?;
                for (_, features) in page::MODULES {
                    let module = format!("--no-default-features --features {features}");
                    clippy(&format!("--package stepscope-wasm {module} --target {WASM}")).await?;
                }
                clippy(&format!("--package stepscope-bench --lib --target {WASM}")).await?;
                let packages = format!(
                    "--package stepscope-core --package stepscope-firmware --package stepscope-controller-firmware \
                     --package {}",
                    bare_metal::PACKAGE
                );
                clippy(&format!("{packages} --no-default-features --target {BARE_METAL}")).await
            }
            Self::Docs => {
                docs::build(&root().join("target").join(docs::FOLDER))?;
                let mut command = cargo("doc --no-deps --workspace --locked");
                command.env("RUSTDOCFLAGS", "-D warnings");
                run::compile(command).await
            }
            Self::Native => run::cargo_test(cargo("test --workspace --locked --no-fail-fast")).await,
            Self::Vcd => dump_readers::test().await,
            Self::Avr => avr::test().await,
            Self::C => c::test().await,
            Self::Live => judges::test().await,
            Self::BareMetal => bare_metal::test().await,
            Self::Wasm => wasm().await,
            Self::Types => {
                build_page_for(self).await?;
                sources::check_types().await
            }
            Self::Package => package::test().await,
            Self::Page => page().await,
            Self::Engines => engines().await,
        }
    }
}

fn cargo(line: &str) -> Command {
    let mut command = toolchain::cargo();
    command.args(line.split_whitespace());
    command
}

async fn clippy(what: &str) -> Result<()> {
    run::compile(cargo(&format!("clippy {what} --locked -- -D warnings"))).await
}

/// wasm/webdriver.json has the flags of the browsers.
async fn wasm() -> Result<()> {
    let browser = Browser::ready().await?;
    let Firefox { firefox: _, geckodriver } = Firefox::ready().await?;
    let tools = WasmTools::ready(Optimize::No).await?;
    let mut command = tools.wasm_pack()?;
    command.args(["test", "--headless", "--chrome", "--chromedriver"]).arg(&browser.chromedriver);
    command.args(["--firefox", "--geckodriver"]).arg(geckodriver);
    command.args(["--mode", "no-install", "wasm", "--locked"]);
    // In seconds, for the whole run; the runner's default of 20 is too short on a busy machine.
    command.env("WASM_BINDGEN_TEST_TIMEOUT", "600");
    // wasm-pack compiles and tests in one call.
    run::compile(cargo(&format!("build --tests --package stepscope-wasm --locked --target {WASM}"))).await?;
    run::to_end(command).await
}

async fn page_tests() -> Result<Command> {
    // The whole workspace, so that the packages keep the features and builds of the native step.
    with_page("test --workspace --features stepscope-tests/browser --test page --locked --").await
}

/// A call of cargo for a program that uses the page in Chromium; its environment has the paths of driver and files.
pub(crate) async fn with_page(line: &str) -> Result<Command> {
    let this = crate::THIS_PROGRAM.as_ref().context("this program's own path is unknown")?;
    let browser = Browser::ready().await?;
    page::built().await?;
    let mut command = cargo(line);
    command
        .env("STEPSCOPE_WEB", root().join("web"))
        .env("STEPSCOPE_DIST", dist::folder())
        .env("STEPSCOPE_XTASK", this)
        .env(browser::CHROMIUM, &browser.chromium)
        .env(browser::CHROMEDRIVER, &browser.chromedriver);
    Ok(command)
}

const INSTALLED: &str = "offline::the_page_can_be_installed";

async fn page() -> Result<()> {
    let parts = build_page_for(Step::Page).await?;
    let mut command = page_tests().await?;
    let weights = page::weigh(&dist::folder(), parts)?;
    print_line(&weights);
    weights.within_budget()?;
    command.args(["--skip", "engines::", "--skip", "live_port::", "--skip", INSTALLED]);
    // Tests also wait for the browser, so one more thread than cores keeps the cores busy.
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    command.arg(format!("--test-threads={}", cores + 1));
    command.env("STEPSCOPE_AXE", npm::axe().await?);
    command.env(browser::CHROMIUM, Browser::ready().await?.headless().await);
    run::cargo_test(command).await
}

/// All three engines or none: a missing one is an error, so that no run passes without it.
async fn engines() -> Result<()> {
    build_page_for(Step::Engines).await?;
    let Firefox { firefox, geckodriver } = Firefox::ready().await?;
    let webkit = WebKit::ready().await?;
    let mut command = page_tests().await?;
    command
        .args(["engines::", INSTALLED])
        .env(engines::FIREFOX, firefox)
        .env(engines::GECKODRIVER, geckodriver)
        .env(engines::WEBKITDRIVER, &webkit.driver)
        .env("DISPLAY", &webkit.display);
    match serial_port::possible().await {
        Ok(()) => {
            judges::socat().await?;
            command.arg("live_port::").env(serial_port::COMMAND, serial_port::command().await?);
        }
        Err(why) => print_line(format_args!(
            "skipped: tests of the page with a serial port, impossible on this machine: {why:#}"
        )),
    }
    run::cargo_test(command).await
}

pub(crate) async fn format() -> Result<()> {
    toolchain::components().await?;
    for workspace in RUSTFMT {
        run::to_end(cargo(workspace)).await?;
    }
    sources::format().await
}

pub(crate) fn list() {
    for value in Step::value_variants().iter().filter_map(ValueEnum::to_possible_value) {
        println!("{:12}{}", value.get_name(), value.get_help().map(ToString::to_string).unwrap_or_default());
    }
}

/// Each row runs two lanes in parallel; the rows run one after the other. The steps of the second lane mostly wait
/// for other programs; their output is buffered.
const ROWS: [[&[Step]; 2]; 5] = [
    [&[Step::Format, Step::Scripts, Step::Lint, Step::Docs], &[]],
    [&[Step::Native], &[Step::Vcd, Step::Avr, Step::C, Step::Live, Step::BareMetal, Step::Wasm]],
    [&[Step::Types, Step::Package], &[]],
    // These use all cores, and live lines have deadlines.
    [&[Step::Page], &[]],
    [&[Step::Engines], &[]],
];

/// Runs the steps named in `only`, or all if it is empty.
pub(crate) async fn run(only: &[Step]) -> Result<()> {
    let start = Instant::now();
    let report = RefCell::default();
    for lanes in ROWS {
        let mut lanes = lanes.map(|lane| {
            lane.iter().copied().filter(|step| only.is_empty() || only.contains(step)).collect::<Vec<_>>()
        });
        if lanes[0].is_empty() {
            lanes.reverse();
        }
        let [first, second] = lanes;
        tokio::join!(run_printed(&first, &report), run_buffered(&second, &report));
    }
    let mut report = report.into_inner();
    report.sort_by_key(|(step, ..)| Step::value_variants().iter().position(|each| each == step));
    println!();
    for (step, time, outcome) in &report {
        println!("{:12}{:8.1} s  {outcome}", step.name(), time.as_secs_f64());
    }
    println!("{:12}{:8.1} s", "all", start.elapsed().as_secs_f64());
    let names_with = |is_wanted: fn(&Outcome) -> bool| {
        let names = report.iter().filter(|(.., outcome)| is_wanted(outcome)).map(|(step, ..)| step.name());
        names.collect::<Vec<_>>()
    };
    let failed = names_with(|outcome| matches!(outcome, Outcome::Failed(_)));
    let skipped = names_with(|outcome| matches!(outcome, Outcome::Skipped(_)));
    let passed = report.len() - failed.len() - skipped.len();
    println!("{passed} passed, {} failed, {} skipped", failed.len(), skipped.len());
    let mut lists = Vec::new();
    for (what, names) in [("failed", failed), ("skipped", skipped)] {
        if !names.is_empty() {
            lists.push(format!("{what}: {}", names.join(", ")));
        }
    }
    ensure!(lists.is_empty(), lists.join("; "));
    Ok(())
}

#[derive(Debug, PartialEq)]
enum Outcome {
    Passed,
    Failed(String),
    Skipped(String),
}

impl Outcome {
    fn of(result: Result<()>) -> Self {
        match result {
            Ok(()) => Self::Passed,
            Err(error) if error.is::<NotBuilt>() => Self::Skipped(error.to_string()),
            Err(error) => Self::Failed(format!("{error:#}")),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Passed => f.write_str("passed"),
            Self::Failed(why) => write!(f, "failed: {why}"),
            Self::Skipped(why) => write!(f, "skipped: {why}"),
        }
    }
}

#[derive(Debug)]
struct NotBuilt(String);

impl fmt::Display for NotBuilt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the page's build failed in step {}", self.0)
    }
}

impl std::error::Error for NotBuilt {}

/// The page, built once for all steps; an error [`NotBuilt`] if the build failed in an earlier step.
async fn build_page_for(step: Step) -> Result<&'static Parts> {
    static FAILED_IN: OnceLock<String> = OnceLock::new();
    if let Some(step) = FAILED_IN.get() {
        return Err(NotBuilt(step.clone()).into());
    }
    page::built().await.inspect_err(|_| {
        let _ = FAILED_IN.set(step.name());
    })
}

type Report = RefCell<Vec<(Step, Duration, Outcome)>>;

async fn run_printed(steps: &[Step], report: &Report) {
    for step in steps {
        println!("\n=== {}", step.name());
        let start = Instant::now();
        report_end(*step, start, Outcome::of(step.run().await), report);
    }
}

async fn run_buffered(steps: &[Step], report: &Report) {
    for step in steps {
        let start = Instant::now();
        let (outcome, output) = match output_buffer::buffered(step.run()).await {
            Ok((result, output)) => (Outcome::of(result), output),
            Err(error) => (Outcome::of(Err(error)), Vec::new()),
        };
        println!("\n=== {} (ran in parallel)", step.name());
        // A closed terminal does not end the work.
        let _ = std::io::stdout().write_all(&output);
        report_end(*step, start, outcome, report);
    }
}

fn report_end(step: Step, start: Instant, outcome: Outcome, report: &Report) {
    let time = start.elapsed();
    println!("=== {}, after {:.1} s: {outcome}", step.name(), time.as_secs_f64());
    report.borrow_mut().push((step, time, outcome));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rows_contain_every_step_in_order() {
        let placed: Vec<_> = ROWS.iter().flatten().copied().flatten().copied().collect();
        assert!(placed == Step::value_variants());
    }

    #[test]
    fn a_step_that_needs_a_failed_build_is_skipped_with_the_reason() {
        let rows = [
            (Ok(()), "passed"),
            (
                Err(anyhow::anyhow!("exit status 1").context("`cargo fmt` failed")),
                "failed: `cargo fmt` failed: exit status 1",
            ),
            (Err(NotBuilt("types".to_owned()).into()), "skipped: the page's build failed in step types"),
        ];
        for (result, expected) in rows {
            assert_eq!(Outcome::of(result).to_string(), expected);
        }
    }
}
