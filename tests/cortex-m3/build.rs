//! Places the program in the board's memory; for other targets there is nothing to place.

use std::{env, error::Error, fs, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=memory.x");
    if env::var("CARGO_CFG_TARGET_OS")? == "none" {
        let out = env::var("OUT_DIR")?;
        fs::copy("memory.x", Path::new(&out).join("memory.x"))?;
        println!("cargo::rustc-link-search={out}");
        // The script is cortex-m-rt's, which reads memory.x.
        println!("cargo::rustc-link-arg-bins=-Tlink.x");
        println!("cargo::rustc-link-arg-bins=--nmagic");
    }
    Ok(())
}
