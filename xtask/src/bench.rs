//! `cargo xtask bench`: criterion's time of each kernel, and ratios between kernels and between native code and the
//! browser.
//!
//! The speed of a busy machine varies from second to second, so the ratios come from blocks: in each, a native process and
//! then the page call all kernels in turn. Other programs only add time, so the best call of a kernel in a block counts.
//! The table has the median of the blocks' ratios and their median absolute deviation.
//!
//! With `--against`, blocks of an earlier commit, built in a clone, alternate with those of the working tree.

mod page;
mod published;
mod table;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use tokio::process::Command;

use crate::browser::Browser;
use crate::tools::{Optimize, WasmTools};
use crate::{files, root, run, steps, toolchain};
use page::Page;
use table::{Block, Estimate, Report};

const FOLDER: &str = "tests/bench";
const PACKAGE: &str = "stepscope-bench";

const RESULTS: &str = "results.json";

struct Effort {
    blocks: usize,
    /// Rounds per block.
    rounds: u32,
    criterion: [&'static str; 6],
}

impl Effort {
    fn announce(&self) {
        println!("measuring {} blocks of {} rounds, native and in the browser", self.blocks, self.rounds);
    }
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

pub(crate) async fn run(quick: bool) -> Result<()> {
    let effort = if quick { QUICK } else { FULL };
    let browser = Browser::ready().await?;
    let tools = WasmTools::ready(Optimize::Yes).await?;
    let tree = Tree::here();
    tree.build(&tools).await?;
    criterion(&tree.home.join("criterion"), effort.criterion).await?;

    effort.announce();
    let mut page = tree.page(&browser).await?;
    let mut blocks = Vec::new();
    for _ in 0..effort.blocks {
        blocks.push(tree.block(&mut page, effort.rounds).await?);
    }
    print!("\n{}", table::tables(&blocks, |kernel| estimate(&tree.home.join("criterion"), kernel))?);
    println!(
        "\nTimes are criterion's medians ± their median absolute deviation. Ratios compare speeds per unit: of the \
         best calls in a block of {} rounds,\nthe median of {} blocks ± its median absolute deviation.",
        effort.rounds, effort.blocks
    );
    println!("\nThe page in Chromium:");
    let path = tree.home.join("page.json");
    self::page(Some(&path)).await?;
    let text = files::read(&path)?;
    let figures = serde_json::from_str(&text).with_context(|| format!("{} is not JSON", path.display()))?;
    save(&tree.home, &table::json(&blocks, None, Some(figures))?)
}

/// Measures the kernels of an earlier commit and of the working tree in turn, and prints the ratios of their speeds.
pub(crate) async fn against(quick: bool, rev: &str) -> Result<()> {
    let effort = if quick { QUICK } else { FULL };
    let browser = Browser::ready().await?;
    let tools = WasmTools::ready(Optimize::Yes).await?;
    let (now, then) = (Tree::here(), Tree::of(rev).await?);
    for tree in [&now, &then] {
        tree.build(&tools).await?;
    }
    effort.announce();
    let (mut page_now, mut page_then) = (now.page(&browser).await?, then.page(&browser).await?);
    let (mut blocks, mut before) = (Vec::new(), Vec::new());
    for _ in 0..effort.blocks {
        blocks.push(now.block(&mut page_now, effort.rounds).await?);
        before.push(then.block(&mut page_then, effort.rounds).await?);
    }
    print!("\n{}", table::against(&blocks, &before)?);
    println!(
        "\nRatios are current speeds divided by the speeds at {rev}: of the best calls in a block of {} rounds, the median of {} blocks ± its \
         median absolute deviation.",
        effort.rounds, effort.blocks
    );
    save(&now.home, &table::json(&blocks, Some(&before), None)?)
}

fn save(home: &Path, json: &str) -> Result<()> {
    let path = home.join(RESULTS);
    files::write(&path, json)?;
    println!("As JSON: {}", path.strip_prefix(root()).unwrap_or(&path).display());
    Ok(())
}

pub(crate) fn published() -> Result<()> {
    published::write()
}

struct Tree {
    root: PathBuf,
    home: PathBuf,
    /// Another commit's builds have their own target folder.
    target: Option<PathBuf>,
}

impl Tree {
    fn here() -> Self {
        Self { root: root().to_path_buf(), home: root().join("target").join("bench"), target: None }
    }

