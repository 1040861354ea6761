//! The contract's three plant digests (F10: K1 to K3) on every target: for the whole run, and for a part that is short enough
//! for a microcontroller.

use alloc::{format, string::String, sync::Arc, vec, vec::Vec};
use stepscope_core::{
    peripheral::{
        device::SegmentEngine,
        segment::{CheckedSegments, PulseTimes, Segment, SegmentList},
        signal::Record,
        units::{Cycles, Instant},
    },
    plant::{
        Plant,
        parameters::{CurrentControl, CurrentDecay, DriverModel, MotorModel, Setup},
    },
};

/// A digest of the contract.
#[derive(Debug)]
pub struct PlantCase {
    /// Its name in the contract.
    pub name: &'static str,
    motor: MotorModel,
    start: u64,
    /// Number of steps, first interval, and change of each following one, in cycles.
    segments: Vec<(u32, u64, i64)>,
    /// Cycles and digest in the contract.
    whole: (u64, u64),
    /// Fewer cycles, and their digest.
    short: (u64, u64),
}

/// All three digests.
#[must_use]
pub fn plant_cases() -> [PlantCase; 3] {
    let full_steps = MotorModel { microsteps: 1, ..MotorModel::default() };
    let drive = DriverModel {
        regulator: CurrentControl::Chopper,
        decay: CurrentDecay::Mixed(0.31),
        ..DriverModel::default()
    };
    let case =
        |name, motor, start, segments, whole, short| PlantCase { name, motor, start, segments, whole, short };
    let (forty, ramps) = (vec![(40, 32_768, 0)], vec![(600, 6000, -8), (600, 1200, 8)]);
    [
        case(
            "K1",
            full_steps.clone(),
            1600,
            forty.clone(),
            (1_600_000, 0x35f2_6c33_1139_1d20),
            (80_000, 0x9c1e_9918_b82d_e238),
        ),
        case(
            "K2",
            MotorModel::default(),
            1,
            ramps,
            (6_000_000, 0xa699_812c_01ef_3b7e),
            (80_000, 0xa39e_8d35_dce3_267f),
        ),
        case(
            "K3",
            MotorModel { drive, ..full_steps },
            1600,
            forty,
            (1_600_000, 0xbf86_f4b1_cc5e_03fc),
            (40_000, 0x3d31_2ac3_4b52_8994),
        ),
    ]
}

impl PlantCase {
    /// Compares the digest of the whole or of the short run.
    ///
    /// # Errors
    /// The digest of the run.
    pub fn check(&self, whole: bool) -> Result<(), String> {
        let (cycles, expected) = if whole { self.whole } else { self.short };
        match self.digest(cycles) {
            Some(found) if found == expected => Ok(()),
            found => Err(format!("{}: {found:016x?} is not {expected:016x}", self.name)),
        }
    }

    /// The plant's digest after this number of cycles.
    fn digest(&self, cycles: u64) -> Option<u64> {
        let pulse = PulseTimes { width: Cycles(16), setup: Cycles(0), hold: Cycles(0) };
        let segments = self.segments.iter().map(|&(count, interval, add)| Segment::Steps {
            count,
            interval: interval << 16,
            add: add << 16,
            right: true,
        });
        let lists = vec![SegmentList { start: Instant(self.start), segments: segments.collect() }];
        let mut engine = SegmentEngine::new(Arc::new(CheckedSegments::new(pulse, lists, 1).ok()?));
        let mut records: Vec<Record> = Vec::new();
        engine.run(Instant(cycles), &mut records);
        let mut plant = Plant::new(&Setup { motors: vec![self.motor.clone()], ..Setup::default() }).ok()?;
        records.into_iter().for_each(|record| plant.record(record, &mut ()));
        plant.advance(cycles, &mut ());
        Some(plant.digest())
    }
}
