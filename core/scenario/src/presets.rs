//! Presets: experiments from the papers, shared by tests, command and page.

use crate::Scenario;
use alloc::{format, string::String, vec::Vec};

/// A preset.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// Name in files and on the command line.
    pub id: &'static str,
    /// What it is for.
    pub task: Task,
    /// The paper that it comes from: author, year and subject.
    pub paper: Option<&'static str>,
    /// The view that it opens with, as part `v` of a link: time in cycles, tab of a narrow screen, selected views.
    pub view: &'static str,
    /// The scenario as JSON.
    pub json: &'static str,
}

impl Preset {
    /// Reads the scenario. Tests check that every preset is valid.
    pub fn scenario(&self) -> Scenario {
        Scenario::from_json(self.json).unwrap_or_default()
    }
}

/// All presets, in the order of the command's list.
pub fn all() -> impl Iterator<Item = &'static Preset> {
    [PRESETS, PLANT_PRESETS, CONTROLLER_PRESETS, CONTROLLER_PLANT_PRESETS].into_iter().flatten()
}

/// The preset of this name.
///
/// # Errors
/// No such preset; the message lists all names.
pub fn find(id: &str) -> Result<&'static Preset, String> {
    all().find(|preset| preset.id == id).ok_or_else(|| {
        let names: Vec<&str> = all().map(|preset| preset.id).collect();
        format!("unknown preset {id:?}; use one of {}", names.join(", "))
    })
}

/// What a preset is for: its group in the page's gallery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// Curves, ramps and step times.
    Motion,
    /// Commands on the serial line, and their pulses.
    Packets,
    /// Pulses against a data sheet.
    DriverTiming,
    /// Simulated motors, drivers and supply.
    Motor,
    /// Stand-alone controllers.
    Controller,
}

impl Task {
    /// Its title.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Motion => "Motion",
            Self::Packets => "Packets",
            Self::DriverTiming => "Driver timing",
            Self::Motor => "Motor",
            Self::Controller => "Controller",
        }
    }
}

const SINE: Option<&str> = Some("SWorldJournal 2022: sine by segments");
const SONG: Option<&str> = Some("Song 2021: exact S-curve");
const SONOBE: Option<&str> = Some("Sonobe 2011: acceleration table");
const PATENT: Option<&str> = Some("RU 2704486, 2019: tick packets");
const ZHANG: Option<&str> = Some("Zhang 2012: fixed-length controller");

macro_rules! presets {
    ($(#[$meta:meta])* $list:ident: $($task:ident, $paper:expr => $id:literal, $view:literal;)*) => {
        $(#[$meta])*
        pub const $list: &[Preset] = &[$(Preset {
            id: $id,
            task: Task::$task,
            paper: $paper,
            view: $view,
            json: include_str!(concat!("../presets/", $id, ".json")),
        }),*];
    };
}

presets! {
    /// All presets of the page, in the order of its menu.
    PRESETS:
    Motion, SONG => "song-2021-one-turn", "tmotion";
    Motion, SONG => "song-2021-plateau", "tmotion";
    Motion, SONG => "song-2021-sliced", "tmotion";
    Motion, SONG => "song-2021-ramps", "tmotion";
    Motion, SONOBE => "sonobe-2011-table", "tmotion";
    Motion, SONOBE => "sonobe-2011-segments", "tmotion";
    Motion, ZHANG => "zhang-2012-fixed-length", "tmotion";
    Motion, ZHANG => "zhang-2012-staircase", "0-6000000.tmotion";
    Motion, SINE => "sine-2022-d00054", "tspectrum";
    Motion, SINE => "sine-2022-d0006", "tspectrum";
    Motion, None => "exact-sine", "tmotion";
    Motion, None => "jerk-limited", "tmotion";
    Motion, None => "points", "tmotion";
    Packets, PATENT => "patent-2019-four-motors", "0-270000.tpulses";
    Packets, PATENT => "patent-2019-sixteen-motors", "tmotion";
    Packets, PATENT => "patent-2019-staggered", "0-270000.tpulses";
    Packets, PATENT => "patent-2019-common-dir", "600-660.tpulses";
    Packets, PATENT => "patent-2019-addressed", "tpackets";
    Packets, PATENT => "two-controllers-raw", "0-200000.tpackets";
    Packets, PATENT => "glitches-and-breaks", "tpulses";
    Packets, None => "framed-link", "0-700000.tpackets";
    Packets, None => "raw-noisy-line", "1500000-2000000.tpackets";
    Packets, None => "framed-noisy-line", "0-1100000.tpackets";
    Packets, None => "four-controllers-framed", "0-300000.tpackets";
    DriverTiming, None => "driver-timing-broken", "2850-3350.ttiming";
}

presets! {
    /// Presets with a plant.
    PLANT_PRESETS:
    Motor, PATENT => "patent-2019-figure-1", "325000-353000.tmotor";
    Motor, PATENT => "patent-2019-figure-2", "320000-760000.tmotor";
    Motor, PATENT => "patent-2019-overload", "0-80000.tmotor.qphases-supply";
    Motor, SONG => "song-2021-motor", "tmotor";
    Motor, SONG => "song-2021-direct-start", "tmotor";
    Motor, SONG => "song-2021-stall", "tmotor";
    Motor, None => "resonance-full-steps", "tmotor";
}

presets! {
    /// Presets of stand-alone controllers.
    CONTROLLER_PRESETS:
    Controller, ZHANG => "zhang-2012-controller", "tpanel";
    Controller, ZHANG => "zhang-2012-program", "tpanel";
    Controller, ZHANG => "zhang-2012-zero-by-jog", "tpanel";
    Controller, None => "controller-homing", "tpanel";
    Controller, None => "controller-limit", "tpanel";
    Controller, None => "controller-emergency-stop", "41187000-41203000.a41196800.tpulses";
    Controller, None => "controller-power-cut", "tpanel";
    Controller, None => "controller-power-cut-lost", "tpanel";
}

presets! {
    /// Presets of stand-alone controllers with a plant.
    CONTROLLER_PLANT_PRESETS:
    Controller, None => "controller-held-and-wrong", "tpanel";
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Kinds, VERSION};

    #[test]
    fn every_kind_of_move_has_a_preset() {
        // A new target needs a move before it; tests of plans have both.
        let kinds = stepscope_motion::moves::Move::KINDS.iter().filter(|kind| **kind != "retarget");
        for kind in kinds {
            let key = alloc::format!("\"{kind}\": {{");
            assert!(PRESETS.iter().any(|preset| preset.json.contains(&key)), "{kind}");
        }
    }

    #[test]
    fn a_preset_is_found_by_its_name() {
        assert_eq!(find("points").map(|preset| preset.id), Ok("points"));
        let why = find("point").expect_err("no such preset");
        assert!(why.starts_with(r#"unknown preset "point"; use one of song-2021-one-turn, "#), "{why}");
    }

    #[test]
    fn every_preset_is_valid() {
        let all: Vec<&Preset> = all().collect();
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
