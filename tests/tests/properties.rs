//! Properties of random scenarios of all sources: all speeds have the same results (DESIGN A2), no run exceeds its computed
//! cost, and scenarios round-trip through JSON and links (PAGE "Share link").

use proptest::prelude::*;
use stepscope_core::{
    peripheral::{config::Config, device::Device, signal::Record, trace::Digest, units::Cycles},
    scenario::{
        Compact, Scenario,
        link::{LinkError, decode, encode},
    },
    sim::Experiment,
};
use stepscope_tests::{
    effort,
    equivalence::{self, Left, Ways, same},
    scenarios::{segmented, small, typed},
};

proptest! {
    #![proptest_config(effort::cases(1_500))]

    #[test]
    fn slices_and_speeds_do_not_change_a_run(
        scenario in small(),
        slices in prop::collection::vec(1..40_u64, 1..5),
        hurry in 0..=100_u64,
    ) {
        let Ok(experiment) = Experiment::new(&scenario) else { return Ok(()) };
        equivalence::check(&scenario, &experiment, Ways { slices: &slices, hurry, most_clocked: 200_000 });
    }

    #[test]
    fn slices_and_speeds_do_not_change_segments(
        scenario in segmented(),
        slices in prop::collection::vec(1..40_u64, 1..5),
    ) {
        let Ok(experiment) = Experiment::new(&scenario) else { return Ok(()) };
        equivalence::check(&scenario, &experiment, Ways { slices: &slices, hurry: 100, most_clocked: u64::MAX });
    }

    /// Any levels on the line, as in a test of firmware, not only those of a scenario.
    #[test]
    fn any_line_is_accepted_and_skipping_changes_nothing(
        scenario in small(),
        lengths in prop::collection::vec(prop_oneof![3 => 1..30_u64, 1 => 1..2_000_u64], 0..200),
    ) {
        let Ok(config) = Config::new(scenario.clock_hz, &scenario.bus, &scenario.line.serial()) else { return Ok(()) };
        let (mut every, mut skipping) = (Left::default(), Left::default());
        let (mut clocked, mut skipped) = (Device::new(&config), Device::new(&config));
        let mut end = 0;
        for (index, length) in lengths.iter().chain(&[1_000]).enumerate() {
            let level = index % 2 == 0;
            end += length;
            while clocked.now().0 < end {
                clocked.clock(level, &mut every);
            }
            while skipped.now().0 < end {
                skipped.clock(level, &mut skipping);
                let left = end - skipped.now().0;
                skipped.advance(skipped.cycles_until_event().map_or(Cycles(left), |quiet| Cycles(quiet.0.min(left))));
            }
        }
        same("skipping", (&skipping, &skipped), (&every, &clocked));
    }
}

proptest! {
    #![proptest_config(effort::cases(4_000))]

    #[test]
    fn scenarios_round_trip_through_json_and_links(scenario in prop_oneof![typed(), small()]) {
        for json in [scenario.to_json(), scenario.compact().to_string()] {
            let read = Scenario::from_json(&json);
            prop_assert_eq!(read.as_ref(), Ok(&scenario), "{}", json);
        }
        match encode(&scenario) {
            Ok(link) => {
                let opened = decode(&link);
                prop_assert_eq!(opened.as_ref(), Ok(&scenario));
                prop_assert_eq!(encode(&opened.unwrap_or_default()), Ok(link));
            }
            Err(error) => prop_assert!(matches!(error, LinkError::TooLong { .. }), "{:?}", error),
        }
    }

    /// Equal scenarios are equal, however their numbers are written.
    #[test]
    fn equal_scenarios_have_the_same_link(scenario in typed()) {
        let again = Scenario::from_json(&without_signs_of_zero(&scenario.to_json())).expect("reads");
        prop_assert_eq!(&again, &scenario);
        prop_assert_eq!(again.compact().to_string(), scenario.compact().to_string());
    }
}

/// -0.0 and 0.0 are the same number.
fn without_signs_of_zero(json: &str) -> String {
    json.replace(": -0.0,", ": 0.0,").replace(": -0.0\n", ": 0.0\n")
}

#[test]
fn a_digest_does_not_depend_on_other_sinks() {
    let experiment = Experiment::new(&Scenario::default()).expect("the default has no problems");
    let mut both = (Digest::default(), Vec::<Record>::new());
    experiment.run(&mut both);
    assert_eq!(both.0.value(), Digest::of(&both.1));
    assert_eq!(both.0.records(), both.1.len() as u64);
}
