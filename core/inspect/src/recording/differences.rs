//! The differences of a recording from its plan; adjacent ones of a kind share a row.

use super::{alignment::Alignment, compared_data::Kind, tolerance::Tolerance};
use alloc::{format, string::String, vec::Vec};
use serde::Serialize;

/// Maximum listed differences.
pub const MAX_LISTED: usize = 100_000;

/// How a recorded event differs from the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DifferenceKind {
    Missing,
    Extra,
    Direction,
    Value,
    Late,
}

/// Neighboring steps or bytes that differ in the same way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    #[serde(rename = "what")]
    pub kind: DifferenceKind,
    pub count: usize,
    /// The first in the plan, from 0; for extra ones the planned step before them.
    pub step: Option<usize>,
    /// The first in the recording; for missing ones the recorded step before them.
    pub recorded_step: Option<usize>,
    /// When it was recorded or due, in s of the recording.
    pub recorded_s: f64,
    /// The largest of them; `None` for missing and extra ones.
    pub late_s: Option<f64>,
    pub planned_value: Option<u8>,
    pub recorded_value: Option<u8>,
}

/// The first differences in order of time, and the number of all.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Differences {
    pub listed: Vec<Difference>,
    pub count: usize,
}

impl Differences {
    /// A step that is off by exactly `within` is not late.
    pub fn of(alignment: &Alignment<'_>, within: Tolerance) -> Self {
        let mut found = Self::default();
        let (mut model, mut recorded, mut index) = (0, 0, 0);
        for run in alignment.matching.runs() {
            found.gap(alignment, model..run.model, recorded..run.recorded);
            let mut last: Option<Difference> = None;
            for _ in 0..run.count {
                let next = alignment.difference(index, within);
                match (&mut last, next) {
                    (Some(of), Some(next)) if of.kind == next.kind => of.join(next),
                    _ => found.add(core::mem::replace(&mut last, next)),
                }
                index += 1;
            }
            found.add(last);
            (model, recorded) = (run.model + run.count, run.recorded + run.count);
        }
        let (planned, came) = (alignment.model.steps.len(), alignment.recorded.steps.len());
        found.gap(alignment, model..planned, recorded..came);
        found
    }

    fn add(&mut self, next: Option<Difference>) {
        let Some(next) = next else { return };
        self.count += 1;
        if self.listed.len() < MAX_LISTED {
            self.listed.push(next);
        }
    }

    fn gap(&mut self, of: &Alignment<'_>, missing: core::ops::Range<usize>, extra: core::ops::Range<usize>) {
        let none = Difference {
            kind: DifferenceKind::Missing,
            count: missing.len(),
            step: Some(missing.start),
            recorded_step: extra.start.checked_sub(1),
            recorded_s: 0.0,
            late_s: None,
            planned_value: of.model.values.get(missing.start).copied(),
            recorded_value: None,
        };
        if !missing.is_empty() {
            self.add(Some(Difference { recorded_s: of.due_s(missing.start), ..none }));
        }
        if !extra.is_empty() {
            let cycle = of.recorded.steps.get(extra.start).map_or(0, |step| step.cycle);
            self.add(Some(Difference {
                kind: DifferenceKind::Extra,
                count: extra.len(),
                step: missing.start.checked_sub(1),
                recorded_step: Some(extra.start),
                recorded_s: cycle as f64 / f64::from(of.recorded.clock_hz.max(1)),
                planned_value: None,
                recorded_value: of.recorded.values.get(extra.start).copied(),
                ..none
            }));
        }
    }
}

impl Alignment<'_> {
    fn difference(&self, index: usize, within: Tolerance) -> Option<Difference> {
        let deviation = self.deviation(index)?;
        let kind = match (deviation.other_direction, deviation.other_value) {
            (true, _) => DifferenceKind::Direction,
            (_, true) => DifferenceKind::Value,
            _ if self.is_late(index, within) => DifferenceKind::Late,
            _ => return None,
        };
        Some(Difference {
            kind,
            count: 1,
            step: Some(deviation.step),
            recorded_step: Some(deviation.recorded_step),
            recorded_s: deviation.recorded_s,
            late_s: Some(deviation.late_s),
            planned_value: self.model.values.get(deviation.step).copied(),
            recorded_value: self.recorded.values.get(deviation.recorded_step).copied(),
        })
    }
}

impl Difference {
    fn join(&mut self, next: Self) {
        self.count += next.count;
        let size = |of: &Self| of.late_s.map_or(0.0, libm::fabs);
        if size(&next) > size(self) {
            self.late_s = next.late_s;
        }
    }

    /// Such as "1 step missing after step 1999, at 225.6 ms".
    pub fn to_text(&self, unit: Kind) -> String {
        use DifferenceKind::{Direction, Extra, Late, Missing, Value};

        let one = unit.singular();
        let counted =
            if self.count == 1 { format!("1 {one}") } else { format!("{} {}", self.count, unit.plural()) };
        let at = time(self.recorded_s);
        let step = self.step.unwrap_or(0);
        let late_s = self.late_s.unwrap_or(0.0);
        let size = format!("{:.3} us", libm::fabs(late_s) * 1e6);
        let early = if late_s < 0.0 { "early" } else { "late" };
        match self.kind {
            Missing if step == 0 => {
                format!("{counted} missing before the first recorded {one}, at {at}")
            }
            Missing => format!("{counted} missing after {one} {}, at {at}", step - 1),
            Extra => {
                let extra =
                    format!("{} extra {}", self.count, if self.count == 1 { one } else { unit.plural() });
                match self.step {
                    Some(step) => format!("{extra} after {one} {step}, at {at}"),
                    None => format!("{extra} before {one} 0, at {at}"),
                }
            }
            Direction if self.count == 1 => {
                format!("{one} {step} in the wrong direction, at {at}")
            }
            Direction => {
                format!("{counted} in the wrong direction from {one} {step}, at {at}")
            }
            Value if self.count == 1 => {
                let value =
                    |value: Option<u8>| value.map_or_else(String::new, |value| format!("{value:02x}"));
                let (own, planned) = (value(self.recorded_value), value(self.planned_value));
                format!("{one} {step} is {own} instead of {planned}, at {at}")
            }
            Value => format!("{counted} with another value from {one} {step}, at {at}"),
            Late if self.count == 1 => format!("{one} {step} is {size} {early}, at {at}"),
            Late => {
                format!("{counted} off by up to {size} ({early}) from {one} {step}, at {at}")
            }
        }
    }
}

/// A time with at least four digits in a suitable unit.
fn time(seconds: f64) -> String {
    let (value, unit) = match libm::fabs(seconds) {
        size if size >= 1.0 => (seconds, "s"),
        size if size >= 1e-3 || size == 0.0 => (seconds * 1e3, "ms"),
        _ => (seconds * 1e6, "us"),
    };
    match libm::fabs(value) {
        size if size >= 100.0 => format!("{value:.1} {unit}"),
        size if size >= 10.0 => format!("{value:.2} {unit}"),
        _ => format!("{value:.3} {unit}"),
    }
}

#[cfg(test)]
mod tests;
