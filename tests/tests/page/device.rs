//! Shared by the tests of the dialog Device: the dialog, and a mock of `navigator.serial` (LIVE H6). The mock is a port whose
//! streams lead to a second worker of the page, as a simulated device or a simulated host. Real ports: `live_port`.

use anyhow::{Result, ensure};
use serde_json::{Value, json};

use crate::{browser::Browser, native::Known, session::Session};

/// Ticks of 20 ms: the queue lasts for seconds, so that it does not run empty on a busy machine; the host repeats many times.
pub(crate) const FRAMED: &str = r#"{"line":{"protocol":"framed","host":{"attempts":40}},"bus":{"step_period_cycles":3200,"queue_depth":200},
    "source":{"motion":{"axes":[{"moves":[{"cosine":{"distance":{"steps":400},"duration_s":1}}]}]}}}"#;

pub(crate) const ABOUT: &str = "(document.getElementById('live-about')?.textContent ?? '')";
pub(crate) const SAID: &str = "(document.getElementById('live-status')?.textContent ?? '')";
pub(crate) const REPORT: &str = "document.getElementById('live-report').value";
pub(crate) const STANDING: &str = "document.getElementById('live-standing').textContent";
pub(crate) const MESSAGE: &str = "document.getElementById('link-message').innerText";
/// Whether the port has been released.
pub(crate) const ENDED: &str = "!document.getElementById('live-close').disabled && peer.closed > 0";

/// The other end of a port: a controller of a scenario (`serve`), its host (`stream`), or nothing (`silent`). A port may also
/// fail to open (`taken`), or have a controller and be allowed already, so that no chooser opens (`allowed`). The other end starts
/// when the port is opened and, if a test sets it, `window.held` exists; with `stays` it continues when the port is closed, like a
/// device.
const MOCK: &str = "(role, json, stays) => {
    const peer = (window.peer = { sought: 0, told: [], opened: [], closed: 0, lose() {}, end() {} });
    const begin = () => new Promise((begun, fail) => {
        const main = document.getElementById('main').dataset;
        const worker = new Worker(main.liveWorker, { type: 'module' });
        worker.onerror = fail;
        worker.onmessage = ({ data }) => { peer.told.push(data); begun(worker); };
        peer.end = () => worker.postMessage({ end: true });
        const compiled = fetch(document.getElementById('core').href).then((response) => response.arrayBuffer()).then(WebAssembly.compile);
        compiled.then((module) => { worker.postMessage({ module }); worker.postMessage({ validate: json }); }, fail);
    });
    let other;
    const port = {
        getInfo: () => ({ usbVendorId: 0x2341, usbProductId: 0x43 }),
        async open(options) {
            if (role === 'taken') throw new DOMException('Failed to open serial port.', 'NetworkError');
            const worker = await (other ??= begin());
            await window.held;
            peer.opened.push(options.baudRate);
            const there = new TransformStream({ start(end) { peer.lose = () => end.error(new Error('The device has been lost.')); } });
            const back = new TransformStream();
            Object.assign(port, { readable: there.readable, writable: back.writable });
            if (role === 'silent') return void back.readable.pipeTo(new WritableStream());
            // The end of the other side does not close the port.
            const wire = new TransformStream();
            wire.readable.pipeTo(there.writable, { preventClose: true }).catch(() => {});
            const own = new TransformStream();
            back.readable.pipeTo(own.writable, { preventClose: stays }).catch(() => {});
            const order = { [role === 'stream' ? 'stream' : 'serve']: json, readable: own.readable, writable: wire.writable };
            worker.postMessage(order, [own.readable, wire.writable]);
        },
        async close() {
            if (port.readable?.locked || port.writable?.locked) throw new TypeError('Cannot abort a locked stream');
            peer.closed += 1;
        },
    };
    const serial = {
        getPorts: async () => (role === 'allowed' ? [port] : []),
        async requestPort() {
            if (role === 'allowed') throw new Error('nobody was to be asked');
            return port;
        },
    };
    Object.defineProperty(navigator, 'serial', { configurable: true, get() { peer.sought += 1; return serial; } });
}";

/// Opens the page with the mock, which is installed before the page's scripts or, if a driver cannot do this, after them and
/// before the dialog, which is the first to search for ports (`ports_are_searched_only_with_the_dialog_open`).
pub(crate) async fn open_with(page: &Session, fragment: &str, role: &str, json: &str) -> Result<()> {
    open_at(page, fragment, (json, role, false)).await
}

