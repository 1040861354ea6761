//! Where a move begins: its position between two steps, and the speed that it takes over.

use crate::curves::curve::signed;
use crate::mechanics::Speed;
use crate::planners::quantities::Quantities;
use crate::problem::Cause;

/// The state of an axis before a move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Start {
    /// The exact position minus the whole one, -1/2 to 1/2.
    pub(crate) offset: f64,
    /// The given end speed of the previous move along the axis, or 0.
    pub(crate) speed: f64,
}

/// The curve of a move: by its own formula from rest to rest, or the general one.
pub(crate) enum Planned<C, G> {
    FromRest(C),
    General(G),
}

impl<C, G> Planned<C, G> {
    /// Converts either curve.
    pub(crate) fn map<T>(self, from_rest: impl FnOnce(C) -> T, general: impl FnOnce(G) -> T) -> T {
        match self {
            Self::FromRest(curve) => from_rest(curve),
            Self::General(curve) => general(curve),
        }
    }
}

/// Speeds at the start and the end of a move, along the move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct EdgeSpeeds {
    pub(crate) start: f64,
    pub(crate) end: f64,
}

impl EdgeSpeeds {
    pub(crate) fn are_rest(self) -> bool {
        self == Self::default()
    }
}

impl Start {
    /// The speed that a move of `steps` takes over, along the move; `None` with a problem if it points the other way.
    pub(crate) fn taken_over(self, quantities: &mut Quantities<'_>, steps: i64) -> Option<f64> {
        let along = signed(steps, self.speed);
        if along < 0.0 {
            quantities.refuse("start_speed", Cause::SpeedAgainstMove { speed: self.speed, steps });
            return None;
        }
        // Without the sign of -0.
        Some(along + 0.0)
    }

    /// The speeds of a move of `steps`; a missing end speed is 0.
    pub(crate) fn edges(
        self,
        quantities: &mut Quantities<'_>,
        steps: Option<i64>,
        start: Option<&Speed>,
        end: Option<&Speed>,
    ) -> Option<EdgeSpeeds> {
        let start = quantities.edge_speed("start_speed", start);
        let end = quantities.edge_speed("end_speed", end);
        let start = match start? {
            Some(start) => start,
            None => self.taken_over(quantities, steps?)?,
        };
        Some(EdgeSpeeds { start, end: end?.unwrap_or(0.0) })
    }
}

/// Refuses speeds above the maximum of a move.
pub(crate) fn check_edges(quantities: &mut Quantities<'_>, edges: EdgeSpeeds, max: f64) -> Option<()> {
    for (field, speed) in [("start_speed", edges.start), ("end_speed", edges.end)] {
        if speed > max {
            quantities.refuse(field, Cause::EdgeAboveMax { speed, max });
            return None;
        }
    }
    Some(())
}

/// Refuses the fields of a start and an end speed for a move that follows a table.
pub(crate) fn refuse_edges(
    quantities: &mut Quantities<'_>,
    start: Start,
    given: [(&'static str, bool); 3],
) -> Option<()> {
    let mut is_ok = true;
    for (field, _) in given.into_iter().filter(|(_, is_given)| *is_given) {
        quantities.refuse(
            field,
            Cause::FollowsTable { what: "has no such field", remedy: "null, or the exact method" },
        );
        is_ok = false;
    }
    if is_ok && start.speed != 0.0 {
        quantities.refuse(
            "start_speed",
            Cause::FollowsTable {
                what: "cannot take over a speed",
                remedy: "an end speed of 0 before it, or the exact method",
            },
        );
        is_ok = false;
    }
    is_ok.then_some(())
}
