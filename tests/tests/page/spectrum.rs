//! The spectrum: it loads when it is visible, each harmonic is in its table, and frequencies can be zoomed like the
//! time, on a linear or a logarithmic axis.

use anyhow::{Context, Result, ensure};
use fantoccini::actions::{
    InputSource, MOUSE_BUTTON_RIGHT, MouseActions, PointerAction, WheelAction, WheelActions,
};
use serde::Deserialize;
use serde_json::json;

use crate::{
    bench::{in_browser, in_sources},
    session::{CONTROL, END, ENTER, RELEASE, Session},
};

/// Opens a motion that repeats every 4 s, whose spectrum has 1000 harmonics.
async fn open(page: &Session) -> Result<()> {
    page.open("").await?;
    if page.visible("#tab-spectrum").await? {
        page.click("#tab-spectrum").await?;
    }
    page.preset("sine-2022-d0006").await?;
    page.until("document.getElementById('thd').textContent.includes('0.26')").await?;
    page.ready().await
}

/// Maximizes the view, which then shows its fields, and chart and table next to each other.
async fn open_large(page: &Session) -> Result<()> {
    open(page).await?;
    page.click("#view-spectrum .most").await?;
    page.until("document.getElementById('spectrum-from').checkVisibility() && document.getElementById('harmonics').checkVisibility()")
        .await
}

#[test]
fn the_spectrum_loads_when_it_is_visible() -> Result<()> {
    in_sources(|page| async move {
        let loaded = "performance.getEntriesByType('resource').some(({ name }) => name.includes('/spectrum/spectrum'))";
        page.open("").await?;
        ensure!(!page.eval::<bool>(loaded).await?, "one move has no harmonics to draw");
        page.unfold_spectrum().await?;
        ensure!(page.eval::<bool>(loaded).await?);
        let spectrum = page.canvas("spectrum-chart").await?;
        ensure!(spectrum.ink("--actual").pixels > 100, "its lines are drawn: {spectrum:?}");
        Ok(())
    })
}

/// The visible part of the table.
#[derive(Debug, Deserialize)]
struct Table {
    /// Numbers of its rows.
    numbers: Vec<u32>,
    /// Rows and cells that are partly cut off.
    cut: Vec<String>,
    /// The table's stated number of rows, without the header.
    rows: u32,
}

const TABLE: &str = "
    const table = document.getElementById('harmonics');
    const room = document.getElementById('harmonics-scroll').getBoundingClientRect();
    const rows = [...table.tBodies[0].rows];
    const outside = rows.filter((row) => { const { top, bottom } = row.getBoundingClientRect(); return top < room.top - 1 || bottom > room.bottom + 1; });
    const narrow = [...table.querySelectorAll('th, td')].filter((cell) => cell.scrollWidth > cell.clientWidth);
    return { numbers: rows.map(({ dataset }) => Number(dataset.n)), cut: [...outside, ...narrow].map(({ textContent }) => textContent),
        rows: Number(table.ariaRowCount) - 1 };";

/// Checks that the rows are consecutive and complete, and fewer than all; returns their numbers.
async fn table(page: &Session, place: &str) -> Result<Vec<u32>> {
    let found: Table = page.js(TABLE, vec![]).await?;
    ensure!(found.rows == 1000 && found.cut.is_empty(), "{place}: {found:?}");
    ensure!((3..100).contains(&found.numbers.len()), "{place}: {found:?}");
    ensure!(found.numbers.windows(2).all(|pair| pair[1] == pair[0] + 1), "{place}: {found:?}");
    Ok(found.numbers)
}

