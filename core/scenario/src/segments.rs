//! Checks segment lists (DESIGN A8) and converts them for the segment engine, and back.

use crate::{
    ChannelSegments, Direction, DwellSegment, Segment, SegmentLists, StepSegment, Validator, check::Channels,
};
use stepscope_motion::{Cause, MAX_PROBLEMS};
use stepscope_peripheral::segment::{self, CheckedSegments, PulseTimes, Refused, SegmentList};
use stepscope_peripheral::{config::Bus, signal::MAX_CHANNELS, units::Instant};

/// Maximum segments of all channels together.
const MAX_SEGMENTS: usize = 1_000_000;

impl SegmentLists {
    /// The lists, or problems in `validator`, whose path is the path of the lists.
    pub(crate) fn check(&self, bus: &Bus, validator: &mut Validator) -> Option<CheckedSegments> {
        let before = validator.count();
        let channels = Channels { count: bus.channels, path: "bus.channels" };
        channels.check_count(self.channels.len(), 0, "lists of segments", validator);
        let total = self.channels.iter().map(|channel| channel.segments.len()).sum();
        validator.length("", total, 0..=MAX_SEGMENTS, "segments");
        let pulse = PulseTimes::from(bus);
        let lists = self.channels.iter().take(MAX_CHANNELS).map(ChannelSegments::to_list).collect();
        match CheckedSegments::new(pulse, lists, MAX_PROBLEMS) {
            Ok(lists) => (validator.count() == before).then_some(lists),
            Err(refused) => {
                for Refused { channel, segment, refusal } in refused {
                    // `check_ranges` has checked the starts.
                    if let Some(segment) = segment {
                        let cause = Cause::of_refusal(refusal, pulse);
                        validator.at_entry(channel, |list| {
                            list.at("segments", |segments| {
                                segments.at_entry(segment, |here| here.add("", cause));
                            });
                        });
                    }
                }
                None
            }
        }
    }
}

impl ChannelSegments {
    fn to_list(&self) -> SegmentList {
        let segments = self.segments.iter().map(|each| match each {
            Segment::Steps(steps) => segment::Segment::Steps {
                count: steps.count,
                interval: steps.interval_q16,
                add: steps.add_q16,
                right: steps.direction.is_positive(),
            },
            Segment::Dwell(dwell) => segment::Segment::Dwell(dwell.length_q16),
        });
        SegmentList { start: Instant(self.start_cycle), segments: segments.collect() }
    }
}

