//! Writes output files atomically.
//!
//! ```text
//! check     no output is an input or another output, by any path; at most one is standard output
//! create    a temporary file next to each
//! commit    rename all temporary files
//! ```
//!
//! Until the commit an error, a full disk, Ctrl-C or a kill leaves the existing files. Pipes and devices are written
//! directly.

use crate::{failure::Failure, pipe};
use same_file::Handle;
use std::{
    fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
};
use tempfile::TempPath;

/// Stands for standard input or output.
pub(crate) const STANDARD: &str = "-";
/// Maximum symbolic links to follow.
const MAX_LINKS: u32 = 40;

pub(crate) type Out = BufWriter<Box<dyn Write>>;

#[derive(Default)]
pub(crate) struct Outputs {
    waiting: Vec<Waiting>,
}

/// A complete temporary file.
struct Waiting {
    given: PathBuf,
    /// The target of a link, or the path itself.
    name: PathBuf,
    temporary: TempPath,
}

#[derive(PartialEq)]
enum Identity {
    /// An existing file, by any path or hard link.
    There(Handle),
    /// A new file, by its real folder.
    New(PathBuf),
}

impl Identity {
    fn of_input(path: &Path) -> Option<Self> {
        if path == Path::new(STANDARD) {
            return Handle::stdin().ok().map(Self::There);
        }
        // A pipe can be opened only once.
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
        if name == Path::new("/dev/null") {
            return None;
        }
        if (!pipe::is_named_pipe(&name) || is_open_file(&name))
            && let Ok(handle) = Handle::from_path(&name)
        {
            return Some(Self::There(handle));
        }
        let folder = fs::canonicalize(folder(&name)).ok()?;
        Some(Self::New(folder.join(name.file_name()?)))
    }
}

impl Outputs {
    /// Checks the outputs before any is written.
    ///
    /// # Errors
    /// [`Failure::Output`] if an output is another output or an input.
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
                    "standard output already has another output; give a file for all but one of them"
                } else {
                    "would be written twice; give each output a file of its own"
                };
                return Err(Failure::Output(path.to_owned(), detail));
            }
            // A terminal may be both.
            if identity.as_ref().is_some_and(|identity| inputs.contains(identity)) && is_file(path) {
                return Err(Failure::Output(
                    path.to_owned(),
                    "is an input, and would be overwritten; give another file",
                ));
            }
            before.push((path, identity));
        }
        Ok(Self::default())
    }

    pub(crate) fn create(&mut self, path: &Path) -> Result<Out, Failure> {
        let out = self.open(path).map_err(|error| Failure::File(path.to_owned(), error))?;
        Ok(BufWriter::new(out))
    }

    fn open(&mut self, path: &Path) -> io::Result<Box<dyn Write>> {
        if path == Path::new(STANDARD) {
            return Ok(Box::new(io::stdout()));
        }
        let name = followed(path);
        if is_folder_name(&name) {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        let known = fs::metadata(&name).ok();
        if known.as_ref().is_some_and(|known| !known.is_file()) || is_open_file(&name) {
            return Ok(Box::new(pipe::to_write(&name)?));
        }
        if known.is_some() {
            // A read-only file must not be replaced.
            fs::OpenOptions::new().append(true).open(&name)?;
        }
        let mut start = name.file_name().ok_or(io::ErrorKind::InvalidInput)?.to_owned();
        // A name has at most 255 bytes.
        if start.len() > 200 {
            start = "stepscope".into();
        }
        start.push(".");
        let mut builder = tempfile::Builder::new();
        builder.prefix(&start).suffix(".part");
        // The usual permissions of a new file.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        // Registered before Ctrl-C can interrupt.
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

    /// Renames all complete files; a signal ends the command before or after all of them. If a rename fails, replaced
    /// files are restored where the file system has hard links.
    pub(crate) fn commit(self) -> Result<(), Failure> {
        let mut committed = committed();
        if let Some(folder) = self.waiting.iter().find(|waiting| waiting.name.is_dir()) {
            return Err(Failure::File(folder.given.clone(), io::ErrorKind::IsADirectory.into()));
        }
        let mut replaced = Vec::new();
        for Waiting { given, name, temporary } in self.waiting {
            let path = temporary.to_path_buf();
            let backup = Replaced::of(name);
            if let Err(error) = temporary.persist(&backup.name) {
                replaced.into_iter().rev().for_each(Replaced::restore);
                return Err(Failure::File(given, error.error));
            }
            replaced.push(backup);
            lock().retain(|other| *other != path);
        }
        *committed |= !replaced.is_empty();
        Ok(())
    }
}

struct Replaced {
    name: PathBuf,
    existed: bool,
    /// A hard link to the old file, if the file system supports them.
    backup: Option<TempPath>,
}

impl Replaced {
    fn of(name: PathBuf) -> Self {
        let existed = fs::symlink_metadata(&name).is_ok();
        let mut builder = tempfile::Builder::new();
        builder.prefix("stepscope.").suffix(".old");
        let backup = existed.then(|| builder.make_in(folder(&name), |path| fs::hard_link(&name, path)));
        let backup = backup.and_then(Result::ok).map(tempfile::NamedTempFile::into_temp_path);
        Self { name, existed, backup }
    }

    fn restore(self) {
        if let Some(backup) = self.backup {
            // A file that cannot be restored keeps its second name.
            if let Err(error) = backup.persist(&self.name) {
                let _ = error.path.keep();
            }
        } else if !self.existed {
            let _ = fs::remove_file(self.name);
        }
    }
}

static COMMITTED: Mutex<bool> = Mutex::new(false);

/// Whether the files have been renamed; locked meanwhile.
pub(crate) fn committed() -> MutexGuard<'static, bool> {
    COMMITTED.lock().unwrap_or_else(PoisonError::into_inner)
}

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

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Follows links even if their target does not exist.
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

