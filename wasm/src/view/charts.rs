//! The page's charts: one chart per canvas (DESIGN Part D).
//!
//! plotters draws axes, grid and labels on a canvas or as SVG. It has no device-pixel ratio, so all lengths are multiplied
//! by it, and no fractions of a pixel, so curves are separate strokes.
//!
//! A `band` is a curve with the minimum and maximum of each pixel column, drawn as one line through both.

// Native builds only draw SVG in tests.
#![cfg(any(test, target_arch = "wasm32"))]

mod axis;
mod curve;
#[cfg(all(test, not(target_arch = "wasm32")))]
mod pictures;
mod stroke;
mod surface;
mod ticks;

pub(crate) use axis::Axis;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::prelude::*;
use plotters::style::{FontFamily, FontStyle, RGBColor, TextStyle};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use stroke::Stroke;
use surface::Surface;
use ticks::Ticks;

#[derive(Deserialize)]
pub(crate) struct Spec {
    /// Device pixels per CSS pixel.
    pub(crate) ratio: f64,
    pub(crate) font: String,
    pub(crate) font_px: f64,
    /// The time or frequency axis.
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) colors: Colors,
    pub(crate) series: Vec<Series>,
}

/// Colors as `#rrggbb`.
#[derive(Deserialize)]
pub(crate) struct Colors {
    pub(crate) label: String,
    pub(crate) axis: String,
    pub(crate) grid: String,
}

#[derive(Deserialize)]
pub(crate) struct Series {
    /// Color as `#rrggbb`.
    pub(crate) color: String,
    /// From 0 (invisible) to 1.
    pub(crate) opacity: f64,
    /// Width of the stroke in CSS pixels.
    pub(crate) width: f64,
    /// Length of dashes and gaps in CSS pixels; 0 for a solid line.
    #[serde(default)]
    pub(crate) dash: f64,
    pub(crate) x: Vec<f64>,
    /// The values, such as `{"line": {"y": […]}}`.
    pub(crate) shape: Shape,
}

/// The values of a series. NaN leaves a gap.
#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Shape {
    Line {
        y: Vec<f64>,
    },
    /// Minimum and maximum of each pixel column.
    Band {
        min: Vec<f64>,
        max: Vec<f64>,
    },
    /// A stem from the bottom of the chart to each value.
    Stems {
        y: Vec<f64>,
        /// Shift to the right in CSS pixels.
        shift: f64,
    },
}

/// The plotting area, in CSS pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Plot {
    /// Left edge, at `x.min`.
    pub(crate) left: f64,
    /// Upper edge, at `y.max`.
    pub(crate) top: f64,
    /// Right edge, at `x.max`.
    pub(crate) right: f64,
    /// Lower edge, at `y.min`.
    pub(crate) bottom: f64,
}

/// A chart as SVG, and its plotting area.
pub(crate) fn svg(size: (u32, u32), spec: &Spec) -> Result<(String, Plot), String> {
    let mut text = String::new();
    let (plot, strokes) = draw(Surface::Svg(SVGBackend::with_string(&mut text, size)), spec)?;
    let end = text.rfind("</svg>").unwrap_or(text.len());
    let curves: String = strokes.iter().map(Stroke::svg).collect();
    text.insert_str(end, &curves);
    Ok((text, plot))
}

fn draw(surface: Surface<'_>, spec: &Spec) -> Result<(Plot, Vec<Stroke>), String> {
    let root = surface.into_drawing_area();
    for (name, axis) in [("x", &spec.x), ("y", &spec.y)] {
        // Also true for NaN.
        if !(axis.max - axis.min).is_normal() || axis.max < axis.min {
            return Err(format!("axis {name} from {} to {} has no length", axis.min, axis.max));
        }
    }
    let px = |css: f64| (css * spec.ratio).round() as i32;
    let (width, height) = root.dim_in_pixel();
    let css = |pixels: u32| f64::from(pixels) / spec.ratio;
    // Plain counts have short labels.
    let x_space = if spec.x.unit.is_empty() { 40.0 } else { 90.0 };
    let x_ticks = (((css(width) - spec.y.label_px) / x_space) as usize).clamp(2, 12);
    let tall = css(height) - spec.x.label_px;
    let y_ticks = ((tall / 22.0) as usize).clamp(2, 10);
    let x_format = Ticks::new(&spec.x, x_ticks, x_ticks);
    let y_format = Ticks::new(&spec.y, y_ticks, ((tall / 14.0) as usize).max(2));
    let mut chart = ChartBuilder::on(&root)
        .margin_top(px(6.0))
        .margin_right(px(26.0))
        .margin_bottom(px(if spec.x.label_px > 0.0 { 2.0 } else { 6.0 }))
        .x_label_area_size(px(spec.x.label_px))
        .y_label_area_size(px(spec.y.label_px))
        .build_cartesian_2d(
            Ruled(spec.x.min..spec.x.max, x_format.values.clone()),
            Ruled(spec.y.min..spec.y.max, y_format.values.clone()),
        )
        .map_err(|error| error.to_string())?;

    // Generic families would add tables of letter cases to the binary.
    let font = (FontFamily::Name(&spec.font), spec.font_px * spec.ratio, FontStyle::Normal);
    let ink = color(&spec.colors.label);
    let label: TextStyle<'_> = TextStyle::from(font).color(&ink);
    let thin = px(1.0).max(1) as u32;
    chart
        .configure_mesh()
        .max_light_lines(1)
        .x_labels(x_format.values.len())
        .y_labels(y_format.values.len())
        .x_label_formatter(&|value| x_format.print(*value))
        .y_label_formatter(&|value| y_format.print(*value))
        .label_style(label)
        .bold_line_style(color(&spec.colors.grid).stroke_width(thin))
        .light_line_style(TRANSPARENT)
        .axis_style(color(&spec.colors.axis).stroke_width(thin))
        .set_all_tick_mark_size(px(4.0))
        .draw()
        .map_err(|error| error.to_string())?;

    let (across, down) = chart.plotting_area().get_pixel_range();
    let area = chart.plotting_area();
    let (left, bottom) = area.map_coordinate(&(spec.x.min, spec.y.min));
    let (right, top) = area.map_coordinate(&(spec.x.max, spec.y.max));
    let frame = curve::Frame {
        x: (spec.x.min, spec.x.max),
        y: (spec.y.min, spec.y.max),
        corner: (f64::from(left), f64::from(bottom)),
        width: f64::from(right - left),
        height: f64::from(bottom - top),
    };
    let stroke = |series: &Series| {
        let lines = match &series.shape {
            Shape::Line { y } => curve::line(&frame, &series.x, y),
            Shape::Band { min, max } => curve::band(&frame, &series.x, min, max),
            Shape::Stems { y, shift } => curve::stems(&frame, &series.x, y, shift * spec.ratio),
        };
        Stroke {
            lines: if series.dash > 0.0 { curve::dashes(&lines, series.dash * spec.ratio) } else { lines },
            color: color(&series.color),
            opacity: series.opacity,
            width: series.width * spec.ratio,
        }
    };
    let strokes = spec.series.iter().map(stroke).collect();
    let css = |pixels: i32| f64::from(pixels) / spec.ratio;
    let plot =
        Plot { left: css(across.start), top: css(down.start), right: css(across.end), bottom: css(down.end) };
    Ok((plot, strokes))
}

