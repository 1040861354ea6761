//! The figures of the papers (DESIGN Part E), from presets to pulses.
//!
//! Figures of single curves and tables (B2's rates, B4's top speed, B5's breakpoints and distortion) are tested in
//! the core; these tests check the STEP signals.

use std::{f64::consts::PI, fs, path::Path};
use stepscope_core::inspect::trace::stored_run::StoredRun;
use stepscope_core::{
    inspect::motion::spectrum::Spectrum,
    motion::{
        Profile,
        curves::SineSegments,
        mechanics::Distance,
        moves::{self, Axis, Move},
        plan_axis,
    },
    peripheral::{
        config::PulsePhasing,
        trace::{Step, steps},
    },
    scenario::{Packets, Scenario, Source, presets::PRESETS},
    sim::Experiment,
};

/// A scenario and its completed run.
struct Made {
    scenario: Scenario,
    experiment: Experiment,
    recording: StoredRun,
}

impl Made {
    fn of(scenario: Scenario) -> Self {
        let experiment = Experiment::new(&scenario).expect("it has no problems");
        let mut recording = StoredRun::default();
        let run = experiment.run(&mut recording);
        assert_eq!(run.device().faults().bits(), 0);
        recording.packets.finish();
        Self { scenario, experiment, recording }
    }

    fn preset(id: &str) -> Self {
        Self::of(PRESETS.iter().find(|preset| preset.id == id).expect("it is a preset").scenario())
    }

    fn steps(&self, channel: u8) -> Vec<Step> {
        steps(&self.recording.trace, channel)
    }

    /// Duration of a tick in s.
    fn tick_s(&self) -> f64 {
        self.experiment.config().tick().0 as f64 / f64::from(self.scenario.clock_hz)
    }

    /// Time of a step in s, from the start of the first tick, which is the motion's time 0.
    fn time_s(&self, step: &Step) -> f64 {
        let zero = self.recording.first_tick().expect("there is a tick");
        (step.cycle as f64 - zero.0 as f64) / f64::from(self.scenario.clock_hz)
    }

    /// Steps of a channel in each tick of the motion.
    fn steps_a_tick(&self, channel: u8) -> Vec<u32> {
        let mut counts = Vec::new();
        for step in self.steps(channel) {
            let tick = (self.time_s(&step) / self.tick_s()) as usize;
            counts.resize(counts.len().max(tick + 1), 0);
            counts[tick] += 1;
        }
        counts
    }
}

/// A step is made in the tick in which it is due, so it is less than a tick late or early.
#[track_caller]
fn within_a_tick(made: &Made, found_s: f64, expected_s: f64) {
    assert!((found_s - expected_s).abs() < made.tick_s(), "{found_s} s is not {expected_s} s");
}

#[track_caller]
fn close(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} is not {expected}");
}

/// Zhang 2012: 565 pulses/cm, 30.5 cm; f_1 = 1000, f_s = 5000, a = 3000.
#[test]
fn zhang_2012_ends_after_the_ramps_and_the_plateau_of_its_formulas() {
    let made = Made::preset("zhang-2012-fixed-length");
    let all = made.steps(0);
    assert_eq!((all.len(), all[17_232].position), (17_233, 17_233), "30.5 * 565, rounded half up");
    // t_r = (f_s - f_1)/a, t_m = (L - (f_1 + f_s)*t_r)/f_s
    let t_r = (5000.0 - 1000.0) / 3000.0;
    let t_m = (17_233.0 - (1000.0 + 5000.0) * t_r) / 5000.0;
    close(2.0 * t_r + t_m, 4.513, 1e-4);
    close(made.experiment.plans()[0].duration_s(), 2.0 * t_r + t_m, 1e-12);
    within_a_tick(&made, made.time_s(&all[17_232]), 2.0 * t_r + t_m);
    // A ramp has (f_1 + f_s)/2*t_r steps.
    within_a_tick(&made, made.time_s(&all[3_999]), t_r);
    within_a_tick(&made, made.time_s(&all[17_232 - 4_000]), t_r + t_m);
}

