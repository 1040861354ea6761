//! `cargo xtask release`: the command as an archive for a release, with its checksum.
//!
//! ```text
//! stepscope-VERSION-TARGET/
//!   bin/stepscope                                  static on Linux
//!   share/man/man1, share/completions              manual pages, scripts for shells
//!   share/scenario.schema.json                     the scenario format
//!   README.md CHANGELOG.md LICENSE-… THIRD-PARTY-LICENSES.txt
//! ```
//!
//! The same commit and tool chain give the same bytes: no times, owners or paths of this machine get in.

use std::ffi::OsString;
use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use flate2::{Compression, GzBuilder};
use sha2::{Digest, Sha256};
use tokio::process::Command;

use crate::dist::licenses;
use crate::{files, root, run, toolchain};

const PACKAGE: &str = "stepscope-cli";
const SHELLS: [(&str, &str); 5] = [
    ("bash", "stepscope.bash"),
    ("elvish", "stepscope.elv"),
    ("fish", "stepscope.fish"),
    ("powershell", "stepscope.ps1"),
    ("zsh", "_stepscope"),
];
const OWN: [&str; 4] = ["README.md", "CHANGELOG.md", "LICENSE-APACHE", "LICENSE-MIT"];

pub(crate) struct Options {
    pub(crate) target: Option<String>,
    pub(crate) out: PathBuf,
}

/// A file of the archive: its path in it, contents, and whether it is a program.
struct Packed {
    path: String,
    bytes: Vec<u8>,
    is_program: bool,
}

/// Builds and packs the command; prints the files.
pub(crate) async fn make(Options { target, out }: Options) -> Result<()> {
    let target = match target {
        Some(target) => target,
        None => default_target(&toolchain::host().await?),
    };
    toolchain::target(&target).await?;
    let program = build(&target).await?;
    // Manual pages and the like are written by a program that runs here.
    let host = toolchain::host().await?;
    let writer = if runs_on(&target, &host) { program.clone() } else { build(&host).await? };
    let name = archive_name(&target);
    let archive = archive(&name, &contents(&program, &writer, &target).await?)?;
    files::create_folder(&out)?;
    let file = format!("{name}.tar.gz");
    files::write(&out.join(&file), &archive)?;
    // Archives of other targets are made on other machines, and are listed, too.
    let sums = std::fs::read_to_string(out.join("SHA256SUMS")).unwrap_or_default();
    let sums = with_sum(&sums, &file, &archive, |other| out.join(other).exists());
    files::write(&out.join("SHA256SUMS"), &sums)?;
    println!("{}\n{}", out.join(&file).display(), out.join("SHA256SUMS").display());
    Ok(())
}

/// On Linux the target without a C library of the system, so that any distribution runs it.
fn default_target(host: &str) -> String {
    host.replace("-linux-gnu", "-linux-musl")
}

/// As `action.sh` looks for it.
fn archive_name(target: &str) -> String {
    format!("stepscope-{}-{target}", env!("CARGO_PKG_VERSION"))
}

/// Whether the host runs programs of this target.
fn runs_on(target: &str, host: &str) -> bool {
    default_target(target) == default_target(host)
}

async fn build(target: &str) -> Result<PathBuf> {
    // A folder of its own, because other flags would rebuild everything in the usual one.
    let folder = root().join("target").join("release-build");
    let mut command = toolchain::cargo();
    command.args([
        "build",
        "--release",
        "--locked",
        "--package",
        PACKAGE,
        "--target",
        target,
        "--target-dir",
    ]);
    command.arg(&folder).env("CARGO_ENCODED_RUSTFLAGS", remapped(&cargo_home()?));
    run::compile(command).await?;
    let program = format!("stepscope{}", if target.contains("windows") { ".exe" } else { "" });
    Ok(folder.join(target).join("release").join(program))
}

fn cargo_home() -> Result<PathBuf> {
    match std::env::var_os("CARGO_HOME") {
        Some(home) => Ok(home.into()),
        None => Ok(etcetera::home_dir().context("the user has no home folder")?.join(".cargo")),
    }
}