    /// A clone of a commit, which stays until another commit is requested.
    async fn of(rev: &str) -> Result<Self> {
        let git = |folder: &Path, words: &[&str]| {
            let mut command = Command::new("git");
            command.current_dir(folder).args(words);
            command
        };
        let commit = format!("{rev}^{{commit}}");
        let verify = git(root(), &["rev-parse", "--quiet", "--verify", &commit]);
        let commit = run::output(verify).await.with_context(|| {
            format!(
                "{rev:?} is not a commit of this repository; use a branch, a tag or the beginning of a hash"
            )
        })?;
        let commit = commit.trim();
        let home = root().join("target").join("bench").join("against");
        let tree = home.join("tree");
        let checked_out = match tree.exists() {
            true => run::output(git(&tree, &["rev-parse", "HEAD"])).await.unwrap_or_default(),
            false => String::new(),
        };
        if checked_out.trim() != commit {
            files::remove_folder(&tree)?;
            files::create_folder(&home)?;
            let mut clone = git(&home, &["clone", "--quiet", "--shared", "--no-checkout"]);
            clone.arg(root()).arg(&tree);
            run::to_end(clone).await?;
        }
        // Also if the clone is at this commit: an earlier run may have been stopped before the checkout was complete.
        run::to_end(git(&tree, &["checkout", "--quiet", "--detach", "--force", commit])).await?;
        Ok(Self { root: tree, target: Some(home.join("target")), home })
    }

    fn in_tree(&self, mut command: Command) -> Command {
        command.current_dir(&self.root);
        if let Some(target) = &self.target {
            command.env("CARGO_TARGET_DIR", target);
        }
        command
    }

    fn package(&self) -> PathBuf {
        self.home.join("pkg")
    }

    async fn build(&self, tools: &WasmTools) -> Result<()> {
        files::create_folder(&self.home)?;
        let call = self.in_tree(tools.wasm_pack()?);
        crate::page::build_wasm(tools, call, FOLDER, &self.package(), &[]).await?;
        run::compile(self.in_tree(kernels(&["--no-run"]))).await
    }

    async fn page(&self, browser: &Browser) -> Result<Page> {
        Page::open(browser, &self.root.join(FOLDER).join("page"), &self.package(), &self.home).await
    }

    async fn block(&self, page: &mut Page, rounds: u32) -> Result<Block> {
        Ok(Block { native: self.native(rounds).await?, browser: page.rounds(rounds).await? })
    }

    async fn native(&self, rounds: u32) -> Result<Vec<Report>> {
        let path = self.home.join("native.json");
        let file = files::create(&path)?;
        let mut command = self.in_tree(kernels(&["--quiet"]));
        command.args(["--rounds", &rounds.to_string()]).stdout(file);
        run::within(command, run::LIMIT).await?;
        let text = files::read(&path)?;
        Report::all_from_json(&text)
    }
}

pub(crate) async fn page(results: Option<&Path>) -> Result<()> {
    let command = "bench --package stepscope-tests --features browser --bench page --locked";
    let mut command = steps::with_page(command).await?;
    if let Some(results) = results {
        command.env("STEPSCOPE_RESULTS", results);
    }
    run::to_end(command).await
}

pub(crate) async fn live() -> Result<()> {
    let mut command = toolchain::cargo();
    command.args(["bench", "--package", "stepscope-cli", "--bench", "live", "--locked"]);
    run::to_end(command).await
}

async fn criterion(home: &Path, effort: [&str; 6]) -> Result<()> {
    // Criterion would only compare with the results of an earlier run.
    files::remove_folder(home)?;
    let mut command = kernels(&[]);
    command.args(["--noplot", "--quiet"]).args(effort).env("CRITERION_HOME", home);
    run::to_end(command).await
}

fn estimate(home: &Path, kernel: &str) -> Result<Estimate> {
    let file = home.join("kernels").join(kernel).join("new").join("estimates.json");
    let text = files::read(&file)?;
    Estimate::from_json(&text).with_context(|| format!("{} is invalid", file.display()))
}

fn kernels(options: &[&str]) -> Command {
    let mut command = toolchain::cargo();
    command.args(["bench", "--package", PACKAGE, "--features", "criterion", "--bench", "kernels"]);
    command.arg("--locked").args(options).arg("--");
    command
}
