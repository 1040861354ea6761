//! Channel maps of `stepscope capture`: proposals, and syntax.

use crate::program::stepscope;
use std::fmt::Write;

/// Times in us; channels in `high` start high.
fn dump(names: &[&str], high: u64, edges: &[&[u64]]) -> String {
    let mut text = String::from("$timescale 1 us $end $scope module top $end\n");
    let mut rows: Vec<(u64, usize)> = Vec::new();
    for (channel, name) in names.iter().enumerate() {
        let _ = writeln!(text, "$var wire 1 c{channel} {name} $end");
        rows.extend(edges[channel].iter().map(|at| (*at, channel)));
    }
    text.push_str("$upscope $end $enddefinitions $end\n#0\n");
    let mut levels: Vec<bool> =
        (0..names.len()).map(|channel| high.checked_shr(channel as u32).unwrap_or(0) & 1 == 1).collect();
    for (channel, level) in levels.iter().enumerate() {
        let _ = writeln!(text, "{}c{channel}", u8::from(*level));
    }
    rows.sort_unstable();
    for (at, channel) in rows {
        levels[channel] = !levels[channel];
        let _ = writeln!(text, "#{at}\n{}c{channel}", u8::from(levels[channel]));
    }
    text
}

fn pulses(from: u64, count: u64, interval: u64, width: u64) -> Vec<u64> {
    (0..count).flat_map(|k| [from + k * interval, from + k * interval + width]).collect()
}

fn report(input: &str, options: &[&str]) -> String {
    let (code, out, err) = stepscope(&[&["capture", "-"], options].concat(), input);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
    out
}

fn assert_contains(out: &str, expected: &[&str]) {
    for line in expected {
        assert!(out.contains(line), "{line} in {out}");
    }
}

#[test]
fn counts_steps_on_both_edges_or_suggests_it() {
    let edges: Vec<u64> = (0..40).map(|k| 1000 + 100 * k).collect();
    let file = dump(&["STEP", "DIR"], 0b10, &[&edges, &[]]);
    let hint =
        "both edges of STEP0 are evenly spaced: a driver that steps on both edges makes 40 steps of it";
    assert_contains(
        &report(&file, &[]),
        &["channel 0  20 steps: 20 right", "maximum rate 5000.0 steps/s", hint],
    );
    for options in [&["--both-edges"][..], &["--map", "DEDGE0=STEP,DIR0=DIR"]] {
        let out = report(&file, options);
        assert_contains(
            &out,
            &["map       DEDGE0=top.STEP,DIR0=top.DIR", "channel 0  40 steps: 40 right", "10000.0 steps/s"],
        );
        assert!(!out.contains(hint), "{out}");
    }
    // Pulses that are made have no width to check.
    let out = report(&file, &["--both-edges", "--driver", "tb6600_class", "--strict"]);
    assert_contains(&out, &["excludes pulse width and low time", "violations 0"]);
    let scenario = report(&file, &["--both-edges", "--scenario", "-"]);
    let (code, out, err) = stepscope(&["run", "-"], &scenario);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    assert!(out.contains("40"), "{out}");
    let steps = report(&file, &["--both-edges", "--steps", "-"]);
    assert_eq!(steps.lines().count(), 41);
}

#[test]
fn reads_directions_of_cw_ccw_pulses_and_encoders() {
    let file = dump(&["CW", "CCW"], 0, &[&pulses(1000, 20, 100, 5), &pulses(5000, 12, 100, 5)]);
    for options in [&[][..], &["--map", "CW0=CW,CCW0=CCW"]] {
        let out = report(&file, &[options, &["--driver", "drv8825", "--strict"]].concat());
        assert_contains(
            &out,
            &[
                "channel 0  32 steps: 20 right, 12 left, 1 turn; position 8 (0 to 20)",
                "step_high           1900         5000",
            ],
        );
    }
    let (a, b): (Vec<u64>, Vec<u64>) =
        ((0..10).map(|k| 100 + 20 * k).collect(), (0..10).map(|k| 110 + 20 * k).collect());
    let file = dump(&["ENC_A", "ENC_B"], 0, &[&a, &b]);
    assert_contains(
        &report(&file, &[]),
        &["map       A0=top.ENC_A,B0=top.ENC_B ", "channel 0  20 steps: 20 right"],
    );
    assert_contains(
        &report(&file, &["--map", "A0=ENC_B,B0=ENC_A"]),
        &["channel 0  20 steps: 0 right, 20 left"],
    );
    let at_once =
        dump(&["ENC_A", "ENC_B"], 0, &[&a, &[&b[..], &[400]].concat()]).replace("#400\n", "#400\n1c0\n");
    assert_contains(&report(&at_once, &[]), &["1 change of an encoder or of CW and CCW counts no step"]);
}

