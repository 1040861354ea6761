//! Builds the plants of a scenario, one per controller (F9).

use crate::{Cause, PlantSettings, Scenario, Source, Validator, ValueError};
use alloc::string::{String, ToString};
use alloc::{format, vec::Vec};
use stepscope_motion::mechanics::{Mechanics, Rotary};
use stepscope_motion::motor::{Decay, Drive, Motor, Regulator};
use stepscope_motion::{moves::Axis, plan_axis};
use stepscope_peripheral::device::min_boot_time;
use stepscope_peripheral::{config::Config, signal::MAX_CHANNELS, units::Cycles};
use stepscope_plant::{Plant, Refusal, Refused, limits, parameters};

/// The plants of a checked scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Plants {
    /// One per controller, in the scenario's order.
    pub setups: Vec<parameters::Setup>,
    /// Whether a boot measures the settling time (F7).
    pub self_test: bool,
    /// Time after the last step of a run without a given length.
    pub tail: Cycles,
}

/// The motor of a channel, with the paths of its fields and its mechanics.
struct MotorAtPath<'a> {
    /// `None` is the default motor.
    motor: Option<&'a Motor>,
    full_step_deg: f64,
    microsteps: u16,
    path: String,
    mechanics_path: String,
}

impl MotorAtPath<'_> {
    fn supply_v(&self) -> f64 {
        self.motor.map_or_else(|| Motor::default().supply_v, |motor| motor.supply_v)
    }
}

impl Scenario {
    /// Rules between fields are checked only if the fields are valid.
    pub(crate) fn check_plants(&self, configs: &[Config], validator: &mut Validator) -> Option<Plants> {
        self.check_motors(validator);
        let settings = self.plant.as_ref()?;
        if !validator.is_ok() {
            return None;
        }
        let mut setups = Vec::with_capacity(configs.len());
        for (index, config) in configs.iter().enumerate() {
            let motors = self.motors(settings, index, config.channels());
            check_one_supply(&motors, validator);
            let setup = setup(self.clock_hz, settings, &motors);
            for refused in Plant::new(&setup).err().unwrap_or_default() {
                add_refusal(refused, &motors, validator);
            }
            setups.push(setup);
        }
        let tail = Cycles((settings.tail_s * f64::from(self.clock_hz) + 0.5) as u64);
        if settings.self_test {
            self.check_self_test(configs, validator);
        }
        Some(Plants { setups, self_test: settings.self_test, tail })
    }

    /// A self-test steps each motor there and back (F7).
    fn check_self_test(&self, configs: &[Config], validator: &mut Validator) {
        if self.source.sends_nothing() {
            let detail =
                "segments and stand-alone controllers have no self-test; choose ticks, or set it to false";
            validator.add("plant.self_test", ValueError::Conflict { detail });
            return;
        }
        for (index, config) in configs.iter().enumerate() {
            let needed = min_boot_time(config).0;
            if config.boot().0 < needed {
                let path = match index {
                    0 => "bus.self_test_cycles".to_string(),
                    _ => format!("controllers[{}].bus.self_test_cycles", index - 1),
                };
                let given = config.boot().0;
                validator.add(&path, Cause::SelfTest { given, needed });
            }
        }
    }

    /// Checks numbers that only a plant uses, and motors without an axis.
    fn check_motors(&self, validator: &mut Validator) {
        if let Source::Motion(motion) = &self.source {
            check_axes(&motion.axes, "source.motion.axes", validator);
        }
        for (index, controller) in self.controllers.iter().enumerate() {
            check_axes(&controller.axes, &format!("controllers[{index}].axes"), validator);
        }
        for (index, entry) in self.plant.iter().flat_map(|plant| &plant.motors).enumerate().take(MAX_CHANNELS)
        {
            let path = format!("plant.motors[{index}]");
            // A plan checks the motor of its axis; the moves are the default and have no problems.
            let axis = Axis { motor: Some(entry.motor.clone()), ..Axis::default() };
            validator.extend(plan_axis(&axis, &path).err().into_iter().flatten());
            validator.at(&format!("{path}.motor"), |here| check_motor(&entry.motor, here));
        }
    }

