//! STOP has priority (LIVE H4): it is reachable in front of every dialog, and uses the settings of the stream even if the
//! experiment changes. After the failure of a worker no button stays without a function.

use anyhow::{Result, ensure};
use serde_json::{Value, json};

use crate::{
    bench::in_browser,
    device::{ABOUT, ENDED, FRAMED, SAID, open, start, verified},
    live::LONG,
    live_aside::{ROWS, STOP_IN_SIGHT, start_long},
    native::Known,
    session::Session,
};

const ESCAPE: &str = "\u{e00c}";
/// A second press after a pause, which is no double press.
const PRESS_START: &str = "document.getElementById('live-start').click() ?? null";
const HOME: &str = "document.getElementById('live-stop').parentElement.className === 'live-actions'";

/// Drops a text on the page as a file of this name.
async fn drop_file(page: &Session, name: &str, text: &str) -> Result<()> {
    let script = "const data = new DataTransfer(); data.items.add(new File([arguments[1]], arguments[0]));
        document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true })); return true;";
    page.js::<bool>(script, vec![json!(name), json!(text)]).await.map(drop)
}

/// Intercepts later messages to workers: `window.own` is the worker with the page's port, `window.spoil` changes
/// its messages.
const OWN: &str = "(() => {
    const post = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (data, given) {
        if ('stream' in data) window.own = this;
        return post.call(this, 'stream' in data && window.spoil ? window.spoil(data) : data, given);
    };
    return null;
})()";

#[test]
fn stop_is_reachable_in_front_of_every_dialog() -> Result<()> {
    in_browser(|page| async move {
        for (width, height) in [(1440, 900), (390, 844)] {
            page.screen(width, height).await?;
            start_long(&page).await?;
            page.press("#packets-of-model", "\u{e031}").await?;
            page.until("document.getElementById('keys').matches(':modal')").await?;
            page.until(STOP_IN_SIGHT).await?;
            page.picture(&format!("device-stop-keys-{width}")).await?;
            page.click("#keys-close").await?;
            page.until(HOME).await?;
            ensure!(page.eval::<bool>(STOP_IN_SIGHT).await?, "STOP did not come back");

            // Of two, the one that was opened last.
            drop_file(&page, "own.csv", "Time [s],STEP0\n0,0\n0.001,1\n0.002,0\n").await?;
            page.until("document.querySelector('dialog.recording:not(.live)')?.matches(':modal')").await?;
            page.until("document.querySelector('dialog.recording:not(.live) #live-stop') !== null").await?;
            page.press("dialog.recording:not(.live) button", "\u{e031}").await?;
            page.until("document.querySelector('#keys #live-stop') !== null").await?;
            page.click("#keys-close").await?;
            page.until("document.querySelector('dialog.recording:not(.live) #live-stop') !== null").await?;
            page.until(STOP_IN_SIGHT).await?;
            page.picture(&format!("device-stop-recording-{width}")).await?;
            page.click("#live-stop").await?;
            page.until(&format!("{SAID}.startsWith('STOP is confirmed')")).await?;
            page.until(&format!("{ENDED} && {HOME}")).await?;
        }
        Ok(())
    })
}

const OTHER: &str = r#"{"line":{"baud":57600},"source":{"line":{"sends":[{"start_cycle":400,"bytes":"00"}]}},"run_cycles":100000}"#;

#[test]
fn stop_uses_the_settings_of_the_stream_until_confirmed() -> Result<()> {
    in_browser(|page| async move {
        start_long(&page).await?;
        page.eval::<Value>("peer.lose() ?? null").await?;
        page.until(ENDED).await?;
        page.until(&format!("{SAID}.startsWith('Not verified: the port is lost')")).await?;
        // An experiment that cannot be sent or stopped.
        drop_file(&page, "other.json", OTHER).await?;
        page.until_digest(&Known::of(OTHER)?.digest).await?;
        page.click("#live-aside").await?;
        page.until(&format!("{ABOUT}.startsWith('Not available')")).await?;
        ensure!(
            page.eval::<bool>("document.querySelector('[name=live-role][value=stream]').checked").await?,
            "another role was taken, which has no STOP"
        );
        page.click("[name=live-role][value=serve]").await?;
        ensure!(page.visible("#live-stop").await?);
        // The next dialog has the same state, and Escape is STOP before it closes the dialog.
        page.click("#live-close").await?;
        page.until("document.querySelector('dialog.live') === null").await?;
        page.click("#device").await?;
        page.until(&format!("{SAID}.endsWith('STOP is sent at 115200 baud.')")).await?;
        page.press("#live-close", ESCAPE).await?;
        page.until("peer.closed === 2").await?;
        page.until(&format!("{SAID}.startsWith('STOP is confirmed')")).await?;
        assert_eq!(page.eval::<Vec<u32>>("peer.opened").await?, [115_200, 115_200]);
        // After that it is the dialog's own key again.
        page.until("!document.getElementById('live-close').disabled").await?;
        page.press("#live-close", ESCAPE).await?;
        page.until("document.querySelector('dialog.live') === null").await
    })
}

