//! The `stepscope` command: the native front of the model.
//!
//! Results go to standard output, errors to standard error; [`EXIT_CODES`] says how a command ends.

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

/// How a command ends, below the help of each.
const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    a file could not be read or written, or a recording not to its end; a port could not be opened
  2    the scenario, the link, the recording or the command line is wrong
  3    something was to hold and does not: --strict found violations, faults found wrong steps on a framed line,
       powercut found a position that is trusted and wrong, open --verify found another run than the link's,
       capture --against another than the model's, send could not confirm what it sent, serve was not in real time
  4    send, serve: the port was lost; what is known was told
  130  ended by Ctrl-C; no file was changed
  141  standard output was closed, as behind | head";

/// A stepper-motion laboratory: runs scenarios to the clock cycle.
#[derive(Parser)]
#[command(name = "stepscope", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Runs a scenario: digest, status, trace and other files.
    Run(run::Arguments),
    /// Serves a scenario's controllers against the wall clock: other programs talk to them through a pseudo-terminal, a socket or
    /// a real port, and the session can be recorded.
    Serve(live::serve::Arguments),
    /// Sends a scenario's ticks to real controllers and has them confirmed, tick by tick and position by position.
    Send(live::send::Arguments),
    /// Sends the same orders over a line that goes wrong in as many ways as there are seeds, and counts
    /// what was executed wrong, twice or not at all, with and without the framed protocol.
    Faults(faults::Arguments),
    /// Writes the step times of an axis as a table for a firmware (C, AVR, Rust, CSV), or what each form of
    /// table costs and how far its steps are off.
    Tables(tables::Arguments),
    /// Runs a scenario and tells how good an axis is, in numbers: the ideal curve, the steps that are made of
    /// it and the pulses as they come held against each other, peaks, durations, distortion.
    Measures(measures::Arguments),
    /// Says whether the motors have the torque that a scenario's plans ask for, and which ramps they can
    /// follow; or writes a motor's torque-speed curve.
    Torque(torque::Arguments),
    /// Runs a scenario that has a plant and tells what its pulses do to the motors, their supply and the sensors.
    Plant(plant::Arguments),
    /// Measures how long the supply current of each motor takes to settle after a step (the patent's delta t_p), and
    /// can write it into a scenario.
    Settling(limits::SettlingArguments),
    /// Searches the rate at which each motor of a plant starts and stops, and the one to which a ramp brings it.
    Limits(limits::LimitsArguments),
    /// Maps how far each motor of a plant swings at each rate, and where it loses steps (CSV).
    Resonance(limits::ResonanceArguments),
    /// Opens a recording (a dump, a logic analyser's file, bytes, positions) and tells what its steps and bytes come to,
    /// whether a driver could follow, how it stands to a scenario's run; or makes a scenario of it.
    Capture(capture::Arguments),
    /// Cuts the power of stand-alone controllers in as many cycles as there are, and counts where the position is known
    /// afterwards, known to be lost, or silently wrong; finds the hold-up that is just enough, and the memory's life.
    Powercut(powercut::Arguments),
    /// Steps a millimetre by least squares, from measured lengths and the steps that made them.
    Calibrate(calibrate::Arguments),
    /// Looks for the segments that make a sine with least distortion.
    #[command(subcommand)]
    Sine(sine::Command),
    /// Writes a scenario whose one move is the curve through the points of a table (CSV of time, position).
    Points(points::Arguments),
    /// Writes the scenario of a share link as JSON.
    Open {
        /// The link, or what stands behind its `#`.
        link: String,
        /// Also run it, and say on standard error whether the run is the one that the sender of the link
        /// saw, or where the first difference is. Ends with 3 if it is another.
        #[arg(long)]
        verify: bool,
    },
    /// Lists the presets, or writes one as JSON.
    Presets {
        /// The preset to write.
        id: Option<String>,
        /// Print the list as JSON: one object of tables (docs/command.md).
        #[arg(long, conflicts_with = "id")]
        json: bool,
    },
    /// Lists the drivers that pulses can be checked against, with their data sheets' figures.
    Drivers {
        /// Print the list as JSON: one object of tables (docs/command.md).
        #[arg(long)]
        json: bool,
    },
    /// Writes what completes this command's words in a shell.
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Writes the manual page of this command, or a page of each of its commands into a folder.
    Man {
        /// The folder, which is made if it is not there.
        #[arg(long, value_name = "FOLDER")]
        dir: Option<std::path::PathBuf>,
    },
}

/// The command line, with the exit codes below the help of each command.
fn command_line() -> clap::Command {
    fn with_codes(command: clap::Command) -> clap::Command {
        command.after_help(EXIT_CODES).mut_subcommands(with_codes)
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
                // Who has closed standard error has the exit code.
                let _ = writeln!(terminal::err(), "{failure}");
            }
            failure.exit_code()
        }
    }
}

/// Runs a command.
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

/// Prints help, the version, or what is wrong with the command line, and gives the exit code.
fn usage(error: &clap::Error) -> io::Result<ExitCode> {
    // What was typed is repeated, also to a terminal.
    let is_unsafe = |c| terminal::is_unsafe(c) && c != '\n' && c != '\t';
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
