//! `cargo xtask attend` ends its program when its input closes.
#![cfg(unix)]
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use std::{
    io::{BufRead, BufReader},
    path::PathBuf,
    process::{Child, Command, Stdio},
};

fn attend(script: &str) -> Child {
    let mut attend = Command::new(env!("CARGO_BIN_EXE_xtask"));
    attend.args(["attend", "--", "sh", "-c", script]).stdin(Stdio::piped()).stdout(Stdio::piped());
    attend.stderr(Stdio::null()).spawn().expect("it starts")
}

#[test]
fn the_end_of_input_ends_the_program_with_its_children_and_its_folder() {
    let mut attended = attend("echo \"$TMPDIR\"; touch \"$TMPDIR/left\"; (sleep 60; echo alive) & wait");
    let mut lines = BufReader::new(attended.stdout.take().expect("a pipe")).lines().map_while(Result::ok);
    let folder = PathBuf::from(lines.next().expect("the folder's name"));
    assert!(folder.is_dir());
    drop(attended.stdin.take());
    assert!(attended.wait().expect("it ends").success());
    // The output ends when no process holds it open.
    assert_eq!(lines.next(), None);
    assert!(!folder.exists());
}

#[test]
fn the_result_of_a_program_that_ends_by_itself_is_reported() {
    for (script, succeeds) in [("exit 0", true), ("exit 3", false)] {
        let mut attended = attend(script);
        // Dropping it would end the program.
        let _input = attended.stdin.take();
        assert_eq!(attended.wait().expect("it ends").success(), succeeds, "{script}");
    }
}
