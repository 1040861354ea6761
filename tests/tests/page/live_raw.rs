//! Raw packets from the page, with a lead and without replies (LIVE H4), to a simulated device at the mock's port.

use anyhow::{Context as _, Result, ensure};
use serde::Deserialize;
use serde_json::{Value, json};
use stepscope_core::sim::raw_host::RawHost;

use crate::{
    axe,
    bench::in_browser,
    device::{ABOUT, ENDED, FRAMED, REPORT, SAID, STANDING, open_beside, positions, start},
    native::Known,
    session::{Session, field},
};

/// Ticks of 20 ms, two channels and an address. The queue lasts longer than the delays of a busy machine.
const SHORT: &str = r#"{"line":{"protocol":"raw","address":7},
    "bus":{"channels":2,"step_period_cycles":3200,"queue_depth":250,"self_test_cycles":0},
    "source":{"motion":{"axes":[{"moves":[{"cosine":{"distance":{"steps":400},"duration_s":1}}]},{"moves":[{"cosine":{"distance":{"steps":-300},"duration_s":1}}]}]}}}"#;
/// Long enough to be stopped before its end, on any machine.
const LONG: &str = r#"{"line":{"protocol":"raw"},"bus":{"step_period_cycles":3200,"queue_depth":250,"self_test_cycles":0},
    "source":{"motion":{"axes":[{"moves":[{"cosine":{"distance":{"steps":9000},"duration_s":20}}]}]}}}"#;
const LEAD_NS: u64 = 200_000_000;

/// The last reported state of the controller at the other end.
#[derive(Debug, Deserialize)]
struct Peer {
    positions: Vec<i32>,
    faults: Vec<String>,
    ticks_done: u32,
}

const PEER: &str = "peer.told.findLast(({ state }) => state?.controllers)?.state.controllers[0]";

async fn peer(page: &Session) -> Result<Peer> {
    page.eval(PEER).await
}

/// Selects the port, starts, and waits until some packets are sent.
async fn start_long(page: &Session) -> Result<()> {
    start(page).await?;
    page.until(&format!("Number({STANDING}.match(/^(\\d+) of/)?.[1] ?? 0) > 20")).await
}

#[test]
fn raw_packets_are_executed_but_not_reported_as_verified() -> Result<()> {
    in_browser(|page| async move {
        let known = open_beside(&page, (SHORT, "serve", true)).await?;
        let host =
            RawHost::with_slack(&known.experiment, LEAD_NS).ok().context("the queue is deep enough")?;
        let (lead, packets) = (host.lead(), known.experiment.schedule().len());
        page.until(&format!(
            "{ABOUT}.includes('{packets} packets, {lead} packets (200 ms) ahead, 115200 baud.')"
        ))
        .await?;
        start(&page).await?;
        page.until(ENDED).await?;
        let said: String = page.eval(SAID).await?;
        ensure!(said.starts_with("Not verified: raw packets get no reply. All "), "{said}");
        let report: String = page.eval(REPORT).await?;
        for part in [
            format!("sent {packets} of {packets} packets; not verified: raw packets are not answered"),
            "late median <=".to_owned(),
            " ms, 99 % <=".to_owned(),
            " ms, worst ".to_owned(),
        ] {
            ensure!(report.contains(&part), "{part} is not in\n{report}");
        }
        // The reported lateness applies to the motor, too.
        assert_eq!(
            report.contains("the motor must have stopped before"),
            said.contains("The motor stopped before")
        );
        // The motion of the model, packet by packet, regardless of their times.
        let steps = positions(&known);
        page.until_equal(&format!("{PEER}?.positions.map(String)"), &json!(steps)).await?;
        let Peer { faults, .. } = peer(&page).await?;
        assert_eq!(faults, Vec::<String>::new());
        ensure!(page.eval::<bool>("document.querySelector('#live-twin').childElementCount === 0").await?);
        let mut wrong = Vec::new();
        axe::look(&page, "the report of raw packets", &mut wrong).await?;
        page.picture("device-raw").await?;
        axe::none(&wrong)
    })
}

