//! Parameters of a plant: F9's fields with their defaults, the other fields of `motor`, and F2's constants.

/// The driver of a motor, `motor.drive` (F9).
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// How the current is regulated.
    pub regulator: Regulator,
    /// How the current decays.
    pub decay: Decay,
    /// The chopper's fixed off-time, us.
    pub off_us: f64,
    /// The chopper's blanking time, us.
    pub blank_us: f64,
    /// Levels of the DAC that gives the targets, 1..1023; `None`: the exact sine.
    pub dac_levels: Option<u32>,
    /// Resistance of the bridge, in series with the winding, ohm.
    pub bridge_ohm: f64,
    /// Forward voltage of a diode, V.
    pub diode_v: f64,
}

/// F4's two regulators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regulator {
    /// The mean of an ideal chopper.
    Averaged,
    /// Fixed off-time, decided at grid points.
    Chopper,
}

/// F4's decays; a share is 0..1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Decay {
    /// d = 0.
    Slow,
    /// d = 1.
    Fast,
    /// d = the share.
    Mixed(f64),
    /// d = the share where |target| fell at the last rise of STEP, else 0; the share before the first.
    Auto(f64),
}

/// A motor with its mechanics' step, its driver and its load.
#[derive(Debug, Clone, PartialEq)]
pub struct Motor {
    /// Angle of a full step, degrees.
    pub full_step_deg: f64,
    /// Microsteps in a full step.
    pub microsteps: u32,
    /// Current of a phase, both on, A.
    pub rated_current_a: f64,
    /// Peak of the phase current, A; `None`: the rated current.
    pub peak_current_a: Option<f64>,
    /// Of a phase, ohm.
    pub resistance_ohm: f64,
    /// Of a phase, mH.
    pub inductance_mh: f64,
    /// Both phases at the rated current, mN*m.
    pub holding_torque_mn_m: f64,
    /// g*cm^2.
    pub rotor_inertia_g_cm2: f64,
    /// g*cm^2.
    pub load_inertia_g_cm2: f64,
    /// Opposes the motion, mN*m.
    pub load_torque_mn_m: f64,
    /// V; equal for all motors of a plant.
    pub supply_v: f64,
    /// mN*m.
    pub friction_mn_m: f64,
    /// mN*m, at least the friction; `None`: the friction.
    pub stiction_mn_m: Option<f64>,
    /// uN*m*s.
    pub viscous_un_m_s: f64,
    /// mN*m.
    pub detent_torque_mn_m: f64,
    /// Pulls to the left, mN*m.
    pub gravity_torque_mn_m: f64,
    /// Amplitude of a torque that is a sine of the load's angle, mN*m.
    pub sine_torque_mn_m: f64,
    /// Its periods per turn.
    pub sine_per_turn: f64,
    /// Its phase, degrees.
    pub sine_phase_deg: f64,
    /// Spring between rotor and load, N*m/rad; `None`: rigid.
    pub coupling_n_m_rad: Option<f64>,
    /// Its damper, uN*m*s.
    pub coupling_un_m_s: f64,
    /// The driver.
    pub drive: Drive,
}

/// Low pass and ADC of the supply current (F6).
#[derive(Debug, Clone, PartialEq)]
pub struct CurrentSensor {
    /// Hz.
    pub bandwidth_hz: f64,
    /// 1..3.
    pub poles: usize,
    /// Grid points from one ADC value to the next.
    pub adc_steps: u64,
    /// A.
    pub lsb_a: f64,
    /// Maximum code of either sign.
    pub adc_max: u32,
}

/// The AS5600 on each rotor (F6).
#[derive(Debug, Clone, PartialEq)]
pub struct Encoder {
    /// Grid points from one code to the next.
    pub period_steps: u64,
    /// Codes.
    pub offset_lsb: f64,
    /// Codes.
    pub noise_lsb: f64,
    /// Codes.
    pub hysteresis_lsb: f64,
    /// Of the noise.
    pub seed: u64,
}

/// F7's overload protection.
#[derive(Debug, Clone, PartialEq)]
pub struct Protection {
    /// A.
    pub threshold_a: f64,
    /// Consecutive ADC values.
    pub samples: u32,
}

/// Common parameters of all motors, `plant` (F9).
#[derive(Debug, Clone, PartialEq)]
pub struct Plant {
    /// N; `None`: by F1.
    pub step_cycles: Option<u64>,
    /// Rs, ohm.
    pub source_ohm: f64,
    /// Cb, uF; `None`: the bus is the supply.
    pub buffer_uf: Option<f64>,
    /// Whether the source accepts reverse current.
    pub source_sinks: bool,
    /// Of each driver, mA.
    pub idle_ma: f64,
    /// The sensor of the supply current.
    pub current_sensor: CurrentSensor,
    /// The encoders.
    pub encoder: Encoder,
    /// Overload protection.
    pub protection: Option<Protection>,
}

/// A run of the plant: its parameters and the edges of its bus.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Cycles in a second.
    pub clock_hz: u64,
    /// Common parameters of all motors.
    pub plant: Plant,
    /// The motors of channels 0, 1, ...; `None`: no motor.
    pub motors: Vec<Option<Motor>>,
    /// A3's records (cycle, levels), the first at cycle 0.
    pub records: Vec<(u64, u64)>,
    /// The run is the cycles 0..cycles.
    pub cycles: u64,
}

