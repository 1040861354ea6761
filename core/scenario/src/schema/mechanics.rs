//! Step lengths and units of positions, speeds, accelerations and jerks (DESIGN B1); motion owns the types.

use crate::schema::{
    Field, SONOBE, ZHANG, label,
    rows::{fields, kinds},
};
use stepscope_motion::{
    limits,
    mechanics::{Acceleration, Direct, Distance, Jerk, Mechanics, Rotary, Screw, Speed, Wheel},
};

kinds! {
    /// What one step is. Millimetres and degrees can be given where the mechanics have them.
    Mechanics {
        /// The motor turns something; distances are angles. Steps a turn = 360° / full step × microsteps.
        Rotary(Rotary) = "rotary" => label("Rotary shaft").from(SONOBE),
        /// The motor moves something by a radius: one turn is 2π × radius. A step is that, divided by the steps of a
        /// turn.
        Wheel(Wheel) = "wheel" => label("Wheel, pulley or gear").from(SONOBE),
        /// The motor turns a screw; its nut moves by the lead in one turn.
        Screw(Screw) = "screw" => label("Lead screw").from(ZHANG),
        /// The way of one step as it was measured: the fixed-length controller finds it by least squares over measured
        /// pairs of length and steps.
        Direct(Direct) = "direct" => label("Length of a step").from(ZHANG),
    }
}

/// The motor's angle.
const FULL_STEP: Field = label("Full step")
    .unit("°")
    .number(limits::FULL_STEP_DEG)
    .term(
        "Full step",
        "Angle by which the shaft turns when one winding takes over from the other; 1.8° in most motors.",
    )
    .from(SONOBE);
/// What the driver divides it into.
const MICROSTEPS: Field = label("Microsteps")
    .number(limits::MICROSTEPS)
    .term("Microsteps", "Parts into which the driver divides a full step by letting part of the current flow in both windings. One STEP pulse is one microstep; half a step is the 1-2-phase sequence.")
    .from(SONOBE);

fields! {
    /// It has degrees.
    Rotary {
        /// Angle of the motor's full step; 1.8° is 200 a turn.
        full_step_deg: f64 => FULL_STEP,
        /// Parts of a full step.
        microsteps: u16 => MICROSTEPS,
    }
    /// It has mm and degrees.
    Wheel {
        /// Angle of the motor's full step; 1.8° is 200 a turn.
        full_step_deg: f64 => FULL_STEP,
        /// Parts of a full step.
        microsteps: u16 => MICROSTEPS,
        /// 2π × radius is the way of one turn.
        radius_mm: f64 => label("Radius")
            .unit("mm")
            .number(limits::LENGTH_MM)
            .term("Radius", "Of the wheel, pulley or pitch circle that turns angle into way.")
            .from(SONOBE),
    }
    /// It has mm and degrees.
    Screw {
        /// Angle of the motor's full step; 1.8° is 200 a turn.
        full_step_deg: f64 => FULL_STEP,
        /// Parts of a full step.
        microsteps: u16 => MICROSTEPS,
        /// Travel of the nut in one turn.
        lead_mm: f64 => label("Lead")
            .unit("mm")
            .number(limits::LENGTH_MM)
            .term("Lead", "Travel of the nut in one turn of the screw.")
            .from(ZHANG),
    }
    /// It has mm.
    Direct {
        /// Measured or given length of one step.
        step_mm: f64 => label("One step")
            .unit("mm")
            .number(limits::LENGTH_MM)
            .term("One step", "Way of one step, measured or given.")
            .from(ZHANG),
    }
}

kinds! {
    /// A way, negative to the left. It is rounded half up to whole steps, at least 1.
    Distance {
        /// In steps.
        Steps(f64) = "steps" => label("steps"),
        /// In millimetres.
        Millimetres(f64) = "mm" => label("mm"),
        /// In degrees.
        Degrees(f64) = "deg" => label("°"),
    }
    /// Along an axis.
    Speed {
        /// In steps a second (the documents' Hz or pps).
        StepsPerSecond(f64) = "steps_s" => label("steps/s"),
        /// In millimetres a second.
        MillimetresPerSecond(f64) = "mm_s" => label("mm/s"),
        /// In degrees a second.
        DegreesPerSecond(f64) = "deg_s" => label("°/s"),
        /// In turns a minute.
        TurnsPerMinute(f64) = "rpm" => label("rpm"),
    }
    /// The change of a speed in a second.
    Acceleration {
        /// In steps a second squared.
        StepsPerSecond2(f64) = "steps_s2" => label("steps/s²"),
        /// In millimetres a second squared.
        MillimetresPerSecond2(f64) = "mm_s2" => label("mm/s²"),
        /// In degrees a second squared.
        DegreesPerSecond2(f64) = "deg_s2" => label("°/s²"),
    }
    /// The change of an acceleration in a second.
    Jerk {
        /// In steps a second cubed.
        StepsPerSecond3(f64) = "steps_s3" => label("steps/s³"),
        /// In millimetres a second cubed.
        MillimetresPerSecond3(f64) = "mm_s3" => label("mm/s³"),
        /// In degrees a second cubed.
        DegreesPerSecond3(f64) = "deg_s3" => label("°/s³"),
    }
}
