//! The `stepscope` command. Results go to standard output, errors to standard error.

mod calibrate;
mod capture;
#[cfg(test)]
mod command_line_tests;
mod failure;
mod faults;
mod files;
mod interrupt;
mod json;
mod kept_run;
mod limits;
mod line;
mod live;
mod manual;
mod measures;
mod motors;
mod output;
mod panel;
mod parallel;
mod paths;
mod pipe;
mod plant;
mod points;
mod powercut;
mod progress;
mod quantity;
mod run;
mod scenario_file;
mod scenarios;
mod sine;
mod status;
mod steps;
mod tables;
mod terminal;
mod timing;
mod torque;
mod verify;

use crate::failure::Failure;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::{
    io::{self, Write},
    process::ExitCode,
};
use stepscope_core::inspect::export::plain_text::is_unsafe;

/// Printed below the help of each command.
const EXIT_CODES: &str = "\
Exit codes:
  0    success
  1    a file could not be read or written, the recording is truncated, or a port could not be opened
  2    the scenario, the link, the recording or the command line is invalid
  3    a check failed: timing violations with --strict, wrong steps on a framed line (faults), a wrong position
       that is trusted (powercut), a run that differs from the link's (open --verify) or from the plan
       (capture --against), commands that are not confirmed (send), a session not in real time (serve)
  4    the port was lost (send, serve); the report says what is known
  130  stopped by Ctrl-C; no file was changed
  141  standard output was closed, for example by | head";

/// Simulate and check stepper motion to the clock cycle
#[derive(Parser)]
#[command(name = "stepscope", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run a scenario and write its digest, status, trace and other files
    Run(run::Arguments),
    /// Serve a scenario's controllers in real time
    ///
    /// Other programs connect through a pseudo-terminal, a socket or a real port. The session can be recorded.
    Serve(live::serve::Arguments),
    /// Send a scenario's ticks to real controllers and confirm each one
    ///
    /// On a framed line every tick and the final positions are confirmed; raw packets are only timed.
    Send(live::send::Arguments),
    /// Simulate random line faults (one run per seed)
    ///
    /// Counts commands that were executed wrong, twice or not at all, with and without the framed protocol.
    Faults(faults::Arguments),
    /// Write the step times of an axis as a table for a firmware
    ///
    /// C, AVR, Rust or CSV; without --format a summary of what each form of table costs and how far its steps are off.
    Tables(tables::Arguments),
    /// Report tracking error, peaks and distortion of an axis
    ///
    /// Compares the ideal curve, the planned steps and the actual pulses.
    Measures(measures::Arguments),
    /// Check that the motors have enough torque for the planned motion
    ///
    /// Also reports which ramps they can follow, or writes the torque-speed curve of a motor.
    Torque(torque::Arguments),
    /// Simulate motors, supply and sensors driven by the pulses
    Plant(plant::Arguments),
    /// Measure how long the supply current of each motor settles after a step
    ///
    /// The patent's delta t_p. Can write the result into a scenario.
    Settling(limits::SettlingArguments),
    /// Search the start-stop rate and the pull-out rate of each motor
    Limits(limits::LimitsArguments),
    /// Map the swing of each motor and lost steps over the step rate (CSV)
    Resonance(limits::ResonanceArguments),
    /// Analyze a recording of a logic analyzer, a simulation or a serial line
    ///
    /// Reports steps and bytes, checks a driver's timing, compares with a scenario's run, or writes a scenario that
    /// reproduces it.
    Capture(capture::Arguments),
    /// Cut the power of stand-alone controllers and check the restored position
    ///
    /// Counts the cycles after which the position is known, known to be lost, or silently wrong. Also finds the
    /// shortest sufficient hold-up time and the life of the memory.
    Powercut(powercut::Arguments),
    /// Compute steps per millimeter from measured lengths (least squares)
    Calibrate(calibrate::Arguments),
    /// Find the segments that make a sine with least distortion
    #[command(subcommand)]
    Sine(sine::Command),
    /// Write a scenario that moves along the points of a table (CSV of time, position)
    Points(points::Arguments),
    /// Write the scenario of a share link as JSON
    Open {
        /// Link, or the part after its `#`
        link: String,
        /// Run it, and compare the run with that of the link's sender
        ///
        /// The result goes to standard error; exit code 3 if the run differs.
        #[arg(long)]
        verify: bool,
    },
    /// List the presets, or write one as JSON
    Presets {
        /// Preset to write
        id: Option<String>,
        /// Print the list as JSON: one object of tables (docs/command.md).
        #[arg(long, conflicts_with = "id")]
        json: bool,
    },
    /// List the drivers that --driver takes, with their limits and sources
    Drivers {
        /// Print the list as JSON: one object of tables (docs/command.md).
        #[arg(long)]
        json: bool,
    },
    /// Generate shell completions
    Completions {
        /// Shell
        shell: clap_complete::Shell,
    },
    /// Write the manual page, or one page per command into a folder
    Man {
        /// Folder to write to; it is created if needed
        #[arg(long, value_name = "FOLDER")]
        dir: Option<std::path::PathBuf>,
    },
}

