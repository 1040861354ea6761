//! The page's charts: one chart on one canvas, described by plain numbers (DESIGN Part D).
//!
//! Everything is drawn through plotters' `DrawingBackend`, so the same code draws on a canvas in
//! the page and as SVG in a native test. plotters-canvas knows no device-pixel ratio: the canvas
//! has CSS size times ratio, and every length here is multiplied by the ratio.
//!
//! A `band` is a curve that was decimated to the least and greatest value of each pixel column.
//! It is drawn as an oscilloscope draws it, as one line that visits both values of every column;
//! so a smooth curve looks like a line and a dense one like a filled block.

use plotters::{
    coord::Shift,
    prelude::*,
    style::{FontStyle, RGBColor, ShapeStyle, TextStyle},
};
use serde::{Deserialize, Serialize};

/// What to draw, and with which colours.
#[derive(Deserialize)]
pub struct Spec {
    /// Device pixels to a CSS pixel.
    pub ratio: f64,
    /// Font family of all labels.
    pub font: String,
    /// Size of the labels in CSS pixels.
    pub font_px: f64,
    /// The time or frequency axis.
    pub x: Axis,
    /// The axis of values.
    pub y: Axis,
    /// Colours of the page, as `#rrggbb`.
    pub colors: Colors,
    /// From the back to the front.
    pub series: Vec<Series>,
}

/// Range and labels of one axis.
#[derive(Deserialize)]
pub struct Axis {
    /// Least value shown.
    pub min: f64,
    /// Greatest value shown.
    pub max: f64,
    /// Unit behind the tick labels; takes an SI prefix. Empty for a plain number, which takes the
    /// prefix alone.
    pub unit: String,
    /// False for units that take no prefix, such as dB, and for counts.
    pub prefix: bool,
    /// Space for the tick labels in CSS pixels; 0 for none.
    pub label_px: f64,
}

/// Colours of what is no series, as `#rrggbb`.
#[derive(Deserialize)]
pub struct Colors {
    /// Labels.
    pub label: String,
    /// Axes.
    pub axis: String,
    /// Grid at the tick labels.
    pub grid: String,
}

/// One series.
#[derive(Deserialize)]
pub struct Series {
    /// Colour as `#rrggbb`.
    pub color: String,
    /// From 0 (invisible) to 1.
    pub opacity: f64,
    /// Width of the stroke in CSS pixels.
    pub width: f64,
    /// Positions on the x axis.
    pub x: Vec<f64>,
    /// The values, such as `{"line": {"y": […]}}`.
    pub shape: Shape,
}

/// The values of a series, one or two at each x. A value that is no number leaves a gap.
#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Shape {
    /// A line through all points.
    Line {
        /// Values.
        y: Vec<f64>,
    },
    /// Least and greatest value of each pixel column.
    Band {
        /// Least values.
        min: Vec<f64>,
        /// Greatest values.
        max: Vec<f64>,
    },
    /// A stem from the bottom of the chart to each value.
    Stems {
        /// Values.
        y: Vec<f64>,
        /// Shift to the right in CSS pixels, so that two series stand side by side.
        shift: f64,
    },
}

/// Where the plotting area lies in its canvas, in CSS pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Plot {
    /// Left edge, at `x.min`.
    pub left: f64,
    /// Upper edge, at `y.max`.
    pub top: f64,
    /// Right edge, at `x.max`.
    pub right: f64,
    /// Lower edge, at `y.min`.
    pub bottom: f64,
}

