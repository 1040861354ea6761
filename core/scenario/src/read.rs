//! Reads scenarios of any version from JSON text, and writes them.

use crate::{
    Cause, Compact, Json, MAX_TEXT_BYTES, Problem, Problems, ReadJson, Scenario, ToParts, VERSION, compact,
    reader::read_into,
};
use alloc::string::{String, ToString};
use core::str::FromStr;
use stepscope_motion::MAX_PROBLEMS;

/// Maximum bytes of a text with every field written; longer ones omit defaults.
const MAX_WHOLE_BYTES: usize = 4 << 20;
/// The version of a text without one: the names of all versions are accepted.
const ANY_VERSION: u32 = 1;

impl Scenario {
    /// Reads a scenario of any version up to [`VERSION`].
    /// Errors: every unknown or duplicate field and every wrong type. [`Scenario::check`] checks ranges.
    pub fn from_json(text: &str) -> Result<Self, Problems> {
        without_problems(read(text, None))
    }

    /// Reads a scenario whose version is known from elsewhere, such as a link.
    /// Errors: as [`Self::from_json`].
    pub fn from_json_of(text: &str, version: u64) -> Result<Self, Problems> {
        without_problems(read(text, Some(version)))
    }

    /// Reads as much as possible; unreadable fields get their defaults.
    pub fn from_json_lenient(text: &str) -> (Self, Option<Problems>) {
        read(text, None)
    }

    /// All fields as JSON.
    pub fn to_json(&self) -> String {
        to_json(self)
    }

    /// All fields as JSON, or without defaults and indentation if that is too long. `None` if that exceeds
    /// [`MAX_TEXT_BYTES`] as well.
    pub fn to_file_json(&self) -> Option<String> {
        self.to_json_within(MAX_WHOLE_BYTES, MAX_TEXT_BYTES)
    }

    fn to_json_within(&self, max_whole: usize, max_short: usize) -> Option<String> {
        let mut text = String::new();
        compact::write_whole(&mut text, self, 0, max_whole);
        if text.len() > max_whole {
            text.clear();
            compact::write_short(&mut text, self, max_short);
        }
        (text.len() <= max_short).then_some(text)
    }

    /// Canonical JSON, as in a link.
    pub fn to_compact_json(&self) -> String {
        self.compact().to_string()
    }
}

fn without_problems((scenario, problems): (Scenario, Option<Problems>)) -> Result<Scenario, Problems> {
    problems.map_or(Ok(scenario), Err)
}

/// As [`Scenario::from_json`].
impl FromStr for Scenario {
    type Err = Problems;

    fn from_str(json: &str) -> Result<Self, Problems> {
        Self::from_json(json)
    }
}

/// Reads a part of a scenario, such as an axis or a move. A part has no version, so names of all versions are accepted.
/// Errors: every field of the wrong type or name, with its path in the part.
pub fn part_from_json<T: ReadJson>(text: &str) -> Result<T, Problems> {
    let mut part = T::blank();
    read_into(&mut part, parse(text)?, ANY_VERSION).map_or(Ok(part), Err)
}

/// Writes a part of a scenario as JSON, every field included.
pub fn to_json(part: &dyn ToParts) -> String {
    let mut text = String::new();
    compact::write_whole(&mut text, part, 0, usize::MAX);
    text
}

fn parse(text: &str) -> Result<Json<'_>, Problems> {
    // Some editors write a byte order mark.
    Json::parse(text.trim_start_matches('\u{feff}')).map_err(|error| {
        let (line, column) = (error.line(), error.column());
        let detail = error.to_string();
        let detail = detail.split(" at line ").next().unwrap_or_default().into();
        Problem::new("", Cause::Syntax { line, column, detail }).into()
    })
}

/// The version in the text; `None` if it cannot be read.
fn given_version(value: Json<'_>) -> Option<u64> {
    let mut given = None;
    if value.is_map() {
        value.members(&mut |name, value| {
            if name == "version" {
                given.get_or_insert(value);
            }
        });
    }
    match given.map(Json::whole) {
        None => Some(ANY_VERSION.into()),
        Some(Some((false, version))) => Some(version),
        Some(_) => None,
    }
}

