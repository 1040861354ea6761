//! Curves with fractions of a pixel; plotters only has whole pixels, where curves look jagged.

use super::curve::Point;
use plotters::style::RGBColor;
use std::fmt::Write as _;
#[cfg(target_arch = "wasm32")]
use web_sys::CanvasRenderingContext2d;

pub(crate) struct Stroke {
    pub(super) lines: Vec<Vec<Point>>,
    pub(super) color: RGBColor,
    /// From 0 (invisible) to 1.
    pub(super) opacity: f64,
    pub(super) width: f64,
}

impl Stroke {
    #[cfg(target_arch = "wasm32")]
    pub(super) fn draw(&self, context: &CanvasRenderingContext2d) {
        let RGBColor(r, g, b) = self.color;
        context.set_stroke_style_str(&format!("rgba({r},{g},{b},{})", self.opacity));
        context.set_line_width(self.width);
        // A sharp corner would exceed its value.
        context.set_line_join("round");
        context.begin_path();
        for line in &self.lines {
            for (index, &(x, y)) in line.iter().enumerate() {
                if index == 0 { context.move_to(x, y) } else { context.line_to(x, y) }
            }
        }
        context.stroke();
    }

    pub(super) fn svg(&self) -> String {
        let RGBColor(r, g, b) = self.color;
        let mut text = String::new();
        for line in &self.lines {
            text.push_str("<polyline fill=\"none\" stroke-linejoin=\"round\"");
            let points: Vec<String> = line.iter().map(|(x, y)| format!("{x:.2},{y:.2}")).collect();
            let _ = writeln!(
                text,
                " stroke=\"#{r:02X}{g:02X}{b:02X}\" opacity=\"{}\" stroke-width=\"{}\" points=\"{}\"/>",
                self.opacity,
                self.width,
                points.join(" ")
            );
        }
        text
    }
}
