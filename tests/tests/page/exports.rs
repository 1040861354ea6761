//! Files that the page saves have the same bytes as those of the core.

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use stepscope_core::{
    inspect::export::{
        tables::{write_edges_head, write_edges_row},
        vcd::VcdWriter,
    },
    peripheral::signal::{Record, Sink},
    scenario::Scenario,
};

use crate::{bench::in_browser, exchange::drop_file, native::Known, session::Session};

/// Stores the saved files by name instead of downloading them.
pub(crate) const KEEP: &str = "window.saved = {}; const make = URL.createObjectURL;
    URL.createObjectURL = (blob) => { window.last = blob; return make.call(URL, blob); };
    HTMLAnchorElement.prototype.click = function () { window.saved[this.download] = window.last; };";

/// Presses the button of the file whose name ends like this; returns its name and text.
async fn saved(page: &Session, ends: &str) -> Result<(String, String)> {
    let name: String = page
        .eval(&format!("document.querySelector('[data-file$=\"{ends}\"]').dataset.file"))
        .await
        .with_context(|| format!("no file {ends}"))?;
    page.js::<Value>("delete window.saved[arguments[0]]; return null;", vec![json!(name)]).await?;
    page.click(&format!("[data-file=\"{name}\"]")).await?;
    page.until(&format!("window.saved[{}]", json!(name))).await?;
    let text = page.js("return window.saved[arguments[0]].text();", vec![json!(name)]).await?;
    page.until("!document.querySelector('#export-list button').disabled").await?;
    Ok((name, text))
}

fn vcd(known: &Known, records: &[Record], end: u64) -> Result<String> {
    let (mut bytes, config) = (Vec::new(), known.experiment.config());
    let mut writer = VcdWriter::new(&mut bytes, config.clock_hz(), config.channels())?;
    records.iter().for_each(|record| writer.record(*record));
    writer.finish(end)?;
    Ok(String::from_utf8(bytes)?)
}

fn edges(known: &Known, records: &[Record]) -> Result<String> {
    let (mut text, config) = (String::new(), known.experiment.config());
    write_edges_head(&mut text, config.channels())?;
    for record in records {
        write_edges_row(&mut text, *record, config.clock_hz(), config.channels())?;
    }
    Ok(text)
}

/// The part between two cycles, both included: the first record is the one at `start`.
fn cut(trace: &[Record], start: u64, end: u64) -> Option<Vec<Record>> {
    let before = trace.iter().rfind(|record| record.cycle.0 <= start)?;
    let first = Record { cycle: stepscope_core::peripheral::units::Instant(start), ..*before };
    let rest = trace.iter().filter(|record| (start + 1..=end).contains(&record.cycle.0));
    Some([first].into_iter().chain(rest.copied()).collect())
}

#[test]
fn exported_files_have_the_bytes_of_the_core() -> Result<()> {
    in_browser(|page| async move {
        // More rows than one piece.
        let known = Known::of(
            r#"{"source":{"motion":{"axes":[{"moves":[{"cosine":{"distance":{"steps":12000},"duration_s":2}}]}]}}}"#,
        )?;
        let trace = &known.recording.trace;
        ensure!(trace.len() > 20_000, "{} records", trace.len());
        let cycles = known.experiment.run(&mut Vec::new()).cycles().0;
        page.before_scripts(KEEP).await?;
        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        page.click("#export").await?;
        page.until("document.querySelector('#export-list [data-file]') !== null").await?;
        let (name, text) = saved(&page, ".vcd").await?;
        ensure!(name == "stepscope.vcd" && text == vcd(&known, trace, cycles)?, "{name}: other bytes");
        let (_, text) = saved(&page, "-edges.csv").await?;
        ensure!(text == edges(&known, trace)?, "the table has other bytes");
        let (_, text) = saved(&page, "stepscope.json").await?;
        assert_eq!(Scenario::from_json(&text).ok().as_ref(), Some(&known.scenario));
        let (_, text) = saved(&page, "-line.json").await?;
        assert_eq!(Known::of(&text)?.digest, known.digest, "sent again");

        // The packet table, dropped on the page: the same bytes at the same times.
        let (_, text) = saved(&page, "-packets.csv").await?;
        drop_file(&page, "packets.csv", &text).await?;
        page.until(
            "document.getElementById('link-message').textContent.includes('packets.csv are sent again')",
        )
        .await?;
        page.until_digest(&known.digest).await?;

        // From the middle of a packet, and on an edge.
        let (a, b) = (
            trace.get(9_000).context("a record")?.cycle.0 + 1,
            trace.get(15_000).context("a record")?.cycle.0,
        );
        page.open(&format!("#{}&v=a{a}.b{b}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        page.click("#export").await?;
        page.until("document.querySelector('#export-list [data-file]') !== null").await?;
        page.choose("#export-range", "cursors").await?;
        let part = cut(trace, a, b).context("a part")?;
        let (name, text) = saved(&page, ".vcd").await?;
        assert_eq!(name, format!("stepscope-{a}-{b}.vcd"));
        ensure!(text == vcd(&known, &part, b + 1)?, "the part has other bytes");
        let (_, text) = saved(&page, "-edges.csv").await?;
        ensure!(text == edges(&known, &part)?, "the part's table has other bytes");
        Ok(())
    })
}

#[test]
fn tables_match_the_views_and_long_exports_can_be_canceled() -> Result<()> {
    in_browser(|page| async move {
        page.before_scripts(KEEP).await?;
        page.open("").await?;
        page.preset("driver-timing-broken").await?;
        page.until("document.querySelector('#health').textContent.includes('131 timing violations')").await?;
        page.click("#export").await?;
        page.until("document.querySelector('#export-list [data-file]') !== null").await?;
        let (_, text) = saved(&page, "-violations.csv").await?;
        assert_eq!(text.lines().count(), 132);
        assert_eq!(text.lines().nth(1), Some("2930,0.000183125,0,dir_setup,8,11"));
        let (_, text) = saved(&page, "-margins.csv").await?;
        ensure!(text.contains("step_high,1900,"), "{text}");
        let (_, text) = saved(&page, "-harmonics.csv").await?;
        ensure!(text.starts_with("harmonic,frequency_hz,ideal_position"), "{text}");
        let (_, text) = saved(&page, "-ticks.csv").await?;
        ensure!(text.starts_with("start_cycle,packet,steps0"), "{text}");

        // No request follows the reply to the first piece.
        page.js::<Value>(
            "document.querySelector('[data-file$=\".trace\"]').click(); document.getElementById('export-cancel').click(); return null;",
            vec![],
        )
        .await?;
        page.until("document.getElementById('export-status').textContent.startsWith('Canceled')").await?;
        ensure!(
            page.eval::<bool>("!Object.keys(window.saved).some((name) => name.endsWith('.trace'))").await?,
            "it was saved all the same"
        );
        page.picture("export").await
    })
}
