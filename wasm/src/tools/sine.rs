//! Which segments make a sine with least distortion (DESIGN B5, figure 4): rows of a sweep, the best d1 of a range, the
//! best vertices. Each call is a piece of a longer question, which workers share.

use crate::{
    convert::{field, numbers},
    judged::Judged,
};
use js_sys::Object;
use std::ops::Range;
use stepscope_core::{
    inspect::motion::{
        sine_optimum::{Freedom, optimum},
        sine_polyline::{Bounds, Distinct, Measure, Row, best_of_each, swept},
    },
    motion::{
        Profile,
        curves::{Memory, Segment},
    },
    sim::SelectedAxis,
};
use wasm_bindgen::prelude::*;

/// Columns of rows.
fn columns(rows: &[Row]) -> Object {
    let made = Object::new();
    let put = |name: &str, of: &dyn Fn(&Row) -> f64| {
        numbers(&made, name, &rows.iter().map(of).collect::<Vec<f64>>());
    };
    put("d1", &|row| row.d1);
    put("segments", &|row| row.segments as f64);
    put("position", &|row| row.distortion.position);
    put("speed", &|row| row.distortion.speed);
    put("acceleration", &|row| row.distortion.acceleration);
    put("filtered", &|row| row.distortion.acceleration_filtered.unwrap_or(f64::NAN));
    put("euclidean", &|row| row.euclidean);
    made
}

/// Rows `first` to before `end` of the sweep over `count` values of d1, as columns `d1`, `segments`, `position`, `speed`,
/// `acceleration` (THD as ratios), `filtered` (that of the acceleration through a sensor whose bandwidth is `sensor` times the
/// fundamental, NaN without one) and `euclidean`.
#[wasm_bindgen]
#[must_use]
pub fn sine_rows(
    from: f64,
    to: f64,
    count: u32,
    order: u16,
    sensor: Option<f64>,
    first: u32,
    end: u32,
) -> Object {
    let measure = Measure::new(Bounds { order, sensor });
    let Range { start, end } = first..end.min(count);
    let rows: Vec<Row> = (start..end).map(|index| measure.row(swept(from, to, count, index))).collect();
    columns(&rows)
}

/// For each number of segments the d1 with least distortion of the position, of all polylines that a range has: columns
/// as [`sine_rows`].
#[wasm_bindgen]
#[must_use]
pub fn sine_best(from: f64, to: f64, order: u16, sensor: Option<f64>) -> Object {
    columns(&best_of_each(Distinct::new(from, to, Bounds { order, sensor })))
}

/// The vertices of `segments` a quarter with least distortion of the position, on the curve or free: `angle_deg` and
/// `height` of each, and `thd`; undefined for another number of segments than 1 to 32.
#[wasm_bindgen]
#[must_use]
pub fn sine_vertices(segments: usize, free: bool, order: u16) -> Option<Object> {
    let freedom = if free { Freedom::Free } else { Freedom::OnCurve };
    let found = optimum(segments, freedom, order)?;
    let made = Object::new();
    let angles: Vec<f64> = found.vertices.iter().map(|vertex| vertex.angle.to_degrees()).collect();
    let heights: Vec<f64> = found.vertices.iter().map(|vertex| vertex.height).collect();
    numbers(&made, "angle_deg", &angles);
    numbers(&made, "height", &heights);
    field(&made, "thd", &found.distortion.position.into());
    Some(made)
}

#[wasm_bindgen]
impl Judged {
    /// The segments of a quarter of the first sine in segments that an axis has: columns `from_deg`, `to_deg`, `steps`,
    /// `rate` (steps/s) and `duration_s`, and the bytes of a quarter as segments (`segment_bytes`) and with one interval a
    /// step (`interval_bytes`); undefined where the axis has none.
    ///
    /// # Errors
    /// If the axis has problems, or is not there.
    pub fn sine_segments(&self, controller: usize, axis: usize) -> Result<Option<Object>, JsError> {
        let SelectedAxis { plan, .. } = self.axis(controller, axis)?;
        let found = plan.moves().iter().find_map(|planned| match &planned.profile {
            Profile::SineSegments(sine) => Some(sine),
            _ => None,
        });
        let Some(sine) = found else { return Ok(None) };
        let made = Object::new();
        let put = |name: &str, of: &dyn Fn(&Segment) -> f64| {
            numbers(&made, name, &sine.segments().iter().map(of).collect::<Vec<f64>>());
        };
        put("from_deg", &|segment| segment.from_deg);
        put("to_deg", &|segment| segment.to_deg);
        put("steps", &|segment| segment.steps as f64);
        put("rate", &|segment| segment.rate);
        put("duration_s", &|segment| segment.duration_s);
        let Memory { segments, intervals } = sine.memory();
        field(&made, "segment_bytes", &(segments as f64).into());
        field(&made, "interval_bytes", &(intervals as f64).into());
        Ok(Some(made))
    }
}
