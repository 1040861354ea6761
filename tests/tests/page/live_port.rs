//! The dialog Device in Chromium on a system port, without a mock (LIVE H6). `stepscope serve` or, behind socat, `stepscope
//! send` has one end of a pseudo-terminal. The other end replaces `/dev/ttyS0` in a mount namespace of this Chromium and its driver.
//! A policy allows the port, so the dialog offers it without the browser's chooser, which no program can operate.
//! `cargo xtask test --only engines` runs this test if the machine supports it, and otherwise reports why not.

use std::{fs, process::Command};

use anyhow::{Context, Result, ensure};
use serde_json::json;

use crate::{
    bench::{dist, in_chromium_of},
    browser::{Says, named},
    device::{ABOUT, FRAMED, SAID, positions, session_opens, verified},
    native::Known,
    pool,
    programs::{Folder, Program},
    session::Session,
};

/// Runs in its own mount namespace, with the pseudo-terminal's path, the policy and the driver as arguments. The namespace ends
/// with its last program.
const NAMESPACE: &str = r#"
    mount --bind "$1" /dev/ttyS0 &&
    mount -t tmpfs none /etc/chromium &&
    mkdir -p /etc/chromium/policies/managed &&
    printf %s "$2" > /etc/chromium/policies/managed/stepscope.json &&
    exec "$3" --port=0"#;

/// Whether the port is closed, by the state of the page's own ports.
const CLOSED: &str =
    "return navigator.serial.getPorts().then((ports) => ports.every(({ readable }) => readable === null));";

/// A device of the scenario, until its host closes the pseudo-terminal.
fn device(folder: &Folder, json: &str) -> Result<Program> {
    let scenario = folder.0.join("scenario.json");
    fs::write(&scenario, json)?;
    let mut serve = Command::new(named("STEPSCOPE_COMMAND")?);
    serve.arg("serve").arg(&scenario).args(["--pty", "--once", "--lag", "5000"]);
    Program::start(&serve, Says::Path("pty:")).context("the device")
}

/// A pseudo-terminal with two ends, and their paths.
fn pair() -> Result<(Program, String, String)> {
    let mut socat = Command::new("socat");
    socat.args(["-d", "-d", "pty,raw,echo=0", "pty,raw,echo=0"]);
    // The second one is reported a moment after the first.
    let socat = Program::start(&socat, Says::Path("starting data transfer loop")).context("socat")?;
    let heard = socat.heard();
    let mut ends = heard.iter().filter_map(|line| Some(line.split_once("PTY is ")?.1.to_owned()));
    let (one, other) = ends.next().zip(ends.next()).with_context(|| heard.join("\n"))?;
    Ok((socat, one, other))
}

/// Sends the scenario's ticks to this end; returns the output, once all is verified.
fn sent(folder: &Folder, json: &str, end: &str) -> Result<String> {
    let scenario = folder.0.join("scenario.json");
    fs::write(&scenario, json)?;
    let mut send = Command::new(named("STEPSCOPE_COMMAND")?);
    let done = send.arg("send").arg(&scenario).args(["--port", end, "--slack", "500"]).output()?;
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    ensure!(done.status.success(), "{said}{}", String::from_utf8_lossy(&done.stderr));
    Ok(said)
}

/// Chromium's driver in a namespace that allows the port to the page at this address.
fn driver(terminal: &str, page: &str) -> Result<Program> {
    let policy = json!({ "SerialAllowAllPortsForUrls": [page.trim_end_matches('/')] });
    let mut driver = Command::new("unshare");
    driver.args(["--mount", "--propagation", "private", "sh", "-c", NAMESPACE, "sh", terminal]);
    driver.arg(policy.to_string()).arg(named("STEPSCOPE_CHROMEDRIVER")?);
    Program::start(&driver, Says::Line("started successfully on port ")).context("Chromium's driver")
}

/// Opens the page with the scenario, selects the allowed port, and starts.
async fn start_as(page: &Session, known: &Known, role: &str) -> Result<()> {
    page.open(&format!("#{}", known.link)).await?;
    page.click("#device").await?;
    page.until(&format!("{ABOUT}.includes(' baud')")).await?;
    page.click(&format!("[name=live-role][value={role}]")).await?;
    let offered =
        "[...document.querySelectorAll('#live-allowed button')].map((button) => button.textContent)";
    page.until_equal(offered, &json!(["Port allowed before"])).await?;
    page.click("#live-allowed button").await?;
    page.until(&format!("{SAID}.startsWith('Port selected')")).await?;
    ensure!(page.js::<bool>(CLOSED, vec![]).await?, "the port is open before its press");
    page.click("#live-start").await
}

#[test]
fn a_stream_over_a_system_port_is_verified_by_the_device() -> Result<()> {
    let known = Known::of(FRAMED)?;
    let folder = Folder::temporary()?;
    let device = device(&folder, FRAMED)?;
    let page = pool::served(&dist()?)?;
    let driver = driver(&device.address, &page)?;
    in_chromium_of(driver, page, |page| async move {
        start_as(&page, &known, "stream").await?;
        page.until("!document.getElementById('live-close').disabled").await?;
        verified(&page, &known).await?;
        ensure!(page.js::<bool>(CLOSED, vec![]).await?, "the port is not given back");
        // The device ends with its host, and reports its positions.
        let said = async || Ok(device.heard().into_iter().find(|line| line.starts_with("positions ")));
        let end = page.eventually("the device's end", said).await?;
        assert_eq!(end, format!("positions {}", positions(&known).join(" ")));
        Ok(())
    })
}

#[test]
fn a_host_at_a_system_port_is_served_and_recorded() -> Result<()> {
    let known = Known::of(FRAMED)?;
    let folder = Folder::temporary()?;
    let (_socat, own, other) = pair()?;
    let page = pool::served(&dist()?)?;
    let driver = driver(&own, &page)?;
    in_chromium_of(driver, page, |page| async move {
        start_as(&page, &known, "serve").await?;
        page.until(&format!("{SAID} === 'Replying…'")).await?;
        let steps = positions(&known).join(" ");
        let said = sent(&folder, FRAMED, &other)?;
        ensure!(said.contains(&format!("positions {steps}: the sums of the ticks")), "{said}");
        session_opens(&page, &known).await?;
        let closed = async || Ok(page.js::<bool>(CLOSED, vec![]).await?.then_some(()));
        page.eventually("the port given back", closed).await
    })
}
