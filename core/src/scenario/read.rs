//! Reads a scenario from JSON and finds every field of the wrong type at once.
//!
//! serde stops at the first error. So the offending value is taken out of the JSON (its default
//! takes its place) and the reading begins again, until it succeeds.

use super::{Cause, Problem, Scenario, VERSION};
use alloc::{
    string::{String, ToString},
    vec::Vec,
};
use serde_json::Value;
use serde_path_to_error::Segment;

/// Most wrong fields that one reading lists.
const MOST_PROBLEMS: usize = 100;

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
        serde_json::to_string_pretty(self).unwrap_or_default()
    }
}

fn parse(text: &str) -> Result<Value, Vec<Problem>> {
    serde_json::from_str(text).map_err(|error| {
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
    let mut problems = Vec::new();
    let mut taken: Vec<Vec<Step>> = Vec::new();
    loop {
        match serde_path_to_error::deserialize(&value) {
            Ok(scenario) => {
                lists_for_maps(&value, &serde_json::to_value(&scenario).unwrap_or_default(), &mut |path| {
                    let detail = "a list, where a map of names and values belongs".into();
                    problems.push(Problem::new(print(&original(&path, &taken)), Cause::Type { detail }));
                });
                return (scenario, problems);
            }
            Err(error) => {
                let path: Vec<Step> = error.path().iter().filter_map(Step::of).collect();
                // What is left of a choice or a list whose value was taken out is no new problem.
                if !taken.iter().any(|gone| gone.len() > path.len() && gone.starts_with(&path)) {
                    let at = print(&original(&path, &taken));
                    problems
                        .push(Problem::new(at, Cause::Type { detail: in_words(&error.inner().to_string()) }));
                }
                match take_out(&mut value, &path) {
                    Some(gone) if problems.len() < MOST_PROBLEMS => taken.push(gone),
                    _ => return (Scenario::default(), problems),
                }
            }
        }
    }
}

/// serde's message without Rust's names for types.
fn in_words(message: &str) -> String {
    const WORDS: [(&str, &str); 6] = [
        ("expected u8", "expected a whole number from 0 to 255"),
        ("expected u16", "expected a whole number from 0 to 65535"),
        ("expected u32", "expected a whole number from 0 to 4294967295"),
        ("expected u64", "expected a whole number from 0 on"),
        ("expected f64", "expected a number"),
        ("expected struct ", "expected a map of names and values for "),
    ];
    match WORDS.iter().find(|(rust, _)| message.contains(rust)) {
        Some((rust, words)) => message.replace(rust, words),
        None => message.into(),
    }
}

/// serde also reads a map's fields from a list, by their order; a scenario has names.
fn lists_for_maps(given: &Value, typed: &Value, found: &mut dyn FnMut(Vec<Step>)) {
    match (given, typed) {
        (Value::Array(_), Value::Object(_)) => found(Vec::new()),
        (Value::Object(given), Value::Object(typed)) => {
            for (key, value) in given {
                if let Some(typed) = typed.get(key) {
                    lists_for_maps(value, typed, &mut |path| found(below(Step::Key(key.clone()), path)));
                }
            }
        }
        (Value::Array(given), Value::Array(typed)) => {
            for (index, (value, typed)) in given.iter().zip(typed).enumerate() {
                lists_for_maps(value, typed, &mut |path| found(below(Step::Index(index), path)));
            }
        }
        _ => {}
    }
}

fn below(step: Step, mut path: Vec<Step>) -> Vec<Step> {
    path.insert(0, step);
    path
}

/// One step of a path into JSON.
#[derive(Clone, PartialEq)]
enum Step {
    Key(String),
    Index(usize),
}

impl Step {
    fn of(segment: &Segment) -> Option<Self> {
        match segment {
            Segment::Seq { index } => Some(Self::Index(*index)),
            Segment::Map { key } => Some(Self::Key(key.clone())),
            Segment::Enum { variant } => Some(Self::Key(variant.clone())),
            Segment::Unknown => None,
        }
    }

    fn value_in<'v>(&self, value: &'v mut Value) -> Option<&'v mut Value> {
        match self {
            Self::Key(key) => value.get_mut(key),
            Self::Index(index) => value.get_mut(index),
        }
    }
}

/// Removes the value at the longest part of `path` that exists and returns that part.
fn take_out(value: &mut Value, path: &[Step]) -> Option<Vec<Step>> {
    let (step, rest) = path.split_first()?;
    if let Some(inner) = step.value_in(value)
        && let Some(mut gone) = take_out(inner, rest)
    {
        gone.insert(0, step.clone());
        return Some(gone);
    }
    match (step, value) {
        (Step::Key(key), Value::Object(map)) => map.remove(key).map(|_| ()),
        (Step::Index(index), Value::Array(list)) if *index < list.len() => {
            list.remove(*index);
            Some(())
        }
        _ => None,
    }
    .map(|()| alloc::vec![step.clone()])
}

/// The path as it was before list entries were taken out.
fn original(path: &[Step], taken: &[Vec<Step>]) -> Vec<Step> {
    let mut path = path.to_vec();
    for gone in taken.iter().rev() {
        let Some((Step::Index(gone_index), list)) = gone.split_last() else { continue };
        if path.len() > list.len()
            && path.starts_with(list)
            && let Step::Index(index) = &mut path[list.len()]
            && *index >= *gone_index
        {
            *index += 1;
        }
    }
    path
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
    fn what_can_be_read_is_kept_beside_a_wrong_field() {
        let (scenario, problems) = Scenario::from_json_lenient(r#"{"title":"kept","clock_hz":"x"}"#);
        assert_eq!(scenario.title, "kept");
        assert_eq!(problems.len(), 1);
        assert!(format!("{}", problems[0]).starts_with("clock_hz: "));
    }
}
