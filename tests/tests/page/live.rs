//! The dialog Device with a mock of `navigator.serial` (LIVE H6): a port whose streams lead to a second worker of the page's own,
//! which is the device of a host or the host of a device. What a real port adds is not tested here.

use anyhow::{Result, ensure};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::{axe, bench::in_browser, native::Known, session::Session};

/// A tick of 20 ms: a queue that a busy machine does not let run dry.
pub(crate) const FRAMED: &str = r#"{"line":{"protocol":"framed"},"bus":{"step_period_cycles":3200},
    "source":{"motion":{"axes":[{"moves":[{"cosine":{"distance":{"steps":400},"duration_s":1}}]}]}}}"#;
/// Long enough to be stopped on the way, on any machine.
pub(crate) const LONG: &str = r#"{"line":{"protocol":"framed"},"bus":{"step_period_cycles":3200},
    "source":{"motion":{"axes":[{"moves":[{"cosine":{"distance":{"steps":9000},"duration_s":20}}]}]}}}"#;
/// Two controllers, the first of two channels.
const TWO: &str = r#"{"line":{"protocol":"framed"},"bus":{"channels":2,"step_period_cycles":3200},
    "source":{"motion":{"axes":[{"moves":[{"cosine":{"distance":{"steps":200},"duration_s":1}}]},{"moves":[{"cosine":{"distance":{"steps":-300},"duration_s":1}}]}]}},
    "controllers":[{"address":1,"bus":{"channels":1,"step_period_cycles":3200},"axes":[{"moves":[{"cosine":{"distance":{"steps":100},"duration_s":1}}]}]}]}"#;

/// A port of which the other end is: a controller of a scenario (`serve`), its host (`stream`), or nobody (`silent`); one that
/// cannot be opened (`taken`). Who is there may stay when the port is closed, as a device does.
const MOCK: &str = "
    const [role, json, stays] = arguments;
    const main = document.getElementById('main').dataset;
    const worker = new Worker(main.liveWorker, { type: 'module' });
    const peer = (window.peer = { told: [], opened: [], closed: 0, lose() {}, end: () => worker.postMessage({ end: true }) });
    worker.onmessage = ({ data }) => peer.told.push(data);
    const compiled = fetch(main.liveCore).then((response) => response.arrayBuffer()).then(WebAssembly.compile);
    const ready = compiled.then((module) => worker.postMessage({ module }));
    const port = {
        getInfo: () => ({ usbVendorId: 0x2341, usbProductId: 0x43 }),
        async open(options) {
            if (role === 'taken') throw new DOMException('Failed to open serial port.', 'NetworkError');
            await ready;
            await window.held;
            peer.opened.push(options.baudRate);
            const there = new TransformStream({ start(end) { peer.lose = () => end.error(new Error('The device has been lost.')); } });
            const back = new TransformStream();
            Object.assign(port, { readable: there.readable, writable: back.writable });
            if (role === 'silent') return void back.readable.pipeTo(new WritableStream());
            // Who is at the other end and goes does not close the port.
            const wire = new TransformStream();
            wire.readable.pipeTo(there.writable, { preventClose: true }).catch(() => {});
            const own = new TransformStream();
            back.readable.pipeTo(own.writable, { preventClose: stays }).catch(() => {});
            worker.postMessage({ [role]: json, readable: own.readable, writable: wire.writable }, [own.readable, wire.writable]);
        },
        async close() { peer.closed += 1; },
    };
    Object.defineProperty(navigator, 'serial', { configurable: true, value: { requestPort: async () => port } });
    return true;";

pub(crate) const ABOUT: &str = "(document.getElementById('live-about')?.textContent ?? '')";
pub(crate) const SAID: &str = "(document.getElementById('live-said')?.textContent ?? '')";
pub(crate) const REPORT: &str = "document.getElementById('live-report').value";
pub(crate) const STANDING: &str = "document.getElementById('live-standing').textContent";
pub(crate) const MESSAGE: &str = "document.getElementById('link-message').innerText";
/// What had the port has given it back.
pub(crate) const ENDED: &str = "!document.getElementById('live-close').disabled && peer.closed > 0";

/// The cells of the table that has device and model side by side, after its head.
#[derive(Debug, Deserialize, PartialEq)]
struct Beside(Vec<[String; 3]>);

async fn beside(page: &Session) -> Result<Beside> {
    page.eval("[...document.querySelectorAll('#live-twin tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent.replaceAll('\\u202f', '')))").await
}

/// Opens the page with a scenario and the dialog on it, with a port whose other end has this role.
pub(crate) async fn open(page: &Session, json: &str, role: &str) -> Result<Known> {
    open_beside(page, (json, role, false)).await
}

