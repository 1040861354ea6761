//! Runs with a plant: the rows of the contract's F10 that need a motion or feedback (F7), equal results at all speeds and in
//! slices, and sources of all kinds.

use stepscope_core::{
    inspect::plant::outcome::verdict,
    peripheral::{
        device::Faults,
        signal::{Levels, Record},
        trace::{Digest, steps},
        units::Cycles,
    },
    plant::{
        Observer, Plant,
        settling::{Deviation, SensorLog, StepResponse},
    },
    scenario::presets::{CONTROLLER_PLANT_PRESETS, PLANT_PRESETS},
    sim::{Experiment, plant_run::PlantRun},
};

use stepscope_tests::plant_digests::plant_cases;

/// F10's motors of the patent's figures, on axes of full steps.
const PATENT_MOTOR: &str = r#"{"full_step_deg":1.8,"microsteps":1,"motor":{"inductance_mh":5.3,"holding_torque_mn_m":300,
    "load_inertia_g_cm2":100,"friction_mn_m":15,"viscous_un_m_s":1000,"supply_v":27,"drive":{"bridge_ohm":1}}}"#;

fn experiment(json: &str) -> Experiment {
    Experiment::from_json(json).unwrap_or_else(|problems| panic!("{json}: {problems:?}"))
}

fn run<O: Observer>(json: &str, observer: O) -> PlantRun<Vec<Record>, O> {
    let mut run = PlantRun::new(&experiment(json), vec![(Vec::new(), observer)]).expect("it has a plant");
    run.finish();
    run
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    println!("{found} (expected {expected} +- {tolerance})");
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected} +- {tolerance}");
}

/// 3200 steps in 0.4 s with ramps of 0.2 s, in segments, so that time 0 is cycle 1.
fn one_turn(motor: &str, plant: &str) -> String {
    format!(
        r#"{{"source":{{"motion":{{"engine":"segments","axes":[{{"moves":[
            {{"cosine":{{"distance":{{"steps":3200}},"duration_s":0.4,"ramp_s":0.2}}}}],"motor":{{{motor}}}}}]}}}},"plant":{{{plant}}}}}"#
    )
}

