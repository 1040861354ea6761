//! From one version of the format to the next, one function a step. A step that was published is never removed: every
//! file and link that was ever written still opens.

use alloc::string::String;
use serde_json::{Map, Value};

/// Version 1 had other names for some fields and words; their meaning is the same.
pub(crate) fn from_1(scenario: &mut Value) {
    let Some(scenario) = scenario.as_object_mut() else { return };
    rename(scenario, "driver", "driver_timing");
    each(scenario.get_mut("bus"), bus);
    each(scenario.get_mut("line"), |line| {
        each(line.get_mut("host"), |host| rename(host, "ticks_a_frame", "ticks_per_frame"));
        each(line.get_mut("noise"), |noise| {
            rename(noise, "doubled_bytes_ppm", "duplicated_bytes_ppm");
            rename(noise, "deaths_ppm", "host_crashes_ppm");
        });
    });
    each(scenario.get_mut("source"), |source| {
        each(source.get_mut("motion"), |motion| axes(motion.get_mut("axes")));
    });
    each(scenario.get_mut("controllers"), |controller| {
        each(controller.get_mut("bus"), bus);
        axes(controller.get_mut("axes"));
    });
    if scenario.contains_key("version") {
        scenario.insert("version".into(), 2.into());
    }
}

fn bus(bus: &mut Map<String, Value>) {
    rename(bus, "pulses", "pulse_phasing");
}

fn axes(axes: Option<&mut Value>) {
    each(axes, |axis| {
        each(axis.get_mut("moves"), |each_move| {
            each(each_move.get_mut("staircase"), |staircase| {
                if let Some(word) = staircase.get_mut("short_move").filter(|word| *word == "turn_round") {
                    *word = "reverse".into();
                }
            });
        });
    });
}

/// Does something to a map, or to each map of a list; what is neither is left to the reader, who says so.
fn each(value: Option<&mut Value>, mut change: impl FnMut(&mut Map<String, Value>)) {
    match value {
        Some(Value::Object(map)) => change(map),
        Some(Value::Array(entries)) => entries.iter_mut().filter_map(Value::as_object_mut).for_each(change),
        _ => {}
    }
}

/// Gives a field its new name; where both stand, the reader tells of the old one.
fn rename(map: &mut Map<String, Value>, old: &str, new: &str) {
    if !map.contains_key(new)
        && let Some(value) = map.remove(old)
    {
        map.insert(new.into(), value);
    }
}