/// The same with a device that stays when the port is closed.
pub(crate) async fn open_beside(page: &Session, (json, role, stays): (&str, &str, bool)) -> Result<Known> {
    let known = Known::of(json)?;
    page.open(&format!("#{}", known.link)).await?;
    page.js::<bool>(MOCK, vec![json!(role), json!(json), json!(stays)]).await?;
    // On a narrow screen the view is a tab.
    page.eval::<Value>(
        "[document.getElementById('tab-packets')].find((tab) => tab.checkVisibility())?.click() ?? null",
    )
    .await?;
    page.click("#device").await?;
    page.until(&format!("{ABOUT}.includes(' baud')")).await?;
    Ok(known)
}

/// Chooses the port, and starts.
pub(crate) async fn start(page: &Session) -> Result<()> {
    ensure!(page.eval::<Vec<u32>>("peer.opened").await?.is_empty(), "a port is open before a press");
    page.click("#live-choose").await?;
    page.until("!document.getElementById('live-start').disabled").await?;
    ensure!(page.eval::<Vec<u32>>("peer.opened").await?.is_empty(), "a port is open before its press");
    page.click("#live-start").await
}

/// Where the model's motors stand at the end.
pub(crate) fn positions(known: &Known) -> Vec<String> {
    let run = known.experiment.run(&mut Vec::new());
    let channels = usize::from(known.experiment.config().channels());
    run.positions().iter().take(channels).map(ToString::to_string).collect()
}

#[test]
fn a_stream_is_confirmed_to_its_end_with_the_models_positions() -> Result<()> {
    in_browser(|page| async move {
        let known = open(&page, FRAMED, "serve").await?;
        let mut wrong = Vec::new();
        axe::look(&page, "the dialog", &mut wrong).await?;
        start(&page).await?;
        page.until(ENDED).await?;
        let report: String = page.eval(REPORT).await?;
        page.until(&format!("{SAID}.startsWith('Verified: READY')")).await?;
        let ticks = known.experiment.ticks_of(0).len().to_string();
        let steps = positions(&known).join("  ");
        for part in
            [format!("ticks {ticks} of {ticks} done"), format!("positions {steps}: the sums of the ticks")]
        {
            ensure!(report.contains(&part), "{part} is not in\n{report}");
        }
        let both = |name: &str, value: &str| [name.to_owned(), value.to_owned(), value.to_owned()];
        let expected =
            Beside(vec![both("state", "READY"), both("ticks done", &ticks), both("steps gone", &steps)]);
        assert_eq!(beside(&page).await?, expected);
        // What the page tells of its port: opened at the line's rate, and closed.
        assert_eq!(page.eval::<(Vec<u32>, u32)>("[peer.opened, peer.closed]").await?, (vec![115_200], 1));
        // A row an exchange, the first ones last: STATUS, POSITIONS, TICKS.
        let kinds: Vec<String> =
            page.eval("[...document.querySelectorAll('.live-replies tbody tr')].map((row) => row.cells[3].textContent).toReversed()").await?;
        assert_eq!(kinds[..3], ["ACK STATUS", "ACK POSITIONS", "ACK TICKS"]);
        // Each frame has one: its reply, or that none came in time.
        ensure!(report.contains(&format!("frames {} ", kinds.len())), "{} rows\n{report}", kinds.len());
        axe::look(&page, "the report", &mut wrong).await?;
        page.picture("device").await?;

        page.click("#live-close").await?;
        page.until("document.querySelector('dialog.live') === null").await?;
        axe::none(&wrong)
    })
}

#[test]
fn two_controllers_have_each_their_rows_and_their_end() -> Result<()> {
    in_browser(|page| async move {
        open(&page, TWO, "serve").await?;
        start(&page).await?;
        page.until(ENDED).await?;
        page.until(&format!("{SAID}.startsWith('Verified')")).await?;
        let Beside(rows) = beside(&page).await?;
        assert_eq!(rows.len(), 6);
        assert_eq!(rows[5], ["controller 1, steps gone", "100", "100"].map(str::to_owned));
        ensure!(rows.iter().all(|[_, device, model]| device == model), "{rows:?}");
        Ok(())
    })
}

