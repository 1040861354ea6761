//! The page behind the dialog Device (LIVE H4): replies are listed as they arrive, STOP stays visible, the page can be used.
//! Also the results of a session of the simulated device.

use anyhow::{Result, ensure};
use serde_json::{Value, json};

use crate::{
    axe,
    bench::in_browser,
    device::{ENDED, FRAMED, MESSAGE, SAID, STANDING, open, start},
    exports::KEEP,
    live::LONG,
    session::Session,
};

pub(crate) const ROWS: &str = "document.querySelectorAll('#view-packets .live-replies tbody tr').length";
const MODAL: &str = "document.querySelector('dialog.live').matches(':modal')";
/// The element at the center of STOP, which gets its press.
pub(crate) const STOP_IN_SIGHT: &str = "(() => {
    const stop = document.getElementById('live-stop');
    const { left, top, width, height } = stop.getBoundingClientRect();
    return document.elementFromPoint(left + width / 2, top + height / 2) === stop;
})()";

pub(crate) async fn start_long(page: &Session) -> Result<()> {
    open(page, LONG, "serve").await?;
    start(page).await?;
    page.until(&format!("Number({STANDING}.match(/(\\d+) ticks accepted/)?.[1] ?? 0) > 20")).await
}

#[test]
fn replies_are_listed_during_a_stream_and_stop_is_visible() -> Result<()> {
    in_browser(|page| async move {
        for (width, height) in [(1440, 900), (390, 844)] {
            page.screen(width, height).await?;
            start_long(&page).await?;
            let at = format!("{width} x {height}");
            ensure!(!page.eval::<bool>(MODAL).await?, "{at}: the page cannot be used");
            ensure!(page.eval::<bool>(STOP_IN_SIGHT).await?, "{at}: STOP is not visible");
            ensure!(page.visible("#view-packets .live-replies").await?, "{at}");
            ensure!(!page.visible("#packets").await?, "{at}: both tables are shown");
            let rows: u32 = page.eval(ROWS).await?;
            page.until(&format!("{ROWS} > {rows}")).await?;
            let mut wrong = Vec::new();
            axe::look(&page, &format!("the dialog aside, {at}"), &mut wrong).await?;
            page.picture(&format!("device-aside-{width}")).await?;
            axe::none(&wrong)?;

            // Both tables use the view in turn.
            page.click("#packets-of-model").await?;
            ensure!(page.visible("#packets").await? && !page.visible("#view-packets .live-replies").await?);
            page.click("#packets-of-device").await?;
            ensure!(!page.visible("#packets").await? && page.visible("#view-packets .live-replies").await?);

            // There is one dialog, which its button brings to the front.
            page.click("#device").await?;
            page.until(MODAL).await?;
            assert_eq!(page.eval::<u32>("document.querySelectorAll('dialog.live').length").await?, 1);
            page.click("#live-aside").await?;
            page.until(&format!("!{MODAL}")).await?;

            // Escape is STOP everywhere.
            page.press("#packets-of-model", "\u{e00c}").await?;
            page.until(ENDED).await?;
            page.until(&format!("{SAID}.startsWith('STOP is confirmed')")).await?;
            page.click("#live-close").await?;
            page.until("document.querySelector('dialog.live') === null").await?;
            ensure!(
                page.visible("#view-packets .live-replies").await?,
                "{at}: the replies are gone with the dialog"
            );
        }
        Ok(())
    })
}

#[test]
fn stop_while_the_port_opens_is_the_only_frame_sent() -> Result<()> {
    in_browser(|page| async move {
        open(&page, LONG, "serve").await?;
        page.eval::<Value>("(window.held = new Promise((admit) => { window.admit = admit; })) && null")
            .await?;
        start(&page).await?;
        page.click("#live-stop").await?;
        ensure!(page.eval::<Vec<u32>>("peer.opened").await?.is_empty(), "the port was open before");
        page.eval::<Value>("window.admit() ?? null").await?;
        page.until(ENDED).await?;
        page.until(&format!("{SAID}.startsWith('STOP is confirmed')")).await?;
        let frames = "[...document.querySelectorAll('#view-packets .live-replies tbody tr')].map((row) => row.cells[2].textContent)";
        let frames: Vec<String> = page.eval(frames).await?;
        ensure!(frames.iter().any(|frame| frame == "STOP"), "{frames:?}");
        ensure!(!frames.iter().any(|frame| frame == "TICKS"), "{frames:?}");
        Ok(())
    })
}