    fn motors<'a>(
        &'a self,
        settings: &'a PlantSettings,
        controller: usize,
        channels: u8,
    ) -> Vec<MotorAtPath<'a>> {
        let (axes, axes_path): (&[Axis], _) = match (&self.source, controller.checked_sub(1)) {
            (Source::Motion(motion), None) => (&motion.axes, "source.motion.axes".to_string()),
            (_, None) => (&[], String::new()),
            (_, Some(index)) => {
                let axes = self.controllers.get(index).map_or(&[][..], |one| &one.axes);
                (axes, format!("controllers[{index}].axes"))
            }
        };
        (0..usize::from(channels))
            .map(|channel| {
                let axis = axes.get(channel);
                let path = format!("{axes_path}[{channel}]");
                let rotation = axis.map(|axis| (axis, rotation_of(&axis.mechanics)));
                if let Some((axis, Some((name, full_step_deg, microsteps)))) = rotation
                    && (axis.motor.is_some() || settings.motors.is_empty())
                {
                    let mechanics_path = format!("{path}.mechanics.{name}");
                    let motor = axis.motor.as_ref();
                    return MotorAtPath {
                        motor,
                        full_step_deg,
                        microsteps,
                        path: format!("{path}.motor"),
                        mechanics_path,
                    };
                }
                let last = settings.motors.len().saturating_sub(1);
                let entry = settings.motors.get(channel.min(last));
                let Rotary { full_step_deg, microsteps } = Rotary::default();
                let path = format!("plant.motors[{}]", channel.min(last));
                MotorAtPath {
                    motor: entry.map(|entry| &entry.motor),
                    full_step_deg: entry.map_or(full_step_deg, |entry| entry.full_step_deg),
                    microsteps: entry.map_or(microsteps, |entry| entry.microsteps),
                    mechanics_path: path.clone(),
                    path: format!("{path}.motor"),
                }
            })
            .collect()
    }
}

/// Name, full step and microsteps, if these mechanics have them.
fn rotation_of(mechanics: &Mechanics) -> Option<(&'static str, f64, u16)> {
    match mechanics {
        Mechanics::Rotary(m) => Some(("rotary", m.full_step_deg, m.microsteps)),
        Mechanics::Wheel(m) => Some(("wheel", m.full_step_deg, m.microsteps)),
        Mechanics::Screw(m) => Some(("screw", m.full_step_deg, m.microsteps)),
        Mechanics::Direct(_) => None,
    }
}

fn check_axes(axes: &[Axis], path: &str, validator: &mut Validator) {
    for (index, axis) in axes.iter().enumerate().take(MAX_CHANNELS) {
        if let Some(motor) = &axis.motor {
            validator.at(&format!("{path}[{index}].motor"), |here| check_motor(motor, here));
        }
    }
}

fn check_motor(motor: &Motor, here: &mut Validator) {
    let most = *limits::TORQUE_MN_M.end();
    here.range("friction_mN_m", motor.friction_mn_m, limits::TORQUE_MN_M, "mN*m");
    if let Some(stiction) = motor.stiction_mn_m {
        here.range("stiction_mN_m", stiction, motor.friction_mn_m..=most, "mN*m");
    }
    here.range("viscous_uN_m_s", motor.viscous_un_m_s, limits::VISCOUS_UN_M_S, "uN*m*s");
    here.range("detent_torque_mN_m", motor.detent_torque_mn_m, 0.0..=0.5 * motor.holding_torque_mn_m, "mN*m");
    here.range("gravity_torque_mN_m", motor.gravity_torque_mn_m, limits::SIGNED_TORQUE_MN_M, "mN*m");
    here.range("sine_torque_mN_m", motor.sine_torque_mn_m, limits::TORQUE_MN_M, "mN*m");
    here.range("sine_per_turn", motor.sine_per_turn, limits::SINE_PER_TURN, "");
    here.range("sine_phase_deg", motor.sine_phase_deg, limits::SINE_PHASE_DEG, "deg");
    if let Some(coupling) = motor.coupling_n_m_rad {
        here.range("coupling_N_m_rad", coupling, limits::COUPLING_N_M_RAD, "N*m/rad");
    }
    here.range("coupling_uN_m_s", motor.coupling_un_m_s, limits::VISCOUS_UN_M_S, "uN*m*s");
    let Drive { decay_share, off_us, blank_us, dac_levels, bridge_ohm, diode_v, .. } = motor.drive;
    here.range("driver.fast_decay_fraction", decay_share, limits::SHARE, "");
    here.range("driver.off_time_us", off_us, limits::CHOPPER_US, "us");
    here.range("driver.blanking_time_us", blank_us, limits::CHOPPER_US, "us");
    here.whole("driver.dac_levels", dac_levels.unwrap_or(1), limits::DAC_LEVELS, "");
    here.range("driver.bridge_ohm", bridge_ohm, limits::BRIDGE_OHM, "ohm");
    here.range("driver.diode_v", diode_v, limits::DIODE_V, "V");
}

