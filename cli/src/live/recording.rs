//! What a session leaves: the scenario that gives it again, and its wall-clock times beside it (LIVE H5).

use crate::{failure::Failure, output::Out};
use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};
use stepscope_core::{
    inspect::{fingerprint::Fingerprinter, run_fingerprint::RunFingerprint},
    scenario::{Scenario, link},
    sim::{
        Experiment,
        session::{NotTheSession, Session, SessionClock},
        session_times::SessionTimes,
    },
};

/// A file, and where it will be.
pub(crate) type Named = (PathBuf, Out);

/// The path of `NAME.session.json` beside a recording's.
pub(crate) fn beside(record: &Path) -> PathBuf {
    let mut name = record.file_stem().unwrap_or_default().to_os_string();
    name.push(".session.json");
    record.with_file_name(name)
}

/// Writes the recording, and what was of the wall clock; gives whether it is the same run again.
pub(crate) fn write(
    session: &Session,
    (clock, times): (&SessionClock, &SessionTimes),
    ((record, mut out), (beside, mut out_beside)): (Named, Named),
) -> Result<Result<(), NotTheSession>, Failure> {
    let recording = session.recording();
    let whole = session.records_all();
    let verified = recording.verify();
    let mut rescue = Vec::new();
    let texts = [
        (&record, &mut out, format!("{}\n", recording.scenario.to_json())),
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
        let _ = writeln!(io::stderr(), "recorded are the first {cycles} cycles: then there was no more room");
    }
    Ok(verified)
}

/// The share link of a recording, with the digests of its run; `None` where it does not fit in one.
pub(crate) fn link(scenario: &Scenario) -> Option<String> {
    let link = link::encode(scenario).ok()?;
    let experiment = Experiment::new(scenario).ok()?;
    let mut seen = vec![Fingerprinter::default(); experiment.controllers()];
    experiment.run_each(&mut seen);
    let proof = RunFingerprint::of(seen.into_iter().map(Fingerprinter::finish).collect());
    Some(link::with_part(link, "d", &proof.emit()))
}

/// A recording that its disk does not take is written where there may be room.
fn rescued(path: &Path, error: &str, texts: &[(PathBuf, String)]) -> Failure {
    let mut places = Vec::new();
    for (path, text) in texts {
        let elsewhere = std::env::temp_dir().join(path.file_name().unwrap_or_default());
        if !elsewhere.exists() && std::fs::write(&elsewhere, text).is_ok() {
            places.push(elsewhere.display().to_string());
        }
    }
    let also = if places.is_empty() { "nothing could be written elsewhere" } else { "written instead:" };
    Failure::Port(path.display().to_string(), format!("{error}; {also} {}", places.join(" ")))
}
