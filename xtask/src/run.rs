//! Child processes. Each gets a process group of its own, no standard input and a time limit; when
//! it ends, however it ends, the whole group goes with it, so that no browser or driver stays behind.

use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use process_wrap::tokio::{ChildWrapper, CommandWrap};
use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::process::Command;

use crate::aside;

/// No child may take longer: a hung browser or a lost network must not hold a run for ever.
pub(crate) const LIMIT: Duration = Duration::from_secs(30 * 60);

/// A running child; dropping it kills its process group.
pub(crate) struct Group(Box<dyn ChildWrapper>);

impl Group {
    /// The first line that the child writes to its piped output; an error if there is none within a minute.
    pub(crate) async fn first_line(&mut self) -> Result<String> {
        let output = self.0.stdout().take().context("the output is not piped")?;
        let mut lines = BufReader::new(output).lines();
        let line = tokio::time::timeout(Duration::from_secs(60), lines.next_line()).await;
        line.context("not within a minute")??.context("it ended without a word")
    }

    /// Waits until the child has ended by itself; an error if it failed.
    pub(crate) async fn ended(&mut self) -> Result<()> {
        let status = self.0.wait().await.context("it was lost")?;
        if !status.success() {
            bail!("it failed ({status})");
        }
        Ok(())
    }

    /// Ends the child and its group, and waits until it has.
    pub(crate) async fn end(mut self) -> Result<()> {
        self.0.start_kill()?;
        self.0.wait().await?;
        Ok(())
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        // After a tidy end the group is empty, and the refusal says only that.
        let _ = self.0.start_kill();
    }
}

/// Starts `command`, which runs until it ends or what is returned is dropped.
pub(crate) fn start(mut command: Command) -> Result<Group> {
    let name = name(&command);
    command.stdin(Stdio::null());
    let mut wrap = CommandWrap::from(command);
    #[cfg(unix)]
    wrap.wrap(process_wrap::tokio::ProcessGroup::leader());
    #[cfg(windows)]
    wrap.wrap(process_wrap::tokio::JobObject);
    Ok(Group(wrap.spawn().with_context(|| format!("{name} can't be started"))?))
}

/// Runs `command` to its end; an error if it can't be started, fails, or takes longer than `limit`.
pub(crate) async fn to_end(mut command: Command, limit: Duration) -> Result<()> {
    let name = name(&command);
    aside::redirect(&mut command)?;
    let mut group = start(command)?;
    let Ok(status) = tokio::time::timeout(limit, group.0.wait()).await else {
        bail!("{name} was not done after {} s and was stopped", limit.as_secs_f64());
    };
    let status = status.with_context(|| format!("{name} was lost"))?;
    if !status.success() {
        bail!("{name} failed ({status})");
    }
    Ok(())
}

/// The call as one would type it, for messages.
fn name(command: &Command) -> String {
    let command = command.as_std();
    let program = Path::new(command.get_program());
    let program = program.file_stem().unwrap_or(program.as_os_str());
    let words: Vec<_> =
        std::iter::once(program).chain(command.get_args()).map(|it| it.to_string_lossy()).collect();
    format!("`{}`", words.join(" "))
}

/// What `command` prints, or `None` if it can't be started or fails: for asking a tool its version.
pub(crate) async fn output(mut command: Command) -> Option<String> {
    command.stdin(Stdio::null()).stderr(Stdio::null()).kill_on_drop(true);
    let output = tokio::time::timeout(Duration::from_secs(60), command.output()).await.ok()?.ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Waits for the user's or the system's wish to stop; gives the exit code that says so.
#[cfg(unix)]
pub(crate) async fn interrupted() -> Result<u8> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut hang_up = signal(SignalKind::hangup())?;
    let mut terminate = signal(SignalKind::terminate())?;
    let mut interrupt = signal(SignalKind::interrupt())?;
    let number = tokio::select! {
        _ = hang_up.recv() => 1,
        _ = interrupt.recv() => 2,
        _ = terminate.recv() => 15,
    };
    // Shells report a death by signal n as 128 + n.
    Ok(128 + number)
}

/// Waits for the user's wish to stop; gives the exit code that says so.
#[cfg(not(unix))]
pub(crate) async fn interrupted() -> Result<u8> {
    tokio::signal::ctrl_c().await?;
    Ok(130)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn shell(script: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        command
    }

    #[tokio::test]
    async fn a_failing_child_is_an_error_that_names_it() {
        let error = to_end(shell("exit 3"), LIMIT).await.unwrap_err();
        assert_eq!(error.to_string(), "`sh -c exit 3` failed (exit status: 3)");
    }

    #[tokio::test]
    async fn a_child_beyond_its_limit_is_stopped_with_its_children() {
        let (mut reader, writer) = std::io::pipe().unwrap();
        let mut command = shell("sleep 1000 & wait");
        command.stdout(writer);
        let error = to_end(command, Duration::from_millis(300)).await.unwrap_err();
        assert!(error.to_string().ends_with("` was not done after 0.3 s and was stopped"), "{error}");
        // The pipe ends when nobody holds it any more, the grandchild neither.
        let (ended, end) = tokio::sync::oneshot::channel();
        std::thread::spawn(move || ended.send(std::io::Read::read_to_end(&mut reader, &mut Vec::new())));
        let end = tokio::time::timeout(Duration::from_secs(60), end).await;
        assert!(matches!(end, Ok(Ok(Ok(0)))), "the grandchild lived on: {end:?}");
    }

    #[tokio::test]
    async fn a_child_reads_nothing() {
        to_end(shell("! read line"), LIMIT).await.unwrap();
    }
}
