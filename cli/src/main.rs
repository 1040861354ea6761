//! The `stepscope` command. Results go to standard output, errors to standard error.

mod axis_data;
mod calibrate;
mod capture;
mod check;
#[cfg(test)]
mod command_line_tests;
mod complete;
mod failure;
mod faults;
mod files;
mod help;
mod interrupt;
mod json;
mod limits;
mod line;
mod live;
mod manual;
mod measures;
mod motors;
mod options;
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
mod run_recording;
mod scenario_file;
mod scenarios;
mod schema;
mod sine;
mod status;
mod steps;
mod suggest;
mod tables;
mod terminal;
mod timing;
mod torque;
mod verify;

use crate::failure::Failure;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::io::{self, Write};
use std::process::ExitCode;
use stepscope_core::inspect::export::plain_text::needs_escape;

/// Simulate and check stepper motion with clock-cycle accuracy
#[derive(Parser)]
#[command(name = "stepscope", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run a scenario; print its digest and status, and write traces and tables
    Run(run::Arguments),
    /// Serve a scenario's controllers in real time
    ///
    /// Other programs connect through a pseudo-terminal, a socket or a serial port. The session can be recorded.
    Serve(live::serve::Arguments),
    /// Send a scenario's ticks to real controllers and confirm each one
    ///
    /// On a framed line, each tick and the final positions are confirmed. Raw packets get no replies, so only their
    /// timing is reported.
    Send(live::send::Arguments),
    /// Simulate random line faults, one run per seed
    ///
    /// Counts ticks that are executed incorrectly, twice or not at all, with and without the framed protocol.
    Faults(faults::Arguments),
    /// Write the step times of an axis as a table for firmware
    ///
    /// The table is C, C for AVR, Rust or CSV. Without --format, reports the size and the error of each form of table.
    Tables(tables::Arguments),
    /// Report tracking error, peaks and distortion of an axis
    ///
    /// Compares the ideal curve, the planned steps and the actual pulses.
    Measures(measures::Arguments),
    /// Write the steps of an axis: cycle, time and direction
    ///
    /// The table can be read by `stepscope tables --steps`.
    Steps(axis_data::StepsArguments),
    /// Write the ideal curve of an axis: position, speed and acceleration over time
    ///
    /// Positions are in steps, speeds in steps/s, accelerations in steps/s^2.
    Curve(axis_data::CurveArguments),
    /// Write the spectrum of an axis: peak amplitude of each harmonic
    ///
    /// The number of harmonics is the scenario's analysis.max_harmonic. JSON also has the distortion (THD) as a ratio,
    /// null if the motion is not periodic, and the analyzed time.
    Spectrum(axis_data::SpectrumArguments),
    /// Check that the motors have enough torque for the planned motion
    ///
    /// Also reports feasible ramps, or writes the torque-speed curve of a motor.
    Torque(torque::Arguments),
    /// Simulate motors, supply and sensors driven by the pulses
    Plant(plant::Arguments),
    /// Measure the settling time of each motor's supply current after a step
    ///
    /// Patent RU 2704486 separates steps of different motors by at least this time.
    Settling(limits::SettlingArguments),
    /// Find the start-stop rate and the pull-out rate of each motor
    Limits(limits::LimitsArguments),
    /// Map oscillation and lost steps of each motor over the step rate
    Resonance(limits::ResonanceArguments),
    /// Analyze a recording of a logic analyzer, a simulation or a serial line
    ///
    /// Reports steps and bytes, checks a driver's timing, compares with a scenario's run, or writes a scenario that
    /// reproduces the recording.
    Capture(capture::Arguments),
    /// Check recordings, runs and tables of a project, as in CI
    ///
    /// Runs each check of a list and prints one line per check. A check compares a recording with a scenario, checks the
    /// digest and the driver timing of a run, or compares a table with its scenario.
    Check(check::Arguments),
    /// Cut the power of stand-alone controllers and check the restored position
    ///
    /// Counts the power cuts after which the position is known, known to be lost, or wrong without notice. Also finds
    /// the minimum hold-up time and the lifetime of the memory.
    Powercut(powercut::Arguments),
    /// Compute steps per millimeter from measured lengths by least squares
    Calibrate(calibrate::Arguments),
    /// Approximate sines by straight segments with minimum distortion
    #[command(subcommand)]
    Sine(sine::Command),
    /// Write a scenario that moves along the points of a CSV table
    Points(points::Arguments),
    /// Write the scenario of a share link as JSON
    Open(scenarios::OpenArguments),
    /// List the presets, or write one as JSON
    Presets(scenarios::PresetsArguments),
    /// Write the JSON Schema of a scenario (draft 2020-12)
    ///
    /// Editors use it to complete and check fields. Rules between fields are checked by `stepscope run`.
    Schema(schema::Arguments),
    /// List the drivers that --driver accepts, with their limits and sources
    Drivers(options::Json),
    /// Write a completion script for a shell
    Completions {
        /// Shell to generate the script for
        shell: clap_complete::Shell,
        #[command(flatten)]
        out: options::Out,
    },
    /// Write the manual page, or one page per command into a folder
    Man {
        /// Folder to write to; it is created if needed
        #[arg(long, value_name = "FOLDER")]
        dir: Option<std::path::PathBuf>,
    },
}