#[test]
fn a_stop_after_the_end_of_a_stream_is_sent_separately() -> Result<()> {
    in_browser(|page| async move {
        open(&page, LONG, "serve").await?;
        page.eval::<Value>(OWN).await?;
        start(&page).await?;
        page.until(&format!("{ROWS} > 5")).await?;
        // As if the press reached a worker that has just given up and ignores it.
        let late = "(() => {
            const post = own.postMessage;
            own.postMessage = function (data, given) { if (!('stop' in data) || 'stream' in data) return post.call(this, data, given); };
            document.getElementById('live-stop').click();
            own.postMessage = post;
            return null;
        })()";
        page.eval::<Value>(late).await?;
        page.eval::<Value>("peer.lose() ?? null").await?;
        page.until("peer.closed === 2").await?;
        page.until(&format!("{SAID}.startsWith('STOP is confirmed')")).await
    })
}

#[test]
fn after_a_verified_end_stop_uses_the_current_settings() -> Result<()> {
    in_browser(|page| async move {
        open(&page, FRAMED, "serve").await?;
        start(&page).await?;
        page.until(ENDED).await?;
        page.until(&format!("{SAID}.startsWith('Verified')")).await?;
        page.click("#packets-of-model").await?;
        page.fill("line.baud", "57600").await?;
        page.ready().await?;
        page.click("#live-aside").await?;
        page.until(&format!("{ABOUT}.includes('57600 baud')")).await?;
        page.click("#live-stop").await?;
        page.until("peer.closed === 2").await?;
        assert_eq!(page.eval::<Vec<u32>>("peer.opened").await?, [115_200, 57_600]);
        Ok(())
    })
}

#[test]
fn an_experiment_changed_behind_the_dialog_is_not_started() -> Result<()> {
    in_browser(|page| async move {
        open(&page, FRAMED, "serve").await?;
        page.click("#live-choose").await?;
        page.until("!document.getElementById('live-start').disabled").await?;
        let other = FRAMED.replace(r#""protocol":"framed""#, r#""protocol":"framed","baud":57600"#);
        drop_file(&page, "other.json", &other).await?;
        page.until_digest(&Known::of(&other)?.digest).await?;
        page.click("#live-start").await?;
        page.until(&format!("{SAID}.startsWith('The experiment has changed')")).await?;
        page.until(&format!("{ABOUT}.includes('57600 baud')")).await?;
        assert_eq!(page.eval::<Vec<u32>>("peer.opened").await?, Vec::<u32>::new());
        // Neither is the second of two presses.
        let twice =
            "document.getElementById('live-start').dispatchEvent(new MouseEvent('click', { detail: 2 }))";
        page.eval::<bool>(twice).await?;
        assert_eq!(page.eval::<Vec<u32>>("peer.opened").await?, Vec::<u32>::new());
        page.eval::<Value>(PRESS_START).await?;
        page.until(ENDED).await?;
        assert_eq!(page.eval::<Vec<u32>>("peer.opened").await?, [57_600]);
        Ok(())
    })
}

#[test]
fn a_failed_worker_releases_the_port_and_is_replaced() -> Result<()> {
    in_browser(|page| async move {
        let known = open(&page, FRAMED, "serve").await?;
        page.eval::<Value>(OWN).await?;
        page.eval::<Value>(
            "(window.spoil = (data) => ({ ...data, stream: 'nothing that is read' })) && null",
        )
        .await?;
        start(&page).await?;
        page.until(&format!("{SAID}.startsWith('The transfer failed: ')")).await?;
        ensure!(page.eval::<String>(SAID).await?.contains("Switch off its power if it must not move"));
        page.until("peer.closed === 1").await?;
        page.until("!document.getElementById('live-start').disabled").await?;
        page.eval::<Value>("(window.spoil = null)").await?;
        // Replies before the failure are unknown.
        page.click("#live-start").await?;
        page.until(&format!("{SAID}.endsWith('press STOP first, or start again.')")).await?;
        page.eval::<Value>(PRESS_START).await?;
        page.until("peer.closed === 2 && !document.getElementById('live-close').disabled").await?;
        verified(&page, &known).await.map(drop)
    })
}

#[test]
fn a_port_that_stays_open_is_reported_and_disables_buttons() -> Result<()> {
    in_browser(|page| async move {
        open(&page, LONG, "serve").await?;
        page.eval::<Value>(OWN).await?;
        start(&page).await?;
        page.until(&format!("{ROWS} > 5")).await?;
        // As if the worker's memory were lost: nothing returns the port's streams.
        let gone = "(own.terminate(), own.onmessage({ data: { error: 'unreachable' } }), null)";
        page.eval::<Value>(gone).await?;
        page.until(&format!("{SAID}.includes('The port could not be closed: reload this page')")).await?;
        page.until(&format!("{ABOUT}.includes(' baud')")).await?;
        // Selecting the port in the browser's list again shows the message again.
        page.click("#live-choose").await?;
        page.until(&format!(
            "{SAID} === 'The port could not be closed: reload this page before you use it again.'"
        ))
        .await?;
        for button in ["live-start", "live-stop"] {
            ensure!(page.eval::<bool>(&format!("document.getElementById('{button}').disabled")).await?);
        }
        ensure!(!page.eval::<bool>("document.getElementById('live-close').disabled").await?);
        Ok(())
    })
}