#[test]
fn stop_ends_raw_packets_and_the_device_finishes_its_queue() -> Result<()> {
    in_browser(|page| async move {
        let known = open_beside(&page, (LONG, "serve", true)).await?;
        // There is nothing to stop, and a raw line has no STOP.
        page.click("#live-choose").await?;
        page.until("!document.getElementById('live-start').disabled").await?;
        ensure!(page.eval::<bool>("document.getElementById('live-stop').disabled").await?);
        start_long(&page).await?;
        page.click("#live-stop").await?;
        page.until(ENDED).await?;
        let said: String = page.eval(SAID).await?;
        let packets = known.experiment.schedule().len();
        let sent = said.strip_prefix("Stopped sending after ").and_then(|rest| rest.split(' ').next());
        let sent: u32 = sent.and_then(|sent| sent.parse().ok()).with_context(|| said.clone())?;
        ensure!((21..packets as u32).contains(&sent), "{said}");
        ensure!(said.contains("a raw line has no STOP, and the device still executes its queue"), "{said}");
        let report: String = page.eval(REPORT).await?;
        ensure!(report.contains("stopped sending: queued packets still run"), "{report}");
        // Everything that was sent is executed, and no more.
        page.until(&format!("{PEER}.ticks_done === {sent}")).await?;
        let ticks = known.experiment.ticks_of(0).get(..sent as usize).unwrap_or_default();
        let steps = |tick: &u8| i32::from(tick & 0x7f) * if tick & 0x80 == 0 { -1 } else { 1 };
        assert_eq!(peer(&page).await?.positions, [ticks.iter().map(steps).sum::<i32>()]);
        Ok(())
    })
}

#[test]
fn raw_packets_clear_the_replies_of_an_earlier_stream() -> Result<()> {
    in_browser(|page| async move {
        open_beside(&page, (FRAMED, "serve", true)).await?;
        ensure!(page.eval::<bool>("document.querySelector('.live-replies .note').hidden").await?);
        start(&page).await?;
        page.until(ENDED).await?;
        let rows = "document.querySelectorAll('#view-packets .live-replies tbody tr').length";
        ensure!(page.eval::<u32>(rows).await? > 0);
        page.choose(&field("line.protocol"), "raw").await?;
        page.ready().await?;
        page.click("#live-aside").await?;
        page.until(&format!("{ABOUT}.includes('ahead')")).await?;
        page.click("#live-start").await?;
        page.until("peer.opened.length === 2").await?;
        assert_eq!(page.eval::<u32>(rows).await?, 0);
        // The packets of the model are sent.
        ensure!(page.visible("#packets").await? && !page.visible("#view-packets .live-replies").await?);
        page.until("peer.closed === 2").await?;
        page.click("#live-close").await?;
        page.click("#packets-of-device").await?;
        page.until("document.querySelector('.live-replies').innerText === 'Raw packets get no reply.'").await
    })
}

#[test]
fn a_lost_port_ends_raw_packets_and_is_reported() -> Result<()> {
    in_browser(|page| async move {
        let known = open_beside(&page, (LONG, "serve", true)).await?;
        start_long(&page).await?;
        page.eval::<Value>("peer.lose() ?? null").await?;
        page.until(ENDED).await?;
        let said: String = page.eval(SAID).await?;
        let lost =
            "Not verified: the port is lost: The device has been lost; the device still executes its queue";
        ensure!(said.starts_with(lost), "{said}");
        let report: String = page.eval(REPORT).await?;
        let packets = known.experiment.schedule().len();
        ensure!(report.contains(&format!(" of {packets} packets; not verified")), "{report}");
        ensure!(peer(&page).await?.ticks_done < packets as u32);
        Ok(())
    })
}

#[test]
fn a_lead_longer_than_the_queue_is_rejected_with_its_numbers() -> Result<()> {
    in_browser(|page| async move {
        for json in ["{}", r#"{"bus":{"step_period_cycles":1000,"queue_depth":20}}"#] {
            let known = Known::of(json)?;
            let refused =
                RawHost::with_slack(&known.experiment, LEAD_NS).err().context("the queue is too short")?;
            page.open(&format!("#{}", known.link)).await?;
            page.js::<bool>(
                "Object.defineProperty(navigator, 'serial', { configurable: true, value: { getPorts: async () => [] } }); return true;",
                vec![],
            )
            .await?;
            page.click("#device").await?;
            page.until("document.getElementById('live-about')").await?;
            page.click("[name=live-role][value=stream]").await?;
            page.until(&format!("{ABOUT}.includes({})", json!(refused.to_string()))).await?;
            ensure!(page.eval::<bool>("document.getElementById('live-start').disabled").await?);
        }
        Ok(())
    })
}
