//! Programs in C and C++ with the library that `cargo xtask test --only c` installs: warnings, valgrind, sanitizers, golden
//! digests, and the examples as they stand in a folder of their own.
#![cfg(target_os = "linux")]
#![allow(clippy::expect_used, clippy::panic, reason = "a missing file or program fails the test")]

use std::{
    env,
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

const WARNINGS: [&str; 5] = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];
const SANITIZERS: [&str; 2] = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
const VALGRIND: [&str; 4] = [
    "--quiet",
    "--error-exitcode=9",
    "--leak-check=full",
    "--errors-for-leak-kinds=definite,indirect,possible",
];
const PROGRAMS: [&str; 4] = ["use.c", "misuse.c", "threads.c", "use.cpp"];

fn prefix() -> PathBuf {
    env::var_os("STEPSCOPE_C_LIBRARY").expect("`cargo xtask test --only c` installs the library").into()
}

fn own(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

/// Runs a program in a folder; returns what it prints.
fn call<S: AsRef<OsStr>>(folder: &Path, program: &str, arguments: impl IntoIterator<Item = S>) -> String {
    let arguments: Vec<S> = arguments.into_iter().collect();
    let output = Command::new(program)
        .args(&arguments)
        .current_dir(folder)
        .env("PKG_CONFIG_PATH", prefix().join("lib/pkgconfig"))
        .env("LD_LIBRARY_PATH", prefix().join("lib"))
        .output()
        .unwrap_or_else(|error| panic!("{program}: {error}"));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let line: Vec<_> = arguments.iter().map(|word| word.as_ref().to_string_lossy()).collect();
    assert!(
        output.status.success(),
        "{program} {}: {}\n{}{}",
        line.join(" "),
        output.status,
        text(&output.stdout),
        text(&output.stderr)
    );
    text(&output.stdout)
}

/// Compiles a program to `./program`, with `options` behind its source.
fn compile(folder: &Path, source: &Path, options: &[&str]) {
    let is_cpp = source.extension().is_some_and(|extension| extension == "cpp");
    let (compiler, standard) = if is_cpp { ("g++", "-std=c++17") } else { ("gcc", "-std=c11") };
    let include = format!("-I{}", prefix().join("include").display());
    let source = source.to_str().expect("UTF-8");
    let mut line = vec![standard, "-D_POSIX_C_SOURCE=200809L", "-g", "-o", "program", &include, source];
    line.extend(WARNINGS);
    line.extend(options);
    call(folder, compiler, line);
}

fn library(name: &str) -> String {
    prefix().join("lib").join(name).to_str().expect("UTF-8").to_owned()
}

#[test]
#[ignore = "needs the installed library"]
fn the_interface_is_the_published_one() {
    let folder = folder();
    compile(folder.path(), &own("tests/programs/signatures.c"), &[&library("libstepscope.so")]);
    call(folder.path(), "./program", [""; 0]);
}

/// Older standards, a strict C++ compiler, and a static checker.
#[test]
#[ignore = "needs the installed library"]
fn the_headers_have_no_finding() {
    let folder = folder();
    let include = format!("-I{}", prefix().join("include").display());
    for (compiler, standard, name) in [
        ("gcc", "-std=c99", "c.c"),
        ("gcc", "-std=c17", "c.c"),
        ("g++", "-std=c++11", "c.cpp"),
        ("g++", "-std=c++17", "cpp.cpp"),
        ("g++", "-std=c++20", "cpp.cpp"),
    ] {
        let header = if name == "cpp.cpp" { "stepscope.hpp" } else { "stepscope.h" };
        let text =
            format!("#include <{header}>\n#include <stepscope_walk.h>\nint main(void) {{ return 0; }}\n");
        fs::write(folder.path().join(name), text).expect("a file");
        call(folder.path(), compiler, [standard, &include, "-c", name].into_iter().chain(WARNINGS));
    }
    let programs = own("tests/programs");
    let programs = programs.to_str().expect("UTF-8");
    let line = ["--quiet", "--error-exitcode=1", "--enable=warning,portability", &include, programs];
    call(folder.path(), "cppcheck", line);
}

#[test]
#[ignore = "needs the installed library"]
fn valgrind_has_no_finding() {
    for program in PROGRAMS {
        let folder = folder();
        let options = ["-pthread", &library("libstepscope.so")];
        compile(folder.path(), &own("tests/programs").join(program), &options);
        call(folder.path(), "valgrind", VALGRIND.into_iter().chain(["./program"]));
    }
}

#[test]
#[ignore = "needs the installed library"]
fn sanitizers_have_no_finding_with_the_static_library() {
    for program in PROGRAMS {
        let folder = folder();
        let library = library("libstepscope.a");
        let mut options = vec!["-pthread", &library, "-lm", "-ldl"];
        options.extend(SANITIZERS);
        compile(folder.path(), &own("tests/programs").join(program), &options);
        call(folder.path(), "./program", [""; 0]);
    }
}

#[test]
#[ignore = "needs the installed library"]
fn golden_digests_are_the_same_in_c() {
    let read = |path: PathBuf| fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path:?}: {error}"));
    let cases = fs::read_dir(own("../../tests/golden")).expect("the golden cases");
    let mut cases: Vec<PathBuf> = cases.map(|entry| entry.expect("a case").path()).collect();
    cases.sort();
    let names = cases.iter().map(|case| {
        let file = case.join("scenario.json");
        if file.exists() {
            file.to_str().expect("UTF-8").to_owned()
        } else {
            read(case.join("preset")).trim().to_owned()
        }
    });
    let folder = folder();
    compile(folder.path(), &own("tests/programs/digests.c"), &[&library("libstepscope.so")]);
    let found = call(folder.path(), "./program", names);
    assert_eq!(found.lines().count(), cases.len());
    assert!(cases.len() > 80, "{} cases", cases.len());
    for (case, found) in cases.iter().zip(found.lines()) {
        let expected = read(case.join("digest"));
        assert_eq!(found, expected.split_whitespace().collect::<Vec<_>>().join(" "), "{}", case.display());
    }
}

