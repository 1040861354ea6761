//! Turns the folders of `golden/` into constants, so that the native test and those in a browser and
//! on a microcontroller, which have no files, run the very same cases.
//!
//! A case is a folder, each file in it a text: see `src/golden.rs` for their names.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
};

fn main() -> io::Result<()> {
    let golden = PathBuf::from(variable("CARGO_MANIFEST_DIR")?).join("golden");
    println!("cargo::rerun-if-changed={}", golden.display());
    let mut list = String::from("&[\n");
    for folder in sorted(&golden)?.iter().filter(|path| path.is_dir()) {
        list += &format!("    Case {{ name: {:?}, files: &[\n", name(folder));
        for file in sorted(folder)? {
            list +=
                &format!("        ({:?}, include_str!({:?})),\n", name(&file), file.display().to_string());
        }
        list += "    ] },\n";
    }
    list += "]\n";
    fs::write(PathBuf::from(variable("OUT_DIR")?).join("golden.rs"), list)
}

fn variable(name: &str) -> io::Result<String> {
    env::var(name).map_err(io::Error::other)
}

fn sorted(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut paths = fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
