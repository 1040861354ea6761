//! Compares the picture of the logic view with every record of the trace, also after dragging.

use anyhow::{Result, ensure};
use serde::Deserialize;
use serde_json::{Value, json};
use stepscope_core::inspect::trace::changes::Changes;

use crate::{
    bench::in_browser,
    native::Known,
    session::{ENTER, Session},
};

/// Height of a row, and of a signal in it, in pixels.
const ROW_PX: usize = 22;
/// Width of the labels' column and of the free space at the right.
const BESIDE_PX: usize = 68 + 26;
/// Rows of one expanded channel on a raw line, and the bits of the signals among them, without EN, which is the selected row.
const ROWS: &[(usize, u32, &str)] = &[(1, 33, "RX"), (4, 16, "DIR 0"), (5, 0, "STEP 0")];

/// A dense series of steps, on a line with a low of one cycle while it is idle.
const GLITCHED: &str = r#"{"line":{"glitches":[{"start_cycle":1000000,"length_cycles":1,"level":0}]},
    "source":{"motion":{"axes":[{"moves":[{"constant":{"distance":{"steps":2000},"speed":{"steps_s":20000}}},
    {"dwell":{"duration_s":0.02}},{"constant":{"distance":{"steps":-1},"speed":{"steps_s":100}}}]}]}}}"#;

/// Whether there is ink at the top, in the middle and at the bottom of a row, one character per pixel column.
#[derive(Deserialize)]
struct Row {
    top: String,
    middle: String,
    bottom: String,
}

const READ: &str = "
    const [row, height, beside] = arguments;
    const canvas = document.getElementById('pulses');
    const line = (y) => {
        const { data } = canvas.getContext('2d').getImageData(68, y, canvas.width - beside, 1);
        return Array.from({ length: canvas.width - beside }, (_, x) => data[4 * x + 3] > 100 ? '#' : '.').join('');
    };
    const top = row * height + 4;
    return { top: line(top), middle: line(top + 7), bottom: line(top + 15) };";

/// The expected picture of a row: a bar if a column has both levels, a line if it has one, and an edge in the
/// first column of another level.
fn expected(known: &Known, bit: u32, window: (u64, u64), count: usize) -> Row {
    let trace = &known.recording.trace;
    let mut changes = Changes::default();
    changes.extend(trace);
    let found = changes.columns(trace, window.0, window.1, count, 0);
    let level = |words: &[u64], i: usize| words[i] >> bit & 1 == 1;
    let mut row = Row { top: String::new(), middle: String::new(), bottom: String::new() };
    for i in 0..count {
        let (high, low) = (level(&found.high, i), level(&found.low, i));
        let before = i.checked_sub(1).map(|i| (level(&found.high, i), level(&found.low, i)));
        let edge = high && low || before.is_some_and(|before| before == (low, high) && high != low);
        let ink = |drawn: bool| if drawn { '#' } else { '.' };
        row.top.push(ink(high || edge));
        row.middle.push(ink(edge));
        row.bottom.push(ink(low || edge));
    }
    row
}

/// Types the visible time in s and waits for the picture.
async fn show(page: &Session, from: &str, to: &str) -> Result<()> {
    page.click("#zoom-fit").await?;
    for (field, text) in [("#window-end", to), ("#window-start", from)] {
        page.press(field, &format!("{}a{}{text}{ENTER}", '\u{e009}', '\u{e000}')).await?;
    }
    page.js::<Value>("document.activeElement.blur(); return null;", vec![]).await.map(drop)
}

async fn is_brute_force(page: &Session, known: &Known, window: (u64, u64)) -> Result<()> {
    let count: usize = page.eval(&format!("document.getElementById('pulses').width - {BESIDE_PX}")).await?;
    for &(place, bit, name) in ROWS {
        let wanted = expected(known, bit, window, count);
        page.eventually(&format!("{name} of {window:?} as {}", wanted.middle), async || {
            let row: Row = page.js(READ, vec![json!(place), json!(ROW_PX), json!(BESIDE_PX)]).await?;
            let same = row.top == wanted.top && row.middle == wanted.middle && row.bottom == wanted.bottom;
            Ok(same.then_some(()))
        })
        .await?;
    }
    Ok(())
}

#[test]
fn the_picture_shows_every_record_dense_or_isolated() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(GLITCHED)?;
        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        page.choose("#edge-row", "32").await?;
        let last = known.recording.trace.last().map_or(0, |record| record.cycle.0);
        let hz = u64::from(known.scenario.clock_hz);
        // A glitch of one cycle in a column of many thousands, and series of steps that fill their columns.
        let whole = expected(&known, 33, (0, last), 1000).middle;
        ensure!(whole.contains(".#."), "a lone glitch: {whole}");
        ensure!(expected(&known, 0, (0, last), 1000).middle.contains(&"#".repeat(100)), "a dense train");

        let rows = [
            ("0.01", "0.1", (hz / 100, hz / 10)),
            ("0.0624", "0.0626", (hz * 624 / 10_000, hz * 626 / 10_000)),
            ("0.062499", "0.062501", (hz / 1_000_000 * 62_499, hz / 1_000_000 * 62_501)),
            ("0.02", "0.03", (hz / 50, hz * 3 / 100)),
        ];
        for (from, to, window) in rows {
            show(&page, from, to).await?;
            is_brute_force(&page, &known, window).await?;
        }
        // Dragged, and back to the same position.
        let moved: bool = page
            .js(
                "const canvas = document.getElementById('pulses');
                 for (let i = 0; i < 60; i++) canvas.dispatchEvent(new WheelEvent('wheel', { deltaX: i % 3 ? 40 : -80, deltaY: 0, cancelable: true,
                   clientX: canvas.getBoundingClientRect().left + 400 }));
                 return true;",
                vec![],
            )
            .await?;
        ensure!(moved);
        is_brute_force(&page, &known, (hz / 50, hz * 3 / 100)).await
    })
}