/// Flags that replace the folders of this machine in messages of panics.
fn remapped(cargo_home: &Path) -> OsString {
    let mut flags = OsString::new();
    for (from, to) in [(root(), "/stepscope"), (cargo_home, "/cargo")] {
        if !flags.is_empty() {
            flags.push("\u{1f}");
        }
        flags.push("--remap-path-prefix=");
        flags.push(from);
        flags.push(format!("={to}"));
    }
    flags
}

async fn contents(program: &Path, writer: &Path, target: &str) -> Result<Vec<Packed>> {
    let name = program.file_name().context("the program has no name")?.to_string_lossy().into_owned();
    let text = |path: String, bytes: Vec<u8>| Packed { path, bytes, is_program: false };
    let mut packed =
        vec![Packed { path: format!("bin/{name}"), bytes: files::read_bytes(program)?, is_program: true }];
    for own in OWN {
        packed.push(text(own.to_owned(), files::read_bytes(&root().join(own))?));
    }
    let licenses = licenses::text(PACKAGE, target).await?;
    packed.push(text("THIRD-PARTY-LICENSES.txt".to_owned(), licenses.into_bytes()));
    let folder = tempfile::tempdir().context("no temporary folder can be created")?;
    let manual = folder.path().join("man1");
    let written = |words: &[&str], last: &Path| {
        let mut command = Command::new(writer);
        command.args(words).arg(last);
        run::to_end(command)
    };
    written(&["man", "--dir"], &manual).await?;
    for page in files::below(&manual)? {
        let name = page.file_name().to_string_lossy().into_owned();
        packed.push(text(format!("share/man/man1/{name}"), files::read_bytes(page.path())?));
    }
    let file = folder.path().join("written");
    for (shell, name) in SHELLS {
        written(&["completions", shell, "-o"], &file).await?;
        packed.push(text(format!("share/completions/{name}"), files::read_bytes(&file)?));
    }
    written(&["schema", "-o"], &file).await?;
    packed.push(text("share/scenario.schema.json".to_owned(), files::read_bytes(&file)?));
    Ok(packed)
}

/// The files below a folder `name`, sorted, without times and owners.
fn archive(name: &str, packed: &[Packed]) -> Result<Vec<u8>> {
    ensure!(packed.iter().any(|file| file.is_program), "the archive has no program");
    let mut sorted: Vec<&Packed> = packed.iter().collect();
    sorted.sort_by(|one, other| one.path.cmp(&other.path));
    let mut tar = tar::Builder::new(Vec::new());
    for Packed { path, bytes, is_program } in sorted {
        let mut header = tar::Header::new_ustar();
        header.set_size(bytes.len() as u64);
        header.set_mode(if *is_program { 0o755 } else { 0o644 });
        header.set_mtime(0);
        header.set_uid(0);
        header.set_gid(0);
        tar.append_data(&mut header, format!("{name}/{path}"), &**bytes)
            .with_context(|| format!("{path} can't be packed"))?;
    }
    let bytes = tar.into_inner().context("the archive can't be completed")?;
    let mut gz = GzBuilder::new().mtime(0).write(Vec::new(), Compression::best());
    gz.write_all(&bytes).and_then(|()| gz.finish()).context("the archive can't be compressed")
}