impl Default for Drive {
    fn default() -> Self {
        Self {
            regulator: Regulator::Averaged,
            decay: Decay::Fast,
            off_us: 20.0,
            blank_us: 1.0,
            dac_levels: None,
            bridge_ohm: 0.0,
            diode_v: 0.7,
        }
    }
}

impl Default for Motor {
    fn default() -> Self {
        Self {
            full_step_deg: 1.8,
            microsteps: 16,
            rated_current_a: 1.5,
            peak_current_a: None,
            resistance_ohm: 1.6,
            inductance_mh: 4.3,
            holding_torque_mn_m: 400.0,
            rotor_inertia_g_cm2: 45.0,
            load_inertia_g_cm2: 0.0,
            load_torque_mn_m: 0.0,
            supply_v: 24.0,
            friction_mn_m: 5.0,
            stiction_mn_m: None,
            viscous_un_m_s: 300.0,
            detent_torque_mn_m: 0.0,
            gravity_torque_mn_m: 0.0,
            sine_torque_mn_m: 0.0,
            sine_per_turn: 1.0,
            sine_phase_deg: 0.0,
            coupling_n_m_rad: None,
            coupling_un_m_s: 0.0,
            drive: Drive::default(),
        }
    }
}

impl Default for CurrentSensor {
    fn default() -> Self {
        Self { bandwidth_hz: 3000.0, poles: 1, adc_steps: 1, lsb_a: 0.0244140625, adc_max: 2047 }
    }
}

impl Default for Encoder {
    fn default() -> Self {
        Self { period_steps: 1000, offset_lsb: 0.0, noise_lsb: 0.0, hysteresis_lsb: 0.0, seed: 0 }
    }
}

impl Default for Plant {
    fn default() -> Self {
        Self {
            step_cycles: None,
            source_ohm: 0.1,
            buffer_uf: None,
            source_sinks: false,
            idle_ma: 0.0,
            current_sensor: CurrentSensor::default(),
            encoder: Encoder::default(),
            protection: None,
        }
    }
}

/// N (F1), cycles: `step_cycles`, or its default.
///
/// Reading: "where a driver chops" means that at least one motor has a chopper; the grid is common to all.
pub fn grid_step(case: &Case) -> u64 {
    let chops = case.motors.iter().flatten().any(|motor| motor.drive.regulator == Regulator::Chopper);
    let rate = if chops { 1_000_000 } else { 200_000 };
    case.plant.step_cycles.unwrap_or((case.clock_hz / rate).max(1))
}

/// F2's constants of a motor, in full steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorConstants {
    /// g, rad per full step.
    pub g: f64,
    /// R, ohm.
    pub r: f64,
    /// L, H.
    pub l: f64,
    /// K.
    pub k: f64,
    /// M: of rotor and load; with a coupling of the rotor only.
    pub m: f64,
    /// B.
    pub b: f64,
    /// D.
    pub detent: f64,
    /// G.
    pub gravity: f64,
    /// A.
    pub sine: f64,
    /// Fc.
    pub coulomb: f64,
    /// Fs.
    pub stiction: f64,
    /// Fl.
    pub load: f64,
    /// I, the peak current, A.
    pub peak: f64,
    /// sine_per_turn*full_step_deg/90: quarter turns of the sine's phase per full step.
    pub sine_rate: f64,
    /// sine_phase_deg/90.
    pub sine_start: f64,
    /// M_l, C and Cd, where there is a coupling.
    pub coupling: Option<(f64, f64, f64)>,
}

impl MotorConstants {
    /// F2's formulas.
    #[expect(clippy::approx_constant, reason = "the contract's digits")]
    pub fn new(motor: &Motor) -> Self {
        let g = motor.full_step_deg * 0.017453292519943295;
        let force = |torque_mn_m: f64| torque_mn_m / 1000.0 * g;
        let load = force(motor.load_torque_mn_m);
        let mut coulomb = force(motor.friction_mn_m);
        let mut stiction = force(motor.stiction_mn_m.unwrap_or(motor.friction_mn_m));
        let mut m = (motor.rotor_inertia_g_cm2 + motor.load_inertia_g_cm2) * 1e-7 * g * g;
        let mut coupling = None;
        if let Some(stiffness) = motor.coupling_n_m_rad {
            m = motor.rotor_inertia_g_cm2 * 1e-7 * g * g;
            coupling = Some((
                motor.load_inertia_g_cm2 * 1e-7 * g * g,
                stiffness * g * g,
                motor.coupling_un_m_s / 1e6 * g * g,
            ));
        } else {
            coulomb += load;
            stiction += load;
        }
        Self {
            g,
            r: motor.resistance_ohm + motor.drive.bridge_ohm,
            l: motor.inductance_mh / 1000.0,
            k: motor.holding_torque_mn_m / 1000.0 / (1.4142135623730951 * motor.rated_current_a) * g,
            m,
            b: motor.viscous_un_m_s / 1e6 * g * g,
            detent: force(motor.detent_torque_mn_m),
            gravity: force(motor.gravity_torque_mn_m),
            sine: force(motor.sine_torque_mn_m),
            coulomb,
            stiction,
            load,
            peak: motor.peak_current_a.unwrap_or(motor.rated_current_a),
            sine_rate: motor.sine_per_turn * motor.full_step_deg / 90.0,
            sine_start: motor.sine_phase_deg / 90.0,
            coupling,
        }
    }
}