#[test]
fn a_motor_follows_the_s_curve_despite_a_load() {
    // Remaining errors are measured some time after the last step.
    for (motor, following, rest) in [
        ("", 0.078, -0.002),
        (r#""load_torque_mn_m":100"#, 0.311, -0.211),
        (r#""load_inertia_g_cm2":200"#, 0.090, 0.0),
    ] {
        let run = run(&one_turn(motor, ""), ());
        let result = run.results().remove(0);
        let turn = &result.motors[0];
        assert_eq!((turn.lost, turn.slips.len()), (0, 0), "{motor}");
        near(turn.following_error.value.abs(), following, 0.003);
        if rest != 0.0 {
            near(turn.state.x - turn.command, rest, 0.003);
        }
        near(turn.energy.error(), 0.0, 1e-6);
        let last = turn.last_step.expect("it stepped");
        let fall = last + 40;
        assert_eq!(run.now().0, fall + 1_600_000, "a tenth of a second after the last fall");
    }
}

#[test]
fn the_encoder_reads_the_move_every_five_milliseconds() {
    struct Codes(Vec<u16>);
    impl Observer for Codes {
        fn point(&mut self, plant: &Plant) {
            if plant.events().encoded {
                self.0.push(plant.encoder(0));
            }
        }
    }
    // Time 0 is cycle 1600, as in F10.
    let dwell = r#"{"dwell":{"duration_s":0.0000999375}},"#;
    let json = one_turn("", "").replace(r#"{"cosine""#, &format!(r#"{dwell}{{"cosine""#));
    let run = run(&json, Codes(vec![]));
    let codes = run.into_parts().remove(0).1.0;
    let begin = [0, 0, 1, 2, 6, 10, 17, 26, 36, 50, 66, 86, 108, 134, 164, 197, 235, 276, 321, 370];
    for (found, expected) in codes.iter().zip(begin) {
        assert!((i32::from(*found) - expected).abs() <= 1, "{codes:?}");
    }
    let end = [4084, 4089, 4092, 4095, 0, 4095];
    for (found, expected) in codes[73..].iter().zip(end) {
        let off = (i32::from(*found) - expected).rem_euclid(4096);
        assert!(off.min(4096 - off) <= 1, "{:?}", &codes[70..]);
    }
}

/// Song's table 5 by its encoder, read every 5 ms: the difference of the turn's time from 0.4 s, the distance in codes, and
/// the overshoot in codes.
fn read_back(moves: &str) -> (f64, i32, i32) {
    struct Codes(Vec<i32>);
    impl Observer for Codes {
        fn point(&mut self, plant: &Plant) {
            if plant.events().encoded {
                self.0.push(plant.encoder(0).into());
            }
        }
    }
    let json = format!(
        r#"{{"plant":{{}},"source":{{"motion":{{"engine":"segments","axes":[{{"moves":[{moves}],"motor":{{}}}}]}}}}}}"#
    );
    let codes = run(&json, Codes(vec![])).into_parts().remove(0).1.0;
    // Differences are summed, as in the paper: no difference between two readings is half a turn.
    let mut place = 0;
    let mut before = 0;
    let places: Vec<i32> = codes
        .iter()
        .map(|code| {
            place += (code - before + 2048).rem_euclid(4096) - 2048;
            before = *code;
            place
        })
        .collect();
    let end = *places.last().expect("readings");
    // From the last reading at standstill to the first of those within a code of the end.
    let first = places.iter().position(|place| place.abs() > 1).expect("it moves");
    let last = places.iter().rposition(|place| (place - end).abs() > 1).expect("it stops") + 1;
    let seconds = (last + 1 - first) as f64 * 0.005;
    (seconds - 0.4, end, places.iter().max().expect("readings") - end)
}

#[test]
fn the_encoder_reproduces_table_5_of_song_2021() {
    let cosine = r#"{"cosine":{"distance":{"deg":360},"duration_s":0.4,"ramp_s":0.2}}"#;
    let (off, distance, past) = read_back(cosine);
    // The first and the last 15 ms are within one code, so the encoder measures 30 ms less; the pulses take 0.4 s.
    near(off, -0.03, 0.0051);
    assert!((distance - 4096).abs() <= 1 && past <= 1, "{distance}, past it by {past}");
    // The direct start oscillates and overshoots by two thirds of a full step, 14 codes.
    let direct = r#"{"constant":{"distance":{"deg":360},"speed":{"steps_s":8000}}}"#;
    let (off, distance, past) = read_back(&direct.replace("8000", "19200"));
    assert!((distance - 4096).abs() <= 1, "{distance}");
    assert!(past > 3, "it goes past its place by {past} codes only");
    let rest = off + 0.4 - 3200.0 / 19_200.0;
    assert!(rest > 0.01, "it rings for {rest} s after its last step");
}

/// Four motors of the patent's figures with a self-test of Ts = 32768.
fn self_test(plant: &str, bus: &str) -> String {
    format!(
        r#"{{"bus":{{"channels":4,"slots":4,"step_period_cycles":32768,"self_test_cycles":3145729,"pulse_phasing":"staggered"{bus}}},
            "source":{{"packets":{{"packets":["81818181","81818181"]}}}},
            "plant":{{"self_test":true,"motors":[{PATENT_MOTOR}]{plant}}}}}"#
    )
}

#[test]
fn a_self_test_measures_the_settling_time_of_each_channel_and_staggers_by_it() {
    let run = run(&self_test("", ""), ());
    let found: Vec<u64> = run.self_test(0).iter().map(|dp| dp.expect("it settles")).collect();
    println!("{found:?}");
    for (found, expected) in found.iter().zip([8479.0, 8207.0, 8255.0, 8223.0]) {
        near(*found as f64, expected, 0.03 * expected);
    }
    assert_eq!(found, [8479, 8207, 8255, 8223]);
    assert_eq!(run.faults(), Faults::default());
    // Shown in registers and by the pulses: min(8479, 32768/4) apart.
    let device = run.device();
    assert_eq!(device.read(stepscope_registers::settle::OFFSET), 8479);
    let trace = &run.into_parts()[0].0;
    let rises = |channel| steps(trace, channel).iter().map(|step| step.cycle).collect::<Vec<_>>();
    for channel in 0..4 {
        let s = 1 + u64::from(channel) * 24 * 32_768;
        assert_eq!(rises(channel)[..2], [s + 10 * 32_768, s + 12 * 32_768], "channel {channel}");
        assert_eq!(steps(trace, channel)[1].position, 0, "there and back");
        assert_eq!(rises(channel)[2] - rises(0)[2], u64::from(channel) * 8192);
    }
}

#[test]
fn a_self_test_without_a_result_uses_t_step_and_reports_it() {
    // A converter that always has the same code: P is 0. And a sensor so slow that the current does not settle in T_step.
    let sensors = [
        r#""current_sensor":{"lsb_a":1000}"#,
        r#""idle_ma":100,"current_sensor":{"lsb_a":0.01,"adc_max":7}"#,
        r#""current_sensor":{"bandwidth_hz":20}"#,
    ];
    for sensor in sensors {
        let run = run(&self_test(&format!(",{sensor}"), ""), ());
        assert!(run.self_test(0).contains(&None), "{sensor}: {:?}", run.self_test(0));
        assert_eq!(run.faults(), Faults::SELF_TEST, "{sensor}");
        assert_eq!(run.device().read(stepscope_registers::settle::OFFSET), 32_768, "{sensor}");
        assert_eq!(run.device().read(stepscope_registers::faults::OFFSET), 1 << 9, "{sensor}");
    }
}

/// A stand-alone controller does not react to an overload (F7): its edges are the same without a protection.
#[test]
fn a_stand_alone_controller_does_not_react_to_an_overload() {
    let scenario = |protection: &str| {
        format!(
            r#"{{"source":{{"standalone":[{{"inputs":[{{"cycle":400000,"input":"start","level":1}}]}}]}},
                "plant":{{"idle_ma":3000{protection}}}}}"#
        )
    };
    let runs = ["", r#","protection":{"threshold_a":1,"samples":1}"#].map(|protection| {
        let run = run(&scenario(protection), ());
        assert_eq!(run.overload(0), None, "nothing was switched off");
        run.into_parts().remove(0).0
    });
    let [without, with] = &runs;
    assert!(!with.is_empty() && with.iter().all(|record| record.levels.has(Levels::EN)));
    assert_eq!(without, with);
}