#[test]
fn a_reopened_dialog_shows_the_current_experiment() -> Result<()> {
    in_browser(|page| async move {
        open(&page, FRAMED, "serve").await?;
        start(&page).await?;
        page.until(ENDED).await?;
        page.click("#packets-of-model").await?;
        page.fill("line.baud", "57600").await?;
        page.ready().await?;
        page.click("#device").await?;
        page.until("document.getElementById('live-about').textContent.includes('57600 baud')").await?;
        page.click("#live-start").await?;
        page.until("peer.opened.length === 2").await?;
        assert_eq!(page.eval::<Vec<u32>>("peer.opened").await?, [115_200, 57_600]);
        page.until("peer.closed === 2").await?;
        // The dialog does not show the last stream, either, when its own button opens it.
        page.click("#packets-of-model").await?;
        page.fill("line.baud", "38400").await?;
        page.ready().await?;
        page.click("#live-aside").await?;
        page.until("document.getElementById('live-about').textContent.includes('38400 baud')").await
    })
}

#[test]
fn a_simulated_device_shows_positions_and_saves_its_times() -> Result<()> {
    in_browser(|page| async move {
        open(&page, FRAMED, "stream").await?;
        page.eval::<Value>(&format!("(() => {{ {KEEP} return null; }})()")).await?;
        let before: f64 = page.eval("Date.now()").await?;
        page.click("[name=live-role][value=serve]").await?;
        start(&page).await?;
        page.until("peer.told.some(({ reported }) => reported?.verified)").await?;
        // It started at its initial position, and moved.
        let moved = "new Set(document.querySelector('#live-curves polyline')?.getAttribute('points').split(' ').map((at) => at.split(',')[1])).size > 10";
        page.until(moved).await?;
        page.until("document.getElementById('live-curves').textContent.endsWith('from 0 to 400 steps.')")
            .await?;
        let mut wrong = Vec::new();
        axe::look(&page, "the soft device", &mut wrong).await?;
        page.picture("device-served").await?;
        axe::none(&wrong)?;
        // Also behind the page.
        page.click("#live-aside").await?;
        page.until(&format!("!{MODAL}")).await?;
        page.click("#live-end").await?;
        page.until(&format!("{MESSAGE}.includes('Recorded. The simulation reproduces the digest')")).await?;
        page.ready().await?;
        let digest = page.shown().await?.digest;

        page.click("#link-message button:not(.close)").await?;
        page.until("Object.keys(window.saved).length === 1").await?;
        let name: String = page.eval("Object.keys(window.saved)[0]").await?;
        ensure!(name.ends_with(".session.json"), "{name}");
        let text: String = page.js("return Object.values(window.saved)[0].text();", vec![]).await?;
        let file: Value = serde_json::from_str(&text)?;
        assert_eq!(
            (&file["digests"], &file["pace"], &file["records_all"]),
            (&json!([digest]), &json!("1"), &json!(true))
        );
        let began = file["started_unix_ms"].as_f64().unwrap_or_default();
        ensure!(began >= before, "{before} {began}");
        let rows = |name: &str| file[name].as_array().cloned().unwrap_or_default();
        // The same number of frames as the host sent, each with a reply.
        let frames: usize = page
            .eval(
                "peer.told.findLast(({ reported }) => reported).reported.text.match(/frames (\\d+)/)[1] * 1",
            )
            .await?;
        assert_eq!(rows("replies").len(), frames);
        let bytes: u64 = rows("chunks").iter().filter_map(|chunk| chunk["bytes"].as_u64()).sum();
        ensure!(bytes > 0 && file["rows_left_out"] == 0, "{text}");
        Ok(())
    })
}