#[test]
fn every_harmonic_is_in_the_table_in_whole_rows() -> Result<()> {
    in_browser(|page| async move {
        for (width, height) in [(1440, 900), (1366, 768), (390, 844)] {
            let place = format!("{width} x {height}");
            page.screen(width, height).await?;
            open(&page).await?;
            if width >= 900 {
                page.click("#spectrum-table").await?;
            }
            page.until("document.querySelector('#harmonics tbody tr')?.checkVisibility()").await?;
            ensure!(table(&page, &place).await?[0] == 1, "{place} begins with the fundamental");
            page.press("#harmonics-scroll", &END.to_string()).await?;
            page.until("document.querySelector('#harmonics tr.highlighted')?.dataset.n === '1000'").await?;
            ensure!(table(&page, &place).await?.last() == Some(&1000), "{place} ends with the highest");
            // The scroll bar reaches the rows between.
            page.js::<()>("const scroll = document.getElementById('harmonics-scroll'); scroll.scrollTop = scroll.scrollHeight / 2;", vec![]).await?;
            page.until("[...document.querySelectorAll('#harmonics tbody tr')].some(({ dataset }) => dataset.n > 450 && dataset.n < 550)")
                .await?;
            table(&page, &place).await?;
        }
        Ok(())
    })
}

/// The visible frequencies in Hz, from the fields.
async fn shown(page: &Session) -> Result<(f64, f64)> {
    let texts: (String, String) = page
        .eval(
            "[document.getElementById('spectrum-from').value, document.getElementById('spectrum-to').value]",
        )
        .await?;
    let hz = |text: &str| -> Result<f64> {
        let (number, unit) = text.split_once(' ').with_context(|| format!("`{text}`"))?;
        let scale = if unit == "mHz" { 1e-3 } else { 1.0 };
        Ok(number.parse::<f64>().with_context(|| format!("`{text}`"))? * scale)
    };
    Ok((hz(&texts.0)?, hz(&texts.1)?))
}

/// Waits for other frequencies.
async fn changed(page: &Session, before: (f64, f64)) -> Result<(f64, f64)> {
    // A refused text stays in its field until the frequencies change.
    let look = async || Ok(shown(page).await.ok().filter(|now| *now != before));
    page.eventually(&format!("other frequencies than {before:?}"), look).await
}

/// Position of the chart in the window.
async fn place(page: &Session) -> Result<(f64, f64, f64)> {
    page.eval(
        "(({ x, y, width, height }) => [x, y + height / 2, width])(document.getElementById('spectrum-chart').getBoundingClientRect())",
    )
    .await
}

#[test]
fn every_zoom_control_changes_frequencies_and_fit_restores_them() -> Result<()> {
    in_browser(|page| async move {
        open_large(&page).await?;
        let whole = shown(&page).await?;
        assert_eq!(whole, (0.0, 250.25), "all harmonics of 250 mHz");
        let (x, y, width) = place(&page).await?;

        let mut wheel = WheelActions::new("wheel".into());
        let (px, py) = ((x + width / 2.0) as i64, y as i64);
        wheel.push(WheelAction::Scroll { duration: None, x: px, y: py, delta_x: 0, delta_y: -400 });
        page.actions(wheel).await?;
        let zoomed = changed(&page, whole).await?;
        ensure!(zoomed.0 > 0.0 && zoomed.1 < whole.1, "around the pointer: {zoomed:?}");

        let at = |part: f64| PointerAction::MoveTo { duration: None, x: x + width * part, y };
        let mouse = MouseActions::new("mouse".into())
            .then(at(0.4))
            .then(PointerAction::Down { button: MOUSE_BUTTON_RIGHT })
            .then(at(0.5))
            .then(at(0.6))
            .then(PointerAction::Up { button: MOUSE_BUTTON_RIGHT });
        page.actions(mouse).await?;
        let boxed = changed(&page, zoomed).await?;
        ensure!(boxed.0 > zoomed.0 && boxed.1 < zoomed.1, "a box within {zoomed:?}: {boxed:?}");

        page.press("#spectrum-pane", "\u{e003}").await?;
        ensure!(changed(&page, boxed).await? == zoomed, "Backspace goes one gesture back");
        page.press("#spectrum-pane", "0").await?;
        assert_eq!(changed(&page, zoomed).await?, whole);
        page.press("#spectrum-pane", "+").await?;
        let nearer = changed(&page, whole).await?;
        ensure!(((nearer.1 - nearer.0) * 2.0 - whole.1).abs() < 1.0, "{nearer:?}");
        page.press("#spectrum-pane", "-").await?;
        changed(&page, nearer).await?;
        page.click("#spectrum-tools [aria-label^='Fit']").await?;

        for (field, text) in [("#spectrum-to", "5"), ("#spectrum-from", "500 mHz")] {
            page.press(field, &format!("{CONTROL}a{RELEASE}{text}{ENTER}")).await?;
        }
        page.until_equal("document.getElementById('spectrum-to').value", &json!("5 Hz")).await?;
        assert_eq!(shown(&page).await?, (0.5, 5.0));
        page.press("#spectrum-from", &format!("{CONTROL}a{RELEASE}9{ENTER}")).await?;
        page.until("document.getElementById('spectrum-error').textContent.includes('above')").await?;
        // A harmonic selected by keys is scrolled into view.
        page.press("#spectrum-pane", &END.to_string()).await?;
        let followed = changed(&page, (0.5, 5.0)).await?;
        ensure!(followed.0 < 250.0 && followed.1 >= 250.0, "{followed:?} has harmonic 1000");
        Ok(())
    })
}

