//! The logic view with mouse and keys: decoders, highlights, markers, edges, violations, the overview.

use anyhow::{Context, Result, ensure};
use fantoccini::actions::{InputSource, MOUSE_BUTTON_LEFT, MouseActions, PointerAction};
use stepscope_core::inspect::packets::log::RowOutcome;
use stepscope_core::{peripheral::trace::Digest, scenario::presets::PRESETS};

use crate::{
    bench::{in_browser, in_sources},
    native::Known,
    session::{ENTER, RELEASE, SHIFT, Session},
};

/// Keys in the notation of WebDriver.
const RIGHT: char = '\u{e014}';
/// See [`RIGHT`].
const ESCAPE: char = '\u{e00c}';
/// Rows of the pulses on a raw line with up to four channels.
const BYTES: usize = 3;
/// See [`BYTES`].
const FIELDS: usize = 4;
/// See [`BYTES`].
const PACKETS: usize = 5;

fn preset(id: &str) -> Result<Known> {
    Known::preset(PRESETS.iter().find(|preset| preset.id == id).with_context(|| id.to_owned())?)
}

/// Opens a scenario by its link and shows the whole run.
async fn open(page: &Session, known: &Known) -> Result<()> {
    page.open(&format!("#{}", known.link)).await?;
    page.until_digest(&known.digest).await
}

/// Moves the mouse to a cycle in a row of the whole run, and clicks.
async fn point(page: &Session, known: &Known, row: usize, cycle: u64, press: bool) -> Result<()> {
    let place = "(({ left, top, width }) => [left, top, width])(document.getElementById('pulses').getBoundingClientRect())";
    let (left, top, width): (f64, f64, f64) = page.eval(place).await?;
    let end = known.experiment.run(&mut Digest::default()).cycles().0;
    let x = (left + 68.0 + (width - 94.0) * cycle as f64 / end as f64).round();
    let y = top + 22.0 * row as f64 + 11.0;
    let mouse = MouseActions::new("mouse".into()).then(PointerAction::MoveTo { duration: None, x, y });
    if !press {
        return page.actions(mouse).await;
    }
    let press = PointerAction::Down { button: MOUSE_BUTTON_LEFT };
    page.actions(mouse.then(press).then(PointerAction::Up { button: MOUSE_BUTTON_LEFT })).await
}

async fn until_reads(page: &Session, what: &str) -> Result<()> {
    page.until(&format!("document.getElementById('hover-reading').textContent.includes('{what}')")).await
}

#[test]
fn selecting_bytes_highlights_their_packet_in_all_views() -> Result<()> {
    in_browser(|page| async move {
        let known = preset("glitches-and-breaks")?;
        open(&page, &known).await?;
        // The decoders are folded at first.
        page.choose("#edge-row", "33").await?;
        page.press("#pulses", &ENTER.to_string()).await?;
        let log = &known.recording.packets;
        // The second packet's first byte was sent as 83 and received as 87.
        assert_eq!(log.bytes(1), [0x87, 0x05]);
        let seen = log.start_bits(1);
        let middle = |byte: usize| seen[byte].0 + 5 * known.experiment.config().bit().0;
        point(&page, &known, BYTES, middle(0), false).await?;
        until_reads(&page, "bytes: 87, sent as 83").await?;
        for overlay in ["charts-cursor", "pulses-cursor"] {
            let highlighted = page.canvas(overlay).await?.colors;
            ensure!(highlighted > 0, "{overlay} shows what is pointed at");
        }
        point(&page, &known, FIELDS, middle(0), false).await?;
        until_reads(&page, "fields: ch0: +7").await?;
        point(&page, &known, FIELDS, middle(1), false).await?;
        until_reads(&page, "fields: ch1: \u{2212}5").await?;

        let broken = log.framing_errors()[0].0 + 5 * known.experiment.config().bit().0;
        point(&page, &known, BYTES, broken, false).await?;
        until_reads(&page, "framing error: stop bit low").await?;
        let ignored =
            log.rows().iter().position(|row| row.outcome == RowOutcome::Ignored).context("some are")?;
        point(&page, &known, FIELDS, log.start_bits(ignored)[0].0 + 100, false).await?;
        until_reads(&page, "ignored: until a gap").await?;

        point(&page, &known, BYTES, middle(1), true).await?;
        page.until("document.querySelector('#packets tr[aria-selected=true]')?.dataset.index === '1'")
            .await?;
        point(&page, &known, PACKETS, log.rows()[0].start.0 + 100, true).await?;
        page.until("document.querySelector('#packets tr[aria-selected=true]')?.dataset.index === '0'").await
    })
}