/// The list of sums, as `sha256sum -c` reads it, with this file's sum, and the sums of this version's other files that exist.
fn with_sum(sums: &str, file: &str, bytes: &[u8], exists: impl Fn(&str) -> bool) -> String {
    let mut digits = String::new();
    Sha256::digest(bytes).iter().for_each(|byte| _ = write!(digits, "{byte:02x}"));
    let version = archive_name("");
    let is_kept = |name: &str| name != file && name.starts_with(&version) && exists(name);
    let is_other = |line: &&str| line.split_once("  ").is_some_and(|(_, name)| is_kept(name));
    let mut lines: Vec<String> = sums.lines().filter(is_other).map(str::to_owned).collect();
    lines.push(format!("{digits}  {file}"));
    lines.sort_by(|one, other| one.get(64..).cmp(&other.get(64..)));
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::GzDecoder;
    use std::io::Read;

    fn packed(path: &str, text: &str, is_program: bool) -> Packed {
        Packed { path: path.to_owned(), bytes: text.into(), is_program }
    }

    #[test]
    fn an_archive_has_its_files_without_times_and_owners() {
        let files = [packed("share/a", "text", false), packed("bin/stepscope", "program", true)];
        let bytes = archive("name", &files).unwrap();
        let reversed = [packed("bin/stepscope", "program", true), packed("share/a", "text", false)];
        assert_eq!(bytes, archive("name", &reversed).unwrap());
        let mut read = tar::Archive::new(GzDecoder::new(&*bytes));
        let mut found = Vec::new();
        for entry in read.entries().unwrap() {
            let mut entry = entry.unwrap();
            let mut text = String::new();
            entry.read_to_string(&mut text).unwrap();
            let header = entry.header();
            assert_eq!((header.mtime().unwrap(), header.uid().unwrap(), header.gid().unwrap()), (0, 0, 0));
            found.push((entry.path().unwrap().display().to_string(), header.mode().unwrap(), text));
        }
        let row = |path: &str, mode, text: &str| (path.to_owned(), mode, text.to_owned());
        assert_eq!(found, [row("name/bin/stepscope", 0o755, "program"), row("name/share/a", 0o644, "text")]);
        assert!(archive("name", &files[..1]).is_err());
    }

    #[test]
    fn sums_are_those_of_existing_archives_of_this_version() {
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        let [a, b] = ["a", "b"].map(|target| archive_name(target) + ".tar.gz");
        let first = with_sum("", &b, b"other", |_| false);
        let both = with_sum(&first, &a, b"abc", |_| true);
        assert!(both.starts_with(&format!("{abc}  {a}\n")) && both.ends_with(&first), "{both}");
        assert_eq!(with_sum(&both, &a, b"abc", |_| true), both);
        let with_old = format!("{both}{abc}  stepscope-0.0.1-a.tar.gz\n");
        assert_eq!(with_sum(&with_old, &a, b"abc", |_| true), both);
        assert_eq!(with_sum(&both, &b, b"other", |name| name != a), first);
    }

    #[test]
    fn linux_releases_are_static() {
        assert_eq!(default_target("x86_64-unknown-linux-gnu"), "x86_64-unknown-linux-musl");
        assert_eq!(default_target("aarch64-apple-darwin"), "aarch64-apple-darwin");
    }

    #[test]
    fn a_foreign_program_is_not_run() {
        let host = "x86_64-unknown-linux-gnu";
        assert!(runs_on(host, host) && runs_on("x86_64-unknown-linux-musl", host));
        assert!(!runs_on("aarch64-unknown-linux-musl", host) && !runs_on("x86_64-apple-darwin", host));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_action_fetches_an_archive_of_a_release() {
        let folder = tempfile::tempdir().unwrap();
        let tag = concat!("v", env!("CARGO_PKG_VERSION"));
        let release = folder.path().join(tag);
        std::fs::create_dir(&release).unwrap();
        let (name, script) =
            (archive_name("x86_64-unknown-linux-musl"), "#!/bin/sh\necho \"called with $*\"\n");
        let bytes = archive(&name, &[packed("bin/stepscope", script, true)]).unwrap();
        let file = name + ".tar.gz";
        std::fs::write(release.join(&file), &bytes).unwrap();
        std::fs::write(release.join("SHA256SUMS"), with_sum("", &file, &bytes, |_| true)).unwrap();
        let mut command = std::process::Command::new("bash");
        command.arg(root().join("action.sh")).current_dir(folder.path());
        command.envs([
            ("CHECKS", "list.json"),
            ("VERSION", tag),
            ("REPORT", "report"),
            ("ACTION_PATH", "none"),
        ]);
        command.envs([("RUNNER_OS", "Linux"), ("RUNNER_ARCH", "X64"), ("GITHUB_OUTPUT", "")]);
        command
            .env("RELEASES", format!("file://{}", folder.path().display()))
            .env("RUNNER_TEMP", folder.path());
        let output = command.env("GITHUB_STEP_SUMMARY", "").output().unwrap();
        let expected = "called with check list.json --junit report/junit.xml --summary report/summary.md\n";
        assert_eq!(String::from_utf8(output.stdout).unwrap(), expected, "{:?}", output.stderr);
        assert!(output.status.success());
    }
}
