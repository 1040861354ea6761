//! `cargo xtask`: the project's tasks beyond plain cargo.
//!
//! | file | contents |
//! | --- | --- |
//! | `toolchain`, `tools`, `wasm_opt`, `npm`, `apt` | install missing tools once per user |
//! | `page`, `dist`, `build_record` | build the page, unless it is up to date |
//! | `docs` | build the documentation as a site |
//! | `release` | pack the command for a release |
//! | `c` | install the C and C++ library into a folder, and test it |
//! | `sources` | format, lint and type-check the page's sources |
//! | `words`, `spelling` | check the words and the spelling of texts |
//! | `headers`, `serve` | the local server |
//! | `steps`, `output_buffer`, `browser`, `engines`, `serial_port`, `bare_metal`, `dump_readers`, `avr`, `judges`, `package` | `cargo xtask test` |
//! | `bench`, `fuzz`, `mutants` | the commands of these names |
//! | `run`, `attend`, `files` | child processes and files |

mod apt;
mod attend;
mod avr;
mod bare_metal;
mod bench;
mod browser;
mod build_record;
mod c;
mod dist;
mod docs;
mod dump_readers;
mod engines;
mod files;
mod fuzz;
mod headers;
mod judges;
mod mutants;
mod npm;
mod output_buffer;
mod package;
mod page;
mod release;
mod run;
mod serial_port;
mod serve;
mod sources;
mod spelling;
mod steps;
mod toolchain;
mod tools;
mod wasm_opt;
mod words;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::LazyLock;
use std::{env, io};

use anyhow::Result;
use clap::{Args, Parser, Subcommand};

/// Build, test, measure and fuzz Stepscope
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Install missing tools, build the page, serve it on this machine and open it
    Demo {
        /// Port on 127.0.0.1; 0 for any free one
        #[arg(long, default_value_t = 8080)]
        port: u16,
        /// Print the address without opening it
        #[arg(long)]
        no_open: bool,
        #[command(flatten)]
        optimize: OptimizeOption,
    },
    /// Build the page's wasm into web/pkg and web/pkg-recordings, for `serve`
    Build {
        #[command(flatten)]
        optimize: OptimizeOption,
    },
    /// Build the page into dist/ for any static host, and print the size of each file
    Dist {
        /// Use the wasm that was built last
        #[arg(long)]
        no_build: bool,
        #[command(flatten)]
        optimize: OptimizeOption,
    },
    /// Build the documentation as a site into dist/docs
    Docs,
    /// Build the command and pack it for a release, with SHA256SUMS
    Release {
        /// Target, such as aarch64-unknown-linux-musl (default: this machine's; static on Linux)
        #[arg(long)]
        target: Option<String>,
        /// Folder to write to
        #[arg(long, default_value = "target/releases")]
        out: PathBuf,
    },
    /// Build the C and C++ library, and install headers, libraries, pkg-config and CMake files
    C {
        /// Folder to install into, such as /usr/local
        #[arg(long)]
        prefix: PathBuf,
    },
    /// Serve the page's sources without building anything
    Serve {
        /// Port on 127.0.0.1; 0 for any free one
        #[arg(long, default_value_t = 8080)]
        port: u16,
        /// Folder to serve (default: web/)
        #[arg(long)]
        web: Option<PathBuf>,
    },
    /// Format all sources
    Format,
    /// Run every check of the project
    Test {
        /// Step to run; repeatable (default: all)
        #[arg(long, value_enum)]
        only: Vec<steps::Step>,
        /// List the steps
        #[arg(long)]
        list: bool,
    },
    /// Measure the core, native and in a browser, and print ratios
    Bench {
        /// Measure for a minute or two, with more noise
        #[arg(long)]
        quick: bool,
        /// Measure only the page in Chromium: frames, loading, reaction to keys
        #[arg(long, conflicts_with_all = ["quick", "against"])]
        page: bool,
        /// Measure only `stepscope serve`: delay of replies, load, memory over a day
        #[arg(long, conflicts_with_all = ["quick", "against", "page"])]
        live: bool,
        /// Write the table of docs/benchmarks.md from the last measurement
        #[arg(long, alias = "readme", conflicts_with_all = ["quick", "against", "page", "live"])]
        table: bool,
        /// Compare the kernels with this commit's
        #[arg(long, value_name = "REV")]
        against: Option<String>,
    },
    /// Run a program until standard input ends, then end it and its children
    #[command(hide = true)]
    Attend {
        /// Program and its arguments
        #[arg(last = true, required = true)]
        words: Vec<OsString>,
    },
    /// Search for inputs that break the core, with libFuzzer
    Fuzz {
        /// Targets to run, such as line (default: all)
        targets: Vec<String>,
        /// Seconds per target
        #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=86_400))]
        seconds: u32,
        /// Random seed; the same seed repeats a run (default: a new one, which is printed)
        #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
        seed: Option<u32>,
    },
    /// Change single expressions, and count the changes that no test notices
    Mutants {
        /// Number of changes
        #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=10_000))]
        sample: u32,
        /// Random seed; the same seed draws the same changes from the same sources
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Package to change; repeatable (default: all of them)
        #[arg(long)]
        package: Vec<String>,
    },
}

