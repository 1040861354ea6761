//! Failures of a command: message and exit code.

use crate::terminal::Escaped;
use std::{
    fmt, io,
    path::{Path, PathBuf},
    process::ExitCode,
};
use stepscope_core::{
    inspect::{
        export::vcd::TooCoarse,
        trace::{run_fingerprint::RunFingerprintError, stored_run::TooLong},
    },
    scenario::{MAX_TEXT_BYTES, Problem, ValueError, link::LinkError},
};

pub(crate) const INTERRUPTED: u8 = 130;

#[derive(Debug)]
pub(crate) enum Failure {
    File(PathBuf, io::Error),
    /// A written file that could not be renamed, and the temporary files that are kept.
    NotRenamed(PathBuf, io::Error, Vec<PathBuf>),
    /// The output, and why it cannot be used.
    Output(PathBuf, &'static str),
    Timescale(TooCoarse),
    /// The file, and the maximum bytes.
    TooLong(PathBuf, u64),
    /// The scenario is too long to read again; the text names a remedy.
    LongScenario(PathBuf, &'static str),
    NotText(PathBuf),
    Scenario(PathBuf, Vec<Problem>),
    Link(LinkError),
    /// A link without its sender's digests cannot be verified.
    NoProof,
    RunFingerprint(RunFingerprintError),
    /// The first difference.
    OtherRun(String),
    LongAnalysis(PathBuf, TooLong),
    Preset(String),
    NoPanel(PathBuf),
    LongRun(PathBuf),
    NoStandAlone(PathBuf),
    NoDriver(PathBuf),
    Index(PathBuf, Index),
    Table(PathBuf, String),
    Recording(PathBuf, String),
    /// A truncated recording.
    PartOnly(PathBuf, String),
    /// A recording differs from the plan.
    NotTheModel(String),
    /// Violations that the timing check found, with --strict.
    Violations(u64),
    /// A strict timing check of a recording without steps.
    NoSteps,
    Port(String, String),
    Option(String),
    LostPort(String),
    /// Number of set-backs, and their sum in ms.
    NotRealTime(u64, f64),
    NotRecorded(PathBuf, String),
    NotVerified(String),
    /// Ctrl-C, after the report.
    Interrupted,
    /// Number of seeds with wrong steps on a framed line.
    WrongSteps(u64),
    /// Number of power cuts after which a wrong position is trusted.
    SilentlyWrong(u64),
}

/// A number beyond the last controller, axis or channel.
#[derive(Debug)]
pub(crate) struct Index {
    pub(crate) of: Numbered,
    pub(crate) given: usize,
    pub(crate) count: usize,
    /// Without the option all of them are meant.
    pub(crate) or_all: bool,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Numbered {
    Controllers,
    Axes,
    /// Channels that `--axis` selects.
    AxisChannels,
    Channels,
}

impl Numbered {
    const fn words(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Controllers => ("--controller", "controller", "controllers"),
            Self::Axes => ("--axis", "axis", "axes"),
            Self::AxisChannels => ("--axis", "channel", "channels"),
            Self::Channels => ("--channel", "channel", "channels"),
        }
    }
}

impl fmt::Display for Index {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (option, one, many) = self.of.words();
        write!(f, "{option}: {} is out of range; the scenario has ", self.given)?;
        match self.count {
            0 => return write!(f, "no {many}"),
            1 => write!(f, "only {one} 0; use {option} 0")?,
            count => write!(f, "{many} 0 to {last}; use {option} 0 to {last}", last = count - 1)?,
        }
        if self.or_all { f.write_str(", or omit it for all") } else { Ok(()) }
    }
}

impl Failure {
    pub(crate) fn index(path: &Path, of: Numbered, given: usize, count: usize, or_all: bool) -> Self {
        Self::Index(path.to_owned(), Index { of, given, count, or_all })
    }

    pub(crate) fn output(error: io::Error) -> Self {
        Self::File(PathBuf::from("standard output"), error)
    }

    pub(crate) fn threads(error: io::Error) -> Self {
        Self::File(PathBuf::from("threads"), error)
    }

    /// Such as behind `| head`.
    pub(crate) fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::File(_, error) if error.kind() == io::ErrorKind::BrokenPipe)
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            // The code that a shell reports for SIGPIPE.
            _ if self.is_closed_pipe() => ExitCode::from(141),
            Self::File(..) | Self::NotRenamed(..) | Self::PartOnly(..) | Self::Port(..) => ExitCode::from(1),
            Self::LostPort(_) => ExitCode::from(4),
            Self::Interrupted => ExitCode::from(INTERRUPTED),
            Self::Output(..)
            | Self::Timescale(_)
            | Self::TooLong(..)
            | Self::NotText(_)
            | Self::LongAnalysis(..)
            | Self::LongScenario(..)
            | Self::Scenario(..)
            | Self::Link(_)
            | Self::NoProof
            | Self::RunFingerprint(_)
            | Self::Preset(_)
            | Self::NoPanel(_)
            | Self::NoStandAlone(_)
            | Self::LongRun(_)
            | Self::NoDriver(_)
            | Self::Index(..)
            | Self::Table(..)
            | Self::Option(_)
            | Self::Recording(..) => ExitCode::from(2),
            Self::OtherRun(_)
            | Self::NotTheModel(_)
            | Self::Violations(_)
            | Self::NoSteps
            | Self::NotRealTime(..)
            | Self::NotRecorded(..)
            | Self::NotVerified(_)
            | Self::WrongSteps(_)
            | Self::SilentlyWrong(_) => ExitCode::from(3),
        }
    }
}