/// Draws one chart and tells where its plotting area lies.
///
/// # Errors
/// The backend's own message, or that an axis has no length.
pub fn draw<DB: DrawingBackend>(root: &DrawingArea<DB, Shift>, spec: &Spec) -> Result<Plot, String> {
    for (name, axis) in [("x", &spec.x), ("y", &spec.y)] {
        // Also refuses what is not a number.
        if !(axis.max - axis.min).is_normal() || axis.max < axis.min {
            return Err(format!("axis {name} from {} to {} has no length", axis.min, axis.max));
        }
    }
    let px = |css: f64| (css * spec.ratio).round() as i32;
    let (width, height) = root.dim_in_pixel();
    let mut chart = ChartBuilder::on(root)
        .margin_top(px(6.0))
        .margin_right(px(26.0))
        .margin_bottom(px(if spec.x.label_px > 0.0 { 2.0 } else { 6.0 }))
        .x_label_area_size(px(spec.x.label_px))
        .y_label_area_size(px(spec.y.label_px))
        .build_cartesian_2d(spec.x.min..spec.x.max, spec.y.min..spec.y.max)
        .map_err(|error| error.to_string())?;

    let css = |pixels: u32| f64::from(pixels) / spec.ratio;
    // Plain counts have short labels.
    let x_space = if spec.x.unit.is_empty() { 40.0 } else { 110.0 };
    let x_ticks = ((css(width) / x_space) as usize).clamp(2, 12);
    let y_ticks = ((css(height) / 22.0) as usize).clamp(4, 10);
    let x_format = Ticks::new(&spec.x, x_ticks);
    let y_format = Ticks::new(&spec.y, y_ticks);
    let font = (spec.font.as_str(), spec.font_px * spec.ratio, FontStyle::Normal);
    let ink = color(&spec.colors.label);
    let label: TextStyle<'_> = TextStyle::from(font).color(&ink);
    let thin = px(1.0).max(1) as u32;
    chart
        .configure_mesh()
        .max_light_lines(1)
        .x_labels(x_ticks)
        .y_labels(y_ticks)
        .x_label_formatter(&|value| x_format.print(*value))
        .y_label_formatter(&|value| y_format.print(*value))
        .label_style(label)
        .bold_line_style(color(&spec.colors.grid).stroke_width(thin))
        .light_line_style(TRANSPARENT)
        .axis_style(color(&spec.colors.axis).stroke_width(thin))
        .set_all_tick_mark_size(px(4.0))
        .draw()
        .map_err(|error| error.to_string())?;

    for series in &spec.series {
        let style = ShapeStyle {
            color: color(&series.color).mix(series.opacity),
            filled: false,
            stroke_width: px(series.width).max(1) as u32,
        };
        let y = |value: f64| value.clamp(spec.y.min, spec.y.max);
        let lines = match &series.shape {
            Shape::Line { y: values } => runs(&series.x, values, values, |x, value, _| vec![(x, y(value))]),
            Shape::Band { min, max } => {
                let mut last = 0.0;
                runs(&series.x, min, max, |x, min, max| {
                    let rising = (last - min).abs() <= (last - max).abs();
                    let (first, second) = if rising { (min, max) } else { (max, min) };
                    last = second;
                    vec![(x, y(first)), (x, y(second))]
                })
            }
            Shape::Stems { y: values, shift } => {
                let shift = shift * spec.ratio * (spec.x.max - spec.x.min) / f64::from(width.max(1));
                stems(&series.x, values, shift, spec.y.min)
                    .map(|(x, top)| vec![(x, spec.y.min), (x, y(top))])
                    .collect()
            }
        };
        let paths = lines.into_iter().map(|line| PathElement::new(line, style));
        chart.draw_series(paths).map_err(|error| error.to_string())?;
    }

    let (across, down) = chart.plotting_area().get_pixel_range();
    let css = |pixels: i32| f64::from(pixels) / spec.ratio;
    Ok(Plot { left: css(across.start), top: css(down.start), right: css(across.end), bottom: css(down.end) })
}

/// Splits a series at its gaps into lines of at least one point.
fn runs(
    x: &[f64],
    first: &[f64],
    second: &[f64],
    mut points: impl FnMut(f64, f64, f64) -> Vec<(f64, f64)>,
) -> Vec<Vec<(f64, f64)>> {
    let mut lines = vec![Vec::new()];
    for ((x, first), second) in x.iter().zip(first).zip(second) {
        if first.is_finite() && second.is_finite() {
            if let Some(line) = lines.last_mut() {
                line.extend(points(*x, *first, *second));
            }
        } else if lines.last().is_some_and(|line| !line.is_empty()) {
            lines.push(Vec::new());
        }
    }
    lines.retain(|line| !line.is_empty());
    lines
}

fn stems(x: &[f64], y: &[f64], shift: f64, floor: f64) -> impl Iterator<Item = (f64, f64)> {
    x.iter().zip(y).filter(move |(_, y)| **y > floor).map(move |(x, y)| (x + shift, *y))
}

/// How the labels of one axis print their numbers: one prefix and one number of digits for all.
struct Ticks<'a> {
    scale: f64,
    digits: usize,
    space: &'static str,
    prefix: &'static str,
    unit: &'a str,
}

impl<'a> Ticks<'a> {
    fn new(axis: &'a Axis, count: usize) -> Self {
        const PREFIXES: [(f64, &str); 7] =
            [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")];
        let largest = axis.min.abs().max(axis.max.abs());
        let (scale, prefix) = PREFIXES
            .into_iter()
            .find(|(scale, _)| axis.prefix && largest >= *scale * 0.9999)
            .unwrap_or((1.0, ""));
        // Ticks lie the next 1, 2 or 5 times a power of ten apart.
        let step = (axis.max - axis.min) / scale / count as f64;
        let digits = (0..9).find(|digits| step * 10_f64.powi(*digits) > 0.5001).unwrap_or(9) as usize;
        let space = if axis.unit.is_empty() { "" } else { " " };
        Self { scale, digits, space, prefix, unit: &axis.unit }
    }

    fn print(&self, value: f64) -> String {
        // Adding zero makes a plain zero of a negative one.
        let number = value / self.scale + 0.0;
        let text = format!("{number:.*}", self.digits);
        let zero = text.chars().all(|c| matches!(c, '0' | '.' | '-'));
        let text = if zero { "0" } else { &text };
        let prefix = if zero && self.unit.is_empty() { "" } else { self.prefix };
        format!("{text}{}{prefix}{}", self.space, self.unit).replace('-', "\u{2212}")
    }
}

/// Reads `#rrggbb`; what it cannot read is a middle grey, visible on light and dark.
fn color(text: &str) -> RGBColor {
    let part = |from| text.get(from..from + 2).and_then(|digits| u8::from_str_radix(digits, 16).ok());
    match (part(1), part(3), part(5)) {
        (Some(r), Some(g), Some(b)) => RGBColor(r, g, b),
        _ => RGBColor(128, 128, 128),
    }
}

#[cfg(target_arch = "wasm32")]
mod page {
    use super::{Spec, draw};
    use plotters::prelude::IntoDrawingArea;
    use plotters_canvas::CanvasBackend;
    use serde::Serialize as _;
    use wasm_bindgen::{JsError, JsValue, prelude::wasm_bindgen};
    use web_sys::HtmlCanvasElement;

