//! Details of the help pages: groups of options, exit codes, examples.

use crate::{complete, paths};
use clap::{Arg, Command};

/// The exit codes and examples of one command.
pub(crate) struct Page {
    pub(crate) command: &'static str,
    /// When the command ends with exit codes 1 to 4; empty if it never does.
    one: &'static str,
    two: &'static str,
    three: &'static str,
    four: &'static str,
    success: &'static str,
    stopped: &'static str,
    /// A test runs them in a folder with the files of docs/samples.
    pub(crate) examples: [&'static str; 2],
}

const READ: &str = "a file could not be read or written";
const WRITTEN: &str = "a file could not be written";
const SCENARIO: &str = "the scenario or the command line is invalid";
const LINE: &str = "the command line is invalid";

const fn page(
    command: &'static str,
    one: &'static str,
    two: &'static str,
    examples: [&'static str; 2],
) -> Page {
    let stopped = "stopped by Ctrl-C or a signal; no file was changed";
    Page { command, one, two, three: "", four: "", success: "success", stopped, examples }
}

/// Every command; the first is `stepscope` itself.
pub(crate) const PAGES: &[Page] = &[
    Page {
        three: "a check failed",
        four: "the port was lost",
        ..page(
            "",
            "a file or a port could not be used",
            "the scenario, the link, the recording or the command line is invalid",
            ["stepscope run song-2021-one-turn", "stepscope capture recorded-step-table --driver a4988"],
        )
    },
    Page {
        three: "--strict found timing violations",
        ..page(
            "run",
            READ,
            SCENARIO,
            ["stepscope run framed-link", "stepscope run song-2021-one-turn --vcd turn.vcd --csv turn.csv"],
        )
    },
    Page {
        three: "the session fell behind real time, or its recording does not reproduce it",
        four: "the port was lost; the recording is written",
        success: "success, also after Ctrl-C",
        stopped: "stopped by a signal before the session began",
        ..page(
            "serve",
            "a file could not be read or written, or the port could not be opened",
            SCENARIO,
            [
                "stepscope serve framed-link --pty ./line",
                "stepscope serve framed-link --tcp 127.0.0.1:4711 --record session.json",
            ],
        )
    },
    Page {
        three: "ticks or final positions are not confirmed",
        four: "the port was lost; the results so far are reported",
        stopped: "stopped by Ctrl-C or a signal; the results so far are reported",
        ..page(
            "send",
            "the scenario could not be read, or the port could not be opened",
            SCENARIO,
            [
                "stepscope send framed-link --port pty:./line",
                "stepscope send framed-link --port tcp:127.0.0.1:4711 --json",
            ],
        )
    },
    Page {
        three: "ticks were wrong, duplicated or missing on the framed line",
        ..page(
            "faults",
            READ,
            SCENARIO,
            ["stepscope faults --seeds 200", "stepscope faults --seed 7 --protocol raw -o seven.json"],
        )
    },
    Page {
        three: "--check: a step of the table differs from the plan",
        ..page(
            "tables",
            READ,
            "the scenario, the step times, the table or the command line is invalid",
            [
                "stepscope tables song-2021-one-turn",
                "stepscope tables song-2021-one-turn --format c -o turn.h --with-walker",
            ],
        )
    },
    page(
        "measures",
        READ,
        SCENARIO,
        [
            "stepscope measures song-2021-one-turn",
            "stepscope measures sine-2022-d00054 --format csv -o figures.csv",
        ],
    ),
    page(
        "steps",
        READ,
        SCENARIO,
        [
            "stepscope steps song-2021-one-turn -o steps.csv",
            "stepscope steps framed-link --axis 1 --format npy -o steps.npy",
        ],
    ),
    page(
        "curve",
        READ,
        SCENARIO,
        [
            "stepscope curve song-2021-one-turn -o curve.csv",
            "stepscope curve song-2021-one-turn --points 200 --format json",
        ],
    ),
    page(
        "spectrum",
        READ,
        SCENARIO,
        [
            "stepscope spectrum sine-2022-d00054",
            "stepscope spectrum sine-2022-d00054 --of ideal --format json -o spectrum.json",
        ],
    ),
    page(
        "torque",
        READ,
        SCENARIO,
        [
            "stepscope torque song-2021-motor",
            "stepscope torque song-2021-one-turn --motor 17hs4401 --format csv -o curve.csv",
        ],
    ),
    page(
        "plant",
        READ,
        SCENARIO,
        ["stepscope plant song-2021-stall", "stepscope plant song-2021-motor --csv motor.csv --every 100"],
    ),
    page(
        "settling",
        READ,
        SCENARIO,
        [
            "stepscope settling patent-2019-figure-2",
            "stepscope settling patent-2019-figure-2 --channel 0 -o settled.json",
        ],
    ),
    page(
        "limits",
        READ,
        SCENARIO,
        [
            "stepscope limits song-2021-motor",
            "stepscope limits song-2021-motor --motor nema-8 --motor-driver drv8825",
        ],
    ),
    page(
        "resonance",
        READ,
        SCENARIO,
        [
            "stepscope resonance resonance-full-steps --to 120 --step 10",
            "stepscope resonance resonance-full-steps --from 60 --to 100 --step 5 -o map.csv",
        ],
    ),
    Page {
        three: "the recording differs from --against, or --strict found violations or no steps",
        ..page(
            "capture",
            "a file could not be read or written, or the recording is truncated",
            "the recording, the scenario or the command line is invalid",
            [
                "stepscope capture recorded-step-table --driver a4988",
                "stepscope capture recorded-late-packet --vcd line.vcd -o line.json",
            ],
        )
    },
    Page {
        three: "a check failed",
        ..page(
            "check",
            "the list or a file of a check could not be read, or a file could not be written",
            "the list, a file of a check or the command line is invalid",
            [
                r#"echo '{"checks": [{"run": "framed-link"}]}' | stepscope check -"#,
                r#"echo '{"checks": [{"run": "framed-link"}]}' | stepscope check - --junit junit.xml"#,
            ],
        )
    },
    Page {
        three: "a wrong position was trusted after a power cut",
        ..page(
            "powercut",
            READ,
            SCENARIO,
            [
                "stepscope powercut zhang-2012-controller --cuts 100",
                "stepscope powercut controller-power-cut --cuts 100 --json",
            ],
        )
    },
    page(
        "calibrate",
        READ,
        "the table or the command line is invalid",
        [
            r"printf 'length_mm,steps\n100,4001\n200,7998\n' | stepscope calibrate -",
            r"printf 'length_mm,steps\n100,4001\n200,7998\n' | stepscope calibrate - --json",
        ],
    ),
    page("sine", READ, LINE, ["stepscope sine best", "stepscope sine segments sine-2022-d00054"]),
    page(
        "sine sweep",
        WRITTEN,
        LINE,
        ["stepscope sine sweep --points 50", "stepscope sine sweep --from 0.005 --to 0.01 -o sweep.csv"],
    ),
    page("sine best", WRITTEN, LINE, ["stepscope sine best", "stepscope sine best --segments 5 --json"]),
    page(
        "sine vertices",
        WRITTEN,
        LINE,
        [
            "stepscope sine vertices --segments 4",
            "stepscope sine vertices --segments 4 --free -o vertices.csv",
        ],
    ),
    page(
        "sine segments",
        READ,
        SCENARIO,
        [
            "stepscope sine segments sine-2022-d00054",
            "stepscope sine segments sine-2022-d0006 -o segments.csv",
        ],
    ),
    page(
        "points",
        READ,
        "the table or the command line is invalid",
        [
            r"printf '0,0\n0.5,800\n1,0\n' | stepscope points - -o cam.json",
            r"printf '0,0\n0.5,800\n1,0\n' | stepscope points - --straight | stepscope run -",
        ],
    ),
    Page {
        three: "--verify found a difference from the sender's run",
        ..page(
            "open",
            WRITTEN,
            "the link or the command line is invalid",
            [
                "stepscope open '#c=2.j.e30.90f7e4f5' -o opened.json",
                "stepscope open \"$(stepscope run framed-link --link)\" --verify",
            ],
        )
    },
    page(
        "presets",
        WRITTEN,
        "there is no preset of this name, or the command line is invalid",
        ["stepscope presets", "stepscope presets framed-link -o mine.json"],
    ),
    page("schema", WRITTEN, LINE, ["stepscope schema", "stepscope schema -o scenario.schema.json"]),
    page("drivers", "", LINE, ["stepscope drivers", "stepscope drivers --json"]),
    page(
        "completions",
        WRITTEN,
        LINE,
        ["stepscope completions bash -o stepscope.bash", "stepscope completions zsh -o _stepscope"],
    ),
    page("man", WRITTEN, LINE, ["stepscope man > stepscope.1", "stepscope man --dir man1"]),
];

impl Page {
    fn text(&self) -> String {
        let codes = [
            ("0", self.success),
            ("1", self.one),
            ("2", self.two),
            ("3", self.three),
            ("4", self.four),
            ("130", self.stopped),
            ("141", "standard output was closed"),
        ];
        let codes = codes.iter().filter(|(_, when)| !when.is_empty());
        let codes: Vec<String> = codes.map(|(code, when)| format!("\n  {code:4} {when}")).collect();
        let [first, second] = self.examples;
        format!("Exit codes:{}\n\nExamples:\n  {first}\n  {second}", codes.concat())
    }
}

/// Adds groups, exit codes and examples to a command and its subcommands.
pub(crate) fn add_details(command: Command) -> Command {
    with_page("", command)
}

fn with_page(name: &str, command: Command) -> Command {
    let page = PAGES.iter().find(|page| page.command == name);
    let command = match page {
        Some(page) => command.after_help(page.text()),
        None => command,
    };
    command.mut_args(|argument| with_group(name, argument)).mut_subcommands(|inner| {
        let name = format!("{name} {}", inner.get_name());
        with_page(name.trim_start(), inner)
    })
}

fn with_group(command: &str, argument: Arg) -> Arg {
    let id = argument.get_id().to_string();
    let mut argument = match complete::completer(command, &id) {
        Some(completer) => argument.add(completer),
        None => argument,
    };
    if argument.get_long().is_none() || ["help", "version"].contains(&id.as_str()) {
        return argument;
    }
    if argument.get_action().takes_values() {
        // `-1` is a value out of range, not an option.
        argument = argument.allow_negative_numbers(true);
    }
    argument.help_heading(group(command, &id))
}

/// The heading of an option in the help.
fn group(command: &str, id: &str) -> &'static str {
    match (command, id) {
        (_, "motor" | "microsteps" | "motor_driver" | "motors") => "Motor options",
        (_, "timing" | "driver" | "violations" | "strict") => "Timing check",
        (_, "threads" | "progress") => "Progress options",
        ("serve", "pty" | "tcp" | "allow_remote" | "port")
        | ("send", "port" | "slack" | "lead" | "rs485" | "echo") => "Connection options",
        ("serve", "lag" | "pace" | "once") => "Session options",
        ("capture", "map" | "both_edges" | "clock" | "sample_rate" | "baud" | "uart" | "base") => {
            "Recording options"
        }
        ("capture", "against" | "channel" | "align" | "within_us") => "Comparison options",
        (_, id) if is_output(command, id) => "Output options",
        _ => "Analysis options",
    }
}

fn is_output(command: &str, id: &str) -> bool {
    let words = [
        "json",
        "controller",
        "format",
        "digest",
        "status",
        "link",
        "name",
        "vcd_timescale",
        "every",
        "of_steps",
        "dir",
        "scenario",
    ];
    let is_error = command == "capture" && id == "error_us";
    is_error || words.contains(&id) || paths::of(command).is_some_and(|paths| paths.written.contains(&id))
}
