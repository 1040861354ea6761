//! Builds and runs the programs in `firmware/avr`.

use std::{
    ffi::OsStr,
    fs::{self, File},
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

/// A program that takes longer hangs.
const LIMIT: Duration = Duration::from_secs(600);

/// simavr's header for recorded pins: Debian's folder, and that of a manual build.
const SIMAVR: [&str; 2] = ["-I/usr/include/simavr/avr", "-I/usr/local/include/simavr/avr"];

pub(crate) fn in_the_repository(place: &str, name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(place).join(name)
}

pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("avr").join(name);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Keeps the program's output in the folder; stops it after [`LIMIT`].
pub(crate) fn call<S: AsRef<OsStr>>(folder: &Path, program: &str, arguments: &[S]) -> String {
    let path = if program == "stepscope" {
        PathBuf::from(env!("CARGO_BIN_EXE_stepscope"))
    } else {
        which::which(program)
            .unwrap_or_else(|_| panic!("{program} is not on PATH; `cargo xtask test --only avr` installs it"))
    };
    let log = folder.join(format!("{program}.log"));
    let output = File::create(&log).expect("a file");
    let mut child = Command::new(path)
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(output.try_clone().expect("the same file"))
        .stderr(output)
        .spawn()
        .expect("the program starts");
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().expect("it is our own") {
            break status;
        }
        if begun.elapsed() > LIMIT {
            child.kill().expect("it is our own");
            panic!("{program} has not ended after {LIMIT:?}");
        }
        thread::sleep(Duration::from_millis(10));
    };
    let output = String::from_utf8_lossy(&fs::read(&log).expect("a log")).into_owned();
    assert!(status.success(), "{program}: {status}\n{output}");
    output
}

pub(crate) fn compile(folder: &Path, elf: &str, sources: &[&str]) {
    // The section with the pins is not part of the chip's memory, so it has an unused address.
    let options = "-mmcu=atmega328p -DF_CPU=16000000ul -std=gnu99 -Os -Wall -Wextra -Werror -I. \
        -Wl,--section-start=.mmcu=0x910000 -o";
    let sources: Vec<PathBuf> = sources.iter().map(|name| in_the_repository("firmware/avr", name)).collect();
    let line = SIMAVR.map(OsStr::new).into_iter().chain(options.split_whitespace().map(OsStr::new));
    let line = line.chain([OsStr::new(elf)]).chain(sources.iter().map(|source| source.as_os_str()));
    call(folder, "avr-gcc", &line.collect::<Vec<_>>());
}
