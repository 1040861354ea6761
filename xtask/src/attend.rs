//! `cargo xtask attend PROGRAM …` runs a program that ends when the process that started this one ends.
//!
//! A test may be killed, and then nothing would stop the programs that it started. The test holds the other end of
//! this process's standard input. The system closes it when the test dies, and this process then ends the program,
//! its process group and its folder of files.

use std::ffi::OsString;
use std::io::Read;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result};
use tokio::process::Command;
use tokio::sync::oneshot;

use crate::{files, run};

/// A dying program may still write to its folder, so removing the folder is tried again for this time.
const CLEARING: Duration = Duration::from_secs(5);
const TRY_AGAIN: Duration = Duration::from_millis(20);

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

pub(crate) async fn attend(words: &[OsString]) -> Result<()> {
    let (program, arguments) = words.split_first().context("no program given")?;
    let folder = Folder(std::env::temp_dir().join(format!("stepscope-attend-{}", std::process::id())));
    files::create_folder(&folder.0)?;
    let mut command = Command::new(program);
    command.args(arguments).env("TMPDIR", &folder.0);
    let mut group = run::start(command)?;
    tokio::select! {
        () = end_of_input() => {}
        result = group.wait() => return result,
    }
    group.kill().await
}

/// Not a task of the runtime: the runtime would wait for it at the end.
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
