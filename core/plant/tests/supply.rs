//! The supply with its buffer, and a driver that is switched off (F4, F5).

use crate::common::{Each, near, one, run};
use stepscope_peripheral::{
    signal::{Levels, Record},
    units::Instant,
};
use stepscope_plant::{
    Plant, State,
    measures::Measures,
    parameters::{MotorModel, Setup, Supply},
};

fn buffered(supply: Supply) -> Setup {
    Setup { supply: Supply { buffer_uf: Some(100.0), ..supply }, ..one(MotorModel::default()) }
}

fn off() -> Record {
    Record { cycle: Instant(1600), levels: Levels(Levels::RX | Levels::TX) }
}

#[test]
fn an_idle_bus_keeps_its_equilibrium_voltage() {
    // 3.6 W and 20 mA through 0.5 ohm.
    let setup = buffered(Supply { source_ohm: 0.5, idle_ma: 20.0, ..Supply::default() });
    let mut plant = Plant::new(&setup).expect("it holds");
    let v = plant.supply_v();
    near((24.0 - v) / 0.5, 3.6 / v + 0.02, 1e-9);
    plant.advance(1_600_000, &mut ());
    near(plant.supply_v(), v, 1e-9);
}

#[test]
fn braking_motors_raise_the_bus_of_a_source_that_cannot_sink() {
    let max = |source_sinks| {
        let setup = buffered(Supply { source_sinks, ..Supply::default() });
        let mut measures = Measures::new(&Plant::new(&setup).expect("it holds"));
        let plant = run(&setup, &[off()], 160_000, &mut measures);
        // The current of the windings has returned to the buffer: L*I^2/2 of both together.
        assert_eq!((plant.state(0).expect("a motor").i_a, plant.state(0).expect("a motor").i_b), (0.0, 0.0));
        near(plant.energy(0).expect("a motor").error(), 0.0, 1e-5);
        measures.result(&plant).supply_v.max
    };
    // 4.8 mJ into 100 uF at 24 V, minus the losses of windings and diodes: about 1.8 V.
    near(max(false), 25.7, 0.2);
    near(max(true), 24.1, 0.1);
}

#[test]
fn a_supply_that_is_too_weak_collapses_at_a_reported_time() {
    // In equilibrium 3.6 W are just available. Rising from 0, the currents take 4.8 mJ; the buffer has 2.9 mJ.
    let weak = Supply { source_ohm: 39.0, buffer_uf: Some(10.0), source_sinks: true, ..Supply::default() };
    let setup = Setup { supply: weak, ..one(MotorModel::default()) };
    let on = Record { cycle: Instant(16_000), levels: Levels::RESET };
    let mut measures = Measures::new(&Plant::new(&setup).expect("it holds"));
    let plant = run(&setup, &[off(), on], 1_600_000, &mut measures);
    let result = measures.result(&plant);
    let at = result.collapsed.expect("it collapses");
    assert!(at > 16_000 && at < 160_000, "{at}");
    assert_eq!(result.supply_v.min, 1.5);
}

#[test]
fn currents_decay_through_diodes_in_the_computed_time() {
    let mut zero = None;
    let mut observer = Each(|plant: &Plant| {
        if plant.state(0).expect("a motor").i_a == 0.0 {
            zero.get_or_insert(plant.cycle() - 1600);
        }
    });
    let motor = MotorModel { rotor_inertia_g_cm2: 1e9, ..MotorModel::default() };
    run(&one(motor), &[off()], 160_000, &mut observer);
    // L/R*ln(1 + R*i/(V + 2*0.7)) = 0.1737 ms, then the next point.
    near(zero.expect("it ends") as f64 / 16e3, 0.1737, 0.005);
}

#[test]
fn a_disabled_motor_that_is_turned_fast_feeds_the_bus() {
    let mut plant =
        Plant::new(&one(MotorModel { friction_mn_m: 0.0, viscous_un_m_s: 0.0, ..MotorModel::default() }))
            .expect("it holds");
    plant.record(Record { cycle: Instant(0), ..off() }, &mut ());
    for (w, feeds) in [(4000.0, false), (6000.0, true)] {
        // Its back-EMF is 5.92 V at 1000 full steps/s; the bus and two diodes are at 25.4 V.
        plant.set_state(0, State { w, ..State::default() });
        plant.advance(plant.cycle() + 16_000, &mut ());
        let state = plant.state(0).expect("a motor");
        assert_eq!(state.w < w, feeds, "{w}");
        assert_eq!(plant.energy(0).expect("a motor").bus < 0.0, feeds, "{w}");
        near(plant.energy(0).expect("a motor").error(), 0.0, 1e-5);
    }
}