fn command_line() -> clap::Command {
    // `-1` is a value out of range, not an option.
    fn negative(argument: clap::Arg) -> clap::Arg {
        let takes = argument.get_long().is_some() && argument.get_action().takes_values();
        if takes { argument.allow_negative_numbers(true) } else { argument }
    }
    fn with_codes(command: clap::Command) -> clap::Command {
        command.after_help(EXIT_CODES).mut_args(negative).mut_subcommands(with_codes)
    }
    with_codes(Arguments::command())
}

fn main() -> ExitCode {
    interrupt::install();
    let arguments = command_line().try_get_matches().and_then(|matches| {
        let arguments = Arguments::from_arg_matches(&matches)?;
        Ok((matches, arguments))
    });
    let result = match arguments {
        Ok((matches, arguments)) => paths::check(&matches).and_then(|()| run(arguments.command)),
        Err(error) => match usage(&error) {
            Ok(code) => return code,
            Err(error) => Err(Failure::output(error)),
        },
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if !failure.is_closed_pipe() {
                // If standard error is closed, the exit code remains.
                let _ = writeln!(terminal::err(), "{failure}");
            }
            failure.exit_code()
        }
    }
}

fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Serve(arguments) => live::serve::serve(&arguments),
        Command::Send(arguments) => live::send::send(&arguments),
        Command::Faults(arguments) => faults::faults(&arguments),
        Command::Tables(arguments) => tables::tables(&arguments),
        Command::Measures(arguments) => measures::measures(&arguments),
        Command::Torque(arguments) => torque::torque(&arguments),
        Command::Plant(arguments) => plant::plant(&arguments),
        Command::Settling(arguments) => limits::settling(&arguments),
        Command::Limits(arguments) => limits::limits(&arguments),
        Command::Resonance(arguments) => limits::resonance(&arguments),
        Command::Capture(arguments) => capture::capture(&arguments),
        Command::Powercut(arguments) => powercut::powercut(&arguments),
        Command::Calibrate(arguments) => calibrate::calibrate(&arguments),
        Command::Sine(command) => sine::sine(&command),
        Command::Points(arguments) => points::points(&arguments),
        Command::Open { link, verify } => scenarios::open(&link, verify),
        Command::Presets { id, json } => scenarios::presets(id.as_deref(), json),
        Command::Drivers { json } => timing::drivers(json),
        Command::Completions { shell } => manual::completions(shell, command_line()),
        Command::Man { dir } => manual::pages(dir.as_deref(), command_line()),
    }
}

fn usage(error: &clap::Error) -> io::Result<ExitCode> {
    // The message repeats the user's text.
    let is_unsafe = |c| is_unsafe(c) && c != '\n' && c != '\t';
    if !error.use_stderr() {
        error.print()?;
        io::stdout().flush()?;
    } else if std::env::args_os().any(|word| word.to_string_lossy().contains(is_unsafe)) {
        let _ = write!(terminal::err(), "{}", error.render());
    } else {
        let _ = error.print();
    }
    Ok(ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2)))
}
