//! Buffers the output of a step that runs next to another one; the whole output is printed when the step ends.

use std::fmt;
use std::fs::File;
use std::future::Future;
use std::io::{self, Read, Seek, Write};

use anyhow::{Context, Result};

tokio::task_local! {
    static KEPT: File;
}

pub(crate) async fn kept<T>(work: impl Future<Output = T>) -> Result<(T, Vec<u8>)> {
    let mut file = tempfile::tempfile().context("a file for a step's words can't be made")?;
    let done = KEPT.scope(file.try_clone()?, work).await;
    let mut said = Vec::new();
    file.rewind()?;
    file.read_to_end(&mut said)?;
    Ok((done, said))
}

pub(crate) fn say(line: impl fmt::Display) {
    // A step does not fail because its output cannot be printed.
    let _ = match file() {
        Ok(Some(mut file)) => writeln!(file, "{line}"),
        _ => writeln!(io::stdout(), "{line}"),
    };
}

/// The file that buffers the output of the current step; `None` if it prints to the terminal.
pub(crate) fn file() -> Result<Option<File>> {
    // The clones share one file position, so the parts stay in order.
    match KEPT.try_with(File::try_clone) {
        Ok(file) => Ok(Some(file.context("a step's words can't be kept")?)),
        Err(_) => Ok(None),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::run;
    use tokio::process::Command;

    #[tokio::test]
    async fn what_a_step_and_its_children_say_is_kept_in_its_order() {
        let (done, said) = kept(async {
            say("before");
            let mut command = Command::new("sh");
            command.args(["-c", "echo out; echo error >&2; exit 3"]);
            let done = run::to_end(command).await;
            say("after");
            done
        })
        .await
        .unwrap();
        assert!(done.is_err());
        assert_eq!(String::from_utf8(said).unwrap(), "before\nout\nerror\nafter\n");
    }
}