pub(crate) fn no_plant(path: &Path) -> Failure {
    let detail = "no plant, so nothing is driven; give \"plant\": {}";
    let problem = Problem::new("plant", ValueError::Conflict { detail });
    Failure::Scenario(path.to_owned(), vec![problem])
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path, error) => write!(f, "{}: {error}", Escaped::path(path)),
            Self::NotRenamed(path, error, kept) => {
                write!(f, "{}: {error}; what was written is saved under other names:", Escaped::path(path))?;
                kept.iter().try_for_each(|kept| write!(f, "\n  {}", Escaped::path(kept)))
            }
            Self::Output(path, detail) => write!(f, "{}: {detail}", Escaped::path(path)),
            Self::Timescale(error) => write!(f, "--vcd-timescale: {error}"),
            Self::TooLong(path, most) => write!(
                f,
                "{}: more than {most} bytes; {}",
                Escaped::path(path),
                if *most > MAX_TEXT_BYTES as u64 {
                    "save it to a file, which may have any length"
                } else {
                    "give a shorter text: no scenario or table needs as many"
                }
            ),
            Self::LongAnalysis(path, why) => write!(f, "{}: {why}", Escaped::path(path)),
            Self::LongScenario(path, help) => write!(
                f,
                "{}: not written: the scenario takes more than the {MAX_TEXT_BYTES} bytes that can be read again; {help}",
                Escaped::path(path)
            ),
            Self::NotText(path) => {
                write!(f, "{}: not UTF-8 text; save it as UTF-8", Escaped::path(path))
            }
            Self::Scenario(path, problems) => {
                let count = problems.len();
                let s = if count == 1 { "" } else { "s" };
                write!(f, "{}: {count} problem{s}", Escaped::path(path))?;
                problems.iter().try_for_each(|problem| write!(f, "\n  {}", Escaped(problem)))
            }
            Self::Link(error) => write!(f, "{error}"),
            Self::NoProof => f.write_str(
                "the link carries no digests of its sender (no d= in it), so there is nothing to verify; make it with the page's Share or with `stepscope run --link`",
            ),
            Self::RunFingerprint(error) => write!(f, "{error}"),
            Self::OtherRun(how) => f.write_str(how),
            Self::Preset(id) => {
                write!(f, "{}: no such preset; `stepscope presets` lists them", Escaped(id))
            }
            Self::NoPanel(path) => write!(
                f,
                "{}: --panel writes what stand-alone controllers show, and there is none; take it out, or give a source standalone",
                Escaped::path(path)
            ),
            Self::LongRun(path) => write!(
                f,
                "{}: the run makes more than 4 000 000 edges, or comes to no end; give run_cycles or a shorter program",
                Escaped::path(path)
            ),
            Self::NoStandAlone(path) => write!(
                f,
                "{}: powercut cuts the power of stand-alone controllers, and there is none; give a source standalone, or a preset such as zhang-2012-controller",
                Escaped::path(path)
            ),
            Self::SilentlyWrong(count) => write!(
                f,
                "after {count} power cuts a position is wrong but trusted; the table of --json has the first of these cuts"
            ),
            Self::NoDriver(path) => write!(
                f,
                "{}: the scenario names no driver; give one with --driver, `stepscope drivers` lists them",
                Escaped::path(path)
            ),
            Self::Index(path, index) => write!(f, "{}: {index}", Escaped::path(path)),
            Self::Table(path, what) | Self::Recording(path, what) => write!(f, "{}: {what}", Escaped::path(path)),
            Self::PartOnly(path, why) => {
                write!(f, "{}: the recording is truncated: {why}; the results above are those of the part before", Escaped::path(path))
            }
            Self::NotTheModel(how) | Self::Option(how) | Self::NotVerified(how) => f.write_str(how),
            Self::Port(name, why) => write!(f, "{}: {why}", Escaped(name)),
            Self::LostPort(why) => write!(f, "the port is lost: {why}"),
            Self::NotRealTime(count, ms) => {
                let times = if *count == 1 { "once" } else { "several times" };
                write!(
                    f,
                    "this machine did not keep up: the session's clock was set back {times} ({count}), by {ms:.0} ms in all. The run is exact for what it was given, but was not in real time; give a longer --lag or a lower --pace"
                )
            }
            Self::NotRecorded(path, why) => write!(f, "{}: written, but it does not reproduce the session: {why}", Escaped::path(path)),
            Self::Interrupted => f.write_str("stopped by Ctrl-C"),
            Self::Violations(count) => {
                let s = if *count == 1 { "" } else { "s" };
                write!(f, "{count} violation{s} of the driver's timing")
            }
            Self::NoSteps => f.write_str(
                "--strict: the recording has no steps to check; map a channel to STEP0, such as --map STEP0=CH1",
            ),
            Self::WrongSteps(count) => {
                let s = if *count == 1 { "" } else { "s" };
                write!(f, "framed: wrong, duplicated or missing ticks with {count} seed{s}")
            }
        }
    }
}
