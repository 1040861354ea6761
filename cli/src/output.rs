//! Files that a command writes: each stands under its name only when all of them are written.
//!
//! ```text
//! judge     no output is the input or another output, by whatever path; one at most is standard output
//! create    a temporary file beside each
//! commit    every temporary file gets its name
//! ```
//!
//! What ends a command before, be it an error, a full disk, Ctrl-C or a kill, leaves what stood there. What is no plain
//! file, such as a pipe or a device, is written as it is.

use crate::failure::Failure;
use same_file::Handle;
use std::{
    fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
};
use tempfile::TempPath;

/// What stands for standard input or output in place of a path.
pub(crate) const STANDARD: &str = "-";
/// Links that are followed before a path is taken to be a circle.
const MAX_LINKS: u32 = 40;

/// Where what is written goes.
pub(crate) type Out = BufWriter<Box<dyn Write>>;

/// The outputs of one command.
#[derive(Default)]
pub(crate) struct Outputs {
    waiting: Vec<Waiting>,
}

/// A file that is written and has not got its name yet.
struct Waiting {
    /// As it was given.
    given: PathBuf,
    /// The file that a link leads to, or itself.
    name: PathBuf,
    temporary: TempPath,
}

/// What a path leads to.
#[derive(PartialEq)]
enum Identity {
    /// Something that is there: also by another path, or by a hard link.
    There(Handle),
    /// A file that is not there yet, in its real folder.
    New(PathBuf),
}

impl Identity {
    fn of_input(path: &Path) -> Option<Self> {
        if path == Path::new(STANDARD) {
            return Handle::stdin().ok().map(Self::There);
        }
        // Opening a pipe would take it from who reads it afterwards.
        if !is_file(path) {
            return None;
        }
        Handle::from_path(path).ok().map(Self::There)
    }

    fn of_output(path: &Path) -> Option<Self> {
        if path == Path::new(STANDARD) {
            return Handle::stdout().ok().map(Self::There);
        }
        let name = followed(path);
        // Nothing is there to be destroyed.
        if name == Path::new("/dev/null") {
            return None;
        }
        if !is_pipe(&name)
            && let Ok(handle) = Handle::from_path(&name)
        {
            return Some(Self::There(handle));
        }
        let folder = fs::canonicalize(folder(&name)).ok()?;
        Some(Self::New(folder.join(name.file_name()?)))
    }
}