fn command_line() -> clap::Command {
    help::add_details(Arguments::command())
}

fn main() -> ExitCode {
    complete::print_candidates(command_line);
    interrupt::install();
    let arguments = command_line().try_get_matches().and_then(|matches| {
        let arguments = Arguments::from_arg_matches(&matches)?;
        Ok((matches, arguments))
    });
    let (matches, arguments) = match arguments {
        Ok(arguments) => arguments,
        Err(error) => return print_usage(&error).unwrap_or_else(|error| report(&Failure::output(error))),
    };
    match paths::check(&matches).and_then(|()| run(arguments.command)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => report(&failure),
    }
}

/// Prints a failure; returns its exit code, which remains even if standard error is closed.
fn report(failure: &Failure) -> ExitCode {
    if !failure.is_closed_pipe() {
        let _ = writeln!(terminal::err(), "{failure}");
    }
    failure.exit_code()
}

fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Serve(arguments) => live::serve::serve(&arguments),
        Command::Send(arguments) => live::send::send(&arguments),
        Command::Faults(arguments) => faults::faults(&arguments),
        Command::Tables(arguments) => tables::tables(&arguments),
        Command::Measures(arguments) => measures::measures(&arguments),
        Command::Steps(arguments) => axis_data::steps(&arguments),
        Command::Curve(arguments) => axis_data::curve(&arguments),
        Command::Spectrum(arguments) => axis_data::spectrum(&arguments),
        Command::Torque(arguments) => torque::torque(&arguments),
        Command::Plant(arguments) => plant::plant(&arguments),
        Command::Settling(arguments) => limits::settling(&arguments),
        Command::Limits(arguments) => limits::limits(&arguments),
        Command::Resonance(arguments) => limits::resonance(&arguments),
        Command::Capture(arguments) => capture::capture(&arguments),
        Command::Check(arguments) => check::check(&arguments, Arguments::command()),
        Command::Powercut(arguments) => powercut::powercut(&arguments),
        Command::Calibrate(arguments) => calibrate::calibrate(&arguments),
        Command::Sine(command) => sine::sine(&command),
        Command::Points(arguments) => points::points(&arguments),
        Command::Open(arguments) => scenarios::open(&arguments),
        Command::Presets(arguments) => scenarios::presets(&arguments),
        Command::Schema(arguments) => schema::schema(&arguments),
        Command::Drivers(arguments) => timing::drivers(arguments.json),
        Command::Completions { shell, out } => complete::write_script(shell, &out.out),
        Command::Man { dir } => manual::write_pages(dir.as_deref(), command_line()),
    }
}

/// Prints help, or a usage error; returns the exit code.
fn print_usage(error: &clap::Error) -> io::Result<ExitCode> {
    // A usage error repeats the user's text, which must not control the terminal.
    let is_control = |c| needs_escape(c) && c != '\n' && c != '\t';
    if !error.use_stderr() {
        error.print()?;
        io::stdout().flush()?;
    } else if std::env::args_os().any(|word| word.to_string_lossy().contains(is_control)) {
        let _ = write!(terminal::err(), "{}", error.render());
    } else {
        let _ = error.print();
    }
    Ok(ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2)))
}
