//! Why a command has no result, in words and as an exit code.

use std::{fmt, io, path::PathBuf, process::ExitCode};
use stepscope_core::scenario::{Problem, link::LinkError};

/// Why there is no result.
pub(crate) enum Failure {
    /// A file could not be read or written.
    File(PathBuf, io::Error),
    /// The scenario's file is not text.
    NotText(PathBuf),
    /// The scenario is wrong.
    Scenario(PathBuf, Vec<Problem>),
    /// The link is wrong, or the scenario does not fit in one.
    Link(LinkError),
    /// There is no such preset.
    Preset(String),
    /// A timing check without a driver.
    NoDriver(PathBuf),
    /// The timing check found this many violations, and none was to be.
    Violations(u64),
}

impl Failure {
    /// The command's exit code.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::File(..) => ExitCode::from(1),
            Self::NotText(_) | Self::Scenario(..) | Self::Link(_) | Self::Preset(_) | Self::NoDriver(_) => {
                ExitCode::from(2)
            }
            Self::Violations(_) => ExitCode::from(3),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path, error) => write!(f, "{}: {error}", path.display()),
            Self::NotText(path) => {
                write!(f, "{}: not UTF-8 text; save the scenario as UTF-8", path.display())
            }
            Self::Scenario(path, problems) => {
                let count = problems.len();
                let s = if count == 1 { "" } else { "s" };
                write!(f, "{}: {count} problem{s}", path.display())?;
                problems.iter().try_for_each(|problem| write!(f, "\n  {problem}"))
            }
            Self::Link(error) => write!(f, "{error}"),
            Self::Preset(id) => {
                write!(f, "{id}: no such preset; `stepscope presets` lists them")
            }
            Self::NoDriver(path) => write!(
                f,
                "{}: the scenario names no driver; give one with --driver, `stepscope drivers` lists them",
                path.display()
            ),
            Self::Violations(count) => {
                let s = if *count == 1 { "" } else { "s" };
                write!(f, "{count} violation{s} of the driver's timing")
            }
        }
    }
}
