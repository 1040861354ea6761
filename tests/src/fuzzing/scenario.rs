//! Texts as scenarios (PAGE "Share link"): none makes the reader or the judge fail, what is accepted is work of a size
//! that was bounded before, and what reads survives its way through JSON.

use crate::equivalence::{self, Ways};
use stepscope_core::{
    scenario::{Compact, END_OF_TIME, Problem, Scenario},
    sim::Experiment,
};

/// Most wrong fields that one reading lists.
pub const MAX_PROBLEMS: usize = 100;
/// What one run may be at most: packets or bytes of a script, and the records of the busiest ticks.
const MAX_SENDS: u64 = 4 << 20;
const MAX_BYTES: u64 = 2_000_000 * 17;
const MAX_RECORDS: u64 = 1 + (MAX_BYTES + 10_000) * (10 + 16 * 127 * 4);
/// Of segments: an edge in each cycle of 48 bits on each channel.
const MAX_SEGMENT_RECORDS: u64 = 16 << 48;

/// Runs that cost no more records and cycles than these are made, and made again clock by clock.
const RUN_RECORDS: u64 = 5_000;
const RUN_CYCLES: u64 = 5_000;

/// Reads, judges and, if it is cheap, runs a text; what is no UTF-8 is no text.
///
/// # Panics
/// Where a property is broken.
pub fn check(data: &[u8]) {
    let Ok(text) = str::from_utf8(data) else { return };
    let Ok(experiment) = judge(text) else { return };
    if experiment.cost().records <= RUN_RECORDS {
        let (scenario, _) = Scenario::from_json_lenient(text);
        let ways = Ways { slices: &[1, 7, 100], hurry: 100, most_clocked: RUN_CYCLES };
        equivalence::check(&scenario, &experiment, ways);
    }
}

/// The presets and the golden cases.
#[must_use]
pub fn seeds() -> Vec<Vec<u8>> {
    super::scenarios().map(|json| json.as_bytes().to_vec()).collect()
}

/// Reads and judges a text: its problems can be printed, and what it accepts is bounded.
///
/// # Errors
/// The problems of a text that is refused.
///
/// # Panics
/// Where a property is broken.
pub fn judge(text: &str) -> Result<Experiment, Vec<Problem>> {
    let (scenario, unread) = Scenario::from_json_lenient(text);
    assert!(unread.len() <= MAX_PROBLEMS, "{} problems", unread.len());
    assert_eq!(Scenario::from_json(text).is_ok(), unread.is_empty());
    let canonical = scenario.compact().to_string();
    for json in [scenario.to_json(), canonical.clone()] {
        let again = Scenario::from_json(&json);
        assert_eq!(again.as_ref(), Ok(&scenario), "what is left of it is a scenario");
        assert_eq!(again.map(|again| again.compact().to_string()).as_ref(), Ok(&canonical));
    }
    let judged = Experiment::from_json(text);
    assert!(unread.is_empty() || judged.is_err());
    match &judged {
        Ok(experiment) => bounded(experiment),
        Err(problems) => told(problems, text),
    }
    judged
}

fn bounded(experiment: &Experiment) {
    let cost = experiment.cost();
    assert!(cost.sends <= MAX_SENDS && cost.bytes <= MAX_BYTES.max(MAX_SENDS), "{cost:?}");
    let most = if experiment.segments().is_some() { MAX_SEGMENT_RECORDS } else { MAX_RECORDS };
    assert!(cost.records <= most && cost.end_cycle <= END_OF_TIME, "{cost:?}");
}

/// Every problem says something, and no number that is none.
fn told(problems: &[Problem], given: &str) {
    assert!(!problems.is_empty(), "refused without a reason");
    for problem in problems {
        let text = problem.to_string();
        assert!(text.len() > problem.path.len(), "{text}");
        assert!(!text.contains("NaN") || given.contains("NaN"), "{text}");
    }
}
