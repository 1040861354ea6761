//! Names of earlier format versions. They are never removed, so every old file and link still opens. An old name is
//! accepted only where the new field exists.

/// Old and new field names.
pub(crate) const FIELDS: &[(&str, &str)] = &[
    ("driver", "driver_timing"),
    ("pulses", "pulse_phasing"),
    ("ticks_a_frame", "ticks_per_frame"),
    ("doubled_bytes_ppm", "duplicated_bytes_ppm"),
    ("deaths_ppm", "host_crashes_ppm"),
];

/// Old and new words of choices.
pub(crate) const WORDS: &[(&str, &str)] = &[("turn_round", "reverse")];

#[cfg(test)]
mod tests {
    use crate::{Scenario, VERSION};
    use alloc::{format, string::String, vec::Vec};

    const AXES: &str =
        r#"[{"moves":[{"staircase":{"short_move":"SHORT"}},{"dwell":{}}]},{"moves":[{"staircase":{}}]}]"#;

    const RENAMED: [(&str, &str); 8] = [
        (r#"{"driver":{"preset":"a4988"}}"#, r#"{"driver_timing":{"preset":"a4988"}}"#),
        (
            r#"{"driver":{"rules":{"step_high_ns":5}},"title":"title"}"#,
            r#"{"driver_timing":{"rules":{"step_high_ns":5}},"title":"title"}"#,
        ),
        (r#"{"bus":{"pulses":"staggered"}}"#, r#"{"bus":{"pulse_phasing":"staggered"}}"#),
        (
            r#"{"controllers":[{},{"bus":{"pulses":"staggered","slots":7}}]}"#,
            r#"{"controllers":[{},{"bus":{"pulse_phasing":"staggered","slots":7}}]}"#,
        ),
        (r#"{"line":{"host":{"ticks_a_frame":3}}}"#, r#"{"line":{"host":{"ticks_per_frame":3}}}"#),
        (r#"{"line":{"noise":{"doubled_bytes_ppm":5}}}"#, r#"{"line":{"noise":{"duplicated_bytes_ppm":5}}}"#),
        (r#"{"line":{"noise":{"deaths_ppm":5}}}"#, r#"{"line":{"noise":{"host_crashes_ppm":5}}}"#),
        ("AXES turn_round", "AXES reverse"),
    ];

    fn rows() -> Vec<(String, String)> {
        let axes = |word: &str| AXES.replace("SHORT", word);
        let mut rows: Vec<(String, String)> = Vec::new();
        for (old, new) in RENAMED {
            let (Some(old_word), Some(new_word)) = (old.strip_prefix("AXES "), new.strip_prefix("AXES "))
            else {
                rows.push((old.into(), new.into()));
                continue;
            };
            for place in [r#"{"source":{"motion":{"axes":AXES}}}"#, r#"{"controllers":[{"axes":AXES}]}"#] {
                rows.push((place.replace("AXES", &axes(old_word)), place.replace("AXES", &axes(new_word))));
            }
        }
        rows
    }

    fn of_version(json: &str, version: u64) -> String {
        format!(r#"{{"version":{version},{}"#, &json[1..])
    }

    #[test]
    fn every_name_of_version_1_is_read_in_every_place() {
        for (old, new) in rows() {
            let expected = Scenario::from_json(&of_version(&new, 2)).expect("version 2 reads");
            assert_ne!(expected, Scenario { title: expected.title.clone(), ..Scenario::default() }, "{new}");
            for given in [old.clone(), of_version(&old, 1), new.clone(), of_version(&new, 1)] {
                assert_eq!(Scenario::from_json(&given).as_ref(), Ok(&expected), "{given}");
            }
            assert_eq!(Scenario::from_json_of(&old, 1).as_ref(), Ok(&expected), "{old} of a link");
            assert_eq!(expected.version, VERSION);
        }
    }

    #[test]
    fn a_file_of_version_2_has_the_new_names_only() {
        for (old, _) in rows() {
            let problems = Scenario::from_json(&of_version(&old, 2)).expect_err("an old name");
            assert_eq!(problems.len(), 1, "{old}: {problems:?}");
        }
    }

    #[test]
    fn if_both_names_are_given_the_new_one_counts_and_the_old_one_is_reported() {
        for (both, path, expected) in [
            (
                r#"{"driver":{"preset":"a4988"},"driver_timing":{"preset":"a4979"}}"#,
                "driver",
                r#"{"driver_timing":{"preset":"a4979"}}"#,
            ),
            (
                r#"{"bus":{"pulses":"simultaneous","pulse_phasing":"staggered"}}"#,
                "bus.pulses",
                r#"{"bus":{"pulse_phasing":"staggered"}}"#,
            ),
            (
                r#"{"controllers":[{"bus":{"pulse_phasing":"staggered","pulses":"simultaneous"}}]}"#,
                "controllers[0].bus.pulses",
                r#"{"controllers":[{"bus":{"pulse_phasing":"staggered"}}]}"#,
            ),
            (
                r#"{"line":{"host":{"ticks_a_frame":3,"ticks_per_frame":4}}}"#,
                "line.host.ticks_a_frame",
                r#"{"line":{"host":{"ticks_per_frame":4}}}"#,
            ),
            (
                r#"{"line":{"noise":{"doubled_bytes_ppm":3,"duplicated_bytes_ppm":4}}}"#,
                "line.noise.doubled_bytes_ppm",
                r#"{"line":{"noise":{"duplicated_bytes_ppm":4}}}"#,
            ),
            (
                r#"{"line":{"noise":{"deaths_ppm":3,"host_crashes_ppm":4}}}"#,
                "line.noise.deaths_ppm",
                r#"{"line":{"noise":{"host_crashes_ppm":4}}}"#,
            ),
        ] {
            let (read, problems) = Scenario::from_json_lenient(both);
            let paths: Vec<&str> = problems.iter().map(|problem| problem.path.as_str()).collect();
            assert_eq!(paths, [path], "{both}");
            assert_eq!(Scenario::from_json(expected), Ok(read), "{both}");
        }
    }

    #[test]
    fn what_is_no_map_is_left_to_the_reader() {
        for (given, path) in [
            (r#"{"driver":5}"#, "driver_timing"),
            (r#"{"bus":[{"pulses":1}]}"#, "bus"),
            (r#"{"line":{"noise":"deaths_ppm"}}"#, "line.noise"),
            (r#"{"controllers":{"bus":{"pulses":"staggered"}}}"#, "controllers"),
        ] {
            let problems = Scenario::from_json(given).expect_err("no scenario");
            assert_eq!(problems.len(), 1, "{given}");
            assert_eq!(problems[0].path, path, "{given}");
        }
    }
}