/// Zhang 2012's four cases (its table 3): L, f_s, the rule; the rate that the formulas have for f_s, None if the whole move
/// is at the start speed; f_1 = 1000, a = 3000.
const FOUR_CASES: [(u32, u32, &str, Option<f64>, f64); 7] = [
    // f_s <= f_1
    (5000, 800, "document", None, 800.0),
    (5000, 1000, "turn_round", None, 1000.0),
    // L > 2*S
    (17_233, 5000, "document", Some(5000.0), 0.0),
    (17_233, 5000, "turn_round", Some(5000.0), 0.0),
    // L = 2*S: 36 rows from 1000 have 4200 steps before the row of sqrt(f_1^2 + 2*a*4200) = 5119 steps/s.
    (8400, 5119, "document", Some(5119.0), 0.0),
    // L < 2*S: at f_1, or up to the rate after the 2430 steps of the 26 rows that fit twice.
    (5000, 5000, "document", None, 1000.0),
    (5000, 5000, "turn_round", Some(3947.0), 0.0),
];

/// The time of a move's last step follows the formulas: t_r = (f_s - f_1)/a, t_m = (L - (f_1 + f_s)*t_r)/f_s; at a single
/// rate f the move takes L/f. A row has the rate at its start, so ramps are slightly late.
#[track_caller]
fn takes(last_s: f64, (steps, top, rule, reached, alone): (u32, u32, &str, Option<f64>, f64)) {
    let length = f64::from(steps);
    match reached {
        None => close(last_s, length / alone, 1e-6),
        Some(f_s) => {
            let t_r = (f_s - 1000.0) / 3000.0;
            let t_m = (length - (1000.0 + f_s) * t_r) / f_s;
            let late = last_s / (2.0 * t_r + t_m) - 1.0;
            assert!((0.0..0.03).contains(&late), "{steps} steps at {top}, {rule}: {late} late");
        }
    }
}

#[test]
fn zhang_2012s_four_cases_take_the_times_of_its_formulas() {
    for case in FOUR_CASES {
        let (steps, top, rule, ..) = case;
        let json = format!(
            r#"{{"source":{{"motion":{{"engine":"segments","axes":[{{"moves":[{{"staircase":{{"distance":{{"steps":{steps}}},"top_speed":{{"steps_s":{top}}},"short_move":"{rule}"}}}}]}}]}}}}}}"#
        );
        let made = Made::of(Scenario::from_json(&json).expect("it reads"));
        let all = made.steps(0);
        assert_eq!(all.len(), steps as usize);
        takes((all[all.len() - 1].cycle - 1) as f64 / 16e6, case);
    }
}

/// The same on the paper's own device: a press of start, and a program of one group.
#[test]
fn zhang_2012s_controller_takes_the_times_of_its_table_3() {
    for case in FOUR_CASES {
        let (steps, top, rule, ..) = case;
        let json = format!(
            r#"{{"source":{{"standalone":[{{"pulses_per_unit":1,"decimals":0,
                "groups":[{{"move":{{"length":{steps},"speed_hz":{top},"level":3}}}}],"short_move":"{rule}",
                "inputs":[{{"cycle":3200000,"input":"start"}},{{"cycle":4800000,"input":"start","level":0}}]}}]}}}}"#
        );
        let made = Made::of(Scenario::from_json(&json).expect("it reads"));
        let all = made.steps(0);
        assert_eq!(all.len(), steps as usize);
        // The first step follows one period after the start of the move.
        let first_s = 1.0 / f64::from(top.min(1000));
        takes((all[all.len() - 1].cycle - all[0].cycle) as f64 / 16e6 + first_s, case);
    }
}

