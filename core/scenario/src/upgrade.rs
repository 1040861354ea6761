//! Names of earlier format versions. They are never removed, so every old file and link still opens.

use crate::schema::Group;

/// A name that a later version of the format replaced.
pub(crate) struct Rename {
    pub(crate) old: &'static str,
    pub(crate) new: &'static str,
    /// Newest version in which the old name is accepted.
    pub(crate) last_version: u32,
}

const fn until(last_version: u32, old: &'static str, new: &'static str) -> Rename {
    Rename { old, new, last_version }
}

/// Fields. An old name is accepted where a group has the new name and not the old one.
pub(crate) const FIELDS: &[Rename] = &[
    until(1, "driver", "driver_timing"),
    until(1, "pulses", "pulse_phasing"),
    until(1, "ticks_a_frame", "ticks_per_frame"),
    until(1, "doubled_bytes_ppm", "duplicated_bytes_ppm"),
    until(1, "deaths_ppm", "host_crashes_ppm"),
    until(2, "acceleration", "max_acceleration"),
    until(2, "attempts", "max_attempts"),
    until(2, "blank_us", "blanking_time_us"),
    until(2, "boot_cycles", "self_test_cycles"),
    until(2, "coupling_n_m_rad", "coupling_N_m_rad"),
    until(2, "coupling_un_m_s", "coupling_uN_m_s"),
    until(2, "decay_share", "fast_decay_fraction"),
    until(2, "detent_torque_mn_m", "detent_torque_mN_m"),
    until(2, "dir", "direction"),
    until(2, "drive", "driver"),
    until(2, "friction_mn_m", "friction_mN_m"),
    until(2, "gravity_torque_mn_m", "gravity_torque_mN_m"),
    until(2, "hard_max", "hard_max_steps"),
    until(2, "hard_min", "hard_min_steps"),
    until(2, "holding_torque_mn_m", "holding_torque_mN_m"),
    until(2, "home_from", "home_from_steps"),
    until(2, "home_to", "home_to_steps"),
    until(2, "least_trust", "required_position"),
    until(2, "level", "acceleration_level"),
    until(2, "load_torque_mn_m", "load_torque_mN_m"),
    until(2, "max_switch_at", "max_switch_at_steps"),
    until(2, "min_switch_at", "min_switch_at_steps"),
    until(2, "off_us", "off_time_us"),
    until(2, "order", "max_harmonic"),
    until(2, "regulator", "current_control"),
    until(2, "sine_torque_mn_m", "sine_torque_mN_m"),
    until(2, "stiction_mn_m", "stiction_mN_m"),
    until(2, "top_speed", "max_speed"),
    until(2, "travel_steps", "max_travel_steps"),
    until(2, "viscous_un_m_s", "viscous_uN_m_s"),
];

/// Words of choices, and the numbers that words replaced. Directions may be numbers in every version.
pub(crate) const WORDS: &[Rename] = &[
    until(2, "turn_round", "reverse"),
    until(2, "document", "at_start_speed"),
    until(2, "0", "lost"),
    until(2, "1", "restored"),
    until(2, "2", "confirmed"),
    until(u32::MAX, "0", "negative"),
    until(u32::MAX, "1", "positive"),
];

pub(crate) fn renamed_field(old: &str, group: &Group) -> Option<&'static Rename> {
    let has = |name: &str| group.fields.iter().any(|field| field.name == name);
    FIELDS.iter().find(|rename| rename.old == old && has(rename.new) && !has(old))
}

#[cfg(test)]
mod tests {
    use super::{FIELDS, Rename, WORDS, renamed_field};
    use crate::{
        Scenario, VERSION,
        schema::{Field, Group, Type, Typed},
    };
    use alloc::{
        borrow::ToOwned,
        collections::BTreeSet,
        format,
        string::{String, ToString},
        vec::Vec,
    };

    struct Position {
        rename: &'static Rename,
        /// The scenario before and after the fields of the group, or the word.
        around: (String, String),
        /// The field's value; `None` for a word.
        value: Option<String>,
    }

    impl Position {
        fn new(rename: &'static Rename, around: &dyn Fn(&str) -> String, value: Option<String>) -> Self {
            let marked = around("MARK");
            let (before, after) = marked.split_once("MARK").expect("the mark");
            Self { rename, around: (before.into(), after.into()), value }
        }

        /// The scenario with these names, without a version.
        fn with(&self, names: &[&str]) -> String {
            let text = |name: &&str| match &self.value {
                Some(value) => format!("\"{name}\":{value}"),
                None if name.parse::<u32>().is_ok() => name.to_string(),
                None => format!("\"{name}\""),
            };
            let texts: Vec<String> = names.iter().map(text).collect();
            format!("{}{}{}", self.around.0, texts.join(","), self.around.1)
        }

        fn old(&self) -> String {
            self.with(&[self.rename.old])
        }

        fn new_name(&self) -> String {
            self.with(&[self.rename.new])
        }
    }