#[test]
fn frames_and_replies_are_decoded_to_fields() -> Result<()> {
    in_sources(|page| async move {
        let known = preset("framed-link")?;
        open(&page, &known).await?;
        // One frame and its reply fill the view.
        let log = &known.recording.packets;
        let reply = log
            .rows()
            .iter()
            .position(|row| matches!(row.outcome, RowOutcome::Reply(_)))
            .context("a reply")?;
        let (from, to) = (log.rows()[reply - 1].start.0, log.rows()[reply].end.0);
        let asked: serde_json::Value = page
            .js(
                "return import('/engine/engine.js').then(({ Engine }) => new Promise((resolve, reject) => {
                     const engine = new Engine({ progress() {}, failed: (_, text) => reject(new Error(text)), crashed: reject,
                         done: () => engine.request('decoded', arguments[1], arguments[2], 250, 250).then(resolve, reject) });
                     engine.run(0, arguments[0]);
                 }));",
                vec![known.scenario.to_json().into(), from.into(), to.into()],
            )
            .await?;
        let texts = |lane: &str, kind: &str| -> Vec<String> {
            let spans = asked[lane][kind].as_array().cloned().unwrap_or_default();
            spans.iter().map(|span| span["texts"][0].as_str().unwrap_or_default().to_owned()).collect()
        };
        let hex =
            |row: usize| -> Vec<String> { log.bytes(row).iter().map(|byte| format!("{byte:02x}")).collect() };
        assert_eq!(texts("rx", "bytes"), hex(reply - 1));
        assert_eq!(texts("tx", "bytes"), hex(reply));
        assert_eq!(texts("rx", "bits").len(), 10 * hex(reply - 1).len());
        let wanted = [
            ("rx", "kind: "),
            ("rx", ", valid"),
            ("rx", "delimiter: 00"),
            ("tx", "kind: ACK "),
            ("tx", "state: "),
            ("tx", "free: "),
            ("tx", "ticks done: "),
            ("tx", ", valid"),
        ];
        for (lane, wanted) in wanted {
            let found = texts(lane, "fields");
            ensure!(found.iter().any(|text| text.contains(wanted)), "{lane} has no `{wanted}` in {found:?}");
        }
        Ok(())
    })
}

#[test]
fn markers_are_set_by_shift_and_digit_listed_and_removed() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        ensure!(!page.visible("#marker-panel").await?, "no table without a marker");
        page.press("#pulses", "n").await?;
        page.until("document.getElementById('cursor-readings').textContent.startsWith('A ')").await?;
        page.press("#pulses", &format!("{SHIFT}3{RELEASE}")).await?;
        page.until("!document.getElementById('marker-panel').hidden").await?;
        page.press("#pulses", "nn").await?;
        page.until("document.getElementById('pulses-sentence').textContent.includes('edge at')").await?;
        page.click("#marker-set").await?;
        page.click("#marker-panel summary").await?;
        let rows: Vec<Vec<String>> = page
            .eval("[...document.querySelectorAll('#marker-panel tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent))")
            .await?;
        let digits: Vec<&str> = rows.iter().map(|row| row[0].as_str()).collect();
        ensure!(digits == ["3", "0"], "in the order of time: {rows:?}");
        assert_eq!((rows[0][3].as_str(), rows[1][4].as_str()), ("\u{2013}", "0 s"), "{rows:?}");
        ensure!(rows[1][3].ends_with("\u{b5}s") || rows[1][3].ends_with("ms"), "{rows:?}");

        page.press("#pulses", "++++3").await?;
        let shown: (String, String) = page
            .eval("[document.getElementById('window-start').value, document.getElementById('window-end').value]")
            .await?;
        let around =
            |text: &str| text.split(['\u{a0}', ' ']).next().and_then(|number| number.parse::<f64>().ok());
        let (Some(from), Some(to), Some(at)) = (around(&shown.0), around(&shown.1), around(&rows[0][1]))
        else {
            anyhow::bail!("{shown:?}, {rows:?}")
        };
        ensure!(from <= at && at <= to, "{shown:?} does not show {at} ms");
        page.click("#marker-panel [aria-label='Remove marker 3']").await?;
        page.until("document.querySelectorAll('#marker-panel tbody tr').length === 1").await?;
        page.click("#markers-remove").await?;
        page.until("document.getElementById('marker-panel').hidden").await
    })
}

