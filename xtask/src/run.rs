//! Child processes, each in its own process group, which ends with the child so that no browser keeps running.

use std::io::{self, PipeReader, Read, Write};
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use process_wrap::tokio::{ChildWrapper, CommandWrap};
use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::process::Command;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

use crate::output_buffer;

/// A program that prints nothing for this time is stopped. Total times are not limited, for slow machines.
pub(crate) const SILENCE: Duration = Duration::from_secs(10 * 60);
/// Maximum time of a child whose output goes to a file.
pub(crate) const LIMIT: Duration = Duration::from_secs(2 * 60 * 60);
/// Time to read the rest of a child's output; a process that has left the group may hold it open.
const DRAIN: Duration = Duration::from_secs(10);

/// A running child; dropping it kills its process group.
pub(crate) struct Group(Box<dyn ChildWrapper>);

impl Group {
    /// The first line of the piped output; an error if there is none within [`SILENCE`].
    pub(crate) async fn first_line(&mut self) -> Result<String> {
        let output = self.0.stdout().take().context("the output is not piped")?;
        let mut lines = BufReader::new(output).lines();
        let line = tokio::time::timeout(SILENCE, lines.next_line()).await;
        line.context("no output within ten minutes")??.context("no output")
    }

    pub(crate) async fn wait(&mut self) -> Result<()> {
        let status = self.0.wait().await.context("waiting for the child failed")?;
        if !status.success() {
            bail!("the child failed ({status})");
        }
        Ok(())
    }

    pub(crate) async fn kill(mut self) -> Result<()> {
        self.0.start_kill()?;
        self.0.wait().await?;
        Ok(())
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        let _ = self.0.start_kill();
    }
}

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
    run_watched(command, Some(SILENCE)).await
}

/// As [`to_end`], but without a limit: cargo prints nothing while it compiles a large crate.
pub(crate) async fn compile(command: Command) -> Result<()> {
    run_watched(command, None).await
}

/// Runs a call of `cargo test`: first compiles all of it, then runs it like [`to_end`].
pub(crate) async fn cargo_test(command: Command) -> Result<()> {
    compile(only_compiling(&command)).await?;
    to_end(command).await
}

/// The same call of `cargo test` with `--no-run`, without the arguments of the tests.
fn only_compiling(command: &Command) -> Command {
    let command = command.as_std();
    let mut copy = Command::new(command.get_program());
    copy.args(command.get_args().take_while(|argument| *argument != "--")).arg("--no-run");
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => copy.env(name, value),
            None => copy.env_remove(name),
        };
    }
    if let Some(folder) = command.get_current_dir() {
        copy.current_dir(folder);
    }
    copy
}

/// Runs a command that does not print here; an error if it takes longer than `limit`.
pub(crate) async fn within(command: Command, limit: Duration) -> Result<()> {
    let name = name(&command);
    let mut group = start(command)?;
    let Ok(status) = tokio::time::timeout(limit, group.0.wait()).await else {
        bail!("{name} was not done after {} s and was stopped", limit.as_secs_f64());
    };
    succeeded(&name, status)
}

/// Runs `command` and prints its output; stops it after `silence` without output.
async fn run_watched(mut command: Command, silence: Option<Duration>) -> Result<()> {
    let name = name(&command);
    let mut chunks = forward_output(&mut command)?;
    let mut group = start(command)?;
    let status = unless_silent(group.0.wait(), &mut chunks, silence).await;
    // Other processes of the group would keep the output open.
    drop(group);
    let status = status.map_err(|silence| {
        anyhow::anyhow!("{name} printed nothing for {} s and was stopped", silence.as_secs_f64())
    })?;
    let _ = tokio::time::timeout(DRAIN, async { while chunks.recv().await.is_some() {} }).await;
    succeeded(&name, status)
}

fn succeeded(name: &str, status: io::Result<std::process::ExitStatus>) -> Result<()> {
    let status = status.with_context(|| format!("waiting for {name} failed"))?;
    if !status.success() {
        bail!("{name} failed ({status})");
    }
    Ok(())
}

/// The result of `end`, or an error after `silence` without a chunk of output.
async fn unless_silent<T>(
    end: impl Future<Output = T>,
    chunks: &mut UnboundedReceiver<()>,
    silence: Option<Duration>,
) -> Result<T, Duration> {
    let Some(silence) = silence else {
        return Ok(end.await);
    };
    tokio::pin!(end);
    let mut is_open = true;
    loop {
        tokio::select! {
            result = &mut end => return Ok(result),
            chunk = chunks.recv(), if is_open => is_open = chunk.is_some(),
            () = tokio::time::sleep(silence) => return Err(silence),
        }
    }
}

/// Forwards the command's output to the terminal or to the buffer of the step; sends a message per chunk.
fn forward_output(command: &mut Command) -> Result<UnboundedReceiver<()>> {
    let (activity, chunks) = unbounded_channel();
    let (out, out_end) = io::pipe().context("a pipe can't be created")?;
    if let Some(file) = output_buffer::file()? {
        command.stdout(out_end.try_clone()?).stderr(out_end);
        forward(out, file, activity);
    } else {
        let (errors, errors_end) = io::pipe().context("a pipe can't be created")?;
        command.stdout(out_end).stderr(errors_end);
        if io::IsTerminal::is_terminal(&io::stderr()) {
            command.env("CARGO_TERM_COLOR", "always");
        }
        forward(out, io::stdout(), activity.clone());
        forward(errors, io::stderr(), activity);
    }
    Ok(chunks)
}

