//! The `stepscope` command: the native front of the model.
//!
//! Results go to standard output, errors to standard error. Exit codes: 0 the run was made, 1 a
//! file could not be read or written, 2 the scenario (or the command line) is wrong.

mod run;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// A stepper-motion laboratory: runs scenarios to the clock cycle.
#[derive(Parser)]
#[command(name = "stepscope", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Runs a scenario and prints its digest and status.
    Run(run::Arguments),
}

fn main() -> ExitCode {
    let Arguments { command: Command::Run(arguments) } = Arguments::parse();
    match run::run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            failure.exit_code()
        }
    }
}
