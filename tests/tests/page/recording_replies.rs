//! Recorded replies on TX in the packet table: of a silent device, of a single one, and of several on one line.

use anyhow::{Context, Result, ensure};
use stepscope_core::inspect::packets::log::RowOutcome;
use stepscope_core::inspect::trace::stored_run::StoredRun;
use stepscope_core::{
    peripheral::{
        signal::{Levels, Record},
        trace::levels_at,
    },
    sim::Experiment,
};

use crate::{
    bench::in_browser,
    native::{Known, link_of},
    recording::{CLOSED, MESSAGE, READY, SHOW, choose_file, saleae},
    session::Session,
};

const FRAMED: &str = r#"{"line":{"protocol":"framed"}}"#;
const TWO: &str = r#"{"line":{"protocol":"framed","address":3},"controllers":[
    {"address":7,"axes":[{"moves":[{"cosine":{"distance":{"steps":200}}}]}]}]}"#;
/// Whether the header shows that the views show a recording.
const ON_SHOW: &str = "document.getElementById('on-show').checkVisibility()";

/// Opens a file and shows it, without the experiment.
async fn open(page: &Session, name: &str, text: &str) -> Result<()> {
    choose_file(page, name, text).await?;
    page.until(READY).await?;
    if page.visible("#recording-compare").await? {
        page.click("#recording-compare").await?;
        page.until(READY).await?;
    }
    page.click(SHOW).await?;
    page.until(CLOSED).await?;
    page.until(&format!("{MESSAGE}.startsWith('Opened {name}')")).await
}

/// Waits until the table has this number of rows.
async fn rows(page: &Session, count: usize) -> Result<()> {
    let said = "document.getElementById('packets-count').textContent.replace(/\\u202f/g, '')";
    page.until(&format!("{said}.startsWith('{count} on the line')")).await
}

#[test]
fn unrecorded_replies_are_those_of_the_model() -> Result<()> {
    in_browser(|page| async move {
        let framed = Known::of(FRAMED)?;
        page.open(&format!("#{}", framed.link)).await?;
        page.until_digest(&framed.digest).await?;
        let all = framed.recording.packets.rows().len();
        let rx =
            saleae(&framed.recording.trace, framed.experiment.config().clock_hz(), &[("RX", Levels::RX)]);
        open(&page, "asked.csv", &rx).await?;
        rows(&page, all).await?;
        page.until(&format!("!{ON_SHOW}")).await?;

        let silent: String = rx
            .lines()
            .enumerate()
            .map(|(line, text)| format!("{text},{}\n", if line == 0 { "TX" } else { "1" }))
            .collect();
        open(&page, "silent.csv", &silent).await?;
        rows(&page, all / 2).await?;
        page.until(ON_SHOW).await?;
        let said = page.text("#link-message").await?;
        ensure!(said.contains("TX has no bytes, so the packets show no replies."), "{said}");
        Ok(())
    })
}

#[test]
fn a_recording_of_replies_only_survives_a_reload() -> Result<()> {
    in_browser(|page| async move {
        let framed = Known::of(FRAMED)?;
        page.open(&format!("#{}", framed.link)).await?;
        page.until_digest(&framed.digest).await?;
        let clock_hz = framed.experiment.config().clock_hz();
        let tx = saleae(&framed.recording.trace, clock_hz, &[("TX", Levels::TX)]);
        open(&page, "replies.csv", &tx).await?;
        let replies = framed.recording.packets.rows().len() / 2;
        page.until(ON_SHOW).await?;
        rows(&page, replies).await?;
        page.until("history.state?.own === false").await?;
        page.client.refresh().await?;
        page.listen().await?;
        page.ready().await?;
        page.until(ON_SHOW).await?;
        rows(&page, replies).await?;
        // The model of another experiment is no recording.
        page.click("#undo").await?;
        page.until_digest(&Known::of("{}")?.digest).await?;
        page.until(&format!("!{ON_SHOW}")).await
    })
}

/// A recording of a line with two controllers: the bytes of the host and of both controllers.
fn at_the_line(traces: [&[Record]; 2]) -> Vec<Record> {
    let mut cycles: Vec<_> =
        traces.iter().flat_map(|trace| trace.iter().map(|record| record.cycle)).collect();
    cycles.sort_unstable();
    cycles.dedup();
    let record = |cycle| {
        let [first, second] = traces.map(|trace| levels_at(trace, cycle));
        // The first one receives the host, and the second one's replies, which are low where it sends a 0.
        let rx = first.has(Levels::RX) || !second.has(Levels::TX);
        let tx = first.has(Levels::TX) && second.has(Levels::TX);
        let level = |high, mask| if high { mask } else { 0 };
        Record { cycle, levels: Levels(level(rx, Levels::RX) | level(tx, Levels::TX)) }
    };
    cycles.into_iter().map(record).collect()
}

#[test]
fn each_controllers_table_has_only_its_recorded_replies() -> Result<()> {
    in_browser(|page| async move {
        let experiment = Experiment::from_json(TWO).ok().context("no problems")?;
        let mut recordings = [StoredRun::default(), StoredRun::default()];
        let run = experiment.run_each(&mut recordings);
        let answered = recordings.each_ref().map(|one| {
            one.packets.rows().iter().filter(|row| matches!(row.outcome, RowOutcome::Reply(_))).count()
        });
        ensure!(answered[0] > 5 && answered[1] > 5, "{answered:?}");
        let asked = run.schedule().len();
        assert_eq!(asked, answered[0] + answered[1]);

        page.open(&format!("#{}", link_of(TWO)?)).await?;
        page.ready().await?;
        let trace = at_the_line(recordings.each_ref().map(|one| one.trace.as_slice()));
        let clock_hz = experiment.config().clock_hz();
        open(&page, "line.csv", &saleae(&trace, clock_hz, &[("RX", Levels::RX), ("TX", Levels::TX)])).await?;
        page.until(ON_SHOW).await?;
        for (controller, own) in answered.into_iter().enumerate() {
            page.choose("#controller", &controller.to_string()).await?;
            rows(&page, asked + own).await.with_context(|| format!("controller {controller}"))?;
        }
        let said = page.text("#link-message").await?;
        ensure!(!said.contains("nothing says"), "all name their controller: {said}");
        Ok(())
    })
}
