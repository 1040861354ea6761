//! Runs with and without skipped cycles are equal; a seed always gives the same case.

use super::super::*;

#[test]
fn skipping_cycles_changes_nothing() {
    let mut compared = 0;
    for seed in 0..400 {
        let case = random_case(seed);
        if run_up_to(&case, 30_000, u64::MAX).is_none() {
            continue;
        }
        compared += 1;
        assert_eq!(run(&case), run_every_cycle(&case), "seed {seed}");
    }
    assert!(compared > 100, "{compared}");
}

#[test]
fn a_seed_gives_one_valid_case_and_one_text() {
    for seed in 0..100 {
        let case = random_case(seed);
        assert_eq!(case, random_case(seed));
        assert!(refused(&case).is_empty());
        let text = to_json(&case);
        assert_eq!(text, to_json(&case));
        assert_eq!(text.matches('{').count(), text.matches('}').count());
    }
}