#[derive(Args, Clone, Copy)]
struct OptimizeOption {
    /// Build without wasm-opt; the page is larger and slower
    #[arg(long)]
    no_opt: bool,
}

impl OptimizeOption {
    fn value(self) -> tools::Optimize {
        if self.no_opt { tools::Optimize::No } else { tools::Optimize::Yes }
    }
}

fn root() -> &'static Path {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here)
}

/// This program's path, for tests that start it. Read first, because a step may replace the program's file.
static THIS_PROGRAM: LazyLock<io::Result<PathBuf>> = LazyLock::new(env::current_exe);

async fn perform(task: Task) -> Result<()> {
    let web = root().join("web");
    match task {
        Task::Demo { port, no_open, optimize } => {
            // Bind first: a taken port is reported before the build.
            let listener = serve::bind(port)?;
            page::shipped(optimize.value()).await?;
            serve::serve(listener, &dist::folder(), !no_open).await
        }
        Task::Build { optimize } => page::build(optimize.value()).await,
        Task::Dist { no_build, optimize } => {
            let parts = if no_build {
                dist::make(&web, &dist::folder()).await?
            } else {
                page::shipped(optimize.value()).await?
            };
            print!("{}", page::weigh(&dist::folder(), &parts)?);
            Ok(())
        }
        Task::Docs => {
            let site = dist::folder().join(docs::FOLDER);
            docs::build(&site)?;
            println!("{}", site.join("index.html").display());
            Ok(())
        }
        Task::Release { target, out } => release::make(release::Options { target, out }).await,
        Task::C { prefix } => c::install(&prefix, c::Build::Library).await,
        Task::Serve { port, web: folder } => {
            serve::serve(serve::bind(port)?, &folder.unwrap_or(web), false).await
        }
        Task::Format => steps::format().await,
        Task::Test { only: _, list: true } => {
            steps::list();
            Ok(())
        }
        Task::Test { only, list: false } => steps::run(&only).await,
        Task::Bench { table: true, .. } => bench::published(),
        Task::Bench { page: true, .. } => bench::page(None).await,
        Task::Bench { live: true, .. } => bench::live().await,
        Task::Bench { quick, against: Some(rev), .. } => bench::against(quick, &rev).await,
        Task::Bench { quick, .. } => bench::run(quick).await,
        Task::Attend { words } => attend::attend(&words).await,
        Task::Fuzz { targets, seconds, seed } => {
            let seed = seed.unwrap_or_else(fuzz::new_seed);
            fuzz::run(fuzz::Options { targets, seconds, seed }).await
        }
        Task::Mutants { sample, seed, package } => {
            mutants::run(mutants::Options { sample: sample as usize, seed, packages: package }).await
        }
    }
}

#[tokio::main(flavor = "current_thread")]
async fn main() -> ExitCode {
    LazyLock::force(&THIS_PROGRAM);
    LazyLock::force(&build_record::PROGRAM);
    let task = Cli::parse().task;
    // Dropping the future ends the process group of its child.
    let result = tokio::select! {
        result = perform(task) => result,
        signal = run::interrupted() => match signal {
            Ok(code) => return ExitCode::from(code),
            Err(error) => Err(error),
        },
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
