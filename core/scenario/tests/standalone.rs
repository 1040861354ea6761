//! Stand-alone controllers in scenarios: every error has its path (CONTROLLER.md, "The format").

use stepscope_scenario::{Compact, Scenario};

fn problems(controllers: &str) -> Vec<String> {
    let json = format!(r#"{{"bus":{{"channels":2}},"source":{{"standalone":{controllers}}}}}"#);
    let (scenario, unreadable) = Scenario::from_json_lenient(&json);
    let problems: Vec<_> = unreadable.into_iter().chain(scenario.check().err()).flatten().collect();
    problems.iter().map(ToString::to_string).collect()
}

#[test]
fn every_error_names_its_field_and_numbers() {
    let at = "source.standalone[0]";
    let rows: &[(&str, &[&str])] = &[
        ("[{}]", &[]),
        ("[{},{}]", &[]),
        ("[]", &["source.standalone: 0 controllers; use at least 1"]),
        (
            "[{},{},{}]",
            &[
                "source.standalone: 3 controllers, but `bus.channels` is 2; remove 1, or set `bus.channels` to 3",
            ],
        ),
        (
            r#"[{"max_speed_hz":300000}]"#,
            &[
                "{at}.max_speed_hz: 300000 Hz is a step every 53 cycles, but a pulse with its pauses takes 80; use 10 to 200000 Hz",
            ],
        ),
        (
            r#"[{"home":{"coarse_hz":1500}}]"#,
            &[
                "{at}.home.coarse_hz: 1500 Hz is above `start_speed_hz`, but homing has no ramp; use 10 to 1000 Hz",
            ],
        ),
        (
            r#"[{"groups":[{"home":{}},{"move":{}},{"repeat":{"first":3}},{"jump":{"to":9}}]}]"#,
            &[
                "{at}.groups[0].home: the controller has no `home`; add one or remove this group",
                "{at}.groups[2].repeat.first: 3 is not before this group (3); use 1 to 2",
                "{at}.groups[3].jump.to: there is no group 9; use 1 to 4",
            ],
        ),
        (
            r#"[{"axis":{"max_switch_at_steps":5},"inputs":[{"cycle":9,"input":"limit_max"},{"cycle":4000,"input":"start"},{"cycle":4000,"input":"start","level":0}]}]"#,
            &[
                "{at}.inputs[0]: limit_max is driven by axis.max_switch_at_steps; remove one of them",
                "{at}.inputs[2]: start has two entries at cycle 4000; use one",
            ],
        ),
        (
            r#"[{},{"inputs":[{"cycle":9,"input":"estop"},{"cycle":0,"input":"start"},{"cycle":9},{"cycle":9,"input":"ok","push_steps":3}]}]"#,
            &[
                "source.standalone[1].inputs[1].cycle: 0 cycles is out of range; use 1 to 9000000000000000 cycles",
                "source.standalone[1].inputs[2]: the entry is empty; use an input, or `push_steps`",
                "source.standalone[1].inputs[3]: an entry is an input or a push, not both; make two entries",
                "source.standalone[1].inputs[0]: estop applies to all controllers; use it only in the script of the first controller",
            ],
        ),
        (
            r#"[{"groups":[{"profile":{"intervals_q16":[5242880,5242879]}},{"profile":{"motion":{"sine":{"periods":1}}}}]}]"#,
            &[
                "{at}.groups[1].profile.motion: moves in both directions, but a profile moves in one; use one group per direction",
                "{at}.groups[0].profile.intervals_q16[1]: 5242879/65536 cycle is shorter than a pulse with its pauses; use at least 5242880/65536 cycle",
            ],
        ),
        (
            r#"[{"groups":[{"profile":{"motion":{"cosine":{"duration_s":-1}}}}],"loops":0,"memory":{"initial":"0g"}}]"#,
            &[
                "{at}.memory.initial: \u{201c}g\u{201d} in byte 1 is not a hexadecimal digit; use two digits per byte, such as 80 01 7f; or use blank or factory",
                "{at}.loops: 0 is out of range; use 1 to 9999",
                "{at}.groups[0].profile.motion.cosine.duration_s: -1 s is out of range; use 1e-6 to 86400 s",
            ],
        ),
        (r#"[{"groups":[]}]"#, &["{at}.groups: 0 groups; use 1 to 50"]),
        (
            r#"[{"soft_limits":{"min_steps":5,"max_steps":4}}]"#,
            &["{at}.soft_limits.max_steps: 4 is out of range; use 5 to 2147483648"],
        ),
    ];
    for (given, expected) in rows {
        let expected: Vec<String> = expected.iter().map(|text| text.replace("{at}", at)).collect();
        assert_eq!(problems(given), expected, "{given}");
    }
}

#[test]
fn controllers_round_trip_through_the_canonical_form() {
    let json = r#"{"source":{"standalone":[{"groups":[{"home":{}},{"move_to":{"length":-5}},{"profile":{"direction":"negative","intervals_q16":[18446744073709551615]}}],"home":{},"inputs":[{"cycle":7,"input":"key_9"},{"push_steps":-3}],"memory":{"initial":"01ff","policy":"write_ahead"},"return":{"speed_hz":500},"short_move":"reverse"}]}}"#;
    let scenario = Scenario::from_json(json).expect("reads");
    assert_eq!(scenario.compact().to_string(), json);
    assert_eq!(Scenario::from_json(&scenario.to_json()), Ok(scenario));
}

#[test]
fn only_the_pulse_of_the_bus_is_validated_and_no_line() {
    let rows = [
        (r#""line":{"baud":0}"#, None),
        (r#""bus":{"slots":0}"#, Some("bus.slots")),
        (r#""bus":{"pulse_width_cycles":0}"#, Some("bus.pulse_width_cycles")),
        (r#""controllers":[{}]"#, Some("controllers")),
        (r#""plant":{"protection":{}}"#, None),
        (r#""plant":{"self_test":true}"#, Some("plant.self_test")),
    ];
    for (given, expected) in rows {
        let json = format!(r#"{{{given},"source":{{"standalone":[{{}}]}}}}"#);
        let found = Scenario::from_json(&json)
            .expect("reads")
            .check()
            .err()
            .into_iter()
            .flatten()
            .collect::<Vec<_>>();
        assert_eq!(found.first().map(|problem| problem.path.as_str()), expected, "{given}: {found:?}");
    }
}
