//! The packets: search, filters, highlights, and the inspector compared with the core.

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use stepscope_core::inspect::packets::log::RowOutcome;
use stepscope_core::{
    inspect::packets::dissector::{Dissection, Dissector},
    peripheral::{config::Protocol, protocol::FrameOutcome},
    scenario::presets::PRESETS,
};

use crate::{
    bench::{in_browser, in_sources},
    native::Known,
    session::{CONTROL, ENTER, RELEASE, Session, WINDOW_S},
};

/// A preset by its name, natively.
fn preset(id: &str) -> Result<Known> {
    Known::preset(PRESETS.iter().find(|preset| preset.id == id).with_context(|| id.to_owned())?)
}

/// Opens a preset and waits for its run.
async fn open(page: &Session, known: &Known) -> Result<()> {
    page.open(&format!("#{}", known.link)).await?;
    page.until_digest(&known.digest).await?;
    page.js::<bool>("return document.getElementById('packet-inspector').open = true;", vec![]).await.map(drop)
}

/// The core's dissection of a row.
fn meaning(known: &Known, index: usize) -> Dissection {
    let config = known.experiment.config();
    let channels = |address| {
        let named = known.experiment.configs().find(|config| config.address() == Some(address));
        named.unwrap_or(config).channels()
    };
    let log = &known.recording.packets;
    Dissector {
        protocol: config.protocol(),
        addressed: config.packet_address().is_some(),
        channels: &channels,
    }
    .dissect(log.bytes(index), log.rows()[index].outcome)
}

/// Replaces the text of the search.
async fn search(page: &Session, text: &str) -> Result<()> {
    page.press("#packets-search", &format!("{CONTROL}a{RELEASE}{text}")).await
}

/// Numbers of the rows in the document.
const ROWS: &str =
    "[...document.querySelectorAll('#packets tbody tr')].map((row) => Number(row.dataset.index))";
const CURRENT: &str = "Number(document.querySelector('#packets tr.current')?.dataset.index ?? -1)";
const FOUND: &str = "document.getElementById('packets-found').textContent";
const COUNT: &str = "document.getElementById('packets-count').textContent";
const LIT: &str =
    "[...document.querySelectorAll('#packet-bytes > .highlighted')].map((cell) => Number(cell.id.slice(5)))";

#[test]
fn search_steps_through_matches_and_filter_hides_other_rows() -> Result<()> {
    let known = preset("framed-noisy-line")?;
    in_browser(move |page| async move {
        open(&page, &known).await?;
        let log = &known.recording.packets;
        let with = |wanted: &dyn Fn(usize) -> bool| {
            (0..log.rows().len()).filter(|&row| wanted(row)).collect::<Vec<_>>()
        };
        let bad =
            with(&|row| matches!(log.rows()[row].outcome, RowOutcome::Frame(FrameOutcome::BadCrc { .. })));
        ensure!(bad.len() > 2, "the noise breaks frames");
        let all = log.rows().len();

        // Words: the first match, the next ones, and the first one again.
        search(&page, "crc").await?;
        for (rank, row) in bad.iter().enumerate().chain([(0, &bad[0])]) {
            page.until_equal(FOUND, &json!(format!("{} of {}", rank + 1, bad.len()))).await?;
            page.until_equal(CURRENT, &json!(row)).await?;
            page.press("#packets-search", &ENTER.to_string()).await?;
        }
        page.until_equal(COUNT, &json!(format!("{all} on the line"))).await?;

        // Only the matches are visible, and all rows again without the filter.
        page.click("#packets-filters").await?;
        page.click("#packets-only").await?;
        page.until_equal(COUNT, &json!(format!("{} of {all} on the line", bad.len()))).await?;
        page.press("#packets", "\u{e011}").await?;
        page.until_equal(&format!("({ROWS})[0]"), &json!(bad[0])).await?;
        let shown: Vec<usize> = page.eval(ROWS).await?;
        ensure!(shown.iter().zip(&bad).all(|(a, b)| a == b), "{shown:?}, wanted {bad:?}");

        // The bytes of a frame, without spaces, occur in all its repetitions.
        let bytes = log.bytes(2);
        let hex: String = bytes.iter().take(8).map(|byte| format!("{byte:02x}")).collect();
        let same = with(&|row| log.bytes(row).windows(8).any(|part| part == &bytes[..8]));
        search(&page, &hex).await?;
        page.until_equal(COUNT, &json!(format!("{} of {all} on the line", same.len()))).await?;
        // Text that is not hexadecimal is reported.
        search(&page, "0x8z").await?;
        page.until("document.getElementById('packets-note').textContent.includes('is not hexadecimal')")
            .await?;
        page.until("document.getElementById('packets-empty').textContent.startsWith('No row matches.')")
            .await?;
        page.click("#packets-unmatched").await?;
        page.until_equal(COUNT, &json!(format!("{all} on the line"))).await?;

        // Outcome, and kind with outcome.
        page.choose("#packets-by-outcome", "repeated").await?;
        let repeated = with(&|row| log.rows()[row].outcome == RowOutcome::Frame(FrameOutcome::Repeated));
        page.until_equal(COUNT, &json!(format!("{} of {all} on the line", repeated.len()))).await?;
        page.choose("#packets-by-kind", "reply").await?;
        page.until_equal(COUNT, &json!(format!("0 of {all} on the line"))).await?;
        page.choose("#packets-by-outcome", "good").await?;
        let replies =
            with(&|row| matches!(log.rows()[row].outcome, RowOutcome::Reply(reply) if reply.result.is_ok()));
        page.until_equal(COUNT, &json!(format!("{} of {all} on the line", replies.len()))).await?;
        page.picture("packets-filtered").await
    })
}