#[test]
fn a_self_test_stopped_during_boot_has_no_result() {
    let json = self_test(r#","protection":{"threshold_a":1.2,"samples":1}"#, "");
    let run = run(&json, ());
    assert_eq!(run.self_test(0), [None; 4]);
    assert_eq!(run.faults().bits(), 1 << 8 | 1 << 9);
    let at = run.overload(0).expect("an overload");
    assert!(at > 10 * 32_768 && at < 12 * 32_768, "{at}");
    assert_eq!(run.positions()[0], 1, "the step that rose counts");
}

/// Four default motors in full steps, segments of four steps from 1600 on, channels `apart` cycles after each other.
fn overload(apart: u64) -> String {
    let list = |channel: u64| {
        let (start, interval) = (1600 + channel * apart, 32_768_u64 << 16);
        format!(
            r#"{{"start_cycle":{start},"segments":[{{"steps":{{"count":4,"interval_q16":{interval}}}}}]}}"#
        )
    };
    let lists: Vec<String> = (0..4).map(list).collect();
    format!(
        r#"{{"bus":{{"channels":4}},"source":{{"segments":{{"channels":[{}]}}}},
            "plant":{{"motors":[{{"microsteps":1}}],"protection":{{}},"current_sensor":{{"bandwidth_hz":5000}}}}}}"#,
        lists.join(",")
    )
}

#[test]
fn an_overload_ends_segments_and_staggering_prevents_it() {
    let run_together = run(&overload(0), ());
    let at = run_together.overload(0).expect("an overload");
    near(at as f64, 39_280.0, 160.0);
    assert_eq!(at, 39_280);
    assert_eq!(run_together.faults(), Faults::OVERLOAD);
    assert_eq!(run_together.positions()[..4], [1; 4]);
    let trace = &run_together.into_parts()[0].0;
    let last = trace[trace.len() - 1];
    assert_eq!(last.cycle.0, 39_281, "EN falls in the cycle after, and nothing follows");
    assert_eq!((last.levels.0 >> 32, last.levels.step()), (0b110, 0), "EN and STEP are 0, RX and TX 1");
    let staggered = run(&overload(8192), ());
    assert_eq!((staggered.overload(0), staggered.positions()[0]), (None, 4));
}

/// Like [`overload`], with ticks of packets.
fn overload_by_ticks(line: &str, channels: usize) -> String {
    let packet = "81".repeat(channels);
    format!(
        r#"{{"bus":{{"channels":{channels},"slots":1,"step_period_cycles":32768}},"line":{{{line}}},
            "source":{{"packets":{{"packets":["{packet}","{packet}","{packet}"]}}}},
            "plant":{{"motors":[{{"microsteps":1}}],"protection":{{}},"current_sensor":{{"bandwidth_hz":5000}}}}}}"#
    )
}

