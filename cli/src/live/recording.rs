//! Writes a session's recording: a scenario, and its wall-clock times (LIVE H5).

use crate::{failure::Failure, output::Out, terminal, verify};
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use stepscope_core::inspect::trace::fingerprint::Fingerprinter;
use stepscope_core::scenario::{Scenario, link};
use stepscope_core::sim::session::{NotTheSession, Session, SessionClock};
use stepscope_core::sim::{Experiment, session_times::SessionTimes};

pub(crate) struct Files {
    pub(crate) scenario: (PathBuf, Out),
    pub(crate) times: (PathBuf, Out),
}

/// The file of the wall-clock times: `NAME.session.json`.
pub(crate) fn times_path(record: &Path) -> PathBuf {
    let mut name = record.file_stem().unwrap_or_default().to_os_string();
    name.push(".session.json");
    record.with_file_name(name)
}

/// Writes both files. The inner error is a recording that does not reproduce the session.
pub(crate) fn write(
    session: &Session,
    (clock, times): (&SessionClock, &SessionTimes),
    mut files: Files,
) -> Result<Result<(), NotTheSession>, Failure> {
    let recording = session.recording();
    let is_complete = session.records_all();
    let verified = recording.verify();
    // A session's limits ensure a readable form.
    let scenario = &recording.scenario;
    let text = scenario.to_file_json().unwrap_or_else(|| scenario.to_json());
    let texts = [format!("{text}\n"), times.to_json(clock, &recording, is_complete)];
    let mut failed = None;
    for ((path, out), text) in [&mut files.scenario, &mut files.times].into_iter().zip(&texts) {
        let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
        failed = failed.or(written.err().map(|error| (path.clone(), error.to_string())));
    }
    if let Some((path, error)) = failed {
        return Err(rescue(&path, &error, [&files.scenario.0, &files.times.0].into_iter().zip(&texts)));
    }
    if !is_complete {
        let cycles = recording.scenario.run_cycles.unwrap_or(0);
        let _ = writeln!(
            terminal::err(),
            "recorded only the first {cycles} cycles: the recording has reached its maximum size"
        );
    }
    Ok(verified)
}

/// `None` if the scenario does not fit in a link.
pub(crate) fn link(scenario: &Scenario) -> Option<String> {
    let link = link::encode(scenario).ok()?;
    let experiment = Experiment::new(scenario).ok()?;
    let mut traces = vec![Fingerprinter::default(); experiment.controllers()];
    experiment.run_each(&mut traces);
    Some(verify::with_digests(link, traces.into_iter()))
}

/// Writes the recording to the temporary folder, because its disk is full.
fn rescue<'a>(path: &Path, error: &str, texts: impl Iterator<Item = (&'a PathBuf, &'a String)>) -> Failure {
    let folder = std::env::temp_dir();
    let saved: Vec<String> = texts
        .filter_map(|(path, text)| rescue_in(&folder, path, text))
        .map(|path| path.display().to_string())
        .collect();
    let result = if saved.is_empty() {
        "it could not be saved elsewhere; free some space".to_owned()
    } else {
        format!("saved instead as {}", saved.join(" "))
    };
    Failure::Unusable(path.display().to_string(), format!("{error}; {result}"))
}

const MAX_NAMES: u32 = 100;

/// Never opens an existing file, not even through a dangling symbolic link: other users may write to this folder.
fn rescue_in(folder: &Path, path: &Path, text: &str) -> Option<PathBuf> {
    let name = path.file_name()?.to_string_lossy().into_owned();
    for number in 0..MAX_NAMES {
        let name = if number == 0 { name.clone() } else { format!("{number}-{name}") };
        let elsewhere = folder.join(name);
        let created = OpenOptions::new().write(true).create_new(true).open(&elsewhere);
        match created {
            Ok(mut file) => {
                if file.write_all(text.as_bytes()).is_ok() {
                    return Some(elsewhere);
                }
                let _ = fs::remove_file(&elsewhere);
                return None;
            }
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(_) => return None,
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)]
    fn rescues_to_new_files_without_following_links() {
        let folder = std::env::temp_dir().join(format!("stepscope-rescue-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let (elsewhere, record) = (folder.join("elsewhere"), Path::new("/full/disk/session.json"));
        std::os::unix::fs::symlink(&elsewhere, folder.join("session.json")).expect("a link");
        let first = rescue_in(&folder, record, "first");
        let second = rescue_in(&folder, record, "second");
        assert_eq!(
            (first, second),
            (Some(folder.join("1-session.json")), Some(folder.join("2-session.json")))
        );
        assert!(!elsewhere.exists(), "the link was followed");
        assert_eq!(fs::read_to_string(folder.join("1-session.json")).expect("it is there"), "first");
        fs::remove_dir_all(&folder).expect("it is ours");
    }
}
