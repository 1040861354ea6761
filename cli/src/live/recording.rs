//! Writes a session's recording: a scenario, and its wall-clock times (LIVE H5).

use crate::{failure::Failure, output::Out, terminal};
use std::{
    fs::{self, OpenOptions},
    io::{self, Write},
    path::{Path, PathBuf},
};
use stepscope_core::{
    inspect::trace::{fingerprint::Fingerprinter, run_fingerprint::RunFingerprint},
    scenario::{Scenario, link},
    sim::{
        Experiment,
        session::{NotTheSession, Session, SessionClock},
        session_times::SessionTimes,
    },
};

pub(crate) type Named = (PathBuf, Out);

pub(crate) fn beside(record: &Path) -> PathBuf {
    let mut name = record.file_stem().unwrap_or_default().to_os_string();
    name.push(".session.json");
    record.with_file_name(name)
}

pub(crate) fn write(
    session: &Session,
    (clock, times): (&SessionClock, &SessionTimes),
    ((record, mut out), (beside, mut out_beside)): (Named, Named),
) -> Result<Result<(), NotTheSession>, Failure> {
    let recording = session.recording();
    let whole = session.records_all();
    let verified = recording.verify();
    let mut rescue = Vec::new();
    // A session's limits ensure a readable form.
    let scenario = &recording.scenario;
    let text = scenario.to_file_json().unwrap_or_else(|| scenario.to_json());
    let texts = [
        (&record, &mut out, format!("{text}\n")),
        (&beside, &mut out_beside, times.to_json(clock, &recording, whole)),
    ];
    let mut failed = None;
    for (path, out, text) in texts {
        let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
        if let Err(error) = &written
            && failed.is_none()
        {
            failed = Some((path.clone(), error.to_string()));
        }
        rescue.push((path.clone(), text));
    }
    if let Some((path, error)) = failed {
        return Err(rescued(&path, &error, &rescue));
    }
    if !whole {
        let cycles = recording.scenario.run_cycles.unwrap_or(0);
        let _ = writeln!(
            terminal::err(),
            "recorded only the first {cycles} cycles: the recording has reached its maximum size"
        );
    }
    Ok(verified)
}

/// `None` if it does not fit in a link.
pub(crate) fn link(scenario: &Scenario) -> Option<String> {
    let link = link::encode(scenario).ok()?;
    let experiment = Experiment::new(scenario).ok()?;
    let mut seen = vec![Fingerprinter::default(); experiment.controllers()];
    experiment.run_each(&mut seen);
    let proof = RunFingerprint::of(seen.into_iter().map(Fingerprinter::finish).collect());
    Some(link::with_part(link, "d", &proof.emit()))
}

/// Writes the recording elsewhere if its disk is full.
fn rescued(path: &Path, error: &str, texts: &[(PathBuf, String)]) -> Failure {
    let mut saved = Vec::new();
    for (path, text) in texts {
        if let Some(elsewhere) = rescue_in(&std::env::temp_dir(), path, text) {
            saved.push(elsewhere.display().to_string());
        }
    }
    let also = if saved.is_empty() { "nothing could be written elsewhere" } else { "saved instead as" };
    Failure::Port(path.display().to_string(), format!("{error}; {also} {}", saved.join(" ")))
}

const MAX_NAMES: u32 = 100;

/// Never opens an existing name, not even a dangling symbolic link: other users may write to this folder.
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
    fn a_rescued_file_is_a_new_one_and_no_link_is_followed() {
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
