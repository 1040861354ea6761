//! The rows of the pulses: height, order, names and visibility, by pointer and by keys.

use anyhow::{Result, ensure};
use fantoccini::actions::{InputSource, MouseActions, PointerAction};
use serde_json::json;

use crate::{
    bench::in_browser,
    session::{CONTROL, ENTER, RELEASE, SHIFT, Session},
};

/// Keys in the notation of WebDriver.
const UP: char = '\u{e013}';
/// See [`UP`].
const DOWN: char = '\u{e015}';
/// See [`UP`].
const ALT: char = '\u{e00a}';
/// See [`UP`].
const SPACE: char = '\u{e00d}';
/// See [`UP`].
const ESCAPE: char = '\u{e00c}';
/// Default height of the rows.
const ROW_PX: f64 = 22.0;

/// The number of rows, for a screen reader.
async fn until_rows(page: &Session, rows: usize) -> Result<()> {
    page.until(&format!("document.getElementById('pulses').ariaLabel.includes(', {rows} rows,')")).await
}

/// Names in the panel from the top: those of the user, otherwise the defaults.
async fn names(page: &Session) -> Result<Vec<String>> {
    page.eval("[...document.querySelectorAll('#rows-list input[type=text]')].map((field) => field.value || field.placeholder)")
        .await
}

/// Opens the panel, and waits for its list, whose script may have to load.
async fn open_panel(page: &Session) -> Result<()> {
    page.click("#rows-open").await?;
    page.until("document.getElementById('rows-list').children.length > 0 && !document.querySelector('#rows-panel [inert]')")
        .await
}

/// Moves the mouse to a row.
async fn point(page: &Session, row: usize, row_px: f64) -> Result<()> {
    let place = "(({ left, top, width }) => [left, top, width])(document.getElementById('pulses').getBoundingClientRect())";
    let (left, top, width): (f64, f64, f64) = page.eval(place).await?;
    let (x, y) = ((left + width / 2.0).round(), top + row_px * (row as f64 + 0.5));
    page.actions(MouseActions::new("mouse".into()).then(PointerAction::MoveTo { duration: None, x, y })).await
}

async fn until_reads(page: &Session, what: &str) -> Result<()> {
    page.until(&format!("document.getElementById('hover-reading').textContent.includes('{what}')")).await
}

#[test]
fn rows_are_named_ordered_and_hidden_permanently() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        until_rows(&page, 6).await?;
        open_panel(&page).await?;
        assert_eq!(names(&page).await?, ["EN", "RX", "packets", "ticks", "ch 0"]);

        page.click("[aria-label='Name of ch 0']").await?;
        page.find("[aria-label='Name of ch 0']").await?.send_keys(&format!("X axis{ENTER}")).await?;
        page.until(
            "[...document.getElementById('edge-row').options].some(({ text }) => text === 'STEP X axis')",
        )
        .await?;

        // The pressed button keeps the focus while its line moves up; at the top the other one gets it.
        page.click("[aria-label='Move ch 0 up']").await?;
        for _ in 0..3 {
            page.client.active_element().await?.send_keys(&SPACE.to_string()).await?;
        }
        assert_eq!(names(&page).await?, ["X axis", "EN", "RX", "packets", "ticks"]);
        assert_eq!(page.eval::<String>("document.activeElement.ariaLabel").await?, "Move ch 0 down");
        page.click("[aria-label='Show RX']").await?;
        until_rows(&page, 5).await?;
        page.client.active_element().await?.send_keys(&ESCAPE.to_string()).await?;
        page.until("!document.getElementById('rows-panel').matches(':popover-open')").await?;
        point(&page, 1, ROW_PX).await?;
        until_reads(&page, "STEP X axis ").await?;

        page.open("").await?;
        until_rows(&page, 5).await?;
        point(&page, 1, ROW_PX).await?;
        until_reads(&page, "STEP X axis ").await?;
        open_panel(&page).await?;
        assert_eq!(names(&page).await?, ["X axis", "EN", "RX", "packets", "ticks"]);
        // An empty name restores the default.
        page.press("[aria-label='Name of ch 0']", &format!("{CONTROL}a{RELEASE}\u{e003}{ENTER}")).await?;
        page.until("[...document.getElementById('edge-row').options].some(({ text }) => text === 'STEP 0')")
            .await?;
        page.click("#rows-reset").await?;
        until_rows(&page, 6).await?;
        assert_eq!(names(&page).await?, ["EN", "RX", "packets", "ticks", "ch 0"]);
        Ok(())
    })
}

#[test]
fn the_height_of_rows_is_set_by_a_slider_and_by_keys() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        until_rows(&page, 6).await?;
        let tall = "document.getElementById('pulses-stack').offsetHeight";
        let first: u32 = page.eval(tall).await?;
        page.press("#pulses", &format!("{ALT}{DOWN}{RELEASE}")).await?;
        page.until_equal(&format!("{tall} - {first}"), &json!(18)).await?;
        page.press("#pulses", &format!("{ALT}{UP}{RELEASE}")).await?;
        page.until_equal(tall, &json!(first)).await?;
        page.press("#pulses", "r").await?;
        page.until("document.activeElement.ariaLabel === 'Name of ch 0'").await?;
        page.press("#rows-height", "\u{e010}").await?;
        page.until(&format!(
            "{tall} > 6 * 60 && document.getElementById('rows-height-px').textContent === '64 px'"
        ))
        .await?;
        page.client.active_element().await?.send_keys(&ESCAPE.to_string()).await?;
        // The row under the pointer is the one that is drawn there.
        page.js::<()>("document.querySelector('#view-pulses > .scroll').scrollTop = 0;", vec![]).await?;
        point(&page, 0, 64.0).await?;
        until_reads(&page, "EN ").await?;
        page.open("").await?;
        page.until(&format!("{tall} > 6 * 60")).await
    })
}

#[test]
fn the_selected_row_is_moved_and_hidden_by_keys_and_announced() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        until_rows(&page, 6).await?;
        let said = "document.getElementById('pulses-sentence').textContent";
        page.press("#pulses", &format!("{SHIFT}{UP}{RELEASE}")).await?;
        page.until_equal(said, &json!("ch 0 is row 4 of 5.")).await?;
        page.press("#pulses", &format!("{SHIFT}{DOWN}{DOWN}{RELEASE}")).await?;
        page.until_equal(said, &json!("ch 0 is the last row.")).await?;
        // If the selected row disappears, another one is selected; the last one stays.
        page.press("#pulses", "h").await?;
        until_rows(&page, 4).await?;
        let chosen = "document.getElementById('edge-row').selectedOptions[0].text";
        page.until_equal(chosen, &json!("RX")).await?;
        page.press("#pulses", "h").await?;
        page.until_equal(chosen, &json!("EN")).await?;
        page.press("#pulses", "h").await?;
        page.until_equal(said, &json!("At least one signal must be visible.")).await?;
        until_rows(&page, 3).await?;
        // A hidden signal is visible while it is selected.
        page.choose("#edge-row", "0").await?;
        until_rows(&page, 5).await?;
        ensure!(
            page.eval::<bool>("document.getElementById('pulses').ariaLabel.endsWith('row STEP 0')").await?
        );
        Ok(())
    })
}