#[test]
fn stop_in_the_middle_is_confirmed_and_reported() -> Result<()> {
    in_browser(|page| async move {
        open(&page, LONG, "serve").await?;
        start(&page).await?;
        page.until(&format!("Number({STANDING}.match(/(\\d+) ticks accepted/)?.[1] ?? 0) > 20")).await?;
        ensure!(page.eval::<bool>("document.getElementById('live-close').disabled").await?);
        // Who leaves the page is asked.
        let asks = "!dispatchEvent(new Event('beforeunload', { cancelable: true }))";
        ensure!(page.eval::<bool>(asks).await?);
        page.click("#live-stop").await?;
        page.until(ENDED).await?;
        page.until(&format!("{SAID}.startsWith('STOP is confirmed')")).await?;
        let report: String = page.eval(REPORT).await?;
        for part in ["STOP is acknowledged", "state STOPPED", "is the first not known to be done"] {
            ensure!(report.contains(part), "{part} is not in\n{report}");
        }
        // Also where nothing is sent: to a device that somebody else may have left moving.
        page.click("#live-stop").await?;
        page.until("peer.closed === 2").await?;
        page.until(&format!("{SAID}.startsWith('STOP is confirmed')")).await?;
        ensure!(!page.eval::<bool>(asks).await?);
        Ok(())
    })
}

#[test]
fn escape_is_stop_and_a_dialog_that_goes_stops_first() -> Result<()> {
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
fn a_silent_device_is_given_up_and_told() -> Result<()> {
    in_browser(|page| async move {
        open(&page, FRAMED, "silent").await?;
        start(&page).await?;
        page.until(ENDED).await?;
        page.until(&format!("{SAID} === 'Not verified: controller 0: given up: no reply.'")).await?;
        let report: String = page.eval(REPORT).await?;
        ensure!(report.contains("none sent: it was never opened"), "{report}");
        page.click("#live-stop").await?;
        page.until("peer.closed === 2").await?;
        page.until(&format!("{SAID}.startsWith('STOP is not confirmed')")).await
    })
}

#[test]
fn a_lost_port_ends_the_stream_and_is_told_with_what_is_known() -> Result<()> {
    in_browser(|page| async move {
        open(&page, LONG, "serve").await?;
        start(&page).await?;
        page.until(&format!("Number({STANDING}.match(/(\\d+) ticks accepted/)?.[1] ?? 0) > 20")).await?;
        page.eval::<Value>("peer.lose() ?? null").await?;
        page.until(ENDED).await?;
        let lost = "Not verified: the port is lost: The device has been lost.";
        page.until_equal(SAID, &json!(lost)).await?;
        let report: String = page.eval(REPORT).await?;
        ensure!(report.contains("is the first not known to be done"), "{report}");
        Ok(())
    })
}

#[test]
fn without_web_serial_or_with_nothing_to_confirm_the_buttons_are_off_and_say_why() -> Result<()> {
    in_browser(|page| async move {
        page.open(&format!("#{}", Known::of(FRAMED)?.link)).await?;
        page.js::<bool>(
            "Object.defineProperty(navigator, 'serial', { configurable: true, value: undefined }); return true;",
            vec![],
        )
        .await?;
        page.click("#device").await?;
        page.until(&format!("{ABOUT}.startsWith('This browser has no Web Serial')")).await?;
        for button in ["live-choose", "live-start"] {
            let (off, title): (bool, String) = page
                .eval(&format!(
                    "(({{ disabled, title }}) => [disabled, title])(document.getElementById('{button}'))"
                ))
                .await?;
            ensure!(off && title.starts_with("This browser has no Web Serial"), "{button}: {title}");
        }

        // What is not answered cannot be confirmed; but its controllers can answer a host.
        for (json, why) in [
            ("{}", "choose the framed protocol"),
            (
                r#"{"line":{"protocol":"framed"},"source":{"line":{"sends":[{"start_cycle":400,"bytes":"00"}]}},"run_cycles":100000}"#,
                "choose a motion",
            ),
        ] {
            page.open(&format!("#{}", Known::of(json)?.link)).await?;
            page.js::<bool>(MOCK, vec![json!("serve"), json!(FRAMED), json!(false)]).await?;
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
fn a_port_that_is_taken_is_told_and_nothing_runs() -> Result<()> {
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
fn the_page_answers_a_host_and_the_session_opens_with_its_digest() -> Result<()> {
    in_browser(|page| async move {
        let known = open(&page, FRAMED, "stream").await?;
        page.click("[name=live-role][value=serve]").await?;
        start(&page).await?;
        // The host is the page's own, and its stream is confirmed to the end.
        page.until("peer.told.some(({ reported }) => reported?.verified)").await?;
        let steps = positions(&known).join(" ");
        page.until(&format!("{STANDING}.includes('READY, queue 0/16, positions {steps}')")).await?;
        page.click("#live-end").await?;
        page.until("document.querySelector('dialog.live') === null && peer.closed === 1").await?;
        page.until(&format!("{MESSAGE}.includes('Recorded: run again, the session has the digest')")).await?;
        page.ready().await?;
        let digest = page.shown().await?.digest;
        page.until(&format!("{MESSAGE}.includes('{digest}')")).await?;
        ensure!(page.eval::<bool>("location.hash.length > 10").await?, "it has no link");
        Ok(())
    })
}
