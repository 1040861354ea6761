//! Encodes and decodes share links (PAGE "Share link").
//!
//! `c=<version>.<codec>.<base64url payload>.<crc>`: the payload is the canonical JSON, plain (codec `j`) or deflated
//! (codec `z`), whichever is shorter. The CRC-32 covers everything before its dot. Links are untrusted; the caller checks
//! ranges and cost.
//!
//! ```
//! use stepscope_scenario::{Scenario, link};
//!
//! let scenario = Scenario { title: "mine".into(), ..Scenario::default() };
//! let text = link::encode(&scenario).expect("short enough");
//! assert_eq!(link::decode(&format!("#{text}")), Ok(scenario));
//! assert_eq!(link::decode(&text[..text.len() - 1]), Err(link::LinkError::Damaged));
//! ```

use crate::{Problems, Scenario, VERSION};
use alloc::{format, string::String};
use base64ct::{Base64UrlUnpadded, Encoding};
use core::fmt;
use crc::{CRC_32_ISO_HDLC, Crc};
use miniz_oxide::{deflate::compress_to_vec, inflate::decompress_to_vec_with_limit};
use percent_encoding::percent_decode_str;

/// Maximum bytes of a fragment.
pub const MAX_FRAGMENT_BYTES: usize = 16 << 10;
/// Maximum bytes of the canonical JSON.
pub const MAX_JSON_BYTES: usize = 64 << 10;
/// miniz_oxide's strongest level. Fixed, so that a scenario's link never changes.
const DEFLATE_LEVEL: u8 = 10;
const CRC_32: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
/// Maximum problems in one message.
const MAX_LISTED: usize = 8;
/// Punctuation that a chat program or a sentence may add to a link.
const TRAILING: &[char] = &['.', ',', ';', ':', '!', '?', ')', ']', '}', '>', '"', '\''];

/// Why a link does not open.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[allow(missing_docs, reason = "fields are named as in the message")]
pub enum LinkError {
    /// Longer than any link.
    TooLong { given: usize, most: usize },
    /// It has no `c=`.
    NoScenario,
    /// The format is newer than this reader.
    Newer { given: u64, newest: u32 },
    /// Wrong CRC: truncated or changed.
    Damaged,
    /// The payload does not fit its codec, or inflates to too much.
    Payload { most: usize },
    /// The scenario has problems.
    Scenario(Problems),
}

impl fmt::Display for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong { given, most } => {
                write!(
                    f,
                    "the link is too long: {given} bytes, at most {most} are allowed; share the scenario as a file"
                )
            }
            Self::NoScenario => {
                f.write_str("the link has no scenario (no c= after #); ask for the complete link")
            }
            Self::Newer { given, newest } => write!(
                f,
                "the link was made with a newer version of Stepscope (format {given}, this one reads up to {newest}); reload the page to update, or ask for the scenario as a file"
            ),
            Self::Damaged => f.write_str("the link was cut short or changed; ask for the complete link"),
            Self::Payload { most } => write!(
                f,
                "the link has no valid scenario, or one of more than {most} bytes; ask for the link again"
            ),
            Self::Scenario(problems) => {
                f.write_str("the link's scenario has problems")?;
                for (index, problem) in problems.iter().take(MAX_LISTED).enumerate() {
                    write!(f, "{}{problem}", if index == 0 { ": " } else { "; " })?;
                }
                if let Some(more @ 1..) = problems.len().checked_sub(MAX_LISTED) {
                    write!(f, "; and {more} more")?;
                }
                Ok(())
            }
        }
    }
}

impl core::error::Error for LinkError {}

/// Encodes a scenario as a link, without the `#`.
/// Errors: [`LinkError::TooLong`] if the scenario's JSON or the link is longer than [`decode`] reads.
pub fn encode(scenario: &Scenario) -> Result<String, LinkError> {
    pack(&scenario.to_compact_json())
}

/// Encodes a scenario's compact JSON ([`Scenario::to_compact_json`]) as a link.
/// Errors: as [`encode`].
pub fn pack(json: &str) -> Result<String, LinkError> {
    if json.len() > MAX_JSON_BYTES {
        return Err(LinkError::TooLong { given: json.len(), most: MAX_JSON_BYTES });
    }
    let deflated = compress_to_vec(json.as_bytes(), DEFLATE_LEVEL);
    let (codec, payload) =
        if deflated.len() < json.len() { ('z', deflated.as_slice()) } else { ('j', json.as_bytes()) };
    let text = format!("{VERSION}.{codec}.{}", Base64UrlUnpadded::encode_string(payload));
    let link = format!("c={text}.{:08x}", CRC_32.checksum(text.as_bytes()));
    if link.len() > MAX_FRAGMENT_BYTES {
        return Err(LinkError::TooLong { given: link.len(), most: MAX_FRAGMENT_BYTES });
    }
    Ok(link)
}

