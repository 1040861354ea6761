//! Segments of a sine with minimum distortion (DESIGN B5): a sweep, the best d1 of a range, and the best vertices.

use crate::convert::{field, numbers};
use crate::scenario::ValidatedScenario;
use js_sys::Object;
use std::ops::Range;
use stepscope_core::inspect::motion::sine_optimum::{Freedom, optimum};
use stepscope_core::inspect::motion::sine_polyline::{Bounds, Distinct, Measure, Row, best_of_each, swept};
use stepscope_core::motion::Profile;
use stepscope_core::motion::curves::{Memory, Segment};
use stepscope_core::sim::SelectedAxis;
use wasm_bindgen::prelude::*;

fn columns(rows: &[Row]) -> Object {
    let result = Object::new();
    let put = |name: &str, of: &dyn Fn(&Row) -> f64| {
        numbers(&result, name, &rows.iter().map(of).collect::<Vec<f64>>());
    };
    put("d1", &|row| row.d1);
    put("segments", &|row| row.segments as f64);
    put("position", &|row| row.distortion.position);
    put("speed", &|row| row.distortion.speed);
    put("acceleration", &|row| row.distortion.acceleration);
    put("filtered", &|row| row.distortion.acceleration_filtered.unwrap_or(f64::NAN));
    put("euclidean", &|row| row.euclidean);
    result
}

/// Rows `first..end` of a sweep over `count` values of d1, as columns. `sensor` is the bandwidth of a sensor relative to the
/// fundamental; without one `filtered` is NaN.
#[wasm_bindgen]
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

/// The d1 with minimum distortion of position for each number of segments in a range, as [`sine_rows`].
#[wasm_bindgen]
pub fn sine_best(from: f64, to: f64, order: u16, sensor: Option<f64>) -> Object {
    columns(&best_of_each(Distinct::new(from, to, Bounds { order, sensor })))
}

/// The vertices of `segments` per quarter with minimum distortion of position, on the curve or free: `{angle_deg, height,
/// thd}`; undefined outside of 1 to 32 segments.
#[wasm_bindgen]
pub fn sine_vertices(segments: usize, free: bool, order: u16) -> Option<Object> {
    let freedom = if free { Freedom::Free } else { Freedom::OnCurve };
    let best = optimum(segments, freedom, order)?;
    let result = Object::new();
    let angles: Vec<f64> = best.vertices.iter().map(|vertex| vertex.angle.to_degrees()).collect();
    let heights: Vec<f64> = best.vertices.iter().map(|vertex| vertex.height).collect();
    numbers(&result, "angle_deg", &angles);
    numbers(&result, "height", &heights);
    field(&result, "thd", &best.distortion.position.into());
    Some(result)
}

#[wasm_bindgen]
impl ValidatedScenario {
    /// A quarter of the first sine in segments of an axis: columns `from_deg`, `to_deg`, `steps`, `rate` and `duration_s`,
    /// and its bytes as segments and as intervals; undefined without one.
    /// Errors: if the scenario has problems, or no such axis.
    pub fn sine_segments(&self, controller: usize, axis: usize) -> Result<Option<Object>, JsError> {
        let SelectedAxis { plan, .. } = self.axis(controller, axis)?;
        let sine = plan.moves().iter().find_map(|planned| match &planned.profile {
            Profile::SineSegments(sine) => Some(sine),
            _ => None,
        });
        let Some(sine) = sine else { return Ok(None) };
        let result = Object::new();
        let put = |name: &str, of: &dyn Fn(&Segment) -> f64| {
            numbers(&result, name, &sine.segments().iter().map(of).collect::<Vec<f64>>());
        };
        put("from_deg", &|segment| segment.from_deg);
        put("to_deg", &|segment| segment.to_deg);
        put("steps", &|segment| segment.steps as f64);
        put("rate", &|segment| segment.rate);
        put("duration_s", &|segment| segment.duration_s);
        let Memory { segments, intervals } = sine.memory();
        field(&result, "segment_bytes", &(segments as f64).into());
        field(&result, "interval_bytes", &(intervals as f64).into());
        Ok(Some(result))
    }
}