#[test]
fn an_overload_stops_a_controller_like_stop() {
    for line in ["", r#""protocol":"framed""#] {
        let run = run(&overload_by_ticks(line, 4), ());
        let at = run.overload(0).expect("an overload");
        let device = run.device();
        assert_eq!(device.faults(), Faults::OVERLOAD, "{line}");
        assert_eq!(device.read(stepscope_registers::faults::OFFSET), 1 << 8);
        let status = device.read(stepscope_registers::status::OFFSET);
        assert_eq!(
            stepscope_registers::status::STATE.extract(status),
            stepscope_registers::status::STATE_STOPPED
        );
        assert_eq!(stepscope_registers::status::EN.extract(status), 0);
        if !line.is_empty() {
            assert_eq!(device.status().expect("framed").faults, 1 << 8);
        }
        let trace = &run.into_parts()[0].0;
        let fell = trace.iter().find(|record| record.levels.0 >> 32 & 1 == 0).expect("EN falls");
        assert_eq!(fell.cycle.0, at + 1);
        assert_eq!(steps(trace, 0).len(), 1, "nothing moves after it");
    }
}

/// A run at both speeds and in slices: digests of trace and plant, and other results.
fn all_ways(json: &str, controllers: usize) -> Vec<Vec<(u64, u64)>> {
    let experiment = experiment(json);
    let parts = || (0..controllers).map(|_| (Digest::default(), ())).collect::<Vec<_>>();
    let told = |mut run: PlantRun<Digest, ()>, way: &dyn Fn(&mut PlantRun<Digest, ()>)| {
        way(&mut run);
        let plants: Vec<u64> = run.results().iter().map(|result| result.digest).collect();
        let cycles = run.now().0;
        let digests = run.into_parts().into_iter().map(|(digest, ())| digest.value());
        digests.zip(plants).chain([(cycles, 0)]).collect()
    };
    let start = || PlantRun::new(&experiment, parts()).expect("it has a plant");
    vec![
        told(start(), &|run| run.finish()),
        told(start(), &|run| while !run.advance(Cycles(997)) {}),
        told(start(), &|run| run.finish_clock_by_clock()),
    ]
}

#[test]
fn speeds_and_slices_change_no_edge_and_no_plant_value() {
    // A slow clock, so that a run clock by clock is short.
    let small = |rest: &str| format!(r#"{{"clock_hz":1000000,"line":{{"baud":38400{rest}"#);
    let turn = r#""source":{"motion":{"axes":[{"moves":[{"cosine":{"distance":{"steps":16},"duration_s":0.04,"ramp_s":0.02}}]}]}}"#;
    let bus = r#""bus":{"slots":10,"step_period_cycles":1000,"pulse_width_cycles":10,"dir_setup_cycles":10}"#;
    let weak = r#""protection":{"threshold_a":0.16,"samples":2},"tail_s":0.005"#;
    // An overload in the last cycle, which adds one cycle.
    let late = |samples: u32, tail_s: f64| {
        format!(
            r#"{{"clock_hz":1000000,"bus":{{"pulse_width_cycles":10,"dir_setup_cycles":10}},"source":{{"segments":{{"channels":[
                {{"segments":[{{"steps":{{"interval_q16":172294144}}}}]}}]}}}},
                "plant":{{"idle_ma":5000,"protection":{{"threshold_a":1,"samples":{samples}}},"tail_s":{tail_s}}}}}"#
        )
    };
    let rows = [
        (late(529, 6e-6), 1),
        (late(530, 11e-6), 1),
        (late(549, 106e-6), 1),
        (small(&format!(r#"}},{bus},{turn},"plant":{{"tail_s":0.01}}}}"#)), 1),
        (small(&format!(r#"}},{bus},{turn},"plant":{{{weak}}}}}"#)), 1),
        (small(&format!(r#","protocol":"framed"}},{bus},{turn},"plant":{{{weak}}}}}"#)), 1),
        (small(&format!(r#"}},"run_cycles":77777,{bus},{turn},"plant":{{"step_cycles":3}}}}"#)), 1),
        (
            small(&format!(
                r#","address":1}},{bus},{turn},"controllers":[{{"address":2,{bus},"axes":[{{"moves":[
                    {{"constant":{{"distance":{{"steps":-9}},"speed":{{"steps_s":800}}}}}}]}}]}}],"plant":{{{weak}}}}}"#
            )),
            2,
        ),
        (
            small(&format!(
                r#"}},{bus},"source":{{"line":{{"sends":[{{"start_cycle":1000,"bytes":"85"}},{{"start_cycle":30000,"bytes":"03"}}]}}}},"plant":{{"tail_s":0.01}}}}"#
            )),
            1,
        ),
        (
            small(
                r#"},"bus":{"channels":2,"slots":4,"step_period_cycles":1000,"pulse_width_cycles":10,"dir_setup_cycles":10,"self_test_cycles":48001,
                    "pulse_phasing":"staggered"},"source":{"packets":{"packets":["8181"]}},"plant":{"self_test":true,"tail_s":0.01}}"#,
            ),
            1,
        ),
    ];
    let mut overloads = 0;
    for (json, controllers) in rows {
        let ways = all_ways(&json, controllers);
        assert!(ways.windows(2).all(|pair| pair[0] == pair[1]), "{json}: {ways:x?}");
        let mut run = PlantRun::new(
            &experiment(&json),
            (0..controllers).map(|_| ((), ())).map(|((), ())| (Vec::<Record>::new(), ())).collect(),
        )
        .expect("a plant");
        run.finish();
        overloads += u32::from(run.overload(0).is_some());
    }
    assert!(overloads >= 2, "the way back was not tried");
}