struct Ruled(Range<f64>, Vec<f64>);

impl Ranged for Ruled {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let part = (value - self.0.start) / (self.0.end - self.0.start);
        from + (part * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.1.clone()
    }

    fn range(&self) -> Range<f64> {
        self.0.clone()
    }
}

/// Reads `#rrggbb`; gray if invalid.
fn color(text: &str) -> RGBColor {
    let part = |from| text.get(from..from + 2).and_then(|digits| u8::from_str_radix(digits, 16).ok());
    match (part(1), part(3), part(5)) {
        (Some(r), Some(g), Some(b)) => RGBColor(r, g, b),
        _ => RGBColor(128, 128, 128),
    }
}

#[cfg(target_arch = "wasm32")]
mod page {
    use super::{Spec, draw, surface::Surface, svg};
    use plotters_canvas::CanvasBackend;
    use serde::Serialize as _;
    use wasm_bindgen::{JsCast as _, JsError, JsValue, prelude::wasm_bindgen};
    use web_sys::{CanvasRenderingContext2d, HtmlCanvasElement};

    /// Draws a chart on a canvas of the right device size; returns its [`Plot`](super::Plot).
    /// Errors: for an invalid spec, an axis without length, or a canvas without a 2D context.
    #[wasm_bindgen]
    #[allow(unreachable_pub, reason = "wasm-bindgen only exports public functions")]
    pub fn draw_chart(canvas: HtmlCanvasElement, spec: JsValue) -> Result<JsValue, JsError> {
        let spec: Spec = serde_wasm_bindgen::from_value(spec)?;
        let none = || JsError::new("this canvas has no 2D context");
        let context = canvas.get_context("2d").ok().flatten().ok_or_else(none)?;
        let context: CanvasRenderingContext2d = context.dyn_into().map_err(|_| none())?;
        let backend = CanvasBackend::with_canvas_object(canvas).ok_or_else(none)?;
        let (plot, strokes) =
            draw(Surface::Canvas(backend), &spec).map_err(|message| JsError::new(&message))?;
        strokes.iter().for_each(|stroke| stroke.draw(&context));
        Ok(plot.serialize(&serde_wasm_bindgen::Serializer::json_compatible())?)
    }

    /// The same chart as SVG, in device pixels.
    #[wasm_bindgen]
    #[allow(unreachable_pub, reason = "wasm-bindgen only exports public functions")]
    pub fn chart_svg(width: u32, height: u32, spec: JsValue) -> Result<String, JsError> {
        let spec: Spec = serde_wasm_bindgen::from_value(spec)?;
        svg((width, height), &spec).map(|(text, _)| text).map_err(|message| JsError::new(&message))
    }
}

#[cfg(all(test, not(target_arch = "wasm32")))]
mod tests {
    use super::{axis::axis, *};

    fn spec(x: Axis, y: Axis, shape: Shape) -> Spec {
        let series = Series {
            color: "#0072b2".into(),
            opacity: 1.0,
            width: 1.0,
            dash: 0.0,
            x: vec![0.0, 0.5, 1.0],
            shape,
        };
        let colors = Colors { label: "#222222".into(), axis: "#888888".into(), grid: "#dddddd".into() };
        Spec { ratio: 2.0, font: "sans-serif".into(), font_px: 11.0, x, y, colors, series: vec![series] }
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
            let chart = spec(axis(0.0, 1.0, "s"), axis(0.0, 10.0, ""), shape);
            let (text, plot) = svg((800, 400), &chart).expect("draws");
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
            let chart = spec(axis(0.0, 1.0, "s"), axis(min, max, ""), shape);
            let message = svg((800, 400), &chart).expect_err("refuses");
            assert!(message.contains("axis y") && message.contains("no length"), "{message}");
        }
    }
}
