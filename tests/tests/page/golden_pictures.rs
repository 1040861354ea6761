//! Compares pictures of the curves and the pulses with those in `tests/pictures/`.
//!
//! Text is not drawn, and the boxes have fixed sizes in CSS pixels, because fonts differ between machines, and with
//! them the height of lines of text and the space for a canvas. So the pictures check lines, bands,
//! colors and positions. Browsers still differ in the edges
//! of lines; the comparison allows for that, but not for a line that has moved by two pixels.
//!
//! `STEPSCOPE_BLESS=1 cargo xtask test --only page` writes the pictures; check them before you commit them. If a picture
//! differs and `STEPSCOPE_SHOTS` is set, the actual picture is stored there.

use std::{cell::Cell, env, fs, path::PathBuf};

use anyhow::{Context, Result, ensure};
use data_encoding::BASE64;
use png::{ColorType, Decoder, Transformations};
use serde_json::json;
use stepscope_core::scenario::presets::PRESETS;

use crate::{bench::in_browser, native::Known, session::Session};

/// Maximum mean difference of colors, of 255.
const MAX_MEAN: f64 = 1.0;
/// From this difference of one color on, a pixel differs clearly.
const CLEAR: u8 = 64;
/// Maximum fraction of pixels that differ clearly.
const MAX_CLEAR: f64 = 0.004;

/// Number of equal pictures in a row before one is written.
const STILL: u32 = 5;

/// A picture's pixels, four bytes each.
struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<u8>,
}

impl Picture {
    fn read(file: &[u8]) -> Result<Self> {
        let mut decoder = Decoder::new(std::io::Cursor::new(file));
        decoder.set_transformations(Transformations::normalize_to_color8() | Transformations::ALPHA);
        let mut reader = decoder.read_info()?;
        let mut pixels = vec![0; reader.output_buffer_size().context("the picture is too large")?];
        let info = reader.next_frame(&mut pixels)?;
        ensure!(info.color_type == ColorType::Rgba, "the picture has {:?}", info.color_type);
        Ok(Self { width: info.width, height: info.height, pixels })
    }

    /// Describes the difference if it exceeds the limits.
    fn difference(&self, other: &Self) -> Option<String> {
        if (self.width, self.height) != (other.width, other.height) {
            return Some(format!(
                "{} x {} pixels, not {} x {}",
                other.width, other.height, self.width, self.height
            ));
        }
        let differences = || self.pixels.iter().zip(&other.pixels).map(|(one, other)| one.abs_diff(*other));
        let mean = differences().map(f64::from).sum::<f64>() / self.pixels.len() as f64;
        let each: Vec<u8> = differences().collect();
        let clear = each.chunks(4).filter(|pixel| pixel.iter().any(|&part| part >= CLEAR)).count();
        let clear = clear as f64 / f64::from(self.width * self.height);
        (mean > MAX_MEAN || clear > MAX_CLEAR).then(|| {
            format!("colors differ by {mean:.3} in the mean (at most {MAX_MEAN}), {:.3} % of the pixels clearly (at most {:.3} %)",
                100.0 * clear, 100.0 * MAX_CLEAR)
        })
    }
}

/// Hides all text on canvases.
const NO_LETTERS: &str = "CanvasRenderingContext2D.prototype.fillText = () => {};";

/// The current picture of a canvas, as a file.
async fn drawn(page: &Session, canvas: &str) -> Result<Vec<u8>> {
    let url: String = page
        .js("return document.getElementById(arguments[0]).toDataURL('image/png');", vec![json!(canvas)])
        .await?;
    let base64 = url.strip_prefix("data:image/png;base64,").context("no picture")?;
    BASE64.decode(base64.as_bytes()).map_err(anyhow::Error::msg)
}

/// Compares a canvas with the picture of this name once it is drawn, or writes that picture.
async fn compare(page: &Session, canvas: &str, name: &str, wrong: &mut Vec<String>) -> Result<()> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("pictures");
    let golden = folder.join(format!("{name}.png"));
    if env::var_os("STEPSCOPE_BLESS").is_some() {
        fs::create_dir_all(&folder)?;
        return Ok(fs::write(golden, stands_still(page, canvas).await?)?);
    }
    let wanted = fs::read(&golden).with_context(|| {
        format!("{} can't be read; STEPSCOPE_BLESS=1 writes what is drawn now", golden.display())
    })?;
    let wanted = Picture::read(&wanted)?;
    // A canvas is redrawn when its box has its size, which takes an unknown time.
    let look =
        async || Ok(wanted.difference(&Picture::read(&drawn(page, canvas).await?)?).is_none().then_some(()));
    if page.eventually(name, look).await.is_ok() {
        return Ok(());
    }
    let file = drawn(page, canvas).await?;
    let difference = wanted.difference(&Picture::read(&file)?);
    wrong.push(format!("{name}: {}", difference.unwrap_or_else(|| "never stands still".to_owned())));
    if let Some(shots) = env::var_os("STEPSCOPE_SHOTS") {
        fs::create_dir_all(&shots)?;
        fs::write(PathBuf::from(shots).join(format!("differs-{name}.png")), file)?;
    }
    Ok(())
}