    /// Draws one chart on a canvas that has its device size already, and gives the plotting area
    /// in CSS pixels: `{left, top, right, bottom}`.
    ///
    /// # Errors
    /// A spec that cannot be read, an axis without length, or a canvas without a 2D context.
    #[wasm_bindgen]
    pub fn draw_chart(canvas: HtmlCanvasElement, spec: JsValue) -> Result<JsValue, JsError> {
        let spec: Spec = serde_wasm_bindgen::from_value(spec)?;
        let backend = CanvasBackend::with_canvas_object(canvas)
            .ok_or_else(|| JsError::new("this canvas has no 2D context"))?;
        let plot = draw(&backend.into_drawing_area(), &spec).map_err(|message| JsError::new(&message))?;
        Ok(plot.serialize(&serde_wasm_bindgen::Serializer::json_compatible())?)
    }
}

#[cfg(all(test, not(target_arch = "wasm32")))]
mod tests {
    use super::*;

    fn axis(min: f64, max: f64, unit: &str) -> Axis {
        Axis { min, max, unit: unit.into(), prefix: true, label_px: 40.0 }
    }

    fn spec(x: Axis, y: Axis, shape: Shape) -> Spec {
        let series =
            Series { color: "#0072b2".into(), opacity: 1.0, width: 1.0, x: vec![0.0, 0.5, 1.0], shape };
        let colors = Colors { label: "#222222".into(), axis: "#888888".into(), grid: "#dddddd".into() };
        Spec { ratio: 2.0, font: "sans-serif".into(), font_px: 11.0, x, y, colors, series: vec![series] }
    }

    fn svg(spec: &Spec) -> (String, Result<Plot, String>) {
        let mut text = String::new();
        let plot = draw(&SVGBackend::with_string(&mut text, (800, 400)).into_drawing_area(), spec);
        (text, plot)
    }

    #[test]
    fn tick_labels_share_one_prefix_and_one_number_of_digits() {
        let rows = [
            (0.0, 32_000.0, "", 10_000.0, "10k"),
            (0.0, 32_000.0, "", 0.0, "0"),
            (0.0, 0.4, "s", 0.05, "50 ms"),
            (0.4, 0.4001, "s", 0.40005, "400.05 ms"),
            (-1.0, 1.0, "", -0.5, "\u{2212}0.5"),
            (0.0, 1e-6, "s", 5e-7, "0.5 µs"),
            (0.0, 0.4, "", 0.1, "100m"),
        ];
        for (min, max, unit, value, expected) in rows {
            let axis = axis(min, max, unit);
            let printed = Ticks::new(&axis, 5).print(value);
            assert_eq!(printed, expected, "{min}..{max} {unit}: {value}");
        }
    }

    #[test]
    fn each_shape_is_drawn_inside_the_plotting_area() {
        let (nan, values) = (f64::NAN, vec![1.0, 9e9, 2.0]);
        let shapes = [
            (Shape::Line { y: values.clone() }, 1),
            (Shape::Line { y: vec![1.0, nan, 2.0] }, 2),
            (Shape::Band { min: vec![-9e9, 0.0, 1.0], max: values.clone() }, 1),
            (Shape::Stems { y: values, shift: 0.0 }, 3),
        ];
        for (shape, lines) in shapes {
            let (text, plot) = svg(&spec(axis(0.0, 1.0, "s"), axis(0.0, 10.0, ""), shape));
            let plot = plot.expect("draws");
            assert_eq!(plot.left, 40.0);
            assert!(plot.right > 300.0 && plot.right < 400.0 && plot.top < plot.bottom, "{plot:?}");
            let drawn: Vec<&str> = text.lines().filter(|line| line.contains("#0072B2")).collect();
            assert_eq!(drawn.len(), lines, "{text}");
            for pair in drawn.iter().flat_map(|line| line.split('"')).filter(|part| part.contains(',')) {
                for y in pair.split_whitespace().filter_map(|p| p.split_once(',')?.1.parse::<f64>().ok()) {
                    assert!((plot.top * 2.0 - 1.0..=plot.bottom * 2.0 + 1.0).contains(&y), "{pair}");
                }
            }
        }
    }

    #[test]
    fn an_axis_without_length_is_refused_with_its_numbers() {
        for (min, max) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            let shape = Shape::Line { y: vec![0.0; 3] };
            let (_, plot) = svg(&spec(axis(0.0, 1.0, "s"), axis(min, max, ""), shape));
            let message = plot.expect_err("refuses");
            assert!(message.contains("axis y") && message.contains("no length"), "{message}");
        }
    }
}