    /// Finds every position of a renamed name. `around` puts a group's JSON into a scenario.
    fn collect(group: &'static Group, around: &dyn Fn(&str) -> String, found: &mut Vec<Position>) {
        for field in group.fields {
            for rename in FIELDS.iter().filter(|rename| rename.new == field.name && !group.is_choice) {
                if renamed_field(rename.old, group).is_some() {
                    let fields = |fields: &str| around(&format!("{{{fields}}}"));
                    found.push(Position::new(rename, &fields, Some(other_value(group, field))));
                }
            }
            let inside = |json: &str| around(&format!(r#"{{"{}":{json}}}"#, field.name));
            collect_in_type(&field.ty, &inside, found);
        }
    }

    fn collect_in_type(ty: &'static Type, around: &dyn Fn(&str) -> String, found: &mut Vec<Position>) {
        match ty {
            Type::Group(group) => collect(group, around, found),
            Type::Optional(inner) => collect_in_type(inner, around, found),
            Type::List(inner) => collect_in_type(inner, &|json| around(&format!("[{json}]")), found),
            Type::Word(words) => {
                for rename in WORDS.iter().filter(|rename| words.iter().any(|word| word.name == rename.new)) {
                    found.push(Position::new(rename, around, None));
                }
            }
            _ => {}
        }
    }

    /// A value that differs from the field's default.
    fn other_value(group: &'static Group, field: &'static Field) -> String {
        let default = crate::compact::value_of((group.blank)().parts(), crate::compact::Fields::All);
        let default = default.get(field.name).map(ToString::to_string);
        let candidates = match field.ty {
            Type::Word(words) => words.iter().map(|word| format!("\"{}\"", word.name)).collect(),
            Type::Group(group) if group.is_choice => {
                Vec::from([format!(r#"{{"{}":77}}"#, group.fields[0].name), r#"{"preset":"a4979"}"#.into()])
            }
            Type::Group(_) => Vec::from([r#"{"bridge_ohm":0.5}"#.into()]),
            Type::Optional(Type::Group(group)) if matches!(group.fields[0].ty, Type::Number) => {
                Vec::from([format!(r#"{{"{}":77}}"#, group.fields[0].name)])
            }
            Type::Optional(Type::Group(_)) => Vec::from([r#"{"preset":"a4979"}"#.into()]),
            _ => Vec::from(["7".into()]),
        };
        candidates.into_iter().find(|value| Some(value) != default.as_ref()).expect("another value")
    }

    fn every_position() -> Vec<Position> {
        let Type::Group(root) = Scenario::TYPE else { panic!("a group") };
        let mut found = Vec::new();
        collect(root, &str::to_owned, &mut found);
        found
    }

    fn of_version(json: &str, version: u32) -> String {
        format!(r#"{{"version":{version},{}"#, &json[1..])
    }

    #[test]
    fn old_and_new_names_read_as_the_same_scenario() {
        let (mut seen, positions) = (BTreeSet::new(), every_position());
        for position in &positions {
            let Rename { old, new, last_version } = *position.rename;
            seen.insert((old, new));
            let (old, new) = (position.old(), position.new_name());
            let expected = Scenario::from_json(&of_version(&new, VERSION)).expect(&new);
            assert_eq!(expected.version, VERSION);
            assert_eq!(Scenario::from_json(&old).as_ref(), Ok(&expected), "{old}");
            assert_eq!(Scenario::from_json(&new).as_ref(), Ok(&expected), "{new}");
            for version in 1..=VERSION.min(last_version) {
                assert_eq!(Scenario::from_json(&of_version(&old, version)).as_ref(), Ok(&expected), "{old}");
                assert_eq!(Scenario::from_json_of(&old, version.into()).as_ref(), Ok(&expected), "{old}");
            }
            assert_eq!(Scenario::from_json(&expected.to_json()).as_ref(), Ok(&expected), "{new}");
        }
        assert_eq!(seen.len(), FIELDS.len() + WORDS.len(), "names without a position");
        assert!(positions.len() > 100, "{} positions", positions.len());
    }

    #[test]
    fn later_versions_refuse_the_old_name_and_state_the_new_one() {
        for position in every_position() {
            let Rename { new, last_version, .. } = position.rename;
            for version in last_version.saturating_add(1)..=VERSION {
                let json = of_version(&position.old(), version);
                let problems = Scenario::from_json(&json).expect_err(&json);
                assert_eq!(problems.len(), 1, "{json}: {problems:?}");
                let message = problems[0].to_string();
                assert!(message.contains(&format!("; use {new}, its name since")), "{message}");
            }
        }
    }

    #[test]
    fn if_both_names_are_given_the_old_one_is_refused() {
        for position in every_position().iter().filter(|position| position.value.is_some()) {
            let Rename { old, new, .. } = *position.rename;
            for names in [[old, new], [new, old]] {
                let both = position.with(&names);
                let (read, problems) = Scenario::from_json_lenient(&both);
                let problems = problems.expect("a duplicate field");
                assert_eq!(problems.len(), 1, "{both}: {problems:?}");
                let problem = problems[0].to_string();
                let expected = format!("{old}: duplicate field: {new} is its new name; use one of them");
                assert!(problem.ends_with(&expected), "{both}: {problem}");
                assert_eq!(Scenario::from_json(&position.new_name()), Ok(read), "{both}");
            }
        }
    }

    #[test]
    fn values_of_a_wrong_type_are_reported_at_the_new_name() {
        for (given, path) in [
            (r#"{"driver":5}"#, "driver_timing"),
            (r#"{"bus":[{"pulses":1}]}"#, "bus"),
            (r#"{"line":{"noise":"deaths_ppm"}}"#, "line.noise"),
            (r#"{"controllers":{"bus":{"pulses":"staggered"}}}"#, "controllers"),
            (r#"{"analysis":{"order":"x"}}"#, "analysis.max_harmonic"),
        ] {
            let problems = Scenario::from_json(given).expect_err(given);
            assert_eq!(problems.len(), 1, "{given}");
            assert_eq!(problems[0].path, path, "{given}");
        }
    }
}