#[test]
fn proposes_a_shared_dir_by_name_and_by_behavior() {
    let (x, y) = (pulses(100, 50, 100, 10), pulses(140, 50, 100, 10));
    for (names, map) in [
        (["X_STEP", "DIR", "Y_STEP"], "STEP0=top.X_STEP,STEP1=top.Y_STEP,DIR0=top.DIR,DIR1=top.DIR"),
        (["X_STEP", "D1", "Y_STEP"], "STEP0=top.X_STEP,STEP1=top.Y_STEP,DIR0=top.D1,DIR1=top.D1"),
    ] {
        let file = dump(&names, 0b10, &[&x, &[2575], &y]);
        let proposed = report(&file, &[]);
        assert_eq!(
            report(&file, &["--map", map]).replace(map, ""),
            proposed.replace(&format!("{map}   (proposed; --map sets another)"), "")
        );
        assert_contains(
            &proposed,
            &["channel 0  50 steps: 25 right, 25 left", "channel 1  50 steps: 25 right, 25 left"],
        );
    }
}

#[test]
fn inverts_or_reports_low_pulses() {
    let step = pulses(100, 20, 100, 5);
    let out = report(&dump(&["PUL-"], 1, &[&step]), &["--steps", "-"]);
    assert!(out.lines().nth(1).is_some_and(|row| row.starts_with("100,")), "{out}");
    assert_contains(
        &report(&dump(&["STEP"], 1, &[&step]), &[]),
        &["STEP0 idles high and has low pulses", "use STEP0=!top.STEP in the map"],
    );
}

#[test]
fn suggested_maps_are_valid_for_any_channel_names() {
    for (name, map) in [("Channel 0", "DEDGE0=Channel 0"), ("!STEP", "DEDGE0=#0")] {
        let rows: String = (0..40).map(|k| format!("0.{:06},{}\n", 10 * k, k % 2)).collect();
        let table = format!("Time [s],\"{name}\"\n{rows}");
        let out = report(&table, &["--map", "STEP0=#0"]);
        assert_contains(&out, &[&format!("for such a driver use --both-edges, or {map} in the map\n")]);
        assert_contains(&report(&table, &["--map", map]), &[&format!("map       {map}\n")]);
        let low: String = (0..20).map(|k| format!("0.{:06},1\n0.{:06},0\n", 10 * k, 10 * k + 9)).collect();
        let map = map.replace("DEDGE0=", "STEP0=!");
        let low = format!("Time [s],\"{name}\"\n{low}0.000200,1\n");
        let out = report(&low, &["--map", "STEP0=#0"]);
        assert_contains(&out, &[&format!("use {map} in the map\n")]);
    }
    let (code, _, err) = stepscope(&["capture", "-"], "Time [s],A\n0,0\n1,1\n2,0\n");
    assert!(code == Some(2) && err.contains("the channels are A; use a map, such as --map STEP0=A"), "{err}");
}

#[test]
fn maps_any_of_more_than_64_signals() {
    let names: Vec<String> = (0..70).map(|at| format!("w{at}")).chain(["STEP".to_owned()]).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let (step, other) = (pulses(100, 30, 10, 2), pulses(100, 12, 10, 2));
    let edges: Vec<&[u64]> = (0..71)
        .map(|at| {
            if at == 70 {
                &step[..]
            } else if at == 69 {
                &other[..]
            } else {
                &[]
            }
        })
        .collect();
    let file = dump(&names, 0, &edges);
    assert_contains(
        &report(&file, &[]),
        &["map       STEP0=top.STEP ", "channel 0  30 steps", "7 of 71 channels left out (top.w64"],
    );
    for name in ["top.w69", "w69"] {
        assert_contains(&report(&file, &["--map", &format!("STEP0={name}")]), &["channel 0  12 steps"]);
    }
    let (code, _, err) = stepscope(&["capture", "-", "--map", "STEP0=w71"], &file);
    assert!(code == Some(2) && err.contains("there is no channel w71; use one of top.w0, "), "{err}");
    assert!(err.contains(" and 44 more"), "{err}");
}
