//! Writes output files atomically.
//!
//! ```text
//! check     no output is an input or another output, by any path; at most one is standard output
//! create    a temporary file next to each
//! commit    rename all temporary files
//! ```
//!
//! Until the commit an error, a full disk, Ctrl-C or a kill leaves the existing files. If a file cannot be renamed, all
//! temporary files are kept. Pipes and devices are written directly.

use crate::{failure::Failure, pipe, progress, terminal::Escaped};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::TempPath;

pub(crate) const STANDARD: &str = "-";
const MAX_LINKS: u32 = 40;

pub(crate) type Out = BufWriter<Box<dyn Write>>;

#[derive(Default)]
pub(crate) struct Outputs {
    pending: Vec<PendingFile>,
}

/// A file with its temporary name until all are complete.
struct PendingFile {
    /// As on the command line.
    given: PathBuf,
    /// With symbolic links resolved.
    name: PathBuf,
    temporary: TempPath,
}

#[derive(PartialEq)]
enum Identity {
    /// An existing file, by any path or hard link.
    Existing(identity::Id),
    /// A new file, in a folder with links resolved.
    New(PathBuf),
}

impl Identity {
    fn of_input(path: &Path) -> Option<Self> {
        if path == Path::new(STANDARD) {
            return identity::stdin().and_then(|file| identity::of_file(&file)).map(Self::Existing);
        }
        is_file(path).then(|| identity::of(path)).flatten().map(Self::Existing)
    }

    fn of_output(path: &Path) -> Option<Self> {
        if path == Path::new(STANDARD) {
            return identity::stdout().and_then(|file| identity::of_file(&file)).map(Self::Existing);
        }
        let name = resolve_links(path);
        if name == Path::new("/dev/null") {
            return None;
        }
        if let Some(id) = identity::of(&name) {
            return Some(Self::Existing(id));
        }
        let folder = fs::canonicalize(folder(&name)).ok()?;
        Some(Self::New(folder.join(name.file_name()?)))
    }
}

/// Opens nothing: a pipe can be opened only once, and opening a terminal connects a client to it.
#[cfg(unix)]
mod identity {
    use super::{File, Path, fs, io};
    use std::os::{fd::AsFd, unix::fs::MetadataExt};

    pub(super) type Id = (u64, u64);

    pub(super) fn of(path: &Path) -> Option<Id> {
        fs::metadata(path).ok().map(|known| (known.dev(), known.ino()))
    }

    pub(super) fn of_file(file: &File) -> Option<Id> {
        file.metadata().ok().map(|known| (known.dev(), known.ino()))
    }

    pub(super) fn stdin() -> Option<File> {
        io::stdin().as_fd().try_clone_to_owned().ok().map(File::from)
    }

    pub(super) fn stdout() -> Option<File> {
        io::stdout().as_fd().try_clone_to_owned().ok().map(File::from)
    }
}

#[cfg(not(unix))]
mod identity {
    use super::{File, Path};
    use same_file::Handle;

    pub(super) type Id = Handle;

    pub(super) fn of(path: &Path) -> Option<Id> {
        Handle::from_path(path).ok()
    }

    pub(super) fn of_file(file: &File) -> Option<Id> {
        Handle::from_file(file.try_clone().ok()?).ok()
    }

    pub(super) fn stdin() -> Option<File> {
        Handle::stdin().ok()?.as_file().try_clone().ok()
    }

    pub(super) fn stdout() -> Option<File> {
        Handle::stdout().ok()?.as_file().try_clone().ok()
    }
}