/// Appends `&name=text`, unless the link would become too long to read.
pub fn with_part(link: String, name: &str, text: &str) -> String {
    if text.is_empty() || link.len() + name.len() + text.len() + 2 > MAX_FRAGMENT_BYTES {
        return link;
    }
    link + "&" + name + "=" + text
}

/// Decodes a link's fragment, with or without `#`; ignores other parts (`&v=`, `&d=`).
/// Errors: the first that [`LinkError`] lists.
pub fn decode(fragment: &str) -> Result<Scenario, LinkError> {
    let Packed { json, version } = unpack(fragment)?;
    Scenario::from_json_of(&json, version).map_err(LinkError::Scenario)
}

/// The contents of a link before they are read as a scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Packed {
    /// The scenario's JSON as written.
    pub json: String,
    /// The link's version, for [`Scenario::from_json_of`].
    pub version: u64,
}

/// Decodes the JSON in a link's fragment.
/// Errors: as [`decode`], except problems of the scenario.
pub fn unpack(fragment: &str) -> Result<Packed, LinkError> {
    if fragment.len() > MAX_FRAGMENT_BYTES {
        return Err(LinkError::TooLong { given: fragment.len(), most: MAX_FRAGMENT_BYTES });
    }
    let text = part(fragment, "c").ok_or(LinkError::NoScenario)?;
    let (version, rest) = text.split_once('.').unwrap_or((&text, ""));
    let version: u64 = version.parse().map_err(|_| LinkError::Damaged)?;
    if version == 0 {
        // Versions count from 1.
        return Err(LinkError::Damaged);
    }
    if version > u64::from(VERSION) {
        return Err(LinkError::Newer { given: version, newest: VERSION });
    }
    let (checked, check) = text.rsplit_once('.').ok_or(LinkError::Damaged)?;
    if check != format!("{:08x}", CRC_32.checksum(checked.as_bytes())) {
        return Err(LinkError::Damaged);
    }
    let (codec, payload) =
        rest.rsplit_once('.').and_then(|(rest, _)| rest.split_once('.')).ok_or(LinkError::Damaged)?;
    let payload = Base64UrlUnpadded::decode_vec(payload).map_err(|_| LinkError::Damaged)?;
    let bad = LinkError::Payload { most: MAX_JSON_BYTES };
    let json = match codec {
        "z" => decompress_to_vec_with_limit(&payload, MAX_JSON_BYTES).map_err(|_| bad.clone())?,
        "j" => payload,
        _ => return Err(LinkError::Damaged),
    };
    let json = String::from_utf8(json).map_err(|_| bad)?;
    Ok(Packed { json, version })
}

/// Returns part `name` of a fragment without trailing punctuation. Accepts percent-encoded links and line breaks.
pub fn part(fragment: &str, name: &str) -> Option<String> {
    fragment.trim().split('&').filter_map(|part| percent_decode_str(part).decode_utf8().ok()).find_map(
        |part| {
            part.trim_start_matches('#')
                .split('&')
                .find_map(|part| part.strip_prefix(name)?.strip_prefix('='))
                .map(|part| part.trim_end_matches(TRAILING).replace(is_blank, ""))
        },
    )
}

