//! Failures of a command: message and exit code.

use crate::{suggest, terminal::Escaped};
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
    NoScenario(PathBuf, String),
    NoRecording(PathBuf, String),
    /// A written file that could not be renamed, and the remaining temporary files.
    NotRenamed(PathBuf, io::Error, Vec<PathBuf>),
    /// The output, and why it cannot be used.
    Output(PathBuf, &'static str),
    Timescale(TooCoarse),
    /// The file, and the maximum bytes.
    TooLong(PathBuf, u64),
    /// The scenario is too long to be read again; the text says how to shorten it.
    LongScenario(PathBuf, &'static str),
    NotText(PathBuf),
    Scenario(PathBuf, Vec<Problem>),
    Link(LinkError),
    NoDigests,
    RunFingerprint(RunFingerprintError),
    LongAnalysis(PathBuf, TooLong),
    Preset(String, String),
    NoPanel(PathBuf),
    LongRun(PathBuf),
    NoStandAlone(PathBuf),
    NoDriver(PathBuf),
    Index(PathBuf, Index),
    /// A table, a recording or an option does not fit; the text says why.
    Invalid(PathBuf, String),
    /// The recording is truncated; the text says why.
    Truncated(PathBuf, String),
    /// A check failed (exit code 3); the text says which.
    Check(String),
    Violations(u64),
    NoSteps,
    Port(String, String),
    Option(String),
    LostPort(String),
    /// How often the clock was set back, and the sum in ms.
    NotRealTime(u64, f64),
    NotRecorded(PathBuf, String),
    Interrupted,
    WrongSteps(u64),
    SilentlyWrong(u64),
}

/// A number beyond the last controller, axis or channel.
#[derive(Debug)]
pub(crate) struct Index {
    pub(crate) of: Numbered,
    pub(crate) given: usize,
    pub(crate) count: usize,
    /// Whether omitting the option selects all of them.
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
    /// Option, singular and plural.
    const fn names(self) -> (&'static str, &'static str, &'static str) {
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
        let (option, one, many) = self.of.names();
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

    /// The reader of the output, such as `head`, has ended.
    pub(crate) fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::File(_, error) if error.kind() == io::ErrorKind::BrokenPipe)
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            // The code that a shell reports for SIGPIPE.
            _ if self.is_closed_pipe() => ExitCode::from(141),
            Self::File(..)
            | Self::NoScenario(..)
            | Self::NoRecording(..)
            | Self::NotRenamed(..)
            | Self::Truncated(..)
            | Self::Port(..) => ExitCode::from(1),
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
            | Self::NoDigests
            | Self::RunFingerprint(_)
            | Self::Preset(..)
            | Self::NoPanel(_)
            | Self::NoStandAlone(_)
            | Self::LongRun(_)
            | Self::NoDriver(_)
            | Self::Index(..)
            | Self::Invalid(..)
            | Self::Option(_) => ExitCode::from(2),
            Self::Check(_)
            | Self::Violations(_)
            | Self::NoSteps
            | Self::NotRealTime(..)
            | Self::NotRecorded(..)
            | Self::WrongSteps(_)
            | Self::SilentlyWrong(_) => ExitCode::from(3),
        }
    }
}

pub(crate) fn no_plant(path: &Path) -> Failure {
    let detail = "the scenario has no plant, so there are no motors to simulate; add \"plant\": {}";
    let problem = Problem::new("plant", ValueError::Conflict { detail });
    Failure::Scenario(path.to_owned(), vec![problem])
}