#[test]
fn an_address_hides_packets_for_other_addresses() -> Result<()> {
    let known = preset("patent-2019-addressed")?;
    in_browser(move |page| async move {
        open(&page, &known).await?;
        let log = &known.recording.packets;
        let foreign = (0..log.rows().len()).filter(|&row| log.bytes(row)[0] == 8).count();
        ensure!(foreign > 0);
        page.click("#packets-filters").await?;
        page.choose("#packets-by-address", "8").await?;
        page.until_equal(COUNT, &json!(format!("{foreign} of {} on the line", log.rows().len()))).await
    })
}

/// Compares the inspector with the core, row by row.
async fn inspected(page: &Session, known: &Known, rows: usize) -> Result<()> {
    let log = &known.recording.packets;
    for index in 0..rows {
        search(page, &format!("#{index}")).await?;
        page.until(&format!("document.getElementById('packet-detail').textContent.startsWith('#{index} ')"))
            .await?;
        let bytes: Vec<String> = page
            .eval("[...document.querySelectorAll('#packet-bytes > *')].map((cell) => cell.textContent)")
            .await?;
        let expected: Vec<String> = log.bytes(index).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(bytes, expected, "row {index}");
        let told: Vec<String> = page
            .eval("[...document.querySelectorAll('#packet-fields > *')].map((cell) => cell.textContent)")
            .await?;
        let fields = meaning(known, index).fields;
        let expected: Vec<String> = fields
            .iter()
            .map(|field| {
                let (first, last) = (field.bytes.start, field.bytes.end - 1);
                let range = if first == last { first.to_string() } else { format!("{first}\u{2013}{last}") };
                // Longer layouts explain their bits only at the pointer.
                let explained = if fields.len() <= 24 { field.bits.as_slice() } else { &[] };
                let bits =
                    explained.iter().map(|bits| format!("{} {} {}", bits.levels, bits.name, bits.value));
                format!("{} {} [{range}]{}", field.name, field.value, bits.collect::<String>())
            })
            .collect();
        assert_eq!(told, expected, "row {index}");
    }
    Ok(())
}

#[test]
fn the_inspector_decodes_frames_and_replies_like_the_core() -> Result<()> {
    let known = preset("framed-link")?;
    in_browser(move |page| async move {
        assert_eq!(known.experiment.config().protocol(), Protocol::Framed);
        open(&page, &known).await?;
        inspected(&page, &known, 4).await?;
        let facts = page.text("#packet-facts").await?;
        ensure!(
            facts.contains("turnaround") && facts.contains("of #2") && facts.contains("DE rises"),
            "{facts}"
        );
        Ok(())
    })
}

#[test]
fn the_inspector_decodes_raw_packets_like_the_core() -> Result<()> {
    let known = preset("patent-2019-addressed")?;
    in_browser(move |page| async move {
        open(&page, &known).await?;
        inspected(&page, &known, known.recording.packets.rows().len()).await?;
        let facts = page.text("#packet-facts").await?;
        ensure!(facts.contains("raw packets have no CRC"), "{facts}");
        Ok(())
    })
}