/// A canvas that was the same in several pictures.
async fn stands_still(page: &Session, canvas: &str) -> Result<Vec<u8>> {
    let looks = Cell::new((0, Vec::new()));
    page.eventually(&format!("{canvas} stands still"), async || {
        // Pending drawing is done before the picture is taken.
        page.js::<()>("return new Promise((seen) => requestAnimationFrame(() => setTimeout(seen)));", vec![])
            .await?;
        let now = drawn(page, canvas).await?;
        let (equal, last) = looks.take();
        let equal = if now == last { equal + 1 } else { 0 };
        looks.set((equal, now.clone()));
        Ok((equal >= STILL).then_some(now))
    })
    .await
}

#[test]
fn pictures_of_curves_and_pulses_are_unchanged() -> Result<()> {
    in_browser(|page| async move {
        let preset = PRESETS.iter().find(|preset| preset.id == "song-2021-one-turn").context("the preset")?;
        let known = Known::preset(preset)?;
        let mut wrong = Vec::new();
        page.before_scripts(NO_LETTERS).await?;
        for (name, scheme, width, box_px) in
            [("wide-light", "light", 1440, 860), ("narrow-dark", "dark", 390, 340)]
        {
            page.screen(width, 900).await?;
            page.system_colors(scheme).await?;
            page.open("").await?;
            page.preset(preset.id).await?;
            page.until_digest(&known.digest).await?;
            // A tick or two in the middle: single pulses, and bits on the line.
            let clock = f64::from(known.scenario.clock_hz);
            let middle =
                known.recording.trace.last().map_or(0.0, |record| record.cycle.0 as f64 / clock) / 2.0;
            for (view, canvas, element, height) in
                [("motion", "chart-speed", "charts", Some(480)), ("pulses", "pulses", "pulses-stack", None)]
            {
                if width < 900 {
                    page.click(&format!("#tab-{view}")).await?;
                }
                if view == "pulses" {
                    for (id, at) in [("window-start", middle), ("window-end", middle + 0.004)] {
                        let script = "const field = document.getElementById(arguments[0]); field.value = arguments[1]; \
                                      field.dispatchEvent(new Event('change')); return true;";
                        page.js::<bool>(script, vec![json!(id), json!(format!("{} ms", 1e3 * at))]).await?;
                    }
                    page.choose("#edge-row", "32").await?;
                }
                let fixed = "const { style } = document.getElementById(arguments[0]); style.width = `${arguments[1]}px`; \
                             if (arguments[2]) { style.flex = 'none'; style.height = `${arguments[2]}px`; } return true;";
                page.js::<bool>(fixed, vec![json!(element), json!(box_px), json!(height)]).await?;
                page.until(&format!("document.getElementById('{canvas}').clientWidth === {box_px}")).await?;
                compare(&page, canvas, &format!("{view}-{name}"), &mut wrong).await?;
            }
        }
        ensure!(wrong.is_empty(), "{}", wrong.join("\n"));
        Ok(())
    })
}

/// A white picture of the size of a curve's, with a black line from left to right.
fn line(top: u32, thick: u32, shade: u8) -> Picture {
    let (width, height) = (1720, 272);
    let inked = |row: u32| (top..top + thick).contains(&row);
    let pixels = (0..height).flat_map(|row| {
        let part = if inked(row) { shade } else { 255 };
        std::iter::repeat_n([part, part, part, 255], width as usize).flatten()
    });
    Picture { width, height, pixels: pixels.collect() }
}

#[test]
fn a_moved_line_is_a_difference_and_a_smoother_edge_is_none() {
    let golden = line(100, 4, 0);
    for (other, differs) in [
        (line(100, 4, 0), false),
        (line(100, 4, 40), false),
        (line(102, 4, 0), true),
        (line(100, 2, 0), true),
        (line(100, 4, 128), true),
        (line(100, 0, 0), true),
        (Picture { height: 271, ..line(100, 4, 0) }, true),
    ] {
        assert_eq!(golden.difference(&other).is_some(), differs, "{:?}", golden.difference(&other));
    }
}
