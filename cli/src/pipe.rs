//! Opens files that may be named pipes, and limits the wait for the other end.

use std::fs::{File, OpenOptions};
use std::{io, path::Path, sync::mpsc::sync_channel, thread, time::Duration};

const WAIT: Duration = Duration::from_secs(10);

pub(crate) fn to_read(path: &Path) -> io::Result<File> {
    open(path, OpenOptions::new().read(true), "writes to")
}

pub(crate) fn to_write(path: &Path) -> io::Result<File> {
    open(path, OpenOptions::new().write(true), "reads from")
}

fn open(path: &Path, options: &OpenOptions, does: &str) -> io::Result<File> {
    if !is_named_pipe(path) {
        return options.open(path);
    }
    let (sender, opened) = sync_channel(1);
    let (name, options) = (path.to_owned(), options.clone());
    // Opening a pipe cannot be interrupted, so a thread does it; it ends with the command.
    let open = move || drop(sender.send(options.open(name)));
    thread::Builder::new().name("pipe".to_owned()).spawn(open)?;
    opened.recv_timeout(WAIT).unwrap_or_else(|_| {
        let seconds = WAIT.as_secs();
        let why = format!(
            "no other program opened this named pipe within {seconds} s; start the program that {does} it, or use a file"
        );
        Err(io::Error::new(io::ErrorKind::TimedOut, why))
    })
}

pub(crate) fn is_named_pipe(path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        std::fs::metadata(path).is_ok_and(|known| known.file_type().is_fifo())
    }
    #[cfg(not(unix))]
    {
        let _ = path;
        false
    }
}
