//! Coverage of the random cases: every state, alarm, kind of group and trust, and all paths through memory, power and homing.

use std::{collections::BTreeMap, thread};

use super::super::eeprom::{RECORD, size};
use super::super::*;

/// Number of cases that reached each thing.
#[derive(Default)]
struct Reach(BTreeMap<String, u64>);

impl Reach {
    fn note(&mut self, what: impl Into<String>) {
        self.note_times(what, 1);
    }

    fn note_times(&mut self, what: impl Into<String>, times: u64) {
        *self.0.entry(what.into()).or_default() += times;
    }
}

fn kind(group: &Group) -> &'static str {
    match group {
        Group::Move(_) => "move",
        Group::MoveTo { .. } => "move_to",
        Group::Profile(_) => "profile",
        Group::Home => "home",
        Group::Wait { .. } => "wait",
        Group::Set { .. } => "set",
        Group::Repeat { .. } => "repeat",
        Group::Jump { .. } => "jump",
    }
}

/// Things that panel, memory and axis of a controller show.
fn controller(reach: &mut Reach, of: &Controller, outcome: &ControllerOutcome) {
    reach.note(format!("policy {:?}", of.memory.policy));
    for record in &outcome.panel {
        let (state, alarm, trust) = (record.word & 15, record.word >> 4 & 15, record.word >> 8 & 3);
        reach.note(format!("state {state}"));
        reach.note(format!("trust {trust}"));
        if state == 13 {
            reach.note(format!("alarm {alarm}"));
        }
        let group = (record.word >> 16 & 0x1FF) as usize;
        if state != 12 && group > 0 {
            reach.note(format!("group {}", kind(&of.groups[group - 1])));
        }
        if record.word >> 32 > 1 {
            reach.note("second loop");
        }
    }
    for pair in outcome.panel.windows(2) {
        let [from, to] = [0, 1].map(|at| (pair[at].word & 15, pair[at].word >> 4 & 15));
        reach.note(format!("{} to {}", from.0, to.0));
        if to == (13, 4) {
            reach.note("homing fails");
        }
        if from.0 == 10 && to.0 == 13 {
            reach.note(format!("homing to alarm {}", to.1));
        }
    }
    let slots = of.memory.slots;
    for slot in 0..slots {
        let flags = RECORD * slot + 8;
        if outcome.writes[flags] > 0 && outcome.writes[flags + 7] == outcome.writes[flags] {
            reach.note(if outcome.memory[flags] & 4 == 0 { "closed record" } else { "open record" });
        }
        if outcome.writes[RECORD * slot] != outcome.writes[RECORD * slot + 15] {
            reach.note("record cut short");
        }
    }
    if outcome.writes[RECORD * slots..size(of)].iter().any(|writes| *writes > 0) {
        reach.note("numbers saved");
    }
    if outcome.error != 0 {
        reach.note("axis error");
    }
}

fn pulses(reach: &mut Reach, case: &Case, outcome: &Outcome) {
    let (mut cut, mut whole) = (0, 0);
    for channel in 0..case.controllers.len() {
        let mut rise = None;
        for (cycle, levels) in &outcome.trace {
            match (levels >> channel & 1, rise) {
                (1, None) => rise = Some(*cycle),
                (0, Some(from)) => {
                    *(if cycle - from < case.w { &mut cut } else { &mut whole }) += 1;
                    rise = None;
                }
                _ => {}
            }
        }
    }
    reach.note_times("cut pulse", cut);
    reach.note_times("pulse", whole);
}

/// Coverage of the cases of these seeds, and the cycles of each.
fn cases(seeds: impl Iterator<Item = u64>) -> (Reach, Vec<u64>) {
    let mut reach = Reach::default();
    let mut cycles = Vec::new();
    for seed in seeds {
        let case = random_case(seed);
        let outcome = run(&case);
        cycles.push(outcome.cycles);
        for (of, outcome) in case.controllers.iter().zip(&outcome.controllers) {
            controller(&mut reach, of, outcome);
        }
        pulses(&mut reach, &case, &outcome);
        reach.note(if outcome.work.is_some() { "work" } else { "no work" });
    }
    (reach, cycles)
}

#[test]
fn the_cases_reach_every_state_and_alarm() {
    // The longest test of its kind: on two cores it ends with the others.
    let (reach, mut cycles) = thread::scope(|scope| {
        let odd = scope.spawn(|| cases((1..3000).step_by(2)));
        let (mut reach, mut cycles) = cases((0..3000).step_by(2));
        let (others, more) = odd.join().unwrap();
        others.0.into_iter().for_each(|(what, times)| reach.note_times(what, times));
        cycles.extend(more);
        (reach, cycles)
    });
    cycles.sort_unstable();
    println!("cycles: median {}, most {}", cycles[cycles.len() / 2], cycles[cycles.len() - 1]);
    for (what, count) in &reach.0 {
        println!("{what}: {count}");
    }
    let mut wanted: Vec<String> = Vec::new();
    wanted.extend((0..=14).map(|state| format!("state {state}")));
    wanted.extend((1..=7).map(|alarm| format!("alarm {alarm}")));
    wanted.extend((0..=2).map(|trust| format!("trust {trust}")));
    let kinds = ["move", "move_to", "profile", "home", "wait", "set", "repeat", "jump"];
    wanted.extend(kinds.map(|kind| format!("group {kind}")));
    wanted.extend(
        [
            "policy PowerLoss",
            "policy WriteAhead",
            "closed record",
            "open record",
            "record cut short",
            "numbers saved",
            "axis error",
            "cut pulse",
            "second loop",
            // A restart from OFF, and one during the hold-up time.
            "0 to 1",
            "14 to 1",
            // PAUSING, and start before the stop.
            "6 to 3",
            "6 to 9",
            "7 to 3",
            "7 to 9",
            "7 to 4",
            "7 to 5",
            "8 to 2",
            "8 to 11",
            "10 to 2",
            "10 to 3",
            "homing fails",
        ]
        .map(String::from),
    );
    for what in wanted {
        assert!(reach.0.get(&what).is_some_and(|count| *count >= 5), "{what}");
    }
}