/// Stores the saved file's text instead of downloading it.
const KEEP: &str = "const make = URL.createObjectURL; URL.createObjectURL = (blob) => { window.last = blob; return make.call(URL, blob); };
    HTMLAnchorElement.prototype.click = () => { window.saved = window.last; };";

#[test]
fn frequencies_are_linear_or_logarithmic_and_axes_are_named() -> Result<()> {
    in_browser(|page| async move {
        page.before_scripts(KEEP).await?;
        open_large(&page).await?;
        for (css, name) in [
            (".of-frequencies", "frequency, harmonics at multiples of 250 mHz"),
            (".of-amplitudes", "dB of the fundamental"),
        ] {
            assert_eq!(page.text(css).await?, name);
        }
        let linear = page.canvas("spectrum-chart").await?;
        let saved = async || -> Result<String> {
            page.js::<()>("window.saved = null;", vec![]).await?;
            page.click("#export").await?;
            page.until("document.querySelector('#export-list [data-file$=\"-spectrum.svg\"]') !== null")
                .await?;
            page.click("[data-file$='-spectrum.svg']").await?;
            page.until("window.saved").await?;
            page.press("#export", "\u{e00c}").await?;
            page.js("return window.saved.text();", vec![]).await
        };
        let says = |svg: &str, label: &str| svg.lines().any(|line| line.trim() == label);
        let svg = saved().await?;
        ensure!(says(&svg, "100 Hz") && !says(&svg, "10 Hz"), "linear: {svg}");

        page.click("#spectrum-log").await?;
        page.until("document.getElementById('spectrum-log').ariaPressed === 'true'").await?;
        let drawn = async || {
            let canvas = page.canvas("spectrum-chart").await?;
            Ok((canvas.hash != linear.hash).then_some(canvas))
        };
        page.eventually("the logarithmic axis", drawn).await?;
        let (from, to) = shown(&page).await?;
        ensure!(from > 0.0 && from < 0.25 && to > 250.0, "{from} to {to} Hz");
        let svg = saved().await?;
        for label in ["1 Hz", "10 Hz", "100 Hz"] {
            ensure!(says(&svg, label), "{label} in {svg}");
        }
        // Zoomed to less than a decade, it has round numbers, too.
        for (field, text) in [("#spectrum-to", "9.5"), ("#spectrum-from", "8.6")] {
            page.press(field, &format!("{CONTROL}a{RELEASE}{text}{ENTER}")).await?;
        }
        page.until_equal("document.getElementById('spectrum-from').value", &json!("8.6 Hz")).await?;
        let svg = saved().await?;
        ensure!(says(&svg, "9 Hz"), "{svg}");

        page.choose("#spectrum-scale", "linear").await?;
        page.until_equal("document.querySelector('.of-amplitudes').textContent", &json!("steps")).await
    })
}
