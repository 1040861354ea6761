//! Reads a scenario from JSON and finds every field of the wrong type at once.
//!
//! serde stops at the first error. So the offending value is taken out of the JSON, its default
//! takes its place, and the reading begins again, until it succeeds.

use super::{
    Cause, Problem, Scenario, VERSION, compact,
    judge::MOST_PROBLEMS,
    tracked::{self, Step},
};
use alloc::{
    string::{String, ToString},
    vec::Vec,
};
use serde_json::Value;

impl Scenario {
    /// Reads a scenario from JSON text of any version up to [`VERSION`].
    ///
    /// # Errors
    /// Every field of the wrong type or name, with its path; ranges are judged by
    /// [`Scenario::check`].
    pub fn from_json(text: &str) -> Result<Self, Vec<Problem>> {
        Self::strictly(parse(text)?)
    }

    /// Reads a scenario whose version stands elsewhere, as in a link.
    ///
    /// # Errors
    /// As [`Self::from_json`].
    pub fn from_json_of(text: &str, version: u64) -> Result<Self, Vec<Problem>> {
        let mut value = parse(text)?;
        if let Some(map) = value.as_object_mut() {
            map.insert("version".into(), version.into());
        }
        Self::strictly(value)
    }

    fn strictly(value: Value) -> Result<Self, Vec<Problem>> {
        let (scenario, problems) = read(upgrade(value)?);
        if problems.is_empty() { Ok(scenario) } else { Err(problems) }
    }

    /// Reads what can be read and lists the rest: fields that cannot be read have their defaults.
    #[must_use]
    pub fn from_json_lenient(text: &str) -> (Self, Vec<Problem>) {
        match parse(text).and_then(upgrade) {
            Ok(value) => read(value),
            Err(problems) => (Self::default(), problems),
        }
    }

    /// The whole scenario as JSON, every field written.
    #[must_use]
    pub fn to_json(&self) -> String {
        let mut text = String::new();
        compact::write_whole(&mut text, self, 0);
        text
    }
}

/// The name of a list that stands in another.
const NUMBERS: &str = "[]";

fn parse(text: &str) -> Result<Value, Vec<Problem>> {
    // Some editors put a byte order mark before the text.
    serde_json::from_str(text.trim_start_matches('\u{feff}')).map_err(|error| {
        let (line, column) = (error.line(), error.column());
        let detail = error.to_string();
        let detail = detail.split(" at line ").next().unwrap_or_default().into();
        alloc::vec![Problem::new("", Cause::Syntax { line, column, detail })]
    })
}

/// Brings a scenario of any older version to [`VERSION`], one version a step; a step that was
/// published is never removed.
fn upgrade(value: Value) -> Result<Value, Vec<Problem>> {
    match value.get("version").and_then(Value::as_u64) {
        Some(given) if given > u64::from(VERSION) => {
            Err(alloc::vec![Problem::new("version", Cause::NewerVersion { given, newest: VERSION })])
        }
        _ => Ok(value),
    }
}

fn read(mut value: Value) -> (Scenario, Vec<Problem>) {
    let mut problems: Vec<Problem> = Vec::new();
    for _ in 0..MOST_PROBLEMS {
        if problems.len() >= MOST_PROBLEMS {
            break;
        }
        let (path, error) = match tracked::read(&value) {
            Ok(scenario) => return (scenario, problems),
            Err(wrong) => wrong,
        };
        let at = print(&path);
        // What is left of a choice whose only value was taken out is no new problem.
        if !problems.iter().any(|earlier| earlier.path.len() > at.len() && earlier.path.starts_with(&at)) {
            problems.push(Problem::new(at, Cause::Type { detail: in_words(&error.to_string()) }));
        }
        if !put_right(&mut value, &path, "") {
            break;
        }
    }
    (Scenario::default(), problems)
}

