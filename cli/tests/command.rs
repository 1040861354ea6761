//! The `stepscope` command in scripts: output and exit codes.

use std::{
    env, fs,
    io::{self, Write},
    path::PathBuf,
    process::{Command, Stdio},
};
use stepscope_core::{inspect::trace::drivers::DRIVERS, sim::Experiment};
use stepscope_tests::golden::{CASES, Case};

#[derive(Debug)]
struct CommandOutput {
    code: Option<i32>,
    out: String,
    err: String,
}

impl CommandOutput {
    fn parts(&self) -> (Option<i32>, &str, &str) {
        (self.code, &self.out, &self.err)
    }
}

fn stepscope(arguments: &[&str], input: &str) -> io::Result<CommandOutput> {
    let mut child = Command::new(env!("CARGO_BIN_EXE_stepscope"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    if let Some(mut stdin) = child.stdin.take() {
        // The command may have ended without reading.
        let _ = stdin.write_all(input.as_bytes());
    }
    let output = child.wait_with_output()?;
    let text = |bytes| String::from_utf8(bytes).map_err(io::Error::other);
    Ok(CommandOutput { code: output.status.code(), out: text(output.stdout)?, err: text(output.stderr)? })
}

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> io::Result<Self> {
        let path = env::temp_dir().join(format!("stepscope-command-{name}-{}", std::process::id()));
        fs::create_dir_all(&path)?;
        Ok(Self(path))
    }

    fn file(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A leftover folder of temporary files is harmless.
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn tick() -> (&'static str, &'static str, &'static str, &'static str) {
    let case = CASES.iter().find(|case| case.name == "tick").expect("it is there");
    let file = |name| case.file(name).expect("it has one");
    (file("scenario.json"), file("digest"), file("status"), file("expect.trace"))
}

#[test]
fn each_option_prints_its_part() {
    let (scenario, digest, status, trace) = tick();
    let all = format!("digest {digest}{status}");
    let rows: [(&[&str], String); 6] = [
        (&[], all.clone()),
        (&["--status"], all.clone()),
        (&["--digest"], digest.to_owned()),
        (&["--digest", "--status"], all.clone()),
        (&["--trace", "-"], trace.to_owned()),
        (&["--trace", "-", "--digest"], format!("{trace}{digest}")),
    ];
    let folder = Folder::new("options").expect("there is room");
    let file = folder.file("tick.json");
    fs::write(&file, scenario).expect("there is room");
    for (options, expected) in rows {
        for (scenario, input) in [(file.as_str(), ""), ("-", scenario)] {
            let output = stepscope(&[&["run", scenario], options].concat(), input).expect("it runs");
            assert_eq!(output.parts(), (Some(0), expected.as_str(), ""), "{options:?} {scenario}");
        }
    }
}

#[test]
fn writes_a_trace_to_its_file_and_prints_nothing() {
    let (scenario, digest, _, trace) = tick();
    let folder = Folder::new("trace").expect("there is room");
    let file = folder.file("tick.trace");
    let output = stepscope(&["run", "-", "--trace", &file], scenario).expect("it runs");
    assert_eq!(output.parts(), (Some(0), "", ""));
    assert_eq!(fs::read_to_string(&file).expect("it is there"), trace);
    let output = stepscope(&["run", "-", "--digest", "--trace", &file], scenario).expect("it runs");
    assert_eq!(output.parts(), (Some(0), digest, ""));
}

/// The presets, too.
#[test]
fn reproduces_every_golden_case() {
    let is_reproduced = |case: &Case| {
        let output = stepscope(&["run", "-"], case.json().ok()?).ok()?;
        let experiment = Experiment::from_json(case.json().ok()?).ok()?;
        let warnings = experiment.stand_alone().into_iter().flat_map(|controllers| controllers.warnings());
        let warned: String = warnings.map(|warning| format!("warning: {warning}\n")).collect();
        let digests: String =
            case.file("digest")?.lines().map(|digest| format!("digest {digest}\n")).collect();
        let expected = digests + case.file("status")?;
        Some(output.parts() == (Some(0), expected.as_str(), warned.as_str()))
    };
    let failures: Vec<&str> =
        CASES.iter().filter(|case| is_reproduced(case) != Some(true)).map(|case| case.name).collect();
    assert_eq!(failures, [""; 0]);
}

#[test]
fn lists_all_problems_of_an_invalid_scenario() {
    let rows: [(&str, &[&str]); 4] = [
        ("", &["invalid JSON at line 1, column 0: "]),
        (r#"{"clock_hz": 0}"#, &["clock_hz: 0 Hz is out of range; use 11 to 1000000000 Hz"]),
        (
            r#"{"clok_hz": 1, "bus": {"slots": 200, "channels": "four"}, "line": {"baud": 0}}"#,
            &["bus.channels: ", "clok_hz: ", "bus.slots: ", "line.baud: "],
        ),
        (
            r#"{"source": {"motion": {"axes": [{"moves": [
                {"cosine": {"ramp_s": 1}}, {"constant": {"distance": {"mm": 1}}}]}]}}}"#,
            &[
                "source.motion.axes[0].moves[0].cosine.ramp_s: ",
                "source.motion.axes[0].moves[1].constant.distance: ",
            ],
        ),
    ];
    for (scenario, problems) in rows {
        let output = stepscope(&["run", "-"], scenario).expect("it runs");
        assert_eq!((output.code, output.out.as_str()), (Some(2), ""), "{scenario}");
        let mut lines = output.err.lines();
        let s = if problems.len() == 1 { "" } else { "s" };
        assert_eq!(lines.next(), Some(format!("-: {} problem{s}", problems.len()).as_str()), "{scenario}");
        let mut found: Vec<&str> = lines.collect();
        for problem in problems {
            let at = found.iter().position(|line| line.starts_with(&format!("  {problem}")));
            found.remove(at.unwrap_or_else(|| panic!("no {problem} in {output:?}")));
        }
        assert_eq!(found, [""; 0], "{scenario}");
    }
}