impl Outputs {
    /// Each output has the name of its option.
    /// Errors: [`Failure::Option`] if an output is another output or an input.
    pub(crate) fn check<'p>(
        inputs: impl IntoIterator<Item = &'p (impl AsRef<Path> + ?Sized + 'p)>,
        outputs: impl IntoIterator<Item = (&'p str, &'p Path)>,
    ) -> Result<Self, Failure> {
        let inputs: Vec<Identity> =
            inputs.into_iter().filter_map(|path| Identity::of_input(path.as_ref())).collect();
        let mut before: Vec<(&str, &Path, Option<Identity>)> = Vec::new();
        for (option, path) in outputs {
            let identity = Identity::of_output(path);
            let option_name = option.replace('_', "-");
            let is_standard = |path: &Path| path == Path::new(STANDARD);
            let same = |other: &Option<Identity>| identity.is_some() && *other == identity;
            let mut earlier = before.iter();
            if let Some((other_option, other, _)) =
                earlier.find(|(_, other, known)| same(known) || is_standard(other) && is_standard(path))
            {
                let other_name = other_option.replace('_', "-");
                return Err(Failure::Option(if is_standard(other) || is_standard(path) {
                    format!(
                        "--{option_name}: standard output is already used by --{other_name}; use a file for one of them"
                    )
                } else {
                    format!(
                        "--{option_name}: {} is already the output of --{other_name}; use a separate file for each output",
                        Escaped::path(path)
                    )
                }));
            }
            // A terminal may be input and output.
            if identity.as_ref().is_some_and(|identity| inputs.contains(identity)) && is_file(path) {
                return Err(Failure::Option(format!(
                    "--{option_name}: {} is an input and would be overwritten; use another file",
                    Escaped::path(path)
                )));
            }
            before.push((option, path, identity));
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
        let name = resolve_links(path);
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
        let parent = folder(&name);
        if !parent.exists() {
            let why = format!(
                "the folder {} does not exist; create it, or use another path",
                Escaped::path(parent)
            );
            return Err(io::Error::new(io::ErrorKind::NotFound, why));
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
        // Without the temporary name, which is in the original message.
        let created = builder.tempfile_in(parent).map_err(|error| io::Error::from(error.kind()))?;
        let (file, temporary) = created.into_parts();
        temporaries.push(temporary.to_path_buf());
        drop(temporaries);
        if let Some(known) = known {
            fs::set_permissions(&temporary, known.permissions())?;
        }
        self.pending.push(PendingFile { given: path.to_owned(), name, temporary });
        Ok(Box::new(file))
    }

    /// Renames all complete files; a signal ends the command before or after all of them. If one cannot be renamed,
    /// replaced files are restored, where the file system has hard links, and the new files stay next to them. Returns
    /// the names.
    pub(crate) fn commit(self) -> Result<Vec<PathBuf>, Failure> {
        let mut committed = committed();
        let mut pending = self.pending.into_iter();
        let (mut replaced, mut written) = (Vec::<Replaced>::new(), Vec::new());
        while let Some(next) = pending.next() {
            let (path, given) = (next.temporary.to_path_buf(), next.given.clone());
            let failed = match Replaced::by(next) {
                Ok(done) => {
                    replaced.push(done);
                    written.push(given);
                    lock().retain(|other| *other != path);
                    continue;
                }
                Err(failed) => failed,
            };
            let NotRenamed { given, error, temporary } = *failed;
            let mut kept: Vec<TempPath> = replaced.into_iter().rev().filter_map(Replaced::restore).collect();
            kept.reverse();
            kept.push(temporary);
            kept.extend(pending.map(|file| file.temporary));
            return Err(Failure::NotRenamed(
                given,
                error,
                kept.into_iter().filter_map(keep_temporary).collect(),
            ));
        }
        *committed |= !replaced.is_empty();
        Ok(written)
    }
}

/// `None` if the file is gone.
fn keep_temporary(temporary: TempPath) -> Option<PathBuf> {
    let path = temporary.keep().ok()?;
    lock().retain(|other| *other != path);
    path.exists().then_some(path)
}

struct NotRenamed {
    given: PathBuf,
    error: io::Error,
    temporary: TempPath,
}

struct Replaced {
    name: PathBuf,
    temporary: PathBuf,
    existed: bool,
    /// A hard link to the old file, if the file system supports them.
    backup: Option<TempPath>,
}

impl Replaced {
    fn by(PendingFile { given, name, temporary }: PendingFile) -> Result<Self, Box<NotRenamed>> {
        let existed = fs::symlink_metadata(&name).is_ok();
        let mut builder = tempfile::Builder::new();
        builder.prefix("stepscope.").suffix(".old");
        let backup = existed.then(|| builder.make_in(folder(&name), |path| fs::hard_link(&name, path)));
        let backup = backup.and_then(Result::ok).map(tempfile::NamedTempFile::into_temp_path);
        let path = temporary.to_path_buf();
        match temporary.persist(&name) {
            Ok(()) => Ok(Self { name, temporary: path, existed, backup }),
            Err(tempfile::PathPersistError { error, path: temporary }) => {
                Err(Box::new(NotRenamed { given, error, temporary }))
            }
        }
    }

    /// Restores the old file; returns the new one. Without a backup the old file is gone, so the new one keeps its
    /// name.
    fn restore(self) -> Option<TempPath> {
        if self.existed && self.backup.is_none() {
            return None;
        }
        fs::rename(&self.name, &self.temporary).ok()?;
        if let Some(Err(error)) = self.backup.map(|backup| backup.persist(&self.name)) {
            // A file that cannot be restored keeps its second name.
            let _ = error.path.keep();
        }
        TempPath::try_from_path(self.temporary).ok()
    }
}

static COMMITTED: Mutex<bool> = Mutex::new(false);

/// Whether the files have been renamed; locked meanwhile.
pub(crate) fn committed() -> MutexGuard<'static, bool> {
    COMMITTED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes one file; its path was checked before the command began.
pub(crate) fn write_new(path: &Path, write: impl FnOnce(&mut Out) -> io::Result<()>) -> Result<(), Failure> {
    let mut outputs = Outputs::default();
    let mut out = outputs.create(path)?;
    write(&mut out).and_then(|()| out.flush()).map_err(|error| Failure::File(path.to_owned(), error))?;
    drop(out);
    progress::print_written(&outputs.commit()?);
    Ok(())
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

fn resolve_links(path: &Path) -> PathBuf {
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

pub(crate) fn can_be_file(path: &Path) -> bool {
    let name = resolve_links(path);
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
    identity::stdout().is_some_and(|file| file.metadata().is_ok_and(|known| known.is_file()))
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

    /// A folder takes one of the names, or the folder of one file disappears, while the files are written.
    #[test]
    fn a_failed_rename_restores_old_files_and_keeps_the_new_ones() {
        for (taken, is_late) in [("folder", false), ("file/inside", true)] {
            let folder = tempfile::tempdir().expect("a folder");
            let path = |name: &str| folder.path().join(name);
            fs::write(path("old"), "old").expect("a file");
            fs::create_dir(path("file")).expect("a folder");
            let mut outputs = Outputs::default();
            let names = ["old", "new", taken, "last"];
            for name in names {
                outputs
                    .create(&path(name))
                    .and_then(|mut out| {
                        out.write_all(name.as_bytes()).and_then(|()| out.flush()).map_err(Failure::output)
                    })
                    .expect("there is room");
            }
            if is_late {
                fs::remove_dir_all(path("file")).expect("it is ours");
            } else {
                fs::create_dir_all(path("folder/full")).expect("a folder");
            }
            let failed = outputs.commit().expect_err("a name is taken");
            let Failure::NotRenamed(given, _, kept) = &failed else { panic!("{failed}") };
            assert_eq!(*given, path(taken));
            let text = |path: &Path| fs::read_to_string(path).expect("it is there");
            let expected: Vec<&str> = names.into_iter().filter(|name| !is_late || *name != taken).collect();
            assert_eq!(kept.iter().map(PathBuf::as_path).map(text).collect::<Vec<_>>(), expected, "{failed}");
            assert!(kept.iter().all(|path| failed.to_string().contains(&path.display().to_string())));
            assert_eq!(text(&path("old")), "old");
            assert!(!path("new").exists() && !path("last").exists());
            let left = fs::read_dir(folder.path()).expect("a folder").count();
            assert_eq!(left, if is_late { 4 } else { 7 }, "{taken}: other files are left");
        }
    }

    /// The system reports whether a terminal was opened and closed.
    #[test]
    #[cfg(target_os = "linux")]
    fn checks_a_terminal_behind_a_link_without_opening_it() {
        use rustix::{
            event::{PollFd, PollFlags, Timespec, poll},
            pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt},
        };
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).expect("a terminal");
        grantpt(&master).and_then(|()| unlockpt(&master)).expect("it can be opened");
        let name = ptsname(&master, Vec::new()).expect("a name").into_string().expect("text");
        let folder = tempfile::tempdir().expect("a folder");
        let link = folder.path().join("link");
        std::os::unix::fs::symlink(&name, &link).expect("a link");
        let was_opened = || {
            let mut fds = [PollFd::new(&master, PollFlags::IN)];
            poll(&mut fds, Some(&Timespec { tv_sec: 0, tv_nsec: 0 })).expect("it polls");
            fds[0].revents().contains(PollFlags::HUP)
        };
        let record = folder.path().join("record");
        for inputs in [&["-"] as &[&str], &["-", "/dev/null"]] {
            drop(
                Outputs::check(inputs.iter().copied(), [("record", record.as_path()), ("pty", &link)])
                    .expect("two files"),
            );
            assert!(!was_opened(), "{inputs:?}");
        }
        let twice = Outputs::check(["-"], [("record", link.as_path()), ("pty", Path::new(&name))]);
        assert!(matches!(twice, Err(Failure::Option(_))), "one terminal by two names");
        assert!(!was_opened());
        drop(fs::File::open(&link).expect("it opens"));
        assert!(was_opened(), "the test sees an opening");
    }
}
