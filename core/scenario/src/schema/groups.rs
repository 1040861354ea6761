//! Groups of moves that start and end together, and input shapers; stepscope-motion defines the types.

use crate::schema::rows::{fields, kinds};
use crate::schema::{Field, OWN, label};
use alloc::vec::Vec;
use stepscope_motion::groups::{Group, GroupMove, LineGroup, TimeGroup, WayPoint, WayPointGroup};
use stepscope_motion::mechanics::{Distance, Speed};
use stepscope_motion::moves::{LimitedProfile, Move};
use stepscope_motion::shaper::{InputShaper, ShaperSettings};
use stepscope_motion::{limits, moves::MAX_POINTS};

kinds! {
    /// Moves of several axes that start and end at the same time.
    Group {
        /// Each axis has its own kind of move. Faster moves are stretched to the duration of the slowest.
        Time(TimeGroup) = "time" => label("Equal time").from(OWN),
        /// All axes follow a straight line from rest to rest.
        Line(LineGroup) = "line" => label("Straight line").from(OWN),
        /// All axes pass points without stopping.
        WayPoints(WayPointGroup) = "way_points" => label("Waypoints").from(OWN),
    }
    /// An input shaper. Give all axes of a group the same one.
    InputShaper {
        /// Zero vibration: two impulses, half a period (Singer and Seering 1990). Damping ratio up to 0.99.
        Zv(ShaperSettings) = "zv" => label("ZV"),
        /// Modified zero vibration of Klipper: three impulses, three quarters of a period. Damping ratio up to 0.99.
        Mzv(ShaperSettings) = "mzv" => label("MZV"),
        /// Zero vibration and derivative: three impulses, one period (Singer and Seering 1990). Damping ratio up to 0.99.
        Zvd(ShaperSettings) = "zvd" => label("ZVD"),
        /// Extra insensitive: 5 % of the vibration remains at the frequency itself (Singhose, Seering, Singer 1994). Damping ratio up to 0.4.
        Ei(ShaperSettings) = "ei" => label("EI"),
        /// Two humps: one and a half periods (Singhose et al. 1997). Damping ratio up to 0.3.
        TwoHumpEi(ShaperSettings) = "two_hump_ei" => label("2-hump EI"),
        /// Three humps: two periods (Singhose et al. 1997). Damping ratio up to 0.2.
        ThreeHumpEi(ShaperSettings) = "three_hump_ei" => label("3-hump EI"),
    }
}

const DISTANCE: Field = label("Distance").unit("steps").number(limits::STEPS);

fields! {
    /// Each axis runs its own curve more slowly, so that all end together. A move that follows a table cannot be in a group.
    TimeGroup {
        /// Duration of all moves, at least the duration of the slowest.
        duration_s: Option<f64> => label("Duration").unit("s").number(limits::DURATION_S).null_means("duration of the slowest move"),
        /// At most one per axis; other axes stand still.
        moves: Vec<GroupMove> => label("Moves").range_text("1 to the number of axes"),
    }
    /// The move of one axis.
    GroupMove {
        /// Index of the axis, from 0 on.
        axis: u8 => label("Axis").range_text("0 to the number of axes - 1"),
        /// Any kind of move except `retarget`.
        r#move: Move => label("Move"),
    }
    /// A straight line within the `limits` of all axes.
    LineGroup {
        /// One per axis; an axis with 0 stands still.
        distances: Vec<Distance> => DISTANCE.range_text("one for each axis"),
        /// How the acceleration changes.
        profile: LimitedProfile => label("Profile"),
    }
    /// The axes pass the points within their `limits`, and come to rest at the last one.
    WayPointGroup {
        /// Points in order. In all groups together, points times axes are at most 16384.
        points: Vec<WayPoint> => label("Points").length(1..=MAX_POINTS, "points"),
    }
    /// A point that all axes pass at the same time.
    WayPoint {
        /// Positions from the start of the motion, one for each axis; rounded to whole steps.
        positions: Vec<Distance> => label("Positions").range_text("one for each axis"),
        /// Speeds at the point, one per axis, negative to the left. A null in the list selects a suitable speed.
        speeds: Option<Vec<Option<Speed>>> => label("Speeds").range_text("one for each axis").null_means("suitable speeds"),
    }
    /// The vibration of the machine.
    ShaperSettings {
        /// Frequency of the vibration.
        frequency_hz: f64 => label("Frequency").unit("Hz").number(limits::SHAPER_HZ),
        /// Damping ratio of the vibration.
        damping_ratio: f64 => label("Damping ratio").range_text("0 to the maximum of the shaper"),
    }
}
