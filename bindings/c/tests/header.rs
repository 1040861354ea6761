//! `include/stepscope.h` is what cbindgen writes; its constants are those of the core. STEPSCOPE_BLESS=1 writes it anew.
#![allow(clippy::expect_used, reason = "a missing file fails the test")]

use std::{env, fs, path::Path};
use stepscope_core::{peripheral::signal::Levels, registers};

fn header() -> String {
    fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/include/stepscope.h")).expect("it is committed")
}

#[test]
fn the_header_is_the_one_of_the_functions() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).expect("it reads");
    let sources = ["lib", "status", "error", "scenario", "run", "steps", "device", "frame"];
    let mut builder = cbindgen::Builder::new().with_config(config);
    for source in sources {
        builder = builder.with_src(folder.join("src").join(source).with_extension("rs"));
    }
    let mut text = Vec::new();
    builder.generate().expect("cbindgen reads the crate").write(&mut text);
    let text = String::from_utf8(text).expect("text");
    if env::var_os("STEPSCOPE_BLESS").is_some() {
        fs::write(folder.join("include/stepscope.h"), &text).expect("it can be written");
    }
    assert!(text == header(), "the header differs; write it anew with STEPSCOPE_BLESS=1");
}

/// The value of a `#define`.
fn value(name: &str) -> String {
    let header = header();
    let defined = format!("#define {name} ");
    let line = header.lines().find_map(|line| line.strip_prefix(&defined)).expect(name);
    line.split(" /*").next().unwrap_or_default().trim().to_owned()
}

#[test]
fn constants_are_those_of_the_core() {
    let offsets = [
        ("ID", registers::id::OFFSET),
        ("CONTROL", registers::control::OFFSET),
        ("RESULT", registers::result::OFFSET),
        ("STATUS", registers::status::OFFSET),
        ("FAULTS", registers::faults::OFFSET),
        ("TICKS_DONE", registers::ticks_done::OFFSET),
        ("ORDERS", registers::orders::OFFSET),
        ("PUSH", registers::push::OFFSET),
        ("POSITION", registers::position::OFFSET),
    ];
    for (name, offset) in offsets {
        assert_eq!(value(&format!("STEPSCOPE_REG_{name}")), format!("0x{offset:03X}U"));
    }
    let levels = [("EN", Levels::EN), ("RX", Levels::RX), ("TX", Levels::TX), ("DE", Levels::DE)];
    for (name, level) in levels {
        let expected = format!("(UINT64_C(1) << {})", level.trailing_zeros());
        assert_eq!(value(&format!("STEPSCOPE_LEVEL_{name}")), expected);
    }
    assert!(header().contains(&format!("(UINT64_C(1) << ({}U + (channel)))", Levels::DIR_SHIFT)));
    assert_eq!(value("STEPSCOPE_VERSION"), format!("\"{}\"", env!("CARGO_PKG_VERSION")));
}