/// serde's message without Rust's names for types.
fn in_words(message: &str) -> String {
    const CHOICE: &str = "expected a map of one key that names the choice, such as {\"mm\": 250}";
    const WORDS: [(&str, &str); 10] = [
        ("expected u8", "expected a whole number from 0 to 255"),
        ("expected u16", "expected a whole number from 0 to 65535"),
        ("expected u32", "expected a whole number from 0 to 4294967295"),
        ("expected u64", "expected a whole number from 0 to 18446744073709551615"),
        ("expected i64", "expected a whole number from -9223372036854775808 to 9223372036854775807"),
        ("expected f64", "expected a number"),
        ("expected struct ", "expected a map of names and values for "),
        ("expected map with a single key", CHOICE),
        ("unit variant, expected newtype variant", CHOICE),
        ("expected string or map", "expected a word or a map of one key"),
    ];
    match WORDS.iter().find(|(rust, _)| message.contains(rust)) {
        Some((rust, words)) => message.replace(rust, words),
        None => message.into(),
    }
}

/// The value one step further in.
fn value_in<'v>(value: &'v mut Value, step: &Step) -> Option<&'v mut Value> {
    match step {
        Step::Key(key) => value.get_mut(key),
        Step::Index(index) => value.get_mut(index),
    }
}

/// Takes out the value at the longest part of `path` that exists, so that its default takes its
/// place; in the list `list`, an entry is replaced by a default one, so that the others keep their
/// places. False if nothing of the path exists.
fn put_right(value: &mut Value, path: &[Step], list: &str) -> bool {
    let Some((step, rest)) = path.split_first() else { return false };
    // What a list in a list holds are numbers: the points of a curve.
    let name = match step {
        Step::Key(key) => key,
        Step::Index(_) => NUMBERS,
    };
    if value_in(value, step).is_some_and(|inner| put_right(inner, rest, name)) {
        return true;
    }
    match (step, value) {
        (Step::Key(key), Value::Object(map)) => map.remove(key).is_some(),
        (Step::Index(index), Value::Array(entries)) => entries.get_mut(*index).is_some_and(|entry| {
            let default = match list {
                "moves" | "segments" => serde_json::json!({ "dwell": {} }),
                "packets" => Value::from(""),
                "points" => serde_json::json!([0, 0]),
                NUMBERS => Value::from(0),
                _ => serde_json::json!({}),
            };
            core::mem::replace(entry, default.clone()) != default
        }),
        _ => false,
    }
}

fn print(path: &[Step]) -> String {
    let mut text = String::new();
    for step in path {
        match step {
            Step::Key(key) => {
                if !text.is_empty() {
                    text.push('.');
                }
                text.push_str(key);
            }
            Step::Index(index) => text.push_str(&alloc::format!("[{index}]")),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::format;

    fn paths(text: &str) -> Vec<String> {
        Scenario::from_json_lenient(text).1.into_iter().map(|p| p.path).collect()
    }

    #[test]
    fn every_field_of_a_wrong_type_is_listed_with_its_path() {
        let rows: &[(&str, &[&str])] = &[
            ("{}", &[]),
            ("[]", &[""]),
            (r#"{"bus":[4],"source":{"motion":{"axes":[[]]}}}"#, &["bus", "source.motion.axes[0]"]),
            ("{", &[""]),
            (r#"{"version":2}"#, &["version"]),
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
    fn a_hundred_problems_are_enough() {
        for wrong in ["[],", "7,"] {
            let axes = wrong.repeat(300);
            let text = format!(r#"{{"source":{{"motion":{{"axes":[{axes}{{}}]}}}}}}"#);
            assert_eq!(paths(&text).len(), MOST_PROBLEMS, "{wrong}");
        }
    }

    #[test]
    fn what_can_be_read_is_kept_beside_a_wrong_field() {
        let (scenario, problems) = Scenario::from_json_lenient(r#"{"title":"kept","clock_hz":"x"}"#);
        assert_eq!(scenario.title, "kept");
        assert_eq!(problems.len(), 1);
        assert!(format!("{}", problems[0]).starts_with("clock_hz: "));
        // A list in a map's place leaves nothing behind, though serde could read it by its order.
        let (scenario, problems) = Scenario::from_json_lenient(r#"{"title":"kept","bus":[7]}"#);
        assert_eq!((scenario.title.as_str(), scenario.bus.channels, problems.len()), ("kept", 1, 1));
        assert_eq!(Scenario::from_json_lenient("[2]").0, Scenario::default());
    }
}