/// The problem; for an unknown field, with the most similar name.
pub(crate) fn with_hint(problem: &Problem) -> String {
    let text = problem.to_string();
    let Some((_, names)) = text.rsplit_once("unknown field; use one of ") else { return text };
    let hint = problem.path.rsplit('.').next().map(|name| suggest::hint(name, names.split(", ")));
    text.clone() + &hint.unwrap_or_default()
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path, error) => write!(f, "{}: {error}", Escaped::path(path)),
            Self::NoScenario(path, hint) => write!(
                f,
                "{}: no file or preset of this name; `stepscope presets` lists the presets{hint}",
                Escaped::path(path)
            ),
            Self::NoRecording(path, hint) => {
                write!(f, "{}: no file or recording of this name{hint}", Escaped::path(path))
            }
            Self::NotRenamed(path, error, kept) => {
                let path = Escaped::path(path);
                write!(f, "{path}: {error}; the new files keep their temporary names:")?;
                kept.iter().try_for_each(|kept| write!(f, "\n  {}", Escaped::path(kept)))
            }
            Self::Output(path, detail) => write!(f, "{}: {detail}", Escaped::path(path)),
            Self::Timescale(error) => write!(f, "--vcd-timescale: {error}"),
            Self::TooLong(path, max) => {
                let path = Escaped::path(path);
                write!(f, "{path}: more than {max} bytes; ")?;
                f.write_str(if *max > MAX_TEXT_BYTES as u64 {
                    "save the recording to a file, which may have any length"
                } else {
                    "use a shorter scenario or table"
                })
            }
            Self::LongAnalysis(path, why) => write!(f, "{}: {why}", Escaped::path(path)),
            Self::LongScenario(path, help) => write!(
                f,
                "{}: not written: the scenario has more than {MAX_TEXT_BYTES} bytes and could not be read again; {help}",
                Escaped::path(path)
            ),
            Self::NotText(path) => {
                write!(f, "{}: not UTF-8 text; save it as UTF-8", Escaped::path(path))
            }
            Self::Scenario(path, problems) => {
                let count = problems.len();
                let s = if count == 1 { "" } else { "s" };
                write!(f, "{}: {count} problem{s}", Escaped::path(path))?;
                problems.iter().try_for_each(|problem| write!(f, "\n  {}", Escaped(with_hint(problem))))
            }
            Self::Link(error) => write!(f, "{error}"),
            Self::NoDigests => f.write_str(
                "--verify: the link has no digests of its sender (no d= part); create it with Share in the page, or with `stepscope run --link`",
            ),
            Self::RunFingerprint(error) => write!(f, "{error}"),
            Self::Preset(id, hint) => {
                write!(f, "{}: no preset of this name; `stepscope presets` lists the presets{hint}", Escaped(id))
            }
            Self::NoPanel(path) => write!(
                f,
                "{}: --panel: the scenario has no stand-alone controller; omit the option, or use a preset such as zhang-2012-controller",
                Escaped::path(path)
            ),
            Self::LongRun(path) => write!(
                f,
                "{}: the run has more than 4000000 edges, or no end; set run_cycles, or use a shorter program",
                Escaped::path(path)
            ),
            Self::NoStandAlone(path) => write!(
                f,
                "{}: the scenario has no stand-alone controller; use one with source.standalone, or a preset such as zhang-2012-controller",
                Escaped::path(path)
            ),
            Self::SilentlyWrong(count) => {
                let s = plural(*count);
                write!(f, "a wrong position is trusted after {count} power cut{s}; use --json for the first cycle")
            }
            Self::NoDriver(path) => write!(
                f,
                "{}: the scenario has no driver; use --driver (`stepscope drivers` lists the drivers)",
                Escaped::path(path)
            ),
            Self::Index(path, index) => write!(f, "{}: {index}", Escaped::path(path)),
            Self::Invalid(path, why) => write!(f, "{}: {why}", Escaped::path(path)),
            Self::Truncated(path, why) => write!(
                f,
                "{}: the recording is truncated: {why}; the results cover the part before",
                Escaped::path(path)
            ),
            Self::Check(why) | Self::Option(why) => f.write_str(why),
            Self::Port(name, why) => write!(f, "{}: {why}", Escaped(name)),
            Self::LostPort(why) => write!(f, "the port was lost: {why}"),
            Self::NotRealTime(count, ms) => {
                let s = plural(*count);
                write!(
                    f,
                    "not in real time: the clock was set back {count} time{s}, by {ms:.0} ms in total, but the run is exact for its input; use a longer --lag or a lower --pace"
                )
            }
            Self::NotRecorded(path, why) => write!(
                f,
                "{}: written, but the recording does not reproduce the session: {why}",
                Escaped::path(path)
            ),
            Self::Interrupted => f.write_str("stopped by Ctrl-C"),
            Self::Violations(count) => {
                write!(f, "--strict: {count} violation{} of the driver's timing", plural(*count))
            }
            Self::NoSteps => f.write_str(
                "--strict: the recording has no steps to check; map a channel to STEP0, such as --map STEP0=CH1",
            ),
            Self::WrongSteps(count) => {
                let s = plural(*count);
                write!(f, "framed line: wrong, duplicated or missing ticks with {count} seed{s}")
            }
        }
    }
}

const fn plural(count: u64) -> &'static str {
    if count == 1 { "" } else { "s" }
}