fn check_one_supply(motors: &[MotorAtPath<'_>], validator: &mut Validator) {
    let Some(first) = motors.first().map(MotorAtPath::supply_v) else { return };
    for other in motors {
        let path = format!("{}.supply_v", other.path);
        if other.supply_v().to_bits() != first.to_bits() && !validator.has_problem(&path) {
            validator.add(&path, Cause::OtherSupply { supply_v: other.supply_v(), first_v: first });
        }
    }
}

fn setup(clock_hz: u32, settings: &PlantSettings, motors: &[MotorAtPath<'_>]) -> parameters::Setup {
    let default = Motor::default();
    let supply_v = motors.first().map_or(default.supply_v, MotorAtPath::supply_v);
    let (sensor, encoder) = (&settings.current_sensor, &settings.encoder);
    parameters::Setup {
        clock_hz,
        step_cycles: settings.step_cycles,
        supply: parameters::Supply {
            supply_v,
            source_ohm: settings.source_ohm,
            buffer_uf: settings.buffer_uf,
            source_sinks: settings.source_sinks,
            idle_ma: settings.idle_ma,
        },
        current_sensor: parameters::SensorChain {
            bandwidth_hz: sensor.bandwidth_hz,
            poles: sensor.poles,
            adc_steps: sensor.adc_steps,
            lsb: sensor.lsb_a,
            adc_max: sensor.adc_max,
        },
        encoder: parameters::Encoder {
            period_steps: encoder.period_steps,
            offset_lsb: encoder.offset_lsb,
            noise_lsb: encoder.noise_lsb,
            hysteresis_lsb: encoder.hysteresis_lsb,
            seed: encoder.seed,
        },
        accelerometer: None,
        protection: settings.protection.as_ref().map(|protection| parameters::Protection {
            threshold_a: protection.threshold_a,
            samples: protection.samples,
        }),
        motors: motors.iter().map(|each| motor_model(each, each.motor.unwrap_or(&default))).collect(),
    }
}

fn motor_model(channel: &MotorAtPath<'_>, motor: &Motor) -> parameters::MotorModel {
    let drive = &motor.drive;
    parameters::MotorModel {
        full_step_deg: channel.full_step_deg,
        microsteps: channel.microsteps,
        rated_current_a: motor.rated_current_a,
        peak_current_a: motor.peak_current_a.unwrap_or(motor.rated_current_a),
        resistance_ohm: motor.resistance_ohm,
        inductance_mh: motor.inductance_mh,
        holding_torque_mn_m: motor.holding_torque_mn_m,
        rotor_inertia_g_cm2: motor.rotor_inertia_g_cm2,
        load_inertia_g_cm2: motor.load_inertia_g_cm2,
        load_torque_mn_m: motor.load_torque_mn_m,
        friction_mn_m: motor.friction_mn_m,
        stiction_mn_m: motor.stiction_mn_m,
        viscous_un_m_s: motor.viscous_un_m_s,
        detent_torque_mn_m: motor.detent_torque_mn_m,
        gravity_torque_mn_m: motor.gravity_torque_mn_m,
        sine_torque_mn_m: motor.sine_torque_mn_m,
        sine_per_turn: motor.sine_per_turn,
        sine_phase_deg: motor.sine_phase_deg,
        coupling_n_m_rad: motor.coupling_n_m_rad,
        coupling_un_m_s: motor.coupling_un_m_s,
        drive: parameters::DriverModel {
            regulator: match drive.regulator {
                Regulator::Averaged => parameters::CurrentControl::Averaged,
                Regulator::Chopper => parameters::CurrentControl::Chopper,
            },
            decay: match drive.decay {
                Decay::Slow => parameters::CurrentDecay::Slow,
                Decay::Fast => parameters::CurrentDecay::Fast,
                Decay::Mixed => parameters::CurrentDecay::Mixed(drive.decay_share),
                Decay::Auto => parameters::CurrentDecay::Auto(drive.decay_share),
            },
            off_us: drive.off_us,
            blank_us: drive.blank_us,
            dac_levels: drive.dac_levels,
            bridge_ohm: drive.bridge_ohm,
            diode_v: drive.diode_v,
        },
    }
}

/// The scenario's name of a motor's field. Other fields have the same name or are checked before.
fn scenario_name(field: &'static str) -> &'static str {
    match field {
        "holding_torque_mn_m" => "holding_torque_mN_m",
        "load_torque_mn_m" => "load_torque_mN_m",
        field => field,
    }
}

fn add_refusal(refused: Refused, motors: &[MotorAtPath<'_>], validator: &mut Validator) {
    let of_motor = refused.channel.and_then(|channel| motors.get(channel));
    let path = match (refused.refusal, of_motor) {
        (Refusal::Unstable { .. }, _) => "plant.step_cycles".into(),
        (Refusal::TooWeak { .. }, _) => "plant.source_ohm".into(),
        (Refusal::Range { field: field @ ("full_step_deg" | "microsteps"), .. }, Some(motor)) => {
            format!("{}.{field}", motor.mechanics_path)
        }
        (Refusal::Range { field, .. }, Some(motor)) => format!("{}.{}", motor.path, scenario_name(field)),
        (Refusal::Range { field: "supply_v", .. }, None) => {
            motors.first().map_or_else(String::new, |first| format!("{}.supply_v", first.path))
        }
        (Refusal::Range { field, .. }, None) => format!("plant.{field}"),
    };
    if !validator.has_problem(&path) {
        match refused.refusal {
            Refusal::Range { given, min, max, .. } => {
                validator.add(&path, ValueError::Range { given, min, max, unit: "" });
            }
            _ => validator.add(&path, Cause::Plant(refused)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problems(json: &str) -> Vec<String> {
        let scenario = Scenario::from_json(json).expect("reads");
        scenario.check().err().iter().flatten().map(ToString::to_string).collect()
    }

    #[test]
    fn each_problem_of_a_plant_has_its_path_and_a_remedy() {
        let motor = |motor: &str| {
            format!(r#"{{"plant":{{}},"source":{{"motion":{{"axes":[{{"motor":{{{motor}}}}}]}}}}}}"#)
        };
        let rows: &[(String, &[&str])] = &[
            (r#"{"plant":{}}"#.into(), &[]),
            (r#"{"plant":null}"#.into(), &[]),
            (
                r#"{"plant":{"source_ohm":0,"current_sensor":{"poles":4},"tail_s":11}}"#.into(),
                &[
                    "plant.source_ohm: 0 Ω is out of range; use 0.001 to 100 Ω",
                    "plant.tail_s: 11 s is out of range; use 0 to 10 s",
                    "plant.current_sensor.poles: 4 is out of range; use 1 to 3",
                ],
            ),
            (
                motor(r#""friction_mN_m":-1,"driver":{"off_time_us":-2}"#),
                &[
                    "source.motion.axes[0].motor.friction_mN_m: -1 mN*m is out of range; use 0 to 1000000 mN*m",
                    "source.motion.axes[0].motor.driver.off_time_us: -2 us is out of range; use 0 to 1000000 us",
                ],
            ),
            (
                motor(r#""rotor_inertia_g_cm2":0"#),
                &["source.motion.axes[0].motor.rotor_inertia_g_cm2: 0 is out of range"],
            ),
            (
                motor(r#""inductance_mh":0.02"#),
                &["plant.step_cycles: motor 0: R*h/L is 0.400 at grid steps of 80 cycles"],
            ),
            (
                r#"{"plant":{"buffer_uf":100,"source_ohm":50}}"#.into(),
                &["plant.source_ohm: 50 ohm is too high to supply the 3.6 W"],
            ),
            (
                r#"{"bus":{"channels":2},"plant":{"motors":[{},{"motor":{"supply_v":36,"inductance_mh":0.0001}}]},"source":{"packets":{}}}"#.into(),
                &["plant.motors[1].motor.inductance_mh: 1e-4 mH is out of range; use 0.001 to 10000 mH"],
            ),
            (
                r#"{"bus":{"channels":3},"plant":{"motors":[{},{"motor":{"supply_v":36}}]},"source":{"packets":{}}}"#.into(),
                &["plant.motors[1].motor.supply_v: 36 V, but the first motor has 24 V"],
            ),
            (
                r#"{"bus":{"self_test_cycles":100},"plant":{"self_test":true}}"#.into(),
                &["bus.self_test_cycles: 100 cycles are too short for the self-test; use at least 7681"],
            ),
        ];
        for (given, expected) in rows {
            let found = problems(given);
            assert_eq!(found.len(), expected.len(), "{given}: {found:?}");
            for (found, expected) in found.iter().zip(*expected) {
                assert!(found.starts_with(expected), "{found}\n{expected}");
            }
        }
    }

    #[test]
    fn a_channel_has_the_motor_of_its_axis_or_of_the_list() {
        let json = r#"{"bus":{"channels":4},"plant":{"motors":[
                {"motor":{"inductance_mh":1}},{"microsteps":2,"motor":{"inductance_mh":2}}]},
            "source":{"motion":{"axes":[{},{"mechanics":{"rotary":{"microsteps":8}},"motor":{"inductance_mh":3}}]}}}"#;
        let checked = Scenario::from_json(json).expect("reads").check().expect("holds");
        let setups = checked.plants.expect("a plant").setups;
        let found: Vec<(f64, u16)> =
            setups[0].motors.iter().map(|m| (m.inductance_mh, m.microsteps)).collect();
        assert_eq!(found, [(1.0, 16), (3.0, 8), (2.0, 2), (2.0, 2)]);
    }
}