#[test]
fn a_plant_alone_changes_no_edge() {
    let with = r#"{"plant":{}}"#;
    let mut without = Digest::default();
    experiment("{}").run(&mut without);
    let mut run = PlantRun::new(&experiment(with), vec![(Digest::default(), ())]).expect("a plant");
    run.finish();
    assert_eq!(run.into_parts()[0].0.value(), without.value());
}

#[test]
fn the_cost_of_a_plant_is_validated_before_the_run() {
    let cost = |json: &str| experiment(json).cost();
    assert_eq!(cost("{}").motor_grid_steps, 0);
    let default = cost(r#"{"plant":{},"run_cycles":16000000}"#);
    assert_eq!((default.motor_grid_steps, default.is_over_budget()), (200_000, false));
    let sixteen = cost(r#"{"plant":{"step_cycles":1},"bus":{"channels":16},"run_cycles":16000000}"#);
    assert_eq!((sixteen.motor_grid_steps, sixteen.is_over_budget()), (256_000_000, true));
    let problems = Experiment::from_json(
        r#"{"plant":{"step_cycles":1},"bus":{"channels":16},"run_cycles":16000000000}"#,
    )
    .expect_err("too much");
    assert_eq!(
        problems[0].to_string(),
        "plant.step_cycles: 256000000000 grid steps of all motors exceed the maximum of 10000000000; \
         use a shorter run, fewer channels or a larger step_cycles"
    );
}

fn preset(id: &str) -> &'static str {
    PLANT_PRESETS.iter().find(|preset| preset.id == id).expect("it is a preset").json
}

/// F10's "one step", and the figures of its note.
#[test]
fn each_preset_has_the_results_of_its_note() {
    let result = |id: &str| {
        let run = run(preset(id), SensorLog::default());
        let (result, overload) = (run.results().remove(0), run.overload(0));
        let log = run.into_parts().remove(0).1;
        (result, overload, log)
    };
    let (_, _, log) = result("patent-2019-figure-1");
    let rise = log.steps[0];
    let found = StepResponse::of(&log.samples, rise - 10 * 32_768, rise, 32_768, 0.2).expect("samples");
    near(found.reached.expect("it falls") as f64 / 16e3, 0.515, 0.006);
    near(found.settled.expect("it settles") as f64 / 16e3, 0.512, 0.008);

    let deviation = |json: &str| {
        let log = run(json, SensorLog::default()).into_parts().remove(0).1;
        Deviation::of(&log.samples, log.steps[0], log.steps[4]).expect("samples").max_a()
    };
    let staggered = preset("patent-2019-figure-2");
    let together = staggered.replace(r#""staggered""#, r#""simultaneous""#);
    near(deviation(&together) / deviation(staggered), 2.96, 0.05);
    let measured = |json: &str| run(json, ()).results()[0].deviation.expect("ten steps").max_a();
    near(measured(&together) / measured(staggered), 2.96, 0.05);

    let (_, overload, _) = result("patent-2019-overload");
    assert!(overload.is_some());
    let apart = preset("patent-2019-overload").replace(
        r#""dir_setup_cycles": 16"#,
        r#""dir_setup_cycles": 16, "pulse_phasing": "staggered", "settle_cycles": 8192"#,
    );
    assert_eq!(run(&apart, ()).overload(0), None);

    let motor = |id: &str| result(id).0.motors.remove(0);
    let turn = motor("song-2021-motor");
    assert_eq!((turn.lost, verdict(&turn, 16_000_000, None)), (0, "follows".to_owned()));
    near(turn.following_error.value.abs(), 0.078, 0.003);
    let direct = motor("song-2021-direct-start");
    assert_eq!(direct.lost, 0);
    near(direct.overshoot.expect("it stepped"), 0.676, 0.02);
    near(direct.settling.expect("it stepped") as f64 / 16e3, 26.5, 0.6);
    let stall = motor("song-2021-stall");
    assert_eq!(stall.lost, 188);
    assert!(
        verdict(&stall, 16_000_000, None).starts_with("loses 188 full steps, first at 2."),
        "{}",
        verdict(&stall, 16_000_000, None)
    );
    let resonance = motor("resonance-full-steps");
    assert!(resonance.slip_count > 0, "{}", verdict(&resonance, 16_000_000, None));
    for rate in ["200", "264"] {
        let json = preset("resonance-full-steps").replace("232 } }", &format!("{rate} }} }}"));
        assert_ne!(json, preset("resonance-full-steps"));
        assert_eq!(run(&json, ()).results()[0].motors[0].slip_count, 0, "{rate}");
    }
}

#[test]
fn a_load_can_turn_a_held_rotor_by_whole_periods() {
    let json = CONTROLLER_PLANT_PRESETS[0].json;
    let run = run(json, ());
    let machine = run.stand_alone().expect("a controller");
    // At the power loss the controller saved the exact step.
    assert_eq!((machine.position(0), machine.trust(0)), (Some(1619), Some(1)));
    let off = run.results()[0].motors[0].following_error;
    let plant = run.plant(0).expect("a motor");
    let commanded = 1619.0 / 16.0;
    let wrong = plant.state(0).expect("a motor").x - commanded;
    near(wrong, -8.0, 0.3);
    assert!(off.value.abs() > 8.0, "{off:?}");
}

#[test]
fn a_controller_with_a_final_wait_ends_equally_at_both_speeds() {
    let panel = r#"{"debounce_cycles":0,"max_speed_hz":1000,"memory":{"byte_write_cycles":1},
        "groups":[{"move":{"length":1,"speed_hz":1000}},{"wait":{"timeout_ms":60}}],"inputs":[{"cycle":4000,"input":"start"}]}"#;
    for (panel, least) in [(panel, 10_000), ("{\"memory\":{\"byte_write_cycles\":1}}", 1600)] {
        let json = format!(
            r#"{{"clock_hz":100000,"bus":{{"pulse_width_cycles":2,"dir_setup_cycles":1}},
                "source":{{"standalone":[{panel}]}},"plant":{{"tail_s":0.001}}}}"#
        );
        let experiment = Experiment::from_json(&json).expect("no problems");
        let fast = experiment.run(&mut Vec::<Record>::new());
        let clocked = experiment.run_clock_by_clock(&mut Vec::<Record>::new());
        assert_eq!(fast.cycles(), clocked.cycles(), "{panel}");
        assert!(fast.cycles().0 > least, "{:?}", fast.cycles());
    }
}

