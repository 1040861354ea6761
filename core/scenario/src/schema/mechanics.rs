//! Step lengths and units of positions, speeds, accelerations and jerks (DESIGN B1); motion owns the types.

use crate::schema::rows::{fields, kinds};
use crate::schema::{Field, SONOBE, ZHANG, label};
use stepscope_motion::{
    limits,
    mechanics::{Acceleration, Direct, Distance, Jerk, Mechanics, Rotary, Screw, Speed, Wheel},
};

kinds! {
    /// Travel per step. Millimeters and degrees are available if the mechanics have them.
    Mechanics {
        /// The motor turns a shaft; distances are angles. Steps per turn = 360° / full step × microsteps.
        Rotary(Rotary) = "rotary" => label("Rotary shaft").from(SONOBE),
        /// The motor drives a wheel, pulley or gear: one turn is a travel of 2π × radius.
        Wheel(Wheel) = "wheel" => label("Wheel, pulley or gear").from(SONOBE),
        /// The motor turns a screw. The nut moves by the lead per turn.
        Screw(Screw) = "screw" => label("Lead screw").from(ZHANG),
        /// The measured travel of one step. Zhang 2012 finds it by least squares from pairs of length and steps.
        Direct(Direct) = "direct" => label("Length of a step").from(ZHANG),
    }
}

const FULL_STEP: Field = label("Full step")
    .unit("°")
    .number(limits::FULL_STEP_DEG)
    .term("Full step", "Angle of one full step of the motor; usually 1.8°.")
    .from(SONOBE);
const MICROSTEPS: Field = label("Microsteps")
    .number(limits::MICROSTEPS)
    .term("Microsteps", "Microsteps per full step. The driver shares the current between both windings. One STEP pulse is one microstep; 2 is half-stepping.")
    .from(SONOBE);

fields! {
    /// Units: steps and degrees.
    Rotary {
        /// Angle of a full step; 1.8° is 200 per turn.
        full_step_deg: f64 => FULL_STEP,
        /// Microsteps per full step.
        microsteps: u16 => MICROSTEPS,
    }
    /// Units: steps, mm and degrees.
    Wheel {
        /// Angle of a full step; 1.8° is 200 per turn.
        full_step_deg: f64 => FULL_STEP,
        /// Microsteps per full step.
        microsteps: u16 => MICROSTEPS,
        /// One turn is a travel of 2π × radius.
        radius_mm: f64 => label("Radius").unit("mm").number(limits::LENGTH_MM)
            .term("Radius", "Radius of the wheel, pulley or pitch circle.")
            .from(SONOBE),
    }
    /// Units: steps, mm and degrees.
    Screw {
        /// Angle of a full step; 1.8° is 200 per turn.
        full_step_deg: f64 => FULL_STEP,
        /// Microsteps per full step.
        microsteps: u16 => MICROSTEPS,
        /// Travel of the nut per turn.
        lead_mm: f64 => label("Lead").unit("mm").number(limits::LENGTH_MM)
            .term("Lead", "Travel of the nut per turn of the screw.")
            .from(ZHANG),
    }
    /// Units: steps and mm.
    Direct {
        /// Travel of one step.
        step_mm: f64 => label("One step").unit("mm").number(limits::LENGTH_MM)
            .term("One step", "Travel of one step, measured or given.")
            .from(ZHANG),
    }
}

kinds! {
    /// A distance; negative is left. It is rounded half up to whole steps, at least 1.
    Distance {
        /// In steps.
        Steps(f64) = "steps" => label("steps"),
        /// In millimeters.
        Millimeters(f64) = "mm" => label("mm"),
        /// In degrees.
        Degrees(f64) = "deg" => label("°"),
    }
    /// A speed.
    Speed {
        /// In steps per second (Hz or pps).
        StepsPerSecond(f64) = "steps_s" => label("steps/s"),
        /// In millimeters per second.
        MillimetersPerSecond(f64) = "mm_s" => label("mm/s"),
        /// In degrees per second.
        DegreesPerSecond(f64) = "deg_s" => label("°/s"),
        /// In turns per minute.
        TurnsPerMinute(f64) = "rpm" => label("rpm"),
    }
    /// Change of speed per second.
    Acceleration {
        /// In steps per second squared.
        StepsPerSecond2(f64) = "steps_s2" => label("steps/s²"),
        /// In millimeters per second squared.
        MillimetersPerSecond2(f64) = "mm_s2" => label("mm/s²"),
        /// In degrees per second squared.
        DegreesPerSecond2(f64) = "deg_s2" => label("°/s²"),
    }
    /// Change of acceleration per second.
    Jerk {
        /// In steps per second cubed.
        StepsPerSecond3(f64) = "steps_s3" => label("steps/s³"),
        /// In millimeters per second cubed.
        MillimetersPerSecond3(f64) = "mm_s3" => label("mm/s³"),
        /// In degrees per second cubed.
        DegreesPerSecond3(f64) = "deg_s3" => label("°/s³"),
    }
}