/// Sonobe 2011: 0.393 mm per step, 300 mm forth, 0.1 s, 60 mm back, at most 700 mm/s.
#[test]
fn sonobe_2011_moves_forth_and_back_with_a_dwell() {
    let made = Made::preset("sonobe-2011-table");
    let all = made.steps(0);
    assert_eq!(all.len(), 763 + 153, "300/0.393 and 60/0.393, rounded");
    assert_eq!((all[762].position, all[763 + 152].position), (763, 610));
    let rest = made.time_s(&all[763]) - made.time_s(&all[762]);
    // The first step back follows one interval of 100 mm/s after the pause.
    within_a_tick(&made, rest, 0.1 + 0.393 / 100.0);
    let top = made.experiment.plans()[0].peaks().speed;
    close(top, 700.0 / 0.393, 1e-3);
}

/// The staircase table: level 3 from 1000 to 5000; segments place each step in its cycle at 16 MHz, with time 0 in cycle 1.
#[test]
fn zhang_2012s_staircase_has_the_steps_of_each_rate() {
    let made = Made::preset("zhang-2012-staircase");
    let all = made.steps(0);
    assert_eq!((all.len(), all[17_232].position), (17_233, 17_233));
    // f_n^2 = f_1^2 + 2*a*S, each rate rounded half up and held for 30 steps, from the sixth row on for 60, ...
    let (mut k, mut n, mut covered) = (0, 1, 0_u64);
    let mut cycle = 1.0;
    let rate = |covered: u64| (1e6 + 2.0 * 3000.0 * covered as f64).sqrt().round();
    while rate(covered) < 5000.0 {
        let steps = 30 * (1 + (n - 1) / 5);
        for _ in 0..steps {
            cycle += 16e6 / rate(covered);
            assert!((all[k].cycle as f64 - cycle).abs() <= 1.0, "step {k}: {} {cycle}", all[k].cycle);
            k += 1;
        }
        (n, covered) = (n + 1, covered + steps);
    }
    // S = steps to reach f_s; L > 2*S, so there is a plateau, and a mirrored deceleration.
    // Constant acceleration takes 4000 steps; 7 times five rows are the first with at least this number.
    assert_eq!((n, k, covered), (36, 4_200, 4_200), "35 rows");
    assert_eq!(all[k + 1000].cycle - all[k].cycle, 3_200_000, "1000 steps at 5000 Hz");
    let end = all[17_232].cycle;
    for (up, down) in (0..k).zip((0..17_232).rev()) {
        assert!((all[up].cycle - 1).abs_diff(end - all[down].cycle) <= 1, "step {up}");
    }
    // The paper's times: 1.333 s, 1.847 s, 1.333 s. A row has the rate at its start, so a ramp is about 4 % late.
    close(made.experiment.plans()[0].duration_s(), 4.513, 0.02);
}

/// Sonobe 2011 in segments: every edge is at the table's reloads, of a timer of 1 MHz and so multiples of 16 cycles.
#[test]
fn sonobe_2011_in_segments_steps_at_the_reloads_of_its_table() {
    let made = Made::preset("sonobe-2011-segments");
    let all = made.steps(0);
    assert_eq!((all.len(), all[762].position, all[762 + 153].position), (763 + 153, 763, 610));
    let moves = made.experiment.plans()[0].moves();
    let [Profile::TrapezoidTable(there), _, Profile::TrapezoidTable(back)] =
        [0, 1, 2].map(|i| &moves[i].profile)
    else {
        panic!("a table, a dwell, a table")
    };
    let rates = [254_u64, 287, 317, 344, 369, 392, 414, 435];
    for (k, rate) in rates.into_iter().enumerate() {
        let before = if k == 0 { 1 } else { all[k - 1].cycle };
        assert_eq!(all[k].cycle - before, 16 * (1_000_000 / rate), "interval {k}");
    }
    let (first, second) = all.split_at(763);
    let rest = first[762].cycle + 1_600_000;
    assert!(first.iter().zip(1..).all(|(step, k)| step.cycle == 1 + 16 * there.step_ticks(k)));
    assert!(second.iter().zip(1..).all(|(step, k)| step.cycle == rest + 16 * back.step_ticks(k)));
}

