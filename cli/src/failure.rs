//! Failures of a command: message and exit code.

use crate::{suggest, terminal::Escaped};
use std::path::{Path, PathBuf};
use std::{fmt, io, process::ExitCode};
use stepscope_core::inspect::export::vcd::TooCoarse;
use stepscope_core::scenario::{Cause, MAX_TEXT_BYTES, Problem, Problems, ValueError, link::LinkError};

pub(crate) const INTERRUPTED: u8 = 130;

#[derive(Debug)]
pub(crate) enum Failure {
    File(PathBuf, io::Error),
    /// A name, a port or a file that cannot be used, and why (exit code 1).
    Unusable(String, String),
    /// A written file that could not be renamed, and the remaining temporary files.
    NotRenamed(PathBuf, io::Error, Vec<PathBuf>),
    /// The recording is truncated; the text says why.
    Truncated(PathBuf, String),
    /// The command line is invalid; the text says why.
    Option(String),
    /// A scenario, a table or a recording does not fit the command; the text says why.
    Invalid(PathBuf, String),
    /// The file, and the maximum bytes.
    TooLong(PathBuf, u64),
    Scenario(PathBuf, Problems),
    Index(PathBuf, Index),
    Timescale(TooCoarse),
    Link(LinkError),
    /// A check failed (exit code 3); the text says which.
    Check(String),
    LostPort(String),
    Interrupted,
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

    pub(crate) fn invalid(path: &Path, why: impl Into<String>) -> Self {
        Self::Invalid(path.to_owned(), why.into())
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
        ExitCode::from(match self {
            // The code that a shell reports for SIGPIPE.
            _ if self.is_closed_pipe() => 141,
            Self::File(..) | Self::Unusable(..) | Self::NotRenamed(..) | Self::Truncated(..) => 1,
            Self::Check(_) => 3,
            Self::LostPort(_) => 4,
            Self::Interrupted => INTERRUPTED,
            Self::Option(_)
            | Self::Invalid(..)
            | Self::TooLong(..)
            | Self::Scenario(..)
            | Self::Index(..)
            | Self::Timescale(_)
            | Self::Link(_) => 2,
        })
    }
}

pub(crate) fn no_plant(path: &Path) -> Failure {
    let detail = "the scenario has no plant, so there are no motors to simulate; add \"plant\": {}";
    let problem = Problem::new("plant", ValueError::Conflict { detail });
    Failure::Scenario(path.to_owned(), problem.into())
}

/// The problem; for an unknown field, with the most similar name.
pub(crate) fn with_hint(problem: &Problem) -> String {
    let text = problem.to_string();
    // The first characters show that this is not a JSON object.
    if matches!(problem.cause, Cause::Syntax { line: 1, column: 1 | 2, .. }) {
        return format!("not a scenario: {text}; open a recording with stepscope capture");
    }
    let Some((before, names)) = text.rsplit_once("unknown field; use one of ") else { return text };
    let name = problem.path.rsplit('.').next().unwrap_or_default();
    let hint = suggest::hint(name, names.split(", "));
    format!("{before}unknown field{hint}; use one of {names}")
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path, error) => write!(f, "{}: {error}", Escaped::path(path)),
            Self::Unusable(name, why) => write!(f, "{}: {why}", Escaped(name)),
            Self::NotRenamed(path, error, kept) => {
                let path = Escaped::path(path);
                write!(f, "{path}: {error}; the new files keep their temporary names:")?;
                kept.iter().try_for_each(|kept| write!(f, "\n  {}", Escaped::path(kept)))
            }
            Self::Truncated(path, why) => write!(
                f,
                "{}: the recording is truncated: {why}; the results cover only the data before that point",
                Escaped::path(path)
            ),
            Self::Option(why) | Self::Check(why) => f.write_str(why),
            Self::Invalid(path, why) => write!(f, "{}: {why}", Escaped::path(path)),
            Self::TooLong(path, max) => {
                let path = Escaped::path(path);
                write!(f, "{path}: more than {max} bytes; ")?;
                f.write_str(if *max > MAX_TEXT_BYTES as u64 {
                    "save the recording to a file, which may have any length"
                } else {
                    "use a shorter scenario or table"
                })
            }
            Self::Scenario(path, problems) => {
                let count = problems.len();
                write!(f, "{}: {count} problem{}", Escaped::path(path), plural(count as u64))?;
                problems.iter().try_for_each(|problem| write!(f, "\n  {}", Escaped(with_hint(problem))))
            }
            Self::Index(path, index) => write!(f, "{}: {index}", Escaped::path(path)),
            Self::Timescale(error) => write!(f, "--vcd-timescale: {error}"),
            Self::Link(error) => write!(f, "{error}"),
            Self::LostPort(why) => write!(f, "the port was lost: {why}"),
            Self::Interrupted => f.write_str("stopped by Ctrl-C"),
        }
    }
}

/// The plural ending for a number.
pub(crate) const fn plural(count: u64) -> &'static str {
    if count == 1 { "" } else { "s" }
}