impl From<&CheckedSegments> for SegmentLists {
    fn from(checked: &CheckedSegments) -> Self {
        let segment = |each: &segment::Segment| match *each {
            segment::Segment::Steps { count, interval, add, right } => {
                let direction = Direction::of_dir(right);
                Segment::Steps(StepSegment { count, interval_q16: interval, add_q16: add, direction })
            }
            segment::Segment::Dwell(length_q16) => Segment::Dwell(DwellSegment { length_q16 }),
        };
        let channels = checked.lists().iter().map(|list| ChannelSegments {
            start_cycle: list.start.0,
            segments: list.segments.iter().map(segment).collect(),
        });
        Self { channels: channels.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Compact, Scenario};
    use alloc::{format, string::ToString, vec::Vec};

    fn problems(source: &str) -> Vec<alloc::string::String> {
        let json = format!(r#"{{"source":{{"segments":{{"channels":[{source}]}}}}}}"#);
        let scenario = Scenario::from_json(&json).expect("reads");
        scenario.check().err().iter().flatten().map(ToString::to_string).collect()
    }

    #[test]
    fn every_error_names_its_segment_and_numbers() {
        let rows: [(&str, &[&str]); 7] = [
            ("", &[]),
            (r#"{"segments":[{"steps":{}},{"dwell":{}}]}"#, &[]),
            (
                "{},{}",
                &[
                    "source.segments.channels: 2 lists of segments, but `bus.channels` is 1; remove 1, or set `bus.channels` to 2",
                ],
            ),
            (
                r#"{"start_cycle":0}"#,
                &[
                    "source.segments.channels[0].start_cycle: 0 cycles is out of range; use 1 to 281474976710655 cycles",
                ],
            ),
            (
                r#"{"segments":[{"dwell":{}},{"steps":{"count":0}},{"steps":{"interval_q16":5242879}},{"steps":{"count":4000000000,"interval_q16":8242880,"add_q16":-1}}]}"#,
                &[
                    "source.segments.channels[0].segments[1]: 0 steps; use at least 1 step, or a dwell",
                    "source.segments.channels[0].segments[2]: step 1 follows after 79.99998474121094 cycles, but a pulse needs 80 cycles (width 40 + max(hold 0 + setup 40, 1)); use at least 80 cycles, or shorter pulse times",
                    "source.segments.channels[0].segments[3]: step 3000002 follows after 79.99998474121094 cycles, but a pulse needs 80 cycles (width 40 + max(hold 0 + setup 40, 1)); use at least 80 cycles, or shorter pulse times",
                ],
            ),
            (
                r#"{"segments":[{"steps":{"count":3,"interval_q16":18446744073709551615,"add_q16":9223372036854775807}},{"steps":{}}]}"#,
                &[
                    "source.segments.channels[0].segments[0]: step 2 follows after 422212465065984 cycles; use at most 281474976710655 cycles",
                ],
            ),
            (
                r#"{"segments":[{"steps":{"count":4000000000}},{"steps":{"count":4000000000,"interval_q16":10485760000}},{"steps":{"count":1}}]}"#,
                &[
                    "source.segments.channels[0].segments[1]: the segment ends too late, in cycle 704000000000001; use at most cycle 281474976710655",
                ],
            ),
        ];
        for (given, expected) in rows {
            assert_eq!(problems(given), *expected, "{given}");
        }
    }

    #[test]
    fn only_the_pulse_and_the_channels_of_the_bus_matter() {
        let rows = [
            (
                r#""bus":{"pulse_width_cycles":1000000000,"dir_setup_cycles":1000000000,"dir_hold_cycles":1000000000}"#,
                true,
            ),
            (r#""clock_hz":11"#, true),
            (r#""line":{"baud":0}"#, true),
            (r#""line":{"receiver_baud":4000000000,"baud":4000000000}"#, true),
            (r#""bus":{"pulse_width_cycles":0}"#, false),
            (r#""bus":{"channels":0}"#, false),
            (r#""line":{"protocol":"framed","receiver_baud":0}"#, true),
            (r#""controllers":[{}],"line":{"address":0}"#, false),
        ];
        for (given, expected) in rows {
            let json = format!(r#"{{{given},"source":{{"segments":{{"channels":[]}}}}}}"#);
            assert_eq!(Scenario::from_json(&json).expect("reads").check().is_ok(), expected, "{given}");
        }
    }

    #[test]
    fn segments_round_trip_through_the_canonical_form() {
        let json = r#"{"source":{"segments":{"channels":[{"segments":[{"steps":{"add_q16":-12,"direction":"negative"}},{"dwell":{"length_q16":18446744073709551615}},{"steps":{}}]}]}}}"#;
        let scenario = Scenario::from_json(json).expect("reads");
        assert_eq!(scenario.compact().to_string(), json);
        assert_eq!(Scenario::from_json(&scenario.to_json()), Ok(scenario));
        // An unreadable segment must not shift the others.
        let json = r#"{"source":{"segments":{"channels":[{"segments":[5,{"steps":{"count":-1}},{"step":{}},{"steps":{"count":7}}]}]}}}"#;
        let (scenario, problems) = Scenario::from_json_lenient(json);
        let mut paths: Vec<_> = problems.iter().flatten().map(|problem| problem.path.as_str()).collect();
        paths.sort_unstable();
        let at = "source.segments.channels[0].segments";
        assert_eq!(paths, [format!("{at}[0]"), format!("{at}[1].steps.count"), format!("{at}[2]")]);
        assert!(scenario.compact().to_string().contains(r#"{"steps":{"count":7}}]"#), "{scenario:?}");
    }
}
