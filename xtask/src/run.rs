//! Child processes. Each gets a process group of its own and no standard input, and is stopped when it prints nothing for too
//! long. When it ends, however it ends, the whole group goes with it, so that no browser or driver stays behind.

use std::io::{self, PipeReader, Read, Write};
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use process_wrap::tokio::{ChildWrapper, CommandWrap};
use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::process::Command;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

use crate::aside;

/// A child that prints nothing for this long hangs. However long it takes in all, on a slow or busy machine, is no error.
pub(crate) const SILENCE: Duration = Duration::from_secs(10 * 60);
/// The most that a child takes whose output goes to a file.
pub(crate) const LIMIT: Duration = Duration::from_secs(2 * 60 * 60);
/// How long the output of a child is read after its end; a process that has left its group may hold it open.
const DRAIN: Duration = Duration::from_secs(10);

/// A running child; dropping it kills its process group.
pub(crate) struct Group(Box<dyn ChildWrapper>);

impl Group {
    /// The first line that the child writes to its piped output; an error if there is none within [`SILENCE`].
    pub(crate) async fn first_line(&mut self) -> Result<String> {
        let output = self.0.stdout().take().context("the output is not piped")?;
        let mut lines = BufReader::new(output).lines();
        let line = tokio::time::timeout(SILENCE, lines.next_line()).await;
        line.context("it printed nothing for ten minutes")??.context("it ended without output")
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

/// Runs `command` to its end; an error if it can't be started, fails, or prints nothing for [`SILENCE`].
pub(crate) async fn to_end(command: Command) -> Result<()> {
    unless_silent(command, SILENCE).await
}

/// Runs a command whose output goes where its caller has it go; an error if it takes longer than `limit`.
pub(crate) async fn within(command: Command, limit: Duration) -> Result<()> {
    let name = name(&command);
    let mut group = start(command)?;
    let Ok(status) = tokio::time::timeout(limit, group.0.wait()).await else {
        bail!("{name} was not done after {} s and was stopped", limit.as_secs_f64());
    };
    succeeded(&name, status)
}

async fn unless_silent(mut command: Command, silence: Duration) -> Result<()> {
    let name = name(&command);
    let mut chunks = passed_on(&mut command)?;
    let mut group = start(command)?;
    let status = watched(group.0.wait(), &mut chunks, silence).await;
    // What is left of the group would hold its output open.
    drop(group);
    let Some(status) = status else {
        bail!("{name} printed nothing for {} s and was stopped", silence.as_secs_f64());
    };
    let _ = tokio::time::timeout(DRAIN, async { while chunks.recv().await.is_some() {} }).await;
    succeeded(&name, status)
}

fn succeeded(name: &str, status: io::Result<std::process::ExitStatus>) -> Result<()> {
    let status = status.with_context(|| format!("{name} was lost"))?;
    if !status.success() {
        bail!("{name} failed ({status})");
    }
    Ok(())
}

/// Waits for `end`; `None` if no chunk of output comes for `silence`.
async fn watched<T>(
    end: impl Future<Output = T>,
    chunks: &mut UnboundedReceiver<()>,
    silence: Duration,
) -> Option<T> {
    tokio::pin!(end);
    let mut is_open = true;
    loop {
        tokio::select! {
            ended = &mut end => return Some(ended),
            chunk = chunks.recv(), if is_open => is_open = chunk.is_some(),
            () = tokio::time::sleep(silence) => return None,
        }
    }
}

/// Has a command's output passed on to where the work under way prints; a message for each chunk of it.
fn passed_on(command: &mut Command) -> Result<UnboundedReceiver<()>> {
    let (heard, chunks) = unbounded_channel();
    let (out, out_end) = io::pipe().context("a pipe can't be made")?;
    if let Some(file) = aside::file()? {
        // One pipe for both, so that the file has them in their order.
        command.stdout(out_end.try_clone()?).stderr(out_end);
        pass_on(out, file, heard);
    } else {
        let (errors, errors_end) = io::pipe().context("a pipe can't be made")?;
        command.stdout(out_end).stderr(errors_end);
        if io::IsTerminal::is_terminal(&io::stderr()) {
            command.env("CARGO_TERM_COLOR", "always");
        }
        pass_on(out, io::stdout(), heard.clone());
        pass_on(errors, io::stderr(), heard);
    }
    Ok(chunks)
}

fn pass_on(mut from: PipeReader, mut to: impl Write + Send + 'static, heard: UnboundedSender<()>) {
    std::thread::spawn(move || {
        let mut bytes = [0; 1 << 13];
        while let Ok(len @ 1..) = from.read(&mut bytes) {
            // A closed terminal does not end the work.
            let _ = to.write_all(bytes.get(..len).unwrap_or_default()).and_then(|()| to.flush());
            let _ = heard.send(());
        }
    });
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
    let output = tokio::time::timeout(SILENCE, command.output()).await.ok()?.ok()?;
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
        let error = to_end(shell("exit 3")).await.unwrap_err();
        assert_eq!(error.to_string(), "`sh -c exit 3` failed (exit status: 3)");
    }

    #[tokio::test]
    async fn a_silent_child_is_stopped_with_its_children() {
        let (mut reader, writer) = std::io::pipe().unwrap();
        let error = unless_silent(shell("sleep 1000 & wait"), Duration::from_millis(300)).await.unwrap_err();
        assert!(error.to_string().ends_with("` printed nothing for 0.3 s and was stopped"), "{error}");
        let mut command = shell("sleep 1000 & wait");
        command.stdout(writer);
        let error = within(command, Duration::from_millis(300)).await.unwrap_err();
        assert!(error.to_string().ends_with("` was not done after 0.3 s and was stopped"), "{error}");
        // The pipe ends when nobody holds it any more, the grandchild neither.
        let (ended, end) = tokio::sync::oneshot::channel();
        std::thread::spawn(move || ended.send(std::io::Read::read_to_end(&mut reader, &mut Vec::new())));
        let end = tokio::time::timeout(Duration::from_secs(60), end).await;
        assert!(matches!(end, Ok(Ok(Ok(0)))), "the grandchild lived on: {end:?}");
    }

    #[tokio::test]
    async fn a_child_reads_nothing() {
        to_end(shell("! read line")).await.unwrap();
    }

    #[tokio::test(start_paused = true)]
    async fn only_silence_ends_a_wait() {
        let silence = Duration::from_secs(600);
        let (heard, mut chunks) = unbounded_channel();
        // Two hours of work that prints every nine minutes.
        let works = tokio::time::sleep(Duration::from_secs(7200));
        let prints = async {
            for _ in 0..13 {
                tokio::time::sleep(Duration::from_secs(540)).await;
                heard.send(()).unwrap();
            }
        };
        let (found, ()) = tokio::join!(watched(works, &mut chunks, silence), prints);
        assert_eq!(found, Some(()));
        let started = tokio::time::Instant::now();
        assert_eq!(watched(std::future::pending::<()>(), &mut chunks, silence).await, None);
        assert_eq!(started.elapsed(), silence);
        // Output that has been closed is silence, too.
        drop(heard);
        assert_eq!(watched(std::future::pending::<()>(), &mut chunks, silence).await, None);
    }
}