/// `docs/how-to/c.md` has the same programs.
#[test]
#[ignore = "needs the installed library"]
fn the_ten_lines_run_as_they_stand() {
    let page = fs::read_to_string(own("../../docs/how-to/c.md")).expect("the page");
    for name in ["turn.json", "turn.c", "turn.cpp"] {
        let text = fs::read_to_string(own("examples").join(name)).expect("an example");
        assert!(
            name.ends_with("json") || page.contains(&text),
            "docs/how-to/c.md does not have {name} as it is"
        );
    }
    for source in ["turn.c", "turn.cpp"] {
        let folder = folder();
        for file in ["turn.json", source] {
            fs::copy(own("examples").join(file), folder.path().join(file)).expect("a copy");
        }
        let options = call(folder.path(), "pkg-config", ["--cflags", "--libs", "stepscope"]);
        let options: Vec<&str> = options.split_whitespace().collect();
        compile(folder.path(), Path::new(source), &options);
        let printed = call(folder.path(), "./program", [""; 0]);
        assert_eq!(printed, "3200 steps, digest ed82c77232a01a3a\n");
    }
}

/// Configures, builds and tests the firmware in a folder of its own; a mistake in its step generator fails its tests.
#[test]
#[ignore = "needs the installed library"]
fn the_firmware_is_tested_against_the_model() {
    let folder = folder();
    for entry in fs::read_dir(own("examples/firmware")).expect("the example") {
        let entry = entry.expect("a file");
        fs::copy(entry.path(), folder.path().join(entry.file_name())).expect("a copy");
    }
    let root = format!("-DCMAKE_PREFIX_PATH={}", prefix().display());
    call(folder.path(), "cmake", ["-S", ".", "-B", "build", &root]);
    call(folder.path(), "cmake", ["--build", "build"]);
    let printed = call(folder.path(), "ctest", ["--test-dir", "build", "--output-on-failure"]);
    assert!(printed.contains("100% tests passed, 0 tests failed"), "{printed}");

    let generator = folder.path().join("ramp.c");
    let text = fs::read_to_string(&generator).expect("the generator");
    let wrong = text.replace("2U * (uint64_t)index + 1U", "2U * (uint64_t)index");
    assert_ne!(text, wrong);
    fs::write(&generator, wrong).expect("a file");
    call(folder.path(), "cmake", ["--build", "build"]);
    let output = Command::new("ctest").args(["--test-dir", "build"]).current_dir(folder.path()).output();
    assert_eq!(output.expect("ctest runs").status.code(), Some(8), "a wrong generator fails");
}
