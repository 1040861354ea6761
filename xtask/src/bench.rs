//! `cargo xtask bench`: criterion's figure of each kernel, and ratios between kernels and between
//! native code and the browser.
//!
//! A time by itself says more of the machine than of the code, and a busy machine changes its speed
//! from second to second. So the ratios come from blocks: in each, a native process and then the
//! page in a browser call all kernels in turn, several rounds long; what else runs on the machine
//! only ever adds time, so the best call of a kernel in the block is the one that counts. The table
//! gives the median of the blocks' ratios and, as the measure of what noise is left, their median
//! absolute deviation.

mod page;
mod table;

use std::fs::File;
use std::path::Path;

use anyhow::{Context, Result};
use tokio::process::Command;

use crate::browser::Browser;
use crate::tools::{Optimise, WasmTools};
use crate::{root, run, steps, toolchain};
use page::Page;
use table::{Block, Estimate, Report};

/// The crate of the kernels, from the workspace's folder.
const FOLDER: &str = "tests/bench";
const PACKAGE: &str = "stepscope-bench";

/// How long to measure.
struct Effort {
    blocks: usize,
    /// Rounds of a block.
    rounds: u32,
    criterion: [&'static str; 6],
}

const FULL: Effort = Effort {
    blocks: 10,
    rounds: 12,
    criterion: ["--sample-size", "30", "--warm-up-time", "0.5", "--measurement-time", "2"],
};
const QUICK: Effort = Effort {
    blocks: 4,
    rounds: 6,
    criterion: ["--sample-size", "10", "--warm-up-time", "0.1", "--measurement-time", "0.4"],
};

/// Builds the kernels for both, measures, and prints the tables.
pub(crate) async fn run(quick: bool) -> Result<()> {
    let effort = if quick { QUICK } else { FULL };
    let browser = Browser::ready().await?;
    let tools = WasmTools::ready(Optimise::Yes).await?;
    let home = root().join("target").join("bench");
    let package = home.join("pkg");
    std::fs::create_dir_all(&home).with_context(|| format!("{} can't be made", home.display()))?;

    crate::page::wasm(&tools, FOLDER, &package).await?;
    criterion(&home.join("criterion"), effort.criterion).await?;

    println!("measuring {} blocks of {} rounds, native and in the browser", effort.blocks, effort.rounds);
    let mut page = Page::open(&browser, &root().join(FOLDER).join("page"), &package, &home).await?;
    let mut blocks = Vec::new();
    for _ in 0..effort.blocks {
        blocks.push(Block {
            native: native(&home, effort.rounds).await?,
            browser: page.rounds(effort.rounds).await?,
        });
    }
    print!("\n{}", table::tables(&blocks, |kernel| estimate(&home.join("criterion"), kernel))?);
    println!(
        "\nTimes are criterion's medians ± their median absolute deviation. Ratios are of speeds, a unit each: of the \
         best calls in a block of {} rounds,\nthe median of {} blocks ± its median absolute deviation.",
        effort.rounds, effort.blocks
    );
    Ok(())
}

/// Measures the page as it is shipped, in Chromium. Its times are of this machine and this moment.
pub(crate) async fn page() -> Result<()> {
    let command = "bench --package stepscope-tests --features browser --bench page --locked";
    run::to_end(steps::with_page(command).await?, run::LIMIT).await
}

/// Criterion's benchmarks, each kernel by itself; their results lie under `home` then.
async fn criterion(home: &Path, effort: [&str; 6]) -> Result<()> {
    // What an earlier run left would only be compared with.
    if home.exists() {
        std::fs::remove_dir_all(home).with_context(|| format!("{} can't be removed", home.display()))?;
    }
    let mut command = kernels(&[]);
    command.args(["--noplot", "--quiet"]).args(effort).env("CRITERION_HOME", home);
    run::to_end(command, run::LIMIT).await
}

/// Criterion's estimate of a kernel.
fn estimate(home: &Path, kernel: &str) -> Result<Estimate> {
    let file = home.join("kernels").join(kernel).join("new").join("estimates.json");
    let text = std::fs::read_to_string(&file).with_context(|| format!("{} can't be read", file.display()))?;
    Estimate::from_json(&text).with_context(|| format!("{} is not what it should be", file.display()))
}

/// One native process of so many rounds.
async fn native(home: &Path, rounds: u32) -> Result<Vec<Report>> {
    let path = home.join("native.json");
    let file = File::create(&path).with_context(|| format!("{} can't be written", path.display()))?;
    let mut command = kernels(&["--quiet"]);
    command.args(["--rounds", &rounds.to_string()]).stdout(file);
    run::to_end(command, run::LIMIT).await?;
    let text = std::fs::read_to_string(&path).with_context(|| format!("{} can't be read", path.display()))?;
    Report::all_from_json(&text)
}

/// A call of the kernels as native code with cargo's `options`, to which their own can be added.
fn kernels(options: &[&str]) -> Command {
    let mut command = toolchain::cargo();
    command.args(["bench", "--package", PACKAGE, "--features", "criterion", "--bench", "kernels"]);
    command.arg("--locked").args(options).arg("--");
    command
}