#[test]
fn the_edge_table_matches_the_trace_page_by_page() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of("{}")?;
        open(&page, &known).await?;
        let trace = &known.recording.trace;
        let edges: Vec<u64> = (1..trace.len())
            .filter(|&index| (trace[index].levels.0 ^ trace[index - 1].levels.0) & 1 == 1)
            .map(|index| trace[index].cycle.0)
            .collect();
        page.click("#edge-panel summary").await?;
        for (press, wanted) in
            [("", &edges[..50]), ("#edges-later", &edges[50..100]), ("#edges-earlier", &edges[..50])]
        {
            if !press.is_empty() {
                page.click(press).await?;
            }
            page.until_equal(
                "[...document.querySelectorAll('#edge-panel tbody td:nth-child(2)')].map((cell) => Number(cell.textContent.replace(/\\D/g, '')))",
                &wanted.into(),
            )
            .await?;
        }
        page.choose("#edges-of", "all").await?;
        page.until("document.querySelector('#edge-panel tbody td:nth-child(3)')?.textContent === 'RX'")
            .await?;
        let details: String =
            page.eval("document.getElementById('pulses').getAttribute('aria-details')").await?;
        assert_eq!(details, "edge-panel");
        Ok(())
    })
}

#[test]
fn missing_violations_and_edges_are_reported_in_the_view() -> Result<()> {
    in_browser(|page| async move {
        let known = preset("driver-timing-broken")?;
        open(&page, &known).await?;
        page.until("!document.getElementById('pulses-violations').hidden").await?;
        page.press("#pulses", "v").await?;
        until_reads(&page, "Violation 1 of ").await?;
        page.press("#pulses", &format!("{SHIFT}v{RELEASE}")).await?;
        until_reads(&page, "No more violations").await?;
        page.click("#pulses-violation-next").await?;
        until_reads(&page, "Violation 2 of ").await?;
        page.press("#margins tbody tr:not(.bad) th button", &ENTER.to_string()).await?;
        until_reads(&page, ": shortest ").await?;
        // EN never changes here.
        page.choose("#edge-row", "32").await?;
        page.click("#edge-next").await?;
        until_reads(&page, "EN: no later edge").await?;
        page.until("document.getElementById('pulses-sentence').textContent === 'EN: no later edge.'").await?;
        // The result of a key is announced; without a cursor Escape leaves.
        page.choose("#edge-row", "0").await?;
        page.press("#pulses", &format!("{SHIFT}{RIGHT}{RELEASE}")).await?;
        page.until("/STEP 0 (low|high)/.test(document.getElementById('pulses-sentence').textContent)")
            .await?;
        page.press("#pulses", &ESCAPE.to_string()).await?;
        page.until("document.activeElement.id === 'pulses'").await?;
        page.press("#pulses", &ESCAPE.to_string()).await?;
        page.until("document.activeElement.id !== 'pulses'").await
    })
}

#[test]
fn the_overview_moves_and_resizes_the_range_by_mouse_and_keys() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        let window = "['window-start', 'window-end'].map((id) => document.getElementById(id).value)";
        let whole: (String, String) = page.eval(window).await?;
        page.press("#overview", &format!("{SHIFT}{}{RELEASE}", '\u{e012}')).await?;
        let shorter: (String, String) = page.eval(window).await?;
        ensure!(shorter.0 == whole.0 && shorter.1 != whole.1, "its end comes earlier: {shorter:?}");
        page.press("#overview", &RIGHT.to_string()).await?;
        let moved: (String, String) = page.eval(window).await?;
        ensure!(moved.0 != shorter.0 && moved.1 != shorter.1, "all of it moves: {moved:?}");

        // The mouse drags the right edge to the left.
        let place = "(({ left, top, width }) => [left, top, width])(document.getElementById('overview').getBoundingClientRect())";
        let (left, top, width): (f64, f64, f64) = page.eval(place).await?;
        page.press("#overview", "\u{e011}").await?;
        let y = top + 10.0;
        let mouse = MouseActions::new("mouse".into())
            .then(PointerAction::MoveTo { duration: None, x: (left + width - 26.0).floor(), y })
            .then(PointerAction::Down { button: MOUSE_BUTTON_LEFT })
            .then(PointerAction::MoveTo {
                duration: None,
                x: (left + 68.0 + (width - 94.0) / 2.0).floor(),
                y,
            })
            .then(PointerAction::Up { button: MOUSE_BUTTON_LEFT });
        page.actions(mouse).await?;
        let halved: (String, String) = page.eval(window).await?;
        ensure!(halved.0 == "0 s" && halved.1 != whole.1, "{halved:?} of {whole:?}");
        Ok(())
    })
}

#[test]
fn a_run_of_segments_has_no_serial_line_rows() -> Result<()> {
    in_browser(|page| async move {
        let known = preset("sonobe-2011-segments")?;
        open(&page, &known).await?;
        let rows = 1 + 2 * usize::from(known.experiment.config().channels());
        page.until(&format!(
            "document.getElementById('pulses').getAttribute('aria-label').includes(' {rows} rows')"
        ))
        .await
    })
}
