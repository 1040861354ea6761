//! Files that a run exports can be imported again.

use stepscope_core::inspect::trace::stored_run::StoredRun;
use stepscope_core::{
    inspect::{
        export::tables::{write_edges_head, write_edges_row},
        packets::packet_table::PacketTable,
        trace::diff::TraceDiff,
    },
    peripheral::{units::Instant, wire::schedule::line_time},
    scenario::{LineScript, Scenario, ScriptedSend, presets::PRESETS},
    sim::{Experiment, Run, replayed},
};

fn recorded(scenario: &Scenario) -> (Experiment, Run, StoredRun) {
    let experiment = Experiment::new(scenario).expect("a good scenario");
    let mut recording = StoredRun::default();
    let run = experiment.run(&mut recording);
    recording.packets.finish();
    (experiment, run, recording)
}

/// The packet table of the first controller, as a file.
fn table_of(experiment: &Experiment, run: &Run, recording: &StoredRun) -> String {
    let table = PacketTable::new(experiment, run, 0, &recording.packets);
    let mut text = String::new();
    PacketTable::write_head(&mut text).expect("a string takes it");
    (0..table.len()).for_each(|index| table.write_row(&mut text, index).expect("a string takes it"));
    text
}

/// If bytes follow each other without pauses or noise, the table contains all of them.
#[test]
fn a_packet_table_reproduces_the_trace() {
    for id in ["song-2021-plateau", "patent-2019-sixteen-motors", "patent-2019-addressed"] {
        let preset = PRESETS.iter().find(|preset| preset.id == id).expect(id);
        let scenario = preset.scenario();
        let (experiment, run, recording) = recorded(&scenario);
        let table = table_of(&experiment, &run, &recording);
        let script = LineScript::recorded(&table, scenario.clock_hz).expect(id);
        let (_, _, again) = recorded(&replayed(scenario, script));
        assert_eq!(again.digest.value(), recording.digest.value(), "{id}");
    }
}

/// Replies of other controllers look like frames, but are not sent by the host, even with noise.
#[test]
fn a_packet_table_of_a_shared_line_has_only_the_hosts_sends() {
    let preset = PRESETS.iter().find(|preset| preset.id == "four-controllers-framed").expect("a preset");
    let mut scenario = preset.scenario();
    for (seed, flipped_bits_ppm) in [(0, 0), (3, 300), (4, 1000)] {
        (scenario.line.noise.seed, scenario.line.noise.flipped_bits_ppm) = (seed, flipped_bits_ppm);
        let (experiment, run, recording) = recorded(&scenario);
        let table = table_of(&experiment, &run, &recording);
        let script = LineScript::recorded(&table, scenario.clock_hz).expect("a table");
        if flipped_bits_ppm == 0 {
            let sent: Vec<(u64, &[u8])> =
                run.schedule().iter().map(|send| (send.start.0, send.bytes)).collect();
            let again = script.sends.iter().map(|send| (send.start_cycle, send.bytes.0.as_slice()));
            assert_eq!(again.collect::<Vec<_>>(), sent);
        }
        // A flipped bit may split a frame or join two. Each part begins in a send of the host.
        let is_hosts = |send: &ScriptedSend| {
            let last = run.schedule().last_at_or_before(Instant(send.start_cycle));
            last.is_some_and(|last| {
                let length = line_time(last.bytes.len() as u64, scenario.clock_hz, scenario.line.baud);
                send.start_cycle < last.start.0 + length
            })
        };
        let strange: Vec<&ScriptedSend> = script.sends.iter().filter(|send| !is_hosts(send)).collect();
        assert!(strange.is_empty(), "seed {seed}: {strange:?}");
    }
}

#[test]
fn the_edge_table_of_every_preset_equals_its_run() {
    for preset in PRESETS {
        let (experiment, _, recording) = recorded(&preset.scenario());
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
        assert_eq!((outcome.difference, outcome.run_continues), (None, false), "{}", preset.id);
        assert_eq!(outcome.same, recording.trace.len() as u64, "{}", preset.id);
    }
}