/// The last step is due half a step before the end (B1). Near its end the curve is, to 1 in 1000, a cubic:
/// f_max*pi^2*t^3/(12*t_s^2) steps are left t before it.
#[allow(clippy::disallowed_methods, reason = "the last bit does not matter to a tick")]
fn last_half_step_s(top: f64, ramp_s: f64) -> f64 {
    (6.0 * ramp_s * ramp_s / (top * PI * PI)).cbrt()
}

/// Song, Han and Lu 2021: f_max = n/(t_i - t_s).
#[test]
fn song_2021_makes_one_turn_of_exactly_3200_steps_in_0_4_s() {
    let made = Made::preset("song-2021-one-turn");
    let all = made.steps(0);
    assert_eq!((all.len(), all[3199].position), (3200, 3200));
    within_a_tick(&made, made.time_s(&all[3199]), 0.4 - last_half_step_s(16_000.0, 0.2));
    // Half of the distance after half of the time.
    within_a_tick(&made, made.time_s(&all[1599]), 0.2);
    let busiest = made.steps_a_tick(0).into_iter().max();
    assert_eq!(busiest, Some((3200.0 / (0.4 - 0.2) * made.tick_s()) as u32), "16000 steps/s");
}

#[test]
fn song_2021s_table_2_has_6400_steps_in_0_4_s_without_and_with_a_plateau() {
    let made = Made::preset("song-2021-plateau");
    for (channel, ramp_s) in [(0, 0.2), (1, 0.1)] {
        let all = made.steps(channel);
        assert_eq!((all.len(), all[6399].position), (6400, 6400), "channel {channel}");
        let top = 6400.0 / (0.4 - ramp_s);
        within_a_tick(&made, made.time_s(&all[6399]), 0.4 - last_half_step_s(top, ramp_s));
        let peaks = made.experiment.plans()[usize::from(channel)].peaks();
        close(peaks.speed, top, 1e-12);
        close(peaks.acceleration, top * PI / (2.0 * ramp_s), 1e-12);
        let (a_tick, counts) = (top * made.tick_s(), made.steps_a_tick(channel));
        let plateau = counts.iter().filter(|count| (f64::from(**count) - a_tick).abs() < 1.0).count();
        let plateau_s = plateau as f64 * made.tick_s();
        // A cosine is nearly flat at its maximum, too, which adds some ticks.
        assert!(plateau_s >= 0.4 - 2.0 * ramp_s && plateau_s < 0.45 - 2.0 * ramp_s, "{plateau_s} s at {top}");
    }
    // Figures 7 and 8: without a plateau the rate is higher and the acceleration lower.
    let [without, with] = [0, 1].map(|channel: usize| made.experiment.plans()[channel].peaks());
    assert!(without.speed > with.speed && without.acceleration < with.acceleration);
}

/// SWorldJournal, issue 11: amplitude 20 mm; distortions 0.26913 % and 0.26710 %, and the statement on the 7th harmonic.
#[test]
fn sines_return_to_zero_with_the_published_distortion() {
    let spectra = [("sine-2022-d00054", 0.26913), ("sine-2022-d0006", 0.26710)].map(|(id, distortion)| {
        let made = Made::preset(id);
        let all = made.steps(0);
        let Source::Motion(motion) = &made.scenario.source else { panic!("{id} is a motion") };
        let amplitude = 20.0 / motion.axes[0].mechanics.step_mm().expect("a wheel has millimeters");
        assert_eq!(all.last().map(|step| step.position), Some(0), "{id}");
        let farthest = all.iter().map(|step| step.position).min().expect("it moves");
        assert_eq!(farthest, -2 * amplitude.round() as i32, "{id}: from one extreme to the other");

        let pulses: Vec<(f64, i8)> = (0..all.len())
            .map(|index| (made.time_s(&all[index]), Step::direction(&all, index) as i8))
            .collect();
        let order = made.scenario.analysis.max_harmonic;
        let ideal = Spectrum::ideal(&made.experiment.plans()[0], order, 2048).expect("it lasts");
        let spectrum = Spectrum::of_pulses(&pulses, ideal.window, order);
        for spectrum in [&ideal, &spectrum] {
            close(spectrum.position.distortion.expect("it repeats") * 100.0, distortion, 3e-3);
            close(spectrum.position.amplitudes[0], amplitude, 1e-2);
        }
        spectrum
    });
    let [first, second] = spectra.map(|spectrum| spectrum.position.amplitudes[6]);
    assert!(first * first > 22.0 * second * second, "the 7th harmonics {first} and {second} steps");
}