#[test]
fn a_field_highlights_its_bytes_and_waveform_and_vice_versa() -> Result<()> {
    let known = preset("framed-link")?;
    in_browser(move |page| async move {
        open(&page, &known).await?;
        // The packet alone in the window.
        page.click("#packet-2 td").await?;
        page.until("document.getElementById('packet-detail').textContent.startsWith('#2 ')").await?;
        let fields = meaning(&known, 2).fields;
        let check = fields.iter().position(|field| field.name == "CRC").context("a CRC")?;
        page.press("#packet-fields", "\u{e010}\u{e012}").await?;
        let bytes: Vec<usize> = fields[check].bytes.clone().collect();
        page.until_equal(LIT, &json!(bytes)).await?;
        page.until(&format!(
            "document.getElementById('packet-fields').getAttribute('aria-activedescendant') === 'field-{check}'"
        ))
        .await?;
        let reading = page.text("#packet-reading").await?;
        ensure!(reading.starts_with(&format!("bytes {} to {}", bytes[0], bytes[3])), "{reading}");
        // The same mark is above the pulses.
        let marked = "(() => { const canvas = document.getElementById('pulses-cursor'); const { data } = canvas.getContext('2d')
            .getImageData(0, 0, canvas.width, canvas.height); return data.some((value) => value !== 0); })()";
        page.until(marked).await?;
        page.press("#packet-fields", "\u{e00c}").await?;
        page.until_equal(LIT, &json!([])).await?;
        page.until(&format!("!({marked})")).await?;
        // A row also highlights its part of the line; it is marked itself.
        let over = "document.querySelector('#packet-2').dispatchEvent(new PointerEvent('pointerover', { bubbles: true }));";
        page.js::<Value>(over, Vec::new()).await?;
        page.until("document.querySelector('#packet-2').classList.contains('highlighted')").await?;
        page.until(marked).await
    })
}

#[test]
fn bytes_are_copied_as_hex_or_selected_without_clipboard() -> Result<()> {
    let known = preset("framed-link")?;
    in_browser(move |page| async move {
        let clipboard = "globalThis.copied = []; globalThis.refuses = false;
            Object.defineProperty(navigator, 'clipboard', { value: { writeText: async (text) => {
                if (globalThis.refuses) throw new Error('refused');
                globalThis.copied.push(text); } } });";
        page.before_scripts(clipboard).await?;
        open(&page, &known).await?;
        let log = &known.recording.packets;
        let hex = |row: usize| {
            log.bytes(row).iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().join(" ")
        };
        page.press("#packets", "\u{e015}c").await?;
        page.until_equal("globalThis.copied", &json!([hex(1)])).await?;
        page.press("#packets-copy-all", &ENTER.to_string()).await?;
        let all: String = (0..log.rows().len()).map(|row| hex(row) + "\n").collect();
        page.until_equal("globalThis.copied.at(-1)", &json!(all)).await?;
        page.js::<Value>("globalThis.refuses = true;", Vec::new()).await?;
        page.press("#packets", "c").await?;
        page.until("document.activeElement.id === 'packets-copied-text'").await?;
        page.until_equal(
            "getSelection().toString() || document.getElementById('packets-copied-text').value",
            &json!(hex(1)),
        )
        .await
    })
}