impl Outputs {
    /// Judges where the outputs of a command go before any of them is written.
    ///
    /// # Errors
    /// [`Failure::Output`] if two of them, or one and an input, are the same.
    pub(crate) fn judge<'p>(
        inputs: impl IntoIterator<Item = &'p (impl AsRef<Path> + ?Sized + 'p)>,
        outputs: impl IntoIterator<Item = &'p Path>,
    ) -> Result<Self, Failure> {
        let inputs: Vec<Identity> =
            inputs.into_iter().filter_map(|path| Identity::of_input(path.as_ref())).collect();
        let mut before: Vec<(&Path, Option<Identity>)> = Vec::new();
        for path in outputs {
            let identity = Identity::of_output(path);
            let is_standard = |path: &Path| path == Path::new(STANDARD);
            let same = |other: &Option<Identity>| identity.is_some() && *other == identity;
            if let Some((other, _)) =
                before.iter().find(|(other, known)| same(known) || is_standard(other) && is_standard(path))
            {
                let detail = if is_standard(other) || is_standard(path) {
                    "goes to standard output, where another output goes; give a file for all but one of them"
                } else {
                    "would be written twice; give each output a file of its own"
                };
                return Err(Failure::Output(path.to_owned(), detail));
            }
            // A terminal is what many commands read and write.
            if identity.as_ref().is_some_and(|identity| inputs.contains(identity)) && is_file(path) {
                return Err(Failure::Output(
                    path.to_owned(),
                    "is what is read, and would be overwritten; give another file",
                ));
            }
            before.push((path, identity));
        }
        Ok(Self::default())
    }

    /// Begins a file beside `path`, or takes standard output for `-`.
    pub(crate) fn create(&mut self, path: &Path) -> Result<Out, Failure> {
        let out = self.open(path).map_err(|error| Failure::File(path.to_owned(), error))?;
        Ok(BufWriter::new(out))
    }

    fn open(&mut self, path: &Path) -> io::Result<Box<dyn Write>> {
        if path == Path::new(STANDARD) {
            return Ok(Box::new(io::stdout()));
        }
        let name = followed(path);
        let known = fs::metadata(&name).ok();
        if known.as_ref().is_some_and(|known| !known.is_file()) || is_open_file(&name) {
            return Ok(Box::new(fs::OpenOptions::new().write(true).open(&name)?));
        }
        if known.is_some() {
            // What may not be written may not be replaced.
            fs::OpenOptions::new().append(true).open(&name)?;
        }
        let mut start = name.file_name().ok_or(io::ErrorKind::InvalidInput)?.to_owned();
        // A name may have 255 bytes, and this one becomes longer.
        if start.len() > 200 {
            start = "stepscope".into();
        }
        start.push(".");
        let mut builder = tempfile::Builder::new();
        builder.prefix(&start).suffix(".part");
        // As any new file has them, or those of the file that is replaced.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        // Known before Ctrl-C can come.
        let mut temporaries = lock();
        let (file, temporary) = builder.tempfile_in(folder(&name))?.into_parts();
        temporaries.push(temporary.to_path_buf());
        drop(temporaries);
        if let Some(known) = known {
            fs::set_permissions(&temporary, known.permissions())?;
        }
        self.waiting.push(Waiting { given: path.to_owned(), name, temporary });
        Ok(Box::new(file))
    }

    /// Gives every file its name; all have been written and flushed. A request to end comes before all of them or after.
    pub(crate) fn commit(self) -> Result<(), Failure> {
        let mut committed = committed();
        *committed |= !self.waiting.is_empty();
        for Waiting { given, name, temporary } in self.waiting {
            let path = temporary.to_path_buf();
            temporary.persist(&name).map_err(|error| Failure::File(given, error.error))?;
            lock().retain(|other| *other != path);
        }
        Ok(())
    }
}

static COMMITTED: Mutex<bool> = Mutex::new(false);

/// Whether files have got their names; locked while they get them.
pub(crate) fn committed() -> MutexGuard<'static, bool> {
    COMMITTED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes one file with what `write` gives it, and gives it its name.
pub(crate) fn write_whole(
    mut outputs: Outputs,
    path: &Path,
    write: impl FnOnce(&mut Out) -> io::Result<()>,
) -> Result<(), Failure> {
    let mut out = outputs.create(path)?;
    write(&mut out).and_then(|()| out.flush()).map_err(|error| Failure::File(path.to_owned(), error))?;
    drop(out);
    outputs.commit()
}

/// The folder that a file stands in.
fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Where links lead, the last of them also to what is not there yet.
fn followed(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        if is_open_file(&path) {
            break;
        }
        let Ok(target) = fs::read_link(&path) else { break };
        path = folder(&path).join(target);
    }
    path
}

/// Whether a path is a file that some process has open, as `/dev/stdout` is in the end: it is written where it stands, and
/// not replaced.
fn is_open_file(path: &Path) -> bool {
    let folder = fs::canonicalize(folder(path)).unwrap_or_default();
    cfg!(unix) && (folder.starts_with("/proc") || folder.starts_with("/dev/fd"))
}

/// Whether a path is a pipe with a name: opening it waits for the other end.
fn is_pipe(path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        !is_open_file(path) && fs::metadata(path).is_ok_and(|known| known.file_type().is_fifo())
    }
    #[cfg(not(unix))]
    {
        let _ = path;
        false
    }
}

/// Whether a path, or standard output for `-`, leads to a plain file.
fn is_file(path: &Path) -> bool {
    if path != Path::new(STANDARD) {
        return fs::metadata(path).is_ok_and(|known| known.is_file());
    }
    Handle::stdout().is_ok_and(|out| out.as_file().metadata().is_ok_and(|known| known.is_file()))
}

/// Temporary files that are being written.
static TEMPORARY: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn lock() -> MutexGuard<'static, Vec<PathBuf>> {
    TEMPORARY.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of a command that is ended. No file begins or gets its name any more.
pub(crate) fn remove_temporary() {
    let temporary = lock();
    for path in temporary.iter() {
        let _ = fs::remove_file(path);
    }
    // The lock stays.
    std::mem::forget(temporary);
}
