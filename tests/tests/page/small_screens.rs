//! Small screens: every view has space for its purpose, and empty views leave their space to others.

use anyhow::{Result, ensure};
use serde::Deserialize;
use serde_json::json;

use crate::{bench::in_browser, session::Session};

/// Visible sizes, in CSS pixels.
#[derive(Debug, Deserialize)]
struct Seen {
    /// Heights of the visible canvases of position, speed and acceleration.
    charts: Vec<f64>,
    /// Height of the area of the pulses, and of its contents.
    pulses: (f64, f64),
    /// Height of the area of the packet rows.
    packets: f64,
    /// Width of the bytes column, and whether a text in it is cut off.
    bytes: (f64, bool),
}

const SEEN: &str = "
    const height = (css) => document.querySelector(css).clientHeight;
    const cells = [...document.querySelectorAll('#packets tbody td:nth-child(3)')];
    return {
        charts: [...document.querySelectorAll('#charts > .chart:not([hidden]) canvas')].map((chart) => chart.clientHeight),
        pulses: [height('#view-pulses > .scroll'), document.getElementById('pulses-stack').offsetHeight],
        packets: height('#packets-scroll'),
        bytes: [cells[0]?.offsetWidth ?? 0, cells.some((cell) => cell.scrollWidth > cell.clientWidth)],
    };";

async fn open(page: &Session, preset: &str) -> Result<()> {
    page.open("").await?;
    if page.visible("#welcome").await? {
        page.click("#welcome-never").await?;
    }
    if !preset.is_empty() {
        page.preset(preset).await?;
        page.ready().await?;
    }
    page.js::<()>("return new Promise((seen) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(seen))));", vec![]).await
}

#[test]
fn curves_rows_and_bytes_fit_on_a_small_laptop() -> Result<()> {
    in_browser(|page| async move {
        for (width, height) in [(1366, 768), (1024, 768)] {
            page.screen(width, height).await?;
            for preset in ["", "driver-timing-broken", "four-controllers-framed"] {
                open(&page, preset).await?;
                page.picture(&format!("small-{width}-{preset}")).await?;
                let seen: Seen = page.js(SEEN, vec![]).await?;
                let what = format!("{width} x {height} {preset}: {seen:?}");
                ensure!(seen.charts.iter().all(|&chart| chart >= 80.0), "curves are flat at {what}");
                let (room, rows) = seen.pulses;
                ensure!(room >= rows.min(8.0 * 22.0), "too few rows at {what}");
                ensure!(seen.packets >= 96.0, "too few packets at {what}");
                let framed = preset.starts_with("four");
                ensure!(seen.bytes.0 >= 80.0 && (framed || !seen.bytes.1), "no bytes at {what}");
            }
        }
        Ok(())
    })
}

#[test]
fn on_a_phone_a_view_begins_near_the_top_and_shows_the_bytes() -> Result<()> {
    in_browser(|page| async move {
        for preset in ["", "driver-timing-broken", "four-controllers-framed"] {
            page.screen(390, 844).await?;
            open(&page, preset).await?;
            for tab in ["motion", "pulses", "packets", "spectrum"] {
                page.click(&format!("#tab-{tab}")).await?;
                let top: f64 = page
                    .eval("document.querySelector('.view.open').getBoundingClientRect().top + scrollY")
                    .await?;
                ensure!(top <= 160.0, "{tab} of {preset} begins at {top} px");
            }
            for width in [390, 320] {
                page.screen(width, 844).await?;
                page.click("#tab-packets").await?;
                page.until("document.querySelector('#packets tbody td:nth-child(3)')?.offsetWidth >= 80")
                    .await?;
            }
        }
        Ok(())
    })
}

#[test]
fn an_empty_view_is_collapsed_until_it_is_expanded() -> Result<()> {
    in_browser(|page| async move {
        page.screen(1366, 768).await?;
        open(&page, "song-2021-one-turn").await?;
        let height = async |view: &str| {
            page.js::<f64>(
                "return document.getElementById(arguments[0]).offsetHeight;",
                vec![json!(format!("view-{view}"))],
            )
            .await
        };
        let curves = height("motion").await?;
        // Only segments: the line is idle, and the view states it.
        open(&page, "sonobe-2011-segments").await?;
        page.until("document.getElementById('view-packets').offsetHeight < 100").await?;
        ensure!(page.text("#packets-empty").await?.starts_with("The controller runs segments"));
        ensure!(!page.visible("#packets-search").await?, "there is nothing to search");
        ensure!(height("motion").await? > curves + 40.0, "the curves have none of the room");
        // Not periodic: one line, until it is expanded.
        ensure!(page.text("#spectrum-note").await?.contains("not periodic"));
        ensure!(height("spectrum").await? < 100.0 && !page.visible("#spectrum-chart").await?);
        for large in [true, false, true] {
            page.click("#view-spectrum .fold").await?;
            page.until(&format!("document.getElementById('spectrum-chart').checkVisibility() === {large}"))
                .await?;
        }
        // A view with content has its space again.
        page.preset("song-2021-one-turn").await?;
        page.ready().await?;
        page.until("document.querySelectorAll('#packets tbody tr').length > 3 && document.getElementById('packets').checkVisibility()").await?;
        // The choice is saved on this device.
        page.open("").await?;
        page.until("document.getElementById('spectrum-chart').checkVisibility()").await
    })
}