/// Such as `/dev/stdout`, which cannot be replaced.
fn is_open_file(path: &Path) -> bool {
    let folder = fs::canonicalize(folder(path)).unwrap_or_default();
    cfg!(unix) && (folder.starts_with("/proc") || folder.starts_with("/dev/fd"))
}

/// A file, or a path where one can be created.
pub(crate) fn can_be_file(path: &Path) -> bool {
    let name = followed(path);
    path != Path::new(STANDARD)
        && !is_open_file(&name)
        && !is_folder_name(&name)
        && fs::metadata(&name)
            .map_or_else(|error| error.kind() == io::ErrorKind::NotFound, |known| known.is_file())
}

/// `name/` is a folder's name even if it does not exist.
fn is_folder_name(path: &Path) -> bool {
    path.to_string_lossy().ends_with(std::path::is_separator)
}

fn is_file(path: &Path) -> bool {
    if path != Path::new(STANDARD) {
        return fs::metadata(path).is_ok_and(|known| known.is_file());
    }
    Handle::stdout().is_ok_and(|out| out.as_file().metadata().is_ok_and(|known| known.is_file()))
}

static TEMPORARY: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn lock() -> MutexGuard<'static, Vec<PathBuf>> {
    TEMPORARY.lock().unwrap_or_else(PoisonError::into_inner)
}

pub(crate) fn remove_temporary() {
    let temporary = lock();
    for path in temporary.iter() {
        let _ = fs::remove_file(path);
    }
    // Blocks the creation of others.
    std::mem::forget(temporary);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder takes the last name while the files are written.
    #[test]
    fn files_that_cannot_all_get_their_names_change_nothing() {
        for (taken, is_late, remain) in [("folder", false, 3), ("file/inside", true, 1)] {
            let folder = tempfile::tempdir().expect("a folder");
            let path = |name: &str| folder.path().join(name);
            fs::write(path("old"), "old").expect("a file");
            fs::create_dir(path("file")).expect("a folder");
            let mut outputs = Outputs::default();
            for name in ["old", "new", taken] {
                outputs
                    .create(&path(name))
                    .and_then(|mut out| {
                        out.write_all(b"written").and_then(|()| out.flush()).map_err(Failure::output)
                    })
                    .expect("there is room");
            }
            if is_late {
                // The folder is gone, and the file with it.
                fs::remove_dir_all(path("file")).expect("it is ours");
            } else {
                fs::create_dir_all(path("folder/full")).expect("a folder");
            }
            let failed = outputs.commit().expect_err("a name is taken");
            assert!(matches!(&failed, Failure::File(given, _) if *given == path(taken)), "{failed}");
            assert_eq!(fs::read_to_string(path("old")).expect("it was there"), "old", "{taken}");
            assert!(!path("new").exists());
            let left = fs::read_dir(folder.path()).expect("a folder").count();
            assert_eq!(left, remain, "{taken}: files are left next to them");
        }
    }
}