#[test]
fn names_a_missing_file_with_exit_code_1() {
    let folder = Folder::new("missing").expect("there is room");
    let (missing, unwritable) = (folder.file("missing.json"), folder.file("no-folder/tick.trace"));
    let rows: [(&[&str], &str); 2] =
        [(&["run", &missing], &missing), (&["run", "-", "--trace", &unwritable], &unwritable)];
    for (arguments, name) in rows {
        let output = stepscope(arguments, tick().0).expect("it runs");
        assert_eq!((output.code, output.out.as_str()), (Some(1), ""), "{arguments:?}");
        assert!(output.err.starts_with(&format!("{name}: ")), "{output:?}");
    }
}

#[test]
fn prints_usage_for_an_invalid_command_line() {
    for arguments in [&[] as &[&str], &["run"], &["walk"], &["run", "-", "--trase", "x"]] {
        let output = stepscope(arguments, "").expect("it runs");
        assert_eq!((output.code, output.out.as_str()), (Some(2), ""), "{arguments:?}");
        assert!(output.err.contains("Usage: stepscope"), "{output:?}");
    }
    let output = stepscope(&["--version"], "").expect("it runs");
    assert_eq!(output.parts(), (Some(0), concat!("stepscope ", env!("CARGO_PKG_VERSION"), "\n"), ""));
}

#[test]
fn timing_options_print_write_and_fail_on_violations() {
    let broken = stepscope(&["presets", "driver-timing-broken"], "").expect("it runs").out;
    let run = |options: &[&str]| stepscope(&[&["run", "-"], options].concat(), &broken).expect("it runs");
    let output = run(&["--timing"]);
    assert_eq!((output.code, output.err.as_str()), (Some(0), ""));
    let lines: Vec<Vec<&str>> = output.out.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(lines[1], ["step_high", "1900", "1000", "-900", "2946", "0", "128"]);
    assert_eq!(lines[3], ["dir_setup", "650", "500", "-150", "2930", "0", "3"]);
    assert_eq!(
        lines[6..8].concat().join(" "),
        "violations 131 cycle 2930 channel 0 dir_setup: 8 cycles, at least 11 required"
    );
    assert_eq!((lines.len(), lines[27].join(" ").as_str()), (28, "and 111 more"));

    let strict = run(&["--strict"]);
    let complaint = "--strict: 131 violations of the driver's timing\n";
    assert_eq!(strict.parts(), (Some(3), output.out.as_str(), complaint));
    let rows = run(&["--violations", "-"]);
    assert_eq!((rows.code, rows.out.lines().count()), (Some(0), 132));
    assert_eq!(rows.out.lines().nth(1), Some("2930,0.000183125,0,dir_setup,8,11,500,650"));
    // An A4988 can follow; the option overrides the scenario's driver.
    assert_eq!(run(&["--driver", "a4988", "--strict"]).code, Some(0));
    let output = stepscope(&["run", "-", "--timing"], "{}").expect("it runs");
    assert_eq!((output.code, output.out.as_str()), (Some(2), ""));
    assert!(output.err.contains("--driver"), "{output:?}");
    assert_eq!(stepscope(&["run", "-", "--driver", "a4989"], "{}").expect("it runs").code, Some(2));
}

#[test]
fn converts_a_table_of_points_to_a_valid_scenario() {
    let table = "time_s,position\n0,0\n0.5,12.5\n1,0\n";
    let made = stepscope(&["points", "-", "--unit", "mm", "--step-mm", "0.05", "--straight"], table)
        .expect("it runs");
    assert_eq!((made.code, made.err.as_str()), (Some(0), ""));
    let status = stepscope(&["run", "-", "--status"], &made.out).expect("it runs");
    assert!(status.out.contains("positions 0\n"), "{}", status.out);
    for (table, options, expected) in [
        ("0,0\n1,x\n", &[][..], "-: line 2: the position is \u{201c}x\u{201d}; use a number, such as 0.25\n"),
        (
            "0,0\n1,5\n1,6\n",
            &["--unit", "deg"],
            "-: 1 problem\n  source.motion.axes[0].moves[0].points.points[2]: a time of 1 s is not at least 1e-9 s after the previous time of 1 s; use rising times\n",
        ),
    ] {
        let output = stepscope(&[&["points", "-"], options].concat(), table).expect("it runs");
        assert_eq!(output.parts(), (Some(2), "", expected));
    }
}

#[test]
fn lists_drivers_with_their_limits() {
    let output = stepscope(&["drivers"], "").expect("it runs");
    assert_eq!((output.code, output.err.as_str()), (Some(0), ""));
    for sheet in DRIVERS {
        let rest = output.out.split_once(&format!("{:14} {}\n", sheet.id, sheet.name)).expect(sheet.id).1;
        let figures = rest.lines().next().unwrap_or_default();
        assert!(figures.contains(&format!("step_high {} ns", sheet.rules.step_high_ns)), "{figures}");
    }
}
