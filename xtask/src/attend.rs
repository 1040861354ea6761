//! `cargo xtask attend PROGRAM …`: a program that ends when whoever started this one does, however that ends.
//!
//! A test can be stopped in the middle, and what it started is nobody's then. So it starts this, and holds the other
//! end of this one's standard input: the system closes that with the test's last breath, and here the program goes,
//! with all that it started and with the folder that its files were in.

use std::ffi::OsString;
use std::io::Read;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result};
use tokio::process::Command;
use tokio::sync::oneshot;

use crate::run;

/// Longest that the folder of a program is tried to be removed: what dies still writes.
const CLEARING: Duration = Duration::from_secs(5);
/// Rest between two attempts.
const TRY_AGAIN: Duration = Duration::from_millis(20);

/// A folder for the program's files; it goes with this.
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let attempts = CLEARING.as_millis() / TRY_AGAIN.as_millis();
        for _ in 0..attempts {
            match std::fs::remove_dir_all(&self.0) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => std::thread::sleep(TRY_AGAIN),
                _ => return,
            }
        }
    }
}

/// Runs the program in the words' first, with the others as its arguments, until it or standard input ends.
pub(crate) async fn attend(words: &[OsString]) -> Result<()> {
    let (program, arguments) = words.split_first().context("name a program")?;
    let folder = Folder(std::env::temp_dir().join(format!("stepscope-attend-{}", std::process::id())));
    std::fs::create_dir_all(&folder.0).with_context(|| format!("{} can't be made", folder.0.display()))?;
    let mut command = Command::new(program);
    command.args(arguments).env("TMPDIR", &folder.0);
    // Declared after the folder, and so dropped before it.
    let mut group = run::start(command)?;
    tokio::select! {
        () = end_of_input() => {}
        ended = group.ended() => return ended,
    }
    group.end().await
}

/// A thread of its own, for which nobody waits at the end: the runtime's would be waited for.
async fn end_of_input() {
    let (ended, end) = oneshot::channel();
    std::thread::spawn(move || {
        let mut input = std::io::stdin().lock();
        let mut byte = [0];
        while input.read(&mut byte).is_ok_and(|count| count > 0) {}
        let _ = ended.send(());
    });
    let _ = end.await;
}