fn forward(mut from: PipeReader, mut to: impl Write + Send + 'static, activity: UnboundedSender<()>) {
    std::thread::spawn(move || {
        let mut bytes = [0; 1 << 13];
        while let Ok(len @ 1..) = from.read(&mut bytes) {
            // A closed terminal does not end the work.
            let _ = to.write_all(bytes.get(..len).unwrap_or_default()).and_then(|()| to.flush());
            let _ = activity.send(());
        }
    });
}

fn name(command: &Command) -> String {
    let command = command.as_std();
    let program = Path::new(command.get_program());
    let program = program.file_stem().unwrap_or(program.as_os_str());
    let words: Vec<_> =
        std::iter::once(program).chain(command.get_args()).map(|word| word.to_string_lossy()).collect();
    format!("`{}`", words.join(" "))
}

/// The output of a short command such as `--version`; `None` if it fails.
pub(crate) async fn output(mut command: Command) -> Option<String> {
    command.stdin(Stdio::null()).stderr(Stdio::null()).kill_on_drop(true);
    let output = tokio::time::timeout(SILENCE, command.output()).await.ok()?.ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Waits for a signal to end; returns the exit code.
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
    // The code that shells report for signal n.
    Ok(128 + number)
}

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
        let error =
            run_watched(shell("sleep 1000 & wait"), Some(Duration::from_millis(300))).await.unwrap_err();
        assert!(error.to_string().ends_with("` printed nothing for 0.3 s and was stopped"), "{error}");
        let mut command = shell("sleep 1000 & wait");
        command.stdout(writer);
        let error = within(command, Duration::from_millis(300)).await.unwrap_err();
        assert!(error.to_string().ends_with("` was not done after 0.3 s and was stopped"), "{error}");
        // The pipe ends when no process holds it, the grandchild included.
        let (ended, end) = tokio::sync::oneshot::channel();
        std::thread::spawn(move || ended.send(std::io::Read::read_to_end(&mut reader, &mut Vec::new())));
        let end = tokio::time::timeout(Duration::from_secs(60), end).await;
        assert!(matches!(end, Ok(Ok(Ok(0)))), "the grandchild still runs: {end:?}");
    }

    #[tokio::test]
    async fn a_child_has_no_input() {
        to_end(shell("! read line")).await.unwrap();
    }

    /// In paused time, sleeps end at once while no task can run.
    #[tokio::test(start_paused = true)]
    async fn a_silent_program_is_stopped_but_a_compiler_is_not() {
        let error = to_end(shell("sleep 30")).await.unwrap_err();
        assert!(error.to_string().ends_with("` printed nothing for 600 s and was stopped"), "{error}");
        compile(shell("sleep 0.1")).await.unwrap();
    }

    #[tokio::test(start_paused = true)]
    async fn a_program_that_prints_may_take_any_time() {
        const SILENCE: Duration = Duration::from_secs(600);
        let (sender, mut chunks) = unbounded_channel();
        // Two hours of work that prints every nine minutes.
        let works = tokio::time::sleep(Duration::from_secs(7200));
        let prints = async {
            for _ in 0..13 {
                tokio::time::sleep(Duration::from_secs(540)).await;
                sender.send(()).unwrap();
            }
        };
        let (found, ()) = tokio::join!(unless_silent(works, &mut chunks, Some(SILENCE)), prints);
        assert_eq!(found, Ok(()));
        let never = std::future::pending::<()>;
        assert_eq!(unless_silent(never(), &mut chunks, Some(SILENCE)).await, Err(SILENCE));
        // Closed output counts as silence.
        drop(sender);
        assert_eq!(unless_silent(never(), &mut chunks, Some(SILENCE)).await, Err(SILENCE));
    }

    #[tokio::test(start_paused = true)]
    async fn without_a_limit_silence_is_accepted() {
        let (_sender, mut chunks) = unbounded_channel();
        let compiles = tokio::time::sleep(Duration::from_secs(7200));
        assert_eq!(unless_silent(compiles, &mut chunks, None).await, Ok(()));
    }

    #[test]
    fn compiling_selects_the_same_tests() {
        let rows = [
            ("test --workspace --locked", "test --workspace --locked --no-run"),
            ("test --test page -- --skip engines::", "test --test page --no-run"),
        ];
        for (given, expected) in rows {
            let mut command = Command::new("cargo");
            command.args(given.split(' ')).env("SET", "value").env_remove("REMOVED").current_dir("..");
            let compiling = only_compiling(&command);
            assert_eq!(name(&compiling), format!("`cargo {expected}`"));
            let (given, compiling) = (command.as_std(), compiling.as_std());
            assert!(compiling.get_envs().eq(given.get_envs()));
            assert_eq!(compiling.get_current_dir(), given.get_current_dir());
        }
    }
}
