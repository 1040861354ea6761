//! Groups of moves that start and end together on several axes.

use crate::mechanics::{Distance, Speed};
use crate::moves::{LimitedProfile, Move};
use alloc::{vec, vec::Vec};
use stepscope_peripheral::parameters;

/// Moves of several axes that start and end at the same time.
#[derive(Clone, Debug, PartialEq)]
pub enum Group {
    Time(TimeGroup),
    Line(LineGroup),
    WayPoints(WayPointGroup),
}

impl Default for Group {
    fn default() -> Self {
        Self::Line(LineGroup::default())
    }
}

parameters! { (Clone, Debug, PartialEq)
    /// Each axis has its own kind of move; all have the same duration.
    pub struct TimeGroup {
        /// `None` is the duration of the slowest move.
        pub duration_s: Option<f64> = None,
        /// At most one per axis.
        pub moves: Vec<GroupMove> = vec![GroupMove::default()],
    }

    /// The move of one axis.
    pub struct GroupMove {
        /// From 0 on.
        pub axis: u8 = 0,
        pub r#move: Move = Move::default(),
    }

    /// All axes follow a straight line from rest to rest.
    pub struct LineGroup {
        /// One per axis; an axis with 0 stands still.
        pub distances: Vec<Distance> = vec![Distance::Steps(1000.0)],
        pub profile: LimitedProfile = LimitedProfile::JerkLimited,
    }

    /// All axes pass points without stopping.
    pub struct WayPointGroup {
        pub points: Vec<WayPoint> = vec![WayPoint::default()],
    }

    /// A point that all axes pass at the same time.
    pub struct WayPoint {
        /// From the start of the motion, one per axis.
        pub positions: Vec<Distance> = vec![Distance::Steps(1000.0)],
        /// One per axis, negative to the left; `None` is a suitable speed.
        pub speeds: Option<Vec<Option<Speed>>> = None,
    }
}
