mod edits;

use super::*;
use crate::recording::alignment::Side;
use stepscope_peripheral::trace::Step;

/// 400 steps at 1 kHz, the last 100 in the negative direction.
fn plan() -> Vec<(u64, i32)> {
    (0..400).map(|k| (1000 * k, if k < 300 { 1 } else { -1 })).collect()
}

fn steps(of: &[(u64, i32)]) -> Vec<Step> {
    let mut position = 0;
    let step = |(cycle, direction): &(u64, i32)| {
        position += direction;
        Step { cycle: *cycle, position }
    };
    of.iter().map(step).collect()
}

#[track_caller]
fn check(recorded: &[(u64, i32)], expected: &[&str]) {
    let (recorded, model) = (steps(recorded), steps(&plan()));
    let side = |steps| Side { steps, clock_hz: 1_000_000, values: &[] };
    let alignment = Alignment::of(side(&recorded), side(&model), None).expect("both have steps");
    let found = Differences::of(&alignment, Tolerance::from_micros(20, 0).expect("a time"));
    let text: Vec<String> = found.listed.iter().map(|of| of.to_text(Kind::Steps)).collect();
    assert_eq!(text, expected);
    assert_eq!(found.count, expected.len());
}

#[test]
fn each_difference_is_a_row() {
    let edited = |edit: &dyn Fn(usize, (u64, i32)) -> Vec<(u64, i32)>| -> Vec<(u64, i32)> {
        plan().into_iter().enumerate().flat_map(|(k, step)| edit(k, step)).collect()
    };
    check(&plan(), &[]);
    check(
        &edited(&|k, step| if k == 200 { Vec::new() } else { alloc::vec![step] }),
        &["1 step missing after step 199, at 200.0 ms"],
    );
    check(
        &edited(&|k, step| {
            if k == 200 { alloc::vec![step, (step.0 + 300, 1), (step.0 + 600, 1)] } else { alloc::vec![step] }
        }),
        &["2 extra steps after step 200, at 200.3 ms"],
    );
    check(
        &edited(&|k, (at, direction)| {
            alloc::vec![(at, if (50..60).contains(&k) { -direction } else { direction })]
        }),
        &["10 steps in the wrong direction from step 50, at 50.00 ms"],
    );
    check(
        &edited(&|k, (at, direction)| {
            alloc::vec![(at + [0, 20, 21][(k / 7 % 3).min(if k < 25 { 2 } else { 0 })], direction)]
        }),
        &["7 steps off by up to 21.000 us (late) from step 14, at 14.02 ms"],
    );
    // Several, of each kind.
    check(
        &edited(&|k, (at, direction)| match k {
            100..103 | 350.. => Vec::new(),
            150 => alloc::vec![(at, direction), (at + 500, direction)],
            300 => alloc::vec![(at, 1)],
            320 => alloc::vec![(at + 240, direction)],
            _ => alloc::vec![(at, direction)],
        }),
        &[
            "3 steps missing after step 99, at 100.0 ms",
            "1 extra step after step 150, at 150.5 ms",
            "step 300 in the wrong direction, at 300.0 ms",
            "step 320 is 240.000 us late, at 320.2 ms",
            "50 steps missing after step 349, at 350.0 ms",
        ],
    );
}