async fn open_at(page: &Session, fragment: &str, (json, role, stays): (&str, &str, bool)) -> Result<()> {
    let mock = format!("({MOCK})({}, {}, {stays});", json!(role), json!(json));
    if page.bench.browser == Browser::Chromium {
        page.before_scripts(&mock).await?;
        return page.open(fragment).await;
    }
    page.open(fragment).await?;
    page.js::<bool>(&format!("{mock} return true;"), vec![]).await.map(drop)
}

/// Opens the page with a scenario and the dialog for it, with this role at the other end of the port.
pub(crate) async fn open(page: &Session, json: &str, role: &str) -> Result<Known> {
    open_beside(page, (json, role, false)).await
}

/// The same; `true` for a device that continues when the port is closed.
pub(crate) async fn open_beside(page: &Session, there: (&str, &str, bool)) -> Result<Known> {
    let known = Known::of(there.0)?;
    open_at(page, &format!("#{}", known.link), there).await?;
    // On a narrow screen the view is a tab.
    let tab =
        "[document.getElementById('tab-packets')].find((tab) => tab.checkVisibility())?.click() ?? null";
    page.eval::<Value>(tab).await?;
    page.click("#device").await?;
    page.until(&format!("{ABOUT}.includes(' baud')")).await?;
    Ok(known)
}

/// Selects the port, and starts.
pub(crate) async fn start(page: &Session) -> Result<()> {
    start_by(page, "#live-choose").await
}

/// Selects the port of this button, and starts.
pub(crate) async fn start_by(page: &Session, button: &str) -> Result<()> {
    ensure!(page.eval::<Vec<u32>>("peer.opened").await?.is_empty(), "a port is open before a press");
    page.click(button).await?;
    page.until("!document.getElementById('live-start').disabled").await?;
    ensure!(page.eval::<Vec<u32>>("peer.opened").await?.is_empty(), "a port is open before its press");
    page.click("#live-start").await
}

/// The model's final positions.
pub(crate) fn positions(known: &Known) -> Vec<String> {
    let run = known.experiment.run(&mut Vec::new());
    let channels = usize::from(known.experiment.config().channels());
    run.positions().iter().take(channels).map(ToString::to_string).collect()
}

/// Checks that the stream is verified with the model's ticks and positions; returns the report.
pub(crate) async fn verified(page: &Session, known: &Known) -> Result<String> {
    let report: String = page.eval(REPORT).await?;
    let said: String = page.eval(SAID).await?;
    ensure!(said.starts_with("Verified: READY"), "{said}\n{report}");
    let (ticks, steps) = (known.experiment.ticks_of(0).len(), positions(known).join("  "));
    for part in
        [format!("ticks {ticks} of {ticks} done"), format!("positions {steps}: the sums of the ticks")]
    {
        ensure!(report.contains(&part), "{part} is not in\n{report}");
    }
    Ok(report)
}

/// As a simulated device the page replies to the host at the port, and the session opens with its digest.
pub(crate) async fn answers_a_host(page: &Session, known: &Known) -> Result<()> {
    page.click("[name=live-role][value=serve]").await?;
    start(page).await?;
    // The host is the page's own, and its stream is confirmed completely.
    page.until("peer.told.some(({ reported }) => reported?.verified)").await?;
    session_opens(page, known).await?;
    page.until("peer.closed === 1").await
}

/// Checks that the page shows the execution of a host's ticks, and that the session opens with its digest.
pub(crate) async fn session_opens(page: &Session, known: &Known) -> Result<()> {
    let (depth, steps) = (known.experiment.config().queue_depth(), positions(known).join(" "));
    page.until(&format!("{STANDING}.includes('READY, queue 0/{depth}, positions {steps}')")).await?;
    page.click("#live-end").await?;
    page.until("document.querySelector('dialog.live') === null").await?;
    page.until(&format!("{MESSAGE}.includes('Recorded. The simulation reproduces the digest')")).await?;
    page.ready().await?;
    let digest = page.shown().await?.digest;
    page.until(&format!("{MESSAGE}.includes('{digest}')")).await?;
    ensure!(page.eval::<bool>("location.hash.length > 10").await?, "it has no link");
    Ok(())
}
