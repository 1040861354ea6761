//! `stepscope capture FILE --against SCENARIO`: edited recordings of a gentle ramp, whose steps resemble their
//! neighbors.

use crate::program::stepscope;
use std::{fmt::Write, fs, path::Path};

/// 1500 steps that speed up from 800 to 1400 steps per second and slow down again.
const PLAN: &str = r#"{"source":{"motion":{"axes":[{"moves":[{"trapezoid":{"distance":{"steps":1500},
    "start_speed":{"steps_s":800},"top_speed":{"steps_s":1400},"acceleration":{"steps_s2":1200}}}]}]}}}"#;

/// `edit` replaces each step (index, time in ns) by any number of events, each with its level of DIR.
fn events(name: &str, edit: impl Fn(usize, u64) -> Vec<(u64, bool)>) -> Vec<String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("compared").join(name);
    fs::create_dir_all(&folder).expect("a folder");
    let path = |name: &str| folder.join(name).display().to_string();
    let (plan, dump, own) = (path("plan.json"), path("plan.vcd"), path("own.vcd"));
    fs::write(&plan, PLAN).expect("a file");
    let (code, _, err) = stepscope(&["run", &plan, "--vcd", &dump], "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let (code, steps, err) = stepscope(&["capture", &dump, "--clock", "16000000", "--steps", "-"], "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let cycles = steps.lines().skip(1).filter_map(|row| row.split(',').next()?.parse::<u64>().ok());
    let mut text = String::from("$timescale 1 ns $end $var wire 1 s STEP $end $var wire 1 d DIR $end\n");
    text.push_str("$enddefinitions $end\n#0 0s 1d\n");
    for (at, right) in cycles.enumerate().flat_map(|(index, cycle)| edit(index, cycle * 125 / 2)) {
        // 120 ppm slow, up to 2 us of jitter.
        let at = at + at * 120 / 1_000_000 + at % 2000;
        let _ = writeln!(text, "#{} {}d\n#{at} 1s\n#{} 0s", at - 1000, u8::from(right), at + 2000);
    }
    fs::write(&own, text).expect("a file");
    let (code, out, err) = stepscope(&["capture", &own, "--against", &plan, "--within-us", "1000000"], "");
    assert!(code == Some(3) || code == Some(0), "{out}{err}");
    let rows = out
        .lines()
        .filter(|row| row.starts_with("  ") && row.contains(", at ") && !row.contains("late: maximum"));
    rows.map(|row| row.trim().split(", at ").next().unwrap_or_default().to_owned()).collect()
}

#[test]
fn steps_missing_at_either_end_of_a_ramp_are_not_late() {
    let right = |at| vec![(at, true)];
    let without = |from: usize, to: usize| {
        events(
            &format!("without-{from}"),
            |k, at| if (from..to).contains(&k) { Vec::new() } else { right(at) },
        )
    };
    assert_eq!(without(1500, 1500), [] as [&str; 0]);
    assert_eq!(without(0, 1), ["1 step missing before the first recorded step"]);
    assert_eq!(without(0, 6), ["6 steps missing before the first recorded step"]);
    assert_eq!(without(1499, 1500), ["1 step missing after step 1498"]);
    assert_eq!(without(1495, 1500), ["5 steps missing after step 1494"]);
    let extra =
        events(
            "extra-first",
            |k, at| if k == 0 { vec![(at - 900_000, true), (at, true)] } else { right(at) },
        );
    assert_eq!(extra, ["1 extra step before step 0"]);
    let extra =
        events(
            "extra-last",
            |k, at| if k == 1499 { vec![(at, true), (at + 900_000, true)] } else { right(at) },
        );
    assert_eq!(extra, ["1 extra step after step 1499"]);
}

#[test]
fn lists_nearby_differences_separately() {
    for apart in [3, 6, 12] {
        let found = events(&format!("apart-{apart}"), |k, at| match k {
            0 => Vec::new(),
            700 => vec![(at, true), (at + 400_000, true)],
            1000 => vec![(at, false)],
            _ if k == 700 + apart => Vec::new(),
            _ => vec![(at, true)],
        });
        let missing = format!("1 step missing after step {}", 699 + apart);
        let expected = [
            "1 step missing before the first recorded step",
            "1 extra step after step 700",
            &missing,
            "step 1000 in the wrong direction",
        ];
        assert_eq!(found, expected, "{apart}");
    }
}