#[test]
fn presets_have_the_same_plant_on_every_machine() {
    let expected = [
        ("patent-2019-figure-1", "15dad058bd518a09"),
        ("patent-2019-figure-2", "03a27bce1dd6070e"),
        ("patent-2019-overload", "69c099cbc4f0336c"),
        ("song-2021-motor", "0fe6475a9e3fccbf"),
        ("song-2021-direct-start", "004aeb28b036d394"),
        ("song-2021-stall", "0172c242b93b8014"),
        ("resonance-full-steps", "e6788f170368dfb1"),
        ("controller-held-and-wrong", "2d624bcbf36c6f67"),
    ];
    let found: Vec<(&str, String)> = PLANT_PRESETS
        .iter()
        .chain(CONTROLLER_PLANT_PRESETS)
        .map(|preset| (preset.id, format!("{:016x}", run(preset.json, ()).results()[0].digest)))
        .collect();
    let expected: Vec<(&str, String)> = expected.map(|(id, digest)| (id, digest.to_owned())).into();
    assert_eq!(found, expected);
}

#[test]
fn plant_digests_match_the_contract_in_whole_and_short_runs() {
    for case in plant_cases() {
        for whole in [true, false] {
            assert_eq!(case.check(whole), Ok(()));
        }
    }
}