/// A `known` version overrides the text's. Reads nothing if there are too many problems.
fn read(text: &str, known: Option<u64>) -> (Scenario, Option<Problems>) {
    let value = match parse(text) {
        Ok(value) => value,
        Err(problems) => return (Scenario::default(), Some(problems)),
    };
    let given = known.or_else(|| given_version(value));
    if let Some(given) = given.filter(|given| *given > u64::from(VERSION)) {
        let newer = Problem::new("version", Cause::NewerVersion { given, newest: VERSION });
        return (Scenario::default(), Some(newer.into()));
    }
    let mut scenario = Scenario::default();
    // An unreadable version is reported by `read_into`; then the newest version's names apply.
    let version = given.map_or(VERSION, |given| given as u32);
    let mut problems = read_into(&mut scenario, value, version);
    if known.is_some() {
        let others = problems.into_iter().flatten().filter(|problem| problem.path != "version");
        problems = Problems::new(others.collect());
    }
    if (1..VERSION).contains(&version) || known.is_some() {
        scenario.version = VERSION;
    }
    let count = problems.as_ref().map_or(0, |problems| problems.len());
    let read = if count < MAX_PROBLEMS { scenario } else { Scenario::default() };
    (read, problems)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{format, vec::Vec};

    fn paths(text: &str) -> Vec<String> {
        Scenario::from_json_lenient(text).1.into_iter().flatten().map(|p| p.path).collect()
    }

    #[test]
    fn every_field_of_a_wrong_type_is_listed_with_its_path() {
        let rows: &[(&str, &[&str])] = &[
            ("{}", &[]),
            ("[]", &[""]),
            (r#"{"bus":[4],"source":{"motion":{"axes":[[]]}}}"#, &["bus", "source.motion.axes[0]"]),
            ("{", &[""]),
            (r#"{"version":4}"#, &["version"]),
            (
                r#"{"bus":{"slots":"x","channels":-1},"clock_hz":1.5}"#,
                &["bus.channels", "bus.slots", "clock_hz"],
            ),
            (r#"{"bus":{"slot":3,"channels":-1},"clok_hz":1}"#, &["bus.channels", "bus.slot", "clok_hz"]),
            (
                r#"{"source":{"motion":{"axes":[{"moves":[{"cosine":{"ramp_s":"a"}},{"dwel":{}},{"dwell":{"duration_s":[]}}]},{"mechanics":{"screw":{"lead_mm":{}}}}]}}}"#,
                &[
                    "source.motion.axes[0].moves[0].cosine.ramp_s",
                    "source.motion.axes[0].moves[1]",
                    "source.motion.axes[0].moves[2].dwell.duration_s",
                    "source.motion.axes[1].mechanics.screw.lead_mm",
                ],
            ),
            (
                r#"{"source":{"motion":{"axes":[{"moves":[{"cosine":5},{"dwel":{}},5]},7]}}}"#,
                &[
                    "source.motion.axes[0].moves[0].cosine",
                    "source.motion.axes[0].moves[1]",
                    "source.motion.axes[0].moves[2]",
                    "source.motion.axes[1]",
                ],
            ),
            (
                r#"{"source":{"motion":{"axes":[{"moves":[{"points":{"points":[[0,0],"x",[1,"y"],[1,2,3],[2,1]]}}]}]}}}"#,
                &[
                    "source.motion.axes[0].moves[0].points.points[1]",
                    "source.motion.axes[0].moves[0].points.points[2][1]",
                    "source.motion.axes[0].moves[0].points.points[3]",
                ],
            ),
            (
                r#"{"source":{"packets":{"packets":["00",1,"zz","0"]}}}"#,
                &["source.packets.packets[1]", "source.packets.packets[2]", "source.packets.packets[3]"],
            ),
            (
                r#"{"source":{"motion":{"axes":[{"moves":[{"cosine":{"distance":{"mm":"x"}}}]}]}}}"#,
                &["source.motion.axes[0].moves[0].cosine.distance.mm"],
            ),
        ];
        for (given, expected) in rows {
            let mut expected = expected.to_vec();
            let mut found = paths(given);
            found.sort();
            expected.sort_unstable();
            assert_eq!(found, expected, "{given}");
        }
    }

    #[test]
    fn hints_fit_the_context() {
        let rows = [
            (
                r#"{"source":{"segments":{"channels":[{"segments":[5]}]}}}"#,
                "source.segments.channels[0].segments[0]: 5 is not valid; use an object with one key (steps, dwell), such as {\"steps\": {\u{2026}}}",
            ),
            (
                r#"{"source":{"motion":{"axes":[{"moves":[{"constant":{"distance":5}}]}]}}}"#,
                "source.motion.axes[0].moves[0].constant.distance: 5 is not valid; use an object with one key (steps, mm, deg), such as {\"steps\": 250}",
            ),
            (
                r#"{"source":{"packet":{}}}"#,
                "source: unknown kind \u{201c}packet\u{201d}; use one of motion, packets, line, standalone, segments",
            ),
            (
                r#"{"bus":{"slot":3}}"#,
                "bus.slot: unknown field; use one of channels, slots, step_period_cycles, pulse_width_cycles, dir_setup_cycles, dir_hold_cycles, distribution, dir_line, pulse_phasing, settle_cycles, queue_depth, self_test_cycles",
            ),
        ];
        for (json, expected) in rows {
            let problems = Scenario::from_json(json).expect_err(json);
            assert_eq!(problems[0].to_string(), expected);
        }
    }

    #[test]
    fn long_files_are_written_without_defaults() {
        let texts = [
            "{}",
            r#"{"title":"ü\u001b","source":{"segments":{"channels":[{"segments":[{"steps":{"add_q16":-12}},{"dwell":{}}]},{}]}}}"#,
            r#"{"source":{"motion":{"axes":[{"moves":[{"points":{"points":[[0,0],[0.5,12.5]]}}]}]}}}"#,
            r#"{"source":{"line":{"sends":[{"start_cycle":7,"bytes":"8a05"},{"start_cycle":9000}]}}}"#,
        ];
        for text in texts {
            let scenario = Scenario::from_json(text).expect("it reads");
            assert_eq!(scenario.to_file_json(), Some(scenario.to_json()));
            let short = scenario.to_json_within(10, 4096).expect("it is short");
            assert!(
                short.len() < scenario.to_json().len() / 2 && short.starts_with(r#"{"version":3"#),
                "{short}"
            );
            assert_eq!(Scenario::from_json(&short), Ok(scenario.clone()));
            assert_eq!(scenario.to_json_within(10, short.len()), Some(short.clone()));
            assert_eq!(scenario.to_json_within(10, short.len() - 1), None);
        }
        let points = Scenario::from_json(texts[2]).expect("it reads");
        assert!(
            points
                .to_json_within(10, 4096)
                .is_some_and(|short| short.contains("[\n[0.0,0.0],\n[0.5,12.5]\n]"))
        );
    }

    #[test]
    fn a_hundred_problems_are_enough() {
        for wrong in ["[],", "7,"] {
            let axes = wrong.repeat(300);
            let text = format!(r#"{{"source":{{"motion":{{"axes":[{axes}{{}}]}}}}}}"#);
            assert_eq!(paths(&text).len(), MAX_PROBLEMS, "{wrong}");
        }
    }

    #[test]
    fn valid_fields_are_read_next_to_a_wrong_one() {
        let (scenario, problems) = Scenario::from_json_lenient(r#"{"title":"title","clock_hz":"x"}"#);
        assert_eq!(scenario.title, "title");
        let problems = problems.expect("a wrong field");
        assert_eq!(problems.len(), 1);
        assert!(format!("{}", problems[0]).starts_with("clock_hz: "));
        // serde would read the list as fields in order.
        let (scenario, problems) = Scenario::from_json_lenient(r#"{"title":"title","bus":[7]}"#);
        assert_eq!(
            (scenario.title.as_str(), scenario.bus.channels, problems.map_or(0, |p| p.len())),
            ("title", 1, 1)
        );
        assert_eq!(Scenario::from_json_lenient("[2]").0, Scenario::default());
    }
}
