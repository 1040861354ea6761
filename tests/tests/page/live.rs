//! The dialog Device in Chromium, with a mock of `navigator.serial` (`device`).

use anyhow::{Result, ensure};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::{
    axe,
    bench::in_browser,
    device::{
        ABOUT, ENDED, FRAMED, MESSAGE, REPORT, SAID, STANDING, answers_a_host, open, open_with, positions,
        start, start_by, verified,
    },
    native::Known,
    session::Session,
};

/// Long enough to be stopped before its end, on any machine.
pub(crate) const LONG: &str = r#"{"line":{"protocol":"framed","host":{"attempts":40}},"bus":{"step_period_cycles":3200},
    "source":{"motion":{"axes":[{"moves":[{"cosine":{"distance":{"steps":27000},"duration_s":60}}]}]}}}"#;
/// Two controllers, the first of two channels.
const TWO: &str = r#"{"line":{"protocol":"framed","host":{"attempts":40}},"bus":{"channels":2,"step_period_cycles":3200,"queue_depth":200},
    "source":{"motion":{"axes":[{"moves":[{"cosine":{"distance":{"steps":200},"duration_s":1}}]},{"moves":[{"cosine":{"distance":{"steps":-300},"duration_s":1}}]}]}},
    "controllers":[{"address":1,"bus":{"channels":1,"step_period_cycles":3200,"queue_depth":200},"axes":[{"moves":[{"cosine":{"distance":{"steps":100},"duration_s":1}}]}]}]}"#;

/// The cells of the table with device and model, without its header.
#[derive(Debug, Deserialize, PartialEq)]
struct Beside(Vec<[String; 3]>);

async fn beside(page: &Session) -> Result<Beside> {
    page.eval("[...document.querySelectorAll('#live-twin tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent.replaceAll('\\u202f', '')))").await
}

#[test]
fn a_stream_is_confirmed_with_the_positions_of_the_model() -> Result<()> {
    in_browser(|page| async move {
        let known = open(&page, FRAMED, "serve").await?;
        let mut wrong = Vec::new();
        axe::look(&page, "the dialog", &mut wrong).await?;
        start(&page).await?;
        page.until(ENDED).await?;
        let report = verified(&page, &known).await?;
        let ticks = known.experiment.ticks_of(0).len().to_string();
        let steps = positions(&known).join("  ");
        let both = |name: &str, value: &str| [name.to_owned(), value.to_owned(), value.to_owned()];
        let expected =
            Beside(vec![both("state", "READY"), both("ticks done", &ticks), both("steps moved", &steps)]);
        assert_eq!(beside(&page).await?, expected);
        // The state of the port: opened at the line's rate, and closed.
        assert_eq!(page.eval::<(Vec<u32>, u32)>("[peer.opened, peer.closed]").await?, (vec![115_200], 1));
        // One row per exchange, the first ones at the end: STATUS, POSITIONS, TICKS.
        let kinds: Vec<String> =
            page.eval("[...document.querySelectorAll('.live-replies tbody tr')].map((row) => row.cells[3].textContent).toReversed()").await?;
        let replies: Vec<&String> = kinds.iter().filter(|kind| *kind != "no reply").collect();
        assert_eq!(replies[..3], ["ACK STATUS", "ACK POSITIONS", "ACK TICKS"]);
        // Each frame has one: its reply, or a timeout.
        ensure!(report.contains(&format!("frames {} ", kinds.len())), "{} rows\n{report}", kinds.len());
        axe::look(&page, "the report", &mut wrong).await?;
        page.picture("device").await?;

        page.click("#live-close").await?;
        page.until("document.querySelector('dialog.live') === null").await?;
        axe::none(&wrong)
    })
}

#[test]
fn ports_are_searched_only_with_the_dialog_open() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(FRAMED)?;
        open_with(&page, &format!("#{}", known.link), "serve", FRAMED).await?;
        page.until_digest(&known.digest).await?;
        ensure!(page.eval::<u32>("peer.sought").await? == 0, "ports are searched before the dialog opens");
        page.click("#device").await?;
        page.until("peer.sought > 0").await?;
        page.until(&format!("{ABOUT}.includes(' baud')")).await?;
        Ok(())
    })
}

