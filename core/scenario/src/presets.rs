//! Presets: experiments from the papers, shared by tests, command and page.

use crate::Scenario;

/// A preset.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// Name in files and on the command line.
    pub id: &'static str,
    /// Heading in the menu: the paper that it comes from.
    pub document: &'static str,
    /// The scenario as JSON.
    pub json: &'static str,
}

impl Preset {
    /// Reads the scenario. Tests check that every preset is valid.
    pub fn scenario(&self) -> Scenario {
        Scenario::from_json(self.json).unwrap_or_default()
    }
}

const SINE: &str = "SWorldJournal 2022: sine by segments";
const SONG: &str = "Song 2021: exact S-curve";
const SONOBE: &str = "Sonobe 2011: acceleration table";
const PATENT: &str = "RU 2704486, 2019: tick packets";
const ZHANG: &str = "Zhang 2012: fixed-length controller";
const ALONE: &str = "Stand-alone controller: additional functions";
const FRAMED: &str = "Framed protocol: checked, acknowledged, repeated";
const PROFILES: &str = "Additional profiles: exact sine, jerk-limited, points";
const DRIVERS: &str = "Driver data sheets: timing";

macro_rules! presets {
    ($(#[$meta:meta])* $list:ident: $($document:expr => $id:literal;)*) => {
        $(#[$meta])*
        pub const $list: &[Preset] = &[$(Preset {
            id: $id,
            document: $document,
            json: include_str!(concat!("../presets/", $id, ".json")),
        }),*];
    };
}

presets! {
    /// All presets of the page, in the order of its menu.
    PRESETS:
    SONG => "song-2021-one-turn";
    SONG => "song-2021-plateau";
    SONG => "song-2021-sliced";
    SONG => "song-2021-ramps";
    SONOBE => "sonobe-2011-table";
    SONOBE => "sonobe-2011-segments";
    ZHANG => "zhang-2012-fixed-length";
    ZHANG => "zhang-2012-staircase";
    SINE => "sine-2022-d00054";
    SINE => "sine-2022-d0006";
    PROFILES => "exact-sine";
    PROFILES => "jerk-limited";
    PROFILES => "points";
    PATENT => "patent-2019-four-motors";
    PATENT => "patent-2019-sixteen-motors";
    PATENT => "patent-2019-staggered";
    PATENT => "patent-2019-common-dir";
    PATENT => "patent-2019-addressed";
    PATENT => "two-controllers-raw";
    PATENT => "glitches-and-breaks";
    FRAMED => "framed-link";
    FRAMED => "raw-noisy-line";
    FRAMED => "framed-noisy-line";
    FRAMED => "four-controllers-framed";
    DRIVERS => "driver-timing-broken";
}

presets! {
    /// Presets with a plant.
    PLANT_PRESETS:
    PATENT => "patent-2019-figure-1";
    PATENT => "patent-2019-figure-2";
    PATENT => "patent-2019-overload";
    SONG => "song-2021-motor";
    SONG => "song-2021-direct-start";
    SONG => "song-2021-stall";
    PROFILES => "resonance-full-steps";
}

presets! {
    /// Presets of stand-alone controllers.
    CONTROLLER_PRESETS:
    ZHANG => "zhang-2012-controller";
    ZHANG => "zhang-2012-program";
    ZHANG => "zhang-2012-zero-by-jog";
    ALONE => "controller-homing";
    ALONE => "controller-limit";
    ALONE => "controller-emergency-stop";
    ALONE => "controller-power-cut";
    ALONE => "controller-power-cut-lost";
}

presets! {
    /// Presets of stand-alone controllers with a plant.
    CONTROLLER_PLANT_PRESETS:
    ALONE => "controller-held-and-wrong";
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Kinds, VERSION};
    use alloc::vec::Vec;

    #[test]
    fn every_kind_of_move_has_a_preset() {
        for kind in stepscope_motion::moves::Move::KINDS {
            let key = alloc::format!("\"{kind}\": {{");
            assert!(PRESETS.iter().any(|preset| preset.json.contains(&key)), "{kind}");
        }
    }

    #[test]
    fn every_preset_is_valid() {
        let all: Vec<&Preset> = PRESETS
            .iter()
            .chain(PLANT_PRESETS)
            .chain(CONTROLLER_PRESETS)
            .chain(CONTROLLER_PLANT_PRESETS)
            .collect();
        for (index, preset) in all.iter().enumerate() {
            let scenario = Scenario::from_json_of(preset.json, VERSION.into())
                .unwrap_or_else(|p| panic!("{}: {p:?}", preset.id));
            let lines: Vec<&str> = scenario.note.lines().collect();
            let [_, attempt] = lines[..] else { panic!("{}: two lines: {lines:?}", preset.id) };
            assert!(attempt.starts_with("Try "), "{}: {lines:?}", preset.id);
            assert!(!scenario.title.is_empty() && !scenario.note.contains('_'), "{}", preset.id);
            scenario.check().unwrap_or_else(|p| panic!("{}: {p:?}", preset.id));
            assert!(all[..index].iter().all(|other| other.id != preset.id), "{} twice", preset.id);
        }
    }
}
