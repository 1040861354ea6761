//! Buffers the output of a step that runs next to another one; the whole output is printed when the step ends.

use std::fmt;
use std::fs::File;
use std::future::Future;
use std::io::{self, Read, Seek, Write};

use anyhow::{Context, Result};

tokio::task_local! {
    static BUFFER: File;
}

/// Runs `work`; returns its result, and its output and that of its children.
pub(crate) async fn buffered<T>(work: impl Future<Output = T>) -> Result<(T, Vec<u8>)> {
    let mut file = tempfile::tempfile().context("a temporary file can't be created")?;
    let result = BUFFER.scope(file.try_clone()?, work).await;
    let mut output = Vec::new();
    file.rewind()?;
    file.read_to_end(&mut output)?;
    Ok((result, output))
}

/// Prints a line to the terminal or to the buffer of the step.
pub(crate) fn print_line(line: impl fmt::Display) {
    // A step does not fail because its output cannot be printed.
    let _ = match file() {
        Ok(Some(mut file)) => writeln!(file, "{line}"),
        _ => writeln!(io::stdout(), "{line}"),
    };
}

/// The file that buffers the output of the current step; `None` if it prints to the terminal.
pub(crate) fn file() -> Result<Option<File>> {
    // The clones share one file position, so the parts stay in order.
    match BUFFER.try_with(File::try_clone) {
        Ok(file) => Ok(Some(file.context("the output of a step can't be buffered")?)),
        Err(_) => Ok(None),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::run;
    use tokio::process::Command;

    #[tokio::test]
    async fn output_of_a_step_and_its_children_is_buffered_in_order() {
        let (result, output) = buffered(async {
            print_line("before");
            let mut command = Command::new("sh");
            command.args(["-c", "echo out; echo error >&2; exit 3"]);
            let result = run::to_end(command).await;
            print_line("after");
            result
        })
        .await
        .unwrap();
        assert!(result.is_err());
        assert_eq!(String::from_utf8(output).unwrap(), "before\nout\nerror\nafter\n");
    }
}