/// Mail programs wrap links; a link itself has no blanks.
fn is_blank(letter: char) -> bool {
    letter.is_ascii_whitespace()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Motion, Problem, Source};
    use alloc::string::ToString;
    use stepscope_motion::{
        mechanics::Distance,
        moves::{Axis, Cosine, Move},
    };
    use stepscope_peripheral::config::Bus;

    fn sixteen_axes() -> Scenario {
        let axis = |i: i32| Axis {
            moves: alloc::vec![Move::Cosine(Cosine {
                distance: Distance::Steps(f64::from(1000 + 137 * i)),
                duration_s: 0.4 + f64::from(i) / 64.0,
                ramp_s: 0.1 + f64::from(i) / 100.0,
                ..Cosine::default()
            })],
            ..Axis::default()
        };
        Scenario {
            title: "Sixteen different channels".into(),
            bus: Bus { channels: 16, ..Bus::default() },
            source: Source::Motion(Motion { axes: (0..16).map(axis).collect(), ..Motion::default() }),
            ..Scenario::default()
        }
    }

    #[test]
    fn links_and_scenarios_round_trip() {
        for scenario in [Scenario::default(), sixteen_axes()] {
            let link = encode(&scenario).expect("short enough");
            assert_eq!(decode(&link), Ok(scenario.clone()));
            assert_eq!(encode(&decode(&link).expect("opens")), Ok(link));
        }
        assert!(encode(&sixteen_axes()).expect("short enough").len() < 900);
    }

    #[test]
    fn copies_from_chat_programs_open() {
        let scenario = sixteen_axes();
        let link = encode(&scenario).expect("short enough");
        let encoded = link.replace('=', "%3D").replace('.', "%2E");
        for copy in [
            format!("#{link}"),
            format!("{link}."),
            format!("{link})."),
            format!("#{link}&v=broken&d=0"),
            format!("v=%zz&{link}"),
            format!("{link}&v=%ff"),
            format!("v=%ff&{link}"),
            format!("{link}%26v=1"),
            format!("  #{link}  "),
            encoded,
            format!("{}%0D%0A{}", &link[..76], &link[76..]),
            format!("{}\n{}\n", &link[..76], &link[76..]),
        ] {
            assert_eq!(decode(&copy), Ok(scenario.clone()), "{copy}");
        }
    }

    #[test]
    fn parts_are_added_while_the_link_is_short_enough() {
        let link = encode(&sixteen_axes()).expect("short enough");
        let whole = with_part(with_part(link.clone(), "v", "1-2"), "d", "1.x");
        assert_eq!(whole, format!("{link}&v=1-2&d=1.x"));
        assert_eq!((part(&whole, "v"), part(&whole, "d")), (Some("1-2".into()), Some("1.x".into())));
        assert_eq!(with_part(link.clone(), "v", ""), link);
        let room = MAX_FRAGMENT_BYTES - link.len() - 3;
        assert_eq!(with_part(link.clone(), "d", &"x".repeat(room)).len(), MAX_FRAGMENT_BYTES);
        assert_eq!(with_part(link.clone(), "d", &"x".repeat(room + 1)), link);
    }

    #[test]
    fn every_truncation_is_refused() {
        let link = encode(&sixteen_axes()).expect("short enough");
        for length in 0..link.len() {
            decode(&link[..length]).expect_err(&link[..length]);
        }
    }

    #[test]
    fn every_flipped_character_is_refused() {
        let link = encode(&sixteen_axes()).expect("short enough");
        for at in 0..link.len() {
            for with in ["A", "0", "z", "_", ".", "=", "%", "&", " ", "~"] {
                if link[at..=at] != *with && link.get(at + 1..).is_some_and(|rest| !rest.is_empty()) {
                    let flipped = format!("{}{with}{}", &link[..at], &link[at + 1..]);
                    decode(&flipped).expect_err(&flipped);
                }
            }
        }
    }

    #[test]
    fn the_version_is_checked_before_the_crc() {
        let rows = [
            ("c=4.z.anything.00000000", LinkError::Newer { given: 4, newest: VERSION }),
            ("c=99", LinkError::Newer { given: 99, newest: VERSION }),
            ("c=1.z.AAAA.00000000", LinkError::Damaged),
            ("c=2.z.AAAA.00000000", LinkError::Damaged),
            ("c=x", LinkError::Damaged),
            ("c=0.j.e30.0768f5dc", LinkError::Damaged),
            ("d=1", LinkError::NoScenario),
            ("", LinkError::NoScenario),
        ];
        for (link, expected) in rows {
            assert_eq!(decode(link), Err(expected), "{link}");
        }
        let long = "c=1".repeat(MAX_FRAGMENT_BYTES);
        assert!(matches!(decode(&long), Err(LinkError::TooLong { .. })));
    }

    fn link_of(codec: char, payload: &[u8]) -> String {
        let text = format!("{VERSION}.{codec}.{}", Base64UrlUnpadded::encode_string(payload));
        format!("c={text}.{:08x}", CRC_32.checksum(text.as_bytes()))
    }

    #[test]
    fn a_deflate_bomb_is_refused() {
        let bomb = link_of('z', &compress_to_vec(&alloc::vec![b' '; 10 << 20], DEFLATE_LEVEL));
        assert!(bomb.len() < MAX_FRAGMENT_BYTES, "{}", bomb.len());
        assert_eq!(decode(&bomb), Err(LinkError::Payload { most: MAX_JSON_BYTES }));
    }

    #[test]
    fn a_message_names_some_problems_and_counts_the_others() {
        let problem =
            |count: u32| Problem::new("bus.slots", stepscope_motion::Cause::NoSteps { steps: count.into() });
        let problems = |count| Problems::new((0..count).map(problem).collect()).expect("there are some");
        let text = |count| LinkError::Scenario(problems(count)).to_string();
        assert!(text(8).matches("bus.slots").count() == 8 && !text(8).contains("more"));
        assert!(text(100).matches("bus.slots").count() == 8 && text(100).ends_with("; and 92 more"));
    }

    #[test]
    fn unknown_fields_and_wrong_types_are_refused_with_their_paths() {
        for (json, path) in [
            (r#"{"__proto__":{"version":1}}"#, "__proto__"),
            (r#"{"bus":{"constructor":1}}"#, "bus.constructor"),
            (r#"{"bus":{"slots":"1"}}"#, "bus.slots"),
        ] {
            match decode(&link_of('j', json.as_bytes())) {
                Err(LinkError::Scenario(problems)) => assert_eq!(problems[0].path, path),
                other => panic!("{json}: {other:?}"),
            }
        }
        assert_eq!(decode(&link_of('j', &[0xff])), Err(LinkError::Payload { most: MAX_JSON_BYTES }));
    }
}