#[test]
fn files_have_all_rows_visible_rows_or_rows_between_cursors() -> Result<()> {
    let known = preset("framed-noisy-line")?;
    in_sources(move |page| async move {
        open(&page, &known).await?;
        let log = &known.recording.packets;
        let made = "const { packetFiles } = await import('./views/packets/files.js');
            const { Engine } = await import('./engine/engine.js');
            const engine = new Engine({ progress() {}, failed() {}, crashed() {}, done: () => ready() });
            let ready; const ran = new Promise((resolve) => { ready = resolve; });
            engine.run(0, arguments[0]); await ran;
            const filter = { text: '', kind: '', address: null, outcome: 'bad', only: false };
            await engine.request('filter', '', '', null, 'bad', false);
            const state = { result: {}, filter, cursors: { a: arguments[2], b: arguments[1] } };
            const files = {};
            for (const { name, make } of packetFiles(state, engine)) {
                const bytes = new Uint8Array(await new Blob(await make(() => {})).arrayBuffer());
                files[name] = name.endsWith('bin') ? bytes.length : new TextDecoder().decode(bytes).trimEnd().split('\\n').length;
            }
            return files;";
        let (a, b) = (log.rows()[5].start.0, log.rows()[9].start.0);
        let script = format!("return (async () => {{ {} }})()", made.replace("arguments", "given"));
        let script = format!("const given = arguments; {script}");
        let files: Value =
            page.js(&script, vec![json!(known.scenario.to_json()), json!(a), json!(b)]).await?;
        let bytes: usize = (0..log.rows().len()).map(|row| log.bytes(row).len()).sum();
        let all = log.rows().len();
        assert_eq!(
            (&files["stepscope-packets.csv"], &files["stepscope-packets.txt"]),
            (&json!(all + 1), &json!(all))
        );
        assert_eq!(files["stepscope-packets.bin"], json!(bytes));
        let between = files["stepscope-packets-a-b.csv"].as_u64().context("a table")?;
        ensure!((6..=7).contains(&between), "rows 5 to 9 and the head, and one that ends there: {between}");
        page.click("#packets-filters").await?;
        page.choose("#packets-by-outcome", "bad").await?;
        let shown = files["stepscope-packets-shown.txt"].as_u64().context("lines")?;
        page.until_equal(COUNT, &json!(format!("{shown} of {all} on the line"))).await?;
        Ok(())
    })
}

#[test]
fn an_empty_table_explains_why() -> Result<()> {
    let known = preset("sonobe-2011-segments")?;
    in_browser(move |page| async move {
        open(&page, &known).await?;
        page.until("document.getElementById('packets-empty').checkVisibility()").await?;
        let said = page.text("#packets-empty").await?;
        assert_eq!(said, "The controller runs segments: nothing is on the line.");
        ensure!(!page.visible("#packet-inspector").await? && !page.visible("#packets-unmatched").await?);
        Ok(())
    })
}

#[test]
fn narrow_tables_need_no_horizontal_scrolling() -> Result<()> {
    let known = preset("framed-noisy-line")?;
    in_browser(move |page| async move {
        open(&page, &known).await?;
        for (width, height) in [(1440, 900), (1024, 768), (390, 844)] {
            page.screen(width, height).await?;
            if width < 900 {
                page.click("#tab-packets").await?;
            }
            page.until("document.getElementById('packets-scroll').clientHeight > 90").await?;
            page.until("['packets-scroll', 'packet-inspector'].every((id) => { const box = document.getElementById(id); \
                return box.scrollWidth <= box.clientWidth; })")
                .await?;
            // The outcome is never cut off.
            page.until("[...document.querySelectorAll('#packets td:nth-child(5)')].every((cell) => cell.scrollWidth <= cell.clientWidth)")
                .await?;
            page.picture(&format!("packets-{width}")).await?;
        }
        Ok(())
    })
}

#[test]
fn a_fault_in_the_header_leads_to_its_row_and_reason() -> Result<()> {
    let known = preset("patent-2019-addressed")?;
    let log = &known.recording.packets;
    let short = log.rows().iter().position(|row| row.outcome == RowOutcome::Short).context("one is cut")?;
    in_browser(move |page| async move {
        open(&page, &known).await?;
        assert_eq!(page.text("#health").await?, "faults: SHORT_PACKET, TOO_MANY_STEPS");
        page.click("#health button").await?;
        page.until(&format!("{CURRENT} === {short}")).await?;
        let why = "2 of 3 bytes, then 45 bit times of silence";
        page.until(&format!("document.getElementById('packet-detail').textContent.endsWith('{why}')"))
            .await?;
        let titles = "[...document.querySelectorAll('#packets tr.current td')].map((cell) => cell.title)";
        ensure!(page.eval::<Vec<String>>(titles).await?.contains(&format!("dropped: SHORT_PACKET: {why}")));
        let edge = known.recording.packets.rows()[short].end.0;
        let window = page.eval::<Vec<f64>>(WINDOW_S).await?;
        let at = edge as f64 / f64::from(known.experiment.config().clock_hz());
        ensure!(window.len() == 2 && window[0] < at && at < window[1], "{at} s is not within {window:?}");
        Ok(())
    })
}