/// The segments of a quarter for a maximum deviation d1 and an amplitude in steps.
fn sine(amplitude: f64, d1: f64) -> SineSegments {
    let given = moves::SineSegments {
        amplitude: Distance::Steps(amplitude),
        max_deviation: d1,
        ..moves::SineSegments::default()
    };
    let axis = Axis { moves: vec![Move::SineSegments(given)], ..Axis::default() };
    let plan = plan_axis(&axis, "axis").expect("it plans");
    let Profile::SineSegments(sine) = &plan.moves()[0].profile else { panic!("a sine by segments") };
    sine.clone()
}

/// SWorldJournal, issue 11: its figures 2 and 3 have 4 and 10 segments, on a grid of 360/2048 = 0.17578125 degrees.
#[test]
fn the_figures_of_the_sine_have_4_and_10_segments_on_its_grid() {
    for (d1, segments) in [(0.015, 4), (0.002, 10)] {
        let sine = sine(1000.0, d1);
        assert_eq!(sine.segments().len(), segments);
        for segment in sine.segments() {
            assert_eq!(segment.to_deg, f64::from(segment.to) * 0.175_781_25);
        }
        assert_eq!(sine.segments().last().map(|last| last.to_deg), Some(90.0));
    }
}

/// SWorldJournal, issue 11: the intervals of a quarter take 100 kB and more, segments hundreds of times less.
#[test]
fn sine_segments_need_hundreds_of_times_less_memory() {
    for d1 in [0.015, 0.006, 0.0054, 0.002] {
        let memory = sine(25_000.0, d1).memory();
        assert_eq!(memory.intervals, 100_000);
        let ratio = memory.intervals / memory.segments;
        assert!((1000..5000).contains(&ratio), "{d1}: {ratio} times");
    }
}

/// SWorldJournal, issue 11, explains the 7th harmonic for d1 = 0.0054 by breakpoints 49.5 and 52 degrees apart. Its
/// breakpoints have no such distances: those nearest to the 51.4 degrees of that harmonic are 50.4 and 53.4.
#[test]
fn the_published_distances_of_49_5_and_52_degrees_do_not_occur() {
    let sine = sine(1000.0, 0.0054);
    let quarter: Vec<f64> = sine.segments().iter().map(|segment| segment.from_deg).collect();
    let next = quarter.iter().rev().map(|angle| 180.0 - angle);
    let vertices: Vec<f64> = quarter.iter().copied().chain([90.0]).chain(next).collect();
    let mut near: Vec<f64> = vertices
        .iter()
        .flat_map(|from| vertices.iter().map(move |to| to - from))
        .filter(|apart| (47.0..55.0).contains(apart))
        .collect();
    near.sort_by(f64::total_cmp);
    near.dedup();
    let grid = 0.175_781_25;
    assert_eq!(near, [287.0 * grid, 304.0 * grid], "50.4 and 53.4 degrees");
}

