//! What a run exports, taken in again.
#![allow(clippy::expect_used, reason = "what is missing fails the test")]

use stepscope_core::{
    inspect::{
        tables::{write_edges_head, write_edges_row, write_packets_head, write_packets_row},
        trace_diff::TraceDiff,
    },
    peripheral::trace::Recording,
    scenario::{LineScript, Scenario, presets::PRESETS},
    sim::{Experiment, replayed},
};

fn recorded(scenario: &Scenario) -> (Experiment, Recording) {
    let experiment = Experiment::new(scenario).expect("a good scenario");
    let mut recording = Recording::default();
    experiment.run(&mut recording);
    recording.packets.finish();
    (experiment, recording)
}

/// Where bytes follow one another without pauses and nothing disturbs the line, the table holds all.
#[test]
fn a_table_of_packets_sent_again_gives_the_same_trace() {
    for id in ["song-2021-plateau", "patent-2019-sixteen-motors", "patent-2019-addressed"] {
        let preset = PRESETS.iter().find(|preset| preset.id == id).expect(id);
        let scenario = preset.scenario();
        let (_, recording) = recorded(&scenario);
        let mut table = String::new();
        write_packets_head(&mut table).expect("a string takes it");
        for index in 0..recording.packets.rows().len() {
            write_packets_row(&mut table, &recording.packets, index).expect("a string takes it");
        }
        let script = LineScript::recorded(&table, scenario.clock_hz).expect(id);
        let (_, again) = recorded(&replayed(scenario, script));
        assert_eq!(again.digest.value(), recording.digest.value(), "{id}");
    }
}

#[test]
fn every_presets_own_table_of_edges_is_the_same_as_its_run() {
    for preset in PRESETS {
        let (experiment, recording) = recorded(&preset.scenario());
        let config = experiment.config();
        let mut table = String::new();
        write_edges_head(&mut table, config.channels()).expect("a string takes it");
        for record in &recording.trace {
            write_edges_row(&mut table, *record, config.clock_hz(), config.channels())
                .expect("a string takes it");
        }
        let mut against = TraceDiff::new(config.channels());
        against.feed(&recording.trace, table.as_bytes()).expect(preset.id);
        let outcome = against.finish(&recording.trace).expect(preset.id);
        assert_eq!((outcome.difference, outcome.goes_on), (None, false), "{}", preset.id);
        assert_eq!(outcome.same, recording.trace.len() as u64, "{}", preset.id);
    }
}
