//! The contract's three digests (F10), from edges that the segment engine makes.

use stepscope_peripheral::{
    device::SegmentEngine,
    segment::{CheckedSegments, PulseTimes, Segment, SegmentList},
    signal::Record,
    units::{Cycles, Instant},
};
use stepscope_plant::{
    Plant,
    parameters::{CurrentControl, CurrentDecay, DriverModel, MotorModel, Setup},
};

fn steps(count: u32, interval: u64, add: i64) -> Segment {
    Segment::Steps { count, interval: interval << 16, add: add << 16, right: true }
}

fn trace(start: u64, segments: Vec<Segment>, cycles: u64) -> Vec<Record> {
    let pulse = PulseTimes { width: Cycles(16), setup: Cycles(0), hold: Cycles(0) };
    let lists = vec![SegmentList { start: Instant(start), segments }];
    let checked = CheckedSegments::new(pulse, lists, 9).expect("the list holds");
    let mut engine = SegmentEngine::new(checked.into());
    let mut trace = Vec::new();
    engine.run(Instant(cycles), &mut trace);
    trace
}

fn check(motor: MotorModel, records: &[Record], cycles: u64, digest: u64) -> Plant {
    let setup = Setup { motors: vec![motor], ..Setup::default() };
    let mut plant = Plant::new(&setup).expect("it holds");
    for &record in records {
        plant.record(record, &mut ());
    }
    plant.advance(cycles, &mut ());
    assert_eq!(format!("{:016x}", plant.digest()), format!("{digest:016x}"));
    plant
}

#[test]
fn k1_forty_full_steps() {
    let records = trace(1600, vec![steps(40, 32_768, 0)], 1_600_000);
    let motor = MotorModel { microsteps: 1, ..MotorModel::default() };
    let plant = check(motor, &records, 1_600_000, 0x35f2_6c33_1139_1d20);
    let x = plant.state(0).expect("a motor").x;
    assert_eq!(format!("{x:.14}"), "39.91075131887101");
}

#[test]
fn k2_a_ramp_up_and_down() {
    let records = trace(1, vec![steps(600, 6000, -8), steps(600, 1200, 8)], 6_000_000);
    check(MotorModel::default(), &records, 6_000_000, 0xa699_812c_01ef_3b7e);
}

#[test]
fn k3_forty_full_steps_with_a_chopper_of_mixed_decay() {
    let records = trace(1600, vec![steps(40, 32_768, 0)], 1_600_000);
    let drive = DriverModel {
        regulator: CurrentControl::Chopper,
        decay: CurrentDecay::Mixed(0.31),
        off_us: 20.0,
        blank_us: 1.0,
        ..DriverModel::default()
    };
    check(
        MotorModel { microsteps: 1, drive, ..MotorModel::default() },
        &records,
        1_600_000,
        0xbf86_f4b1_cc5e_03fc,
    );
}