/// RU 2704486: four motors, a step every 2.048 ms, all at the same time.
#[test]
fn the_patents_four_motors_step_together() {
    let made = Made::preset("patent-2019-four-motors");
    for pair in made.steps(0).windows(2).take(7) {
        assert_eq!(pair[1].cycle - pair[0].cycle, 32_768, "2.048 ms of 62.5 ns");
    }
    // All channels of the first tick have 8 steps.
    let cycles = |channel| made.steps(channel).iter().take(8).map(|step| step.cycle).collect::<Vec<_>>();
    assert!((1..4).all(|channel| cycles(channel) == cycles(0)));
    assert_ticks_follow_each_other(&made);
}

/// Staggered by the settling time of 0.518 ms. Four do not fit, so they are 2.048/4 = 0.512 ms apart.
#[test]
fn the_patents_four_motors_step_one_after_the_other() {
    let mut scenario = Made::preset("patent-2019-four-motors").scenario;
    scenario.bus.pulse_phasing = PulsePhasing::Staggered;
    scenario.bus.settle_cycles = 8_288;
    let made = Made::of(scenario.clone());
    let first = |channel: u8| made.steps(channel).first().map_or(0, |step| step.cycle);
    for channel in 1..4 {
        assert_eq!(first(channel) - first(channel - 1), 8_192, "0.512 ms of 62.5 ns");
    }
    // Three motors have the full settling time.
    let Source::Packets(Packets { packets }) = &mut scenario.source else { panic!("it is packets") };
    for packet in packets {
        packet.0[1] &= 0x80;
    }
    let made = Made::of(scenario);
    let first = |channel: u8| made.steps(channel).first().map_or(0, |step| step.cycle);
    assert_eq!((first(2) - first(0), first(3) - first(2)), (8_288, 8_288), "0.518 ms");
}

/// RU 2704486: the packet of a tick is sent during the previous tick.
#[test]
fn the_patents_16_motors_get_each_packet_one_tick_early() {
    let made = Made::preset("patent-2019-sixteen-motors");
    assert_ticks_follow_each_other(&made);
    for pair in made.recording.packets.rows().windows(2) {
        assert!(pair[1].start > pair[0].tick_start.expect("it runs"), "while the tick before it runs");
        assert!(pair[1].end < pair[0].tick_end.expect("it ends"), "{pair:?}");
    }
    // Packet 1 moves right, packet 2 moves back; in packet 3 channel i makes i + 1 steps, odd numbers to the right.
    for channel in 0..16 {
        let count = i32::from(channel) + 1;
        let all = made.steps(channel);
        let expected = if count % 2 == 1 { count } else { -count };
        assert_eq!(all.iter().map(|step| step.position).max(), Some(count), "channel {channel}");
        assert_eq!(all.last().map(|step| step.position), Some(expected), "channel {channel}");
    }
}

#[track_caller]
fn assert_ticks_follow_each_other(made: &Made) {
    let rows = made.recording.packets.rows();
    assert!(rows.len() > 2);
    for pair in rows.windows(2) {
        assert_eq!(pair[0].tick_end, pair[1].tick_start, "without a pause");
    }
}

/// The text of every `.rs` file in a folder.
fn sources(folder: &Path, into: &mut String) {
    for entry in fs::read_dir(folder).expect("the folder can be read") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, into);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            into.push_str(&fs::read_to_string(&path).expect("it is text"));
        }
    }
}

#[test]
fn every_test_named_in_the_list_of_figures_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let list = fs::read_to_string(root.join("docs/documents.md")).expect("the list");
    let mut all = String::new();
    for folder in ["core", "cli/tests", "tests/src", "tests/tests"] {
        sources(&root.join(folder), &mut all);
    }
    // Every second part between code marks; names of tests have no spaces, and at least three words.
    let names = list.split('`').skip(1).step_by(2).filter(|name| {
        name.matches('_').count() > 2 && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    });
    let (found, gone): (Vec<&str>, Vec<&str>) = names.partition(|name| all.contains(&format!("fn {name}(")));
    assert!(found.len() > 15, "{found:?}");
    assert!(gone.is_empty(), "docs/documents.md names tests that are not there: {gone:?}");
}
