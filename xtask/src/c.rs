//! `cargo xtask c`: the C and C++ library as a folder for compilers, CMake and pkg-config; and its tests.
//!
//! ```text
//! PREFIX/
//!   include/stepscope.h, stepscope.hpp, stepscope_walk.h
//!   lib/libstepscope.a, libstepscope.so -> libstepscope.so.0
//!   lib/pkgconfig/stepscope.pc
//!   lib/cmake/stepscope/stepscope-config.cmake, stepscope-config-version.cmake
//! ```
//!
//! The folder may be moved: nothing in it has its path.

use std::path::Path;

use anyhow::{Context, Result, ensure};

use crate::{apt, files, root, run, toolchain};

const PACKAGE: &str = "stepscope-c";
const PROGRAMS: [&str; 7] = ["gcc", "g++", "cmake", "ctest", "pkg-config", "valgrind", "cppcheck"];
const DEBIAN: [&str; 6] = ["gcc", "g++", "cmake", "pkg-config", "valgrind", "cppcheck"];
const HEADERS: [&str; 3] = [
    "bindings/c/include/stepscope.h",
    "bindings/c/include/stepscope.hpp",
    "core/inspect/include/stepscope_walk.h",
];
const SHARED: &str = "libstepscope.so.0";

/// How the library is built.
#[derive(Clone, Copy)]
pub(crate) enum Build {
    /// As it is shipped.
    Library,
    /// With debug assertions, and in seconds: for the tests.
    Dev,
}

/// Builds the library and installs it into `prefix`.
pub(crate) async fn install(prefix: &Path, build: Build) -> Result<()> {
    ensure!(cfg!(target_os = "linux"), "the C library is installed on Linux only; use the crate {PACKAGE}");
    let (profile, folder) = match build {
        Build::Library => ("library", "library"),
        Build::Dev => ("dev", "debug"),
    };
    let mut command = toolchain::cargo();
    command.args(["build", "--locked", "--package", PACKAGE, "--profile", profile]);
    run::compile(command).await?;
    let built = root().join("target").join(folder);
    let (include, lib) = (prefix.join("include"), prefix.join("lib"));
    let (pkgconfig, cmake) = (lib.join("pkgconfig"), lib.join("cmake/stepscope"));
    for folder in [&include, &pkgconfig, &cmake] {
        files::create_folder(folder)?;
    }
    for header in HEADERS {
        let from = root().join(header);
        copy(&from, &include.join(from.file_name().context("a header has a name")?))?;
    }
    copy(&built.join("libstepscope_c.a"), &lib.join("libstepscope.a"))?;
    copy(&built.join("libstepscope_c.so"), &lib.join(SHARED))?;
    link(SHARED, &lib.join("libstepscope.so"))?;
    let package = root().join("bindings/c/package");
    copy(&package.join("stepscope-config.cmake"), &cmake.join("stepscope-config.cmake"))?;
    for (template, to) in [
        ("stepscope.pc.in", pkgconfig.join("stepscope.pc")),
        ("stepscope-config-version.cmake.in", cmake.join("stepscope-config-version.cmake")),
    ] {
        let text = String::from_utf8(files::read_bytes(&package.join(template))?).context("UTF-8")?;
        files::write(&to, text.replace("@VERSION@", env!("CARGO_PKG_VERSION")))?;
    }
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    // A program may run with the library that is replaced, so its file is not written to.
    let _ = std::fs::remove_file(to);
    files::write(to, files::read_bytes(from)?)
}

#[cfg(unix)]
fn link(to: &str, at: &Path) -> Result<()> {
    let _ = std::fs::remove_file(at);
    std::os::unix::fs::symlink(to, at).with_context(|| format!("{} can't be made", at.display()))
}

#[cfg(not(unix))]
fn link(_: &str, _: &Path) -> Result<()> {
    Ok(())
}

pub(crate) async fn test() -> Result<()> {
    apt::require("the test of the C library", &PROGRAMS, &DEBIAN).await?;
    let prefix = root().join("target/c-library");
    install(&prefix, Build::Dev).await?;
    let mut command = toolchain::ignored_tests(&["c_programs"]);
    command.env("STEPSCOPE_C_LIBRARY", prefix);
    run::cargo_test(command).await
}