#[test]
fn an_allowed_port_is_selected_without_the_chooser() -> Result<()> {
    in_browser(|page| async move {
        let known = open(&page, FRAMED, "allowed").await?;
        page.until_equal(
            "[...document.querySelectorAll('#live-allowed button')].map((button) => button.textContent)",
            &json!(["Port allowed before (USB 2341:0043)"]),
        )
        .await?;
        let mut wrong = Vec::new();
        axe::look(&page, "the dialog with a port", &mut wrong).await?;
        start_by(&page, "#live-allowed button").await?;
        page.until(ENDED).await?;
        verified(&page, &known).await?;
        axe::none(&wrong)
    })
}

#[test]
fn two_controllers_have_separate_rows_and_results() -> Result<()> {
    in_browser(|page| async move {
        open(&page, TWO, "serve").await?;
        start(&page).await?;
        page.until(ENDED).await?;
        page.until(&format!("{SAID}.startsWith('Verified')")).await?;
        let Beside(rows) = beside(&page).await?;
        assert_eq!(rows.len(), 6);
        assert_eq!(rows[5], ["controller 1, steps moved", "100", "100"].map(str::to_owned));
        ensure!(rows.iter().all(|[_, device, model]| device == model), "{rows:?}");
        Ok(())
    })
}

#[test]
fn stop_during_a_stream_is_confirmed_and_reported() -> Result<()> {
    in_browser(|page| async move {
        open(&page, LONG, "serve").await?;
        start(&page).await?;
        page.until(&format!("Number({STANDING}.match(/(\\d+) ticks accepted/)?.[1] ?? 0) > 20")).await?;
        ensure!(page.eval::<bool>("document.getElementById('live-close').disabled").await?);
        // Leaving the page needs a confirmation.
        let asks = "!dispatchEvent(new Event('beforeunload', { cancelable: true }))";
        ensure!(page.eval::<bool>(asks).await?);
        page.click("#live-stop").await?;
        page.until(ENDED).await?;
        page.until(&format!("{SAID}.startsWith('STOP is confirmed')")).await?;
        let report: String = page.eval(REPORT).await?;
        for part in ["STOP is acknowledged", "state STOPPED", "is the first that is not confirmed"] {
            ensure!(report.contains(part), "{part} is not in\n{report}");
        }
        // Even if nothing is sent: another program may have left the device moving.
        page.click("#live-stop").await?;
        page.until("peer.closed === 2").await?;
        page.until(&format!("{SAID}.startsWith('STOP is confirmed')")).await?;
        ensure!(!page.eval::<bool>(asks).await?);
        Ok(())
    })
}

#[test]
fn escape_stops_and_a_closing_dialog_stops_first() -> Result<()> {
    for leave in ["escape", "document.querySelector('dialog.live').close() ?? null"] {
        in_browser(|page| async move {
            open(&page, LONG, "serve").await?;
            start(&page).await?;
            page.until(&format!("Number({STANDING}.match(/(\\d+) ticks accepted/)?.[1] ?? 0) > 20")).await?;
            if leave == "escape" {
                page.press("#live-stop", "\u{e00c}").await?;
                page.until(&format!("{SAID}.startsWith('STOP is confirmed')")).await?;
                page.until(ENDED).await
            } else {
                page.eval::<Value>(leave).await?;
                page.until(&format!("peer.closed === 1 && {MESSAGE}.includes('STOP is confirmed')")).await
            }
        })?;
    }
    Ok(())
}

