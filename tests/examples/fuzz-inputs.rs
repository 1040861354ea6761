//! Writes what each fuzz target begins with below the folder that is given: `<target>/inputs/`, a file each, and
//! `<target>/dictionary`, libFuzzer's, where the target has one. `cargo xtask fuzz` calls it.

use std::{
    env,
    fmt::Write as _,
    fs, io,
    path::{Path, PathBuf},
};
use stepscope_tests::fuzzing::{TARGETS, Target};

fn main() -> io::Result<()> {
    let folder = env::args_os().nth(1).map(PathBuf::from);
    let folder = folder.ok_or_else(|| io::Error::other("give the folder to write to"))?;
    for target in TARGETS {
        write(target, &folder.join(target.name))?;
    }
    Ok(())
}

fn write(target: &Target, folder: &Path) -> io::Result<()> {
    let inputs = folder.join("inputs");
    if inputs.exists() {
        fs::remove_dir_all(&inputs)?;
    }
    fs::create_dir_all(&inputs)?;
    let findings = target.findings()?.into_iter().map(|(_, bytes)| bytes);
    for (index, bytes) in (target.seeds)().into_iter().chain(findings).enumerate() {
        fs::write(inputs.join(format!("{index:04}")), bytes)?;
    }
    let mut dictionary = String::new();
    for word in (target.words)() {
        dictionary.push('"');
        for byte in word.bytes() {
            let _ = match byte {
                b'\\' | b'"' => write!(dictionary, "\\{}", char::from(byte)),
                b' '..=b'~' => write!(dictionary, "{}", char::from(byte)),
                _ => write!(dictionary, "\\x{byte:02x}"),
            };
        }
        dictionary.push_str("\"\n");
    }
    if dictionary.is_empty() { Ok(()) } else { fs::write(folder.join("dictionary"), dictionary) }
}
