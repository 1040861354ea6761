//! The canvas or SVG of a chart. One type for both, so that the drawing code is compiled once.

#[cfg(target_arch = "wasm32")]
use plotters_canvas::CanvasBackend;

use plotters::prelude::{DrawingBackend, SVGBackend};
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingErrorKind};
use std::{error::Error, fmt};

pub(crate) enum Surface<'a> {
    #[cfg(target_arch = "wasm32")]
    Canvas(CanvasBackend),
    Svg(SVGBackend<'a>),
}

#[derive(Debug)]
pub(crate) struct Failed(String);

impl fmt::Display for Failed {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.0)
    }
}

impl Error for Failed {}

type Drawn = Result<(), DrawingErrorKind<Failed>>;

fn converted<E: Error + Send + Sync>(drawn: Result<(), DrawingErrorKind<E>>) -> Drawn {
    drawn.map_err(|error| match error {
        DrawingErrorKind::DrawingError(error) => DrawingErrorKind::DrawingError(Failed(error.to_string())),
        DrawingErrorKind::FontError(error) => DrawingErrorKind::FontError(error),
    })
}

/// All styles become this one, so that backends are compiled once.
struct Ink {
    color: BackendColor,
    stroke_width: u32,
}

impl Ink {
    fn of(style: &impl BackendStyle) -> Self {
        Self { color: style.color(), stroke_width: style.stroke_width() }
    }
}

impl BackendStyle for Ink {
    fn color(&self) -> BackendColor {
        self.color
    }

    fn stroke_width(&self) -> u32 {
        self.stroke_width
    }
}

/// Calls a method of the backend.
macro_rules! on {
    ($surface:expr, $backend:ident => $call:expr) => {
        match $surface {
            #[cfg(target_arch = "wasm32")]
            Surface::Canvas($backend) => $call,
            Surface::Svg($backend) => $call,
        }
    };
}

impl DrawingBackend for Surface<'_> {
    type ErrorType = Failed;

    fn get_size(&self) -> (u32, u32) {
        on!(self, backend => backend.get_size())
    }

    fn ensure_prepared(&mut self) -> Drawn {
        on!(self, backend => converted(backend.ensure_prepared()))
    }

    fn present(&mut self) -> Drawn {
        on!(self, backend => converted(backend.present()))
    }

    fn draw_pixel(&mut self, point: BackendCoord, color: BackendColor) -> Drawn {
        on!(self, backend => converted(backend.draw_pixel(point, color)))
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        let ink = Ink::of(style);
        on!(self, backend => converted(backend.draw_line(from, to, &ink)))
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        upper_left: BackendCoord,
        bottom_right: BackendCoord,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let ink = Ink::of(style);
        on!(self, backend => converted(backend.draw_rect(upper_left, bottom_right, &ink, fill)))
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        let (path, ink): (Vec<BackendCoord>, _) = (path.into_iter().collect(), Ink::of(style));
        on!(self, backend => converted(backend.draw_path(path, &ink)))
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        center: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let ink = Ink::of(style);
        on!(self, backend => converted(backend.draw_circle(center, radius, &ink, fill)))
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Drawn {
        let (corners, ink): (Vec<BackendCoord>, _) = (corners.into_iter().collect(), Ink::of(style));
        on!(self, backend => converted(backend.fill_polygon(corners, &ink)))
    }

    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, at: BackendCoord) -> Drawn {
        on!(self, backend => converted(backend.draw_text(text, style, at)))
    }
}