#[test]
fn a_silent_device_ends_the_stream_with_a_report() -> Result<()> {
    in_browser(|page| async move {
        open(&page, &FRAMED.replace(r#","host":{"attempts":40}"#, ""), "silent").await?;
        start(&page).await?;
        page.until(ENDED).await?;
        page.until(&format!("{SAID} === 'Not verified: controller 0: given up: no reply.'")).await?;
        let report: String = page.eval(REPORT).await?;
        ensure!(report.contains("none sent: the job never started"), "{report}");
        page.click("#live-stop").await?;
        page.until("peer.closed === 2").await?;
        page.until(&format!("{SAID}.startsWith('STOP is not confirmed')")).await
    })
}

#[test]
fn a_lost_port_ends_the_stream_and_reports_confirmed_ticks() -> Result<()> {
    in_browser(|page| async move {
        open(&page, LONG, "serve").await?;
        start(&page).await?;
        page.until(&format!("Number({STANDING}.match(/(\\d+) ticks accepted/)?.[1] ?? 0) > 20")).await?;
        page.eval::<Value>("peer.lose() ?? null").await?;
        page.until(ENDED).await?;
        let lost = "Not verified: the port is lost: The device has been lost.";
        page.until_equal(SAID, &json!(lost)).await?;
        let report: String = page.eval(REPORT).await?;
        ensure!(report.contains("is the first that is not confirmed"), "{report}");
        Ok(())
    })
}

#[test]
fn unavailable_buttons_are_disabled_with_a_reason() -> Result<()> {
    in_browser(|page| async move {
        for (lack, why) in [
            (
                "Object.defineProperty(navigator, 'serial', { configurable: true, value: undefined })",
                "This browser does not support Web Serial",
            ),
            (
                "window.structuredClone = () => { throw new DOMException('It can not be cloned.', 'DataCloneError'); }",
                "This browser cannot transfer the streams of a port to a worker",
            ),
        ] {
            open_with(&page, &format!("#{}", Known::of(FRAMED)?.link), "serve", FRAMED).await?;
            page.js::<bool>(&format!("{lack}; return true;"), vec![]).await?;
            page.click("#device").await?;
            page.until(&format!("{ABOUT}.startsWith({})", json!(why))).await?;
            for button in ["live-choose", "live-start"] {
                let (off, title): (bool, String) = page
                    .eval(&format!(
                        "(({{ disabled, title }}) => [disabled, title])(document.getElementById('{button}'))"
                    ))
                    .await?;
                ensure!(off && title.starts_with(why), "{button}: {title}");
            }
        }

        // Without replies nothing can be confirmed, but the controllers can reply to a host.
        for (json, why) in [
            ("{}", "choose the framed protocol"),
            (
                r#"{"line":{"protocol":"framed"},"source":{"line":{"sends":[{"start_cycle":400,"bytes":"00"}]}},"run_cycles":100000}"#,
                "choose a motion",
            ),
        ] {
            open_with(&page, &format!("#{}", Known::of(json)?.link), "serve", FRAMED).await?;
            page.click("#device").await?;
            page.until(&format!("{ABOUT} !== '' && {ABOUT} !== 'Loading…'")).await?;
            ensure!(
                page.eval::<bool>("document.querySelector('[name=live-role][value=serve]').checked").await?,
                "what cannot be is offered first"
            );
            page.click("[name=live-role][value=stream]").await?;
            page.until(&format!("{ABOUT}.includes({})", json!(why))).await?;
            ensure!(page.eval::<bool>("document.getElementById('live-choose').disabled").await?);
        }
        Ok(())
    })
}

#[test]
fn a_port_in_use_is_reported_and_nothing_runs() -> Result<()> {
    in_browser(|page| async move {
        open(&page, FRAMED, "taken").await?;
        page.click("#live-choose").await?;
        page.until("!document.getElementById('live-start').disabled").await?;
        page.click("#live-start").await?;
        page.until(&format!("{SAID}.startsWith('The port cannot be opened: Failed to open serial port.')"))
            .await?;
        ensure!(!page.eval::<bool>("document.getElementById('live-close').disabled").await?);
        Ok(())
    })
}

#[test]
fn the_page_serves_a_host_and_its_session_keeps_its_digest() -> Result<()> {
    in_browser(|page| async move {
        let known = open(&page, FRAMED, "stream").await?;
        answers_a_host(&page, &known).await
    })
}
