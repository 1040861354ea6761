//! What loading takes: which files, and (measured on request) how long.

use anyhow::{Result, ensure};
use serde::Deserialize;
use stepscope_core::scenario::presets::PRESETS;

use crate::{
    bench::in_browser_shipped,
    session::{CONTROL, Session},
};

/// Notes, from the document's beginning on, what the browser measures of the visit.
const OBSERVE: &str = "{
    window.seen = { lcp: 0, lcpOf: '', cls: 0, inp: 0, inpOf: '', shifted: [], fetched: [] };
    const observe = (type, note, options = {}) => new PerformanceObserver((list) => list.getEntries().forEach(note))
        .observe({ type, buffered: true, ...options });
    observe('largest-contentful-paint', (entry) => { seen.lcp = entry.startTime; seen.lcpOf = String(entry.element?.id || entry.element?.className || entry.element?.tagName); });
    observe('layout-shift', (entry) => { if (!entry.hadRecentInput) { seen.cls += entry.value;
        seen.shifted.push(...entry.sources.map(({ node, previousRect: from, currentRect: to }) => `${node?.id || node?.className || node?.nodeName} in ${node?.parentElement?.className} \
        ${[from.x, from.y, from.width, from.height]} to ${[to.x, to.y, to.width, to.height]}`)); } });
    observe('event', (entry) => { if (entry.interactionId && entry.duration > seen.inp) { seen.inp = entry.duration; seen.inpOf = entry.name; } }, { durationThreshold: 16 });
    const { fetch } = window;
    window.fetch = (...given) => { seen.fetched.push(String(given[0]?.url ?? given[0])); return fetch(...given); };
}";

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Seen {
    lcp: f64,
    lcp_of: String,
    cls: f64,
    inp: f64,
    inp_of: String,
    shifted: Vec<String>,
    fetched: Vec<String>,
}

async fn seen(page: &Session) -> Result<Seen> {
    page.eval("window.seen").await
}

#[test]
fn all_that_loads_is_of_this_site_and_the_core_is_fetched_once() -> Result<()> {
    in_browser_shipped(|page| async move {
        page.before_scripts(OBSERVE).await?;
        page.open("").await?;
        let names: Vec<String> =
            page.eval("performance.getEntriesByType('resource').map(({ name }) => name)").await?;
        ensure!(names.len() > 10, "{names:?}");
        for name in &names {
            ensure!(name.starts_with(page.address()), "{name} is of another site");
        }
        let seen = seen(&page).await?;
        assert_eq!(seen.fetched.len(), 1, "{:?}", seen.fetched);
        ensure!(seen.fetched[0].ends_with(".wasm"), "{:?}", seen.fetched);
        assert_eq!(names.iter().filter(|name| name.ends_with(".wasm")).count(), 1, "{names:?}");
        Ok(())
    })
}

#[test]
fn nothing_moves_while_the_page_comes_in() -> Result<()> {
    in_browser_shipped(|page| async move {
        page.before_scripts(OBSERVE).await?;
        for (width, height) in [(1440, 900), (1024, 768), (390, 844)] {
            page.screen(width, height).await?;
            page.open("").await?;
            let seen = seen(&page).await?;
            ensure!(seen.cls == 0.0, "{width} x {height}: {} by {:?}", seen.cls, seen.shifted);
        }
        Ok(())
    })
}

/// `cargo xtask test --only page` leaves this out: times say more of the machine than of the page.
#[test]
#[ignore = "prints times"]
fn measured() -> Result<()> {
    in_browser_shipped(|page| async move {
        page.before_scripts(OBSERVE).await?;
        for (width, height) in [(1440, 900), (390, 844)] {
            page.screen(width, height).await?;
            for visit in ["first", "second", "third"] {
                page.open("").await?;
                let stands: f64 = page.eval("performance.now()").await?;
                let seen = seen(&page).await?;
                println!(
                    "{width} x {height}, {visit} visit: LCP {:.0} ms ({}), first result {stands:.0} ms, CLS {}",
                    seen.lcp, seen.lcp_of, seen.cls
                );
            }
        }
        page.screen(1440, 900).await?;
        for preset in PRESETS {
            page.open("").await?;
            page.choose("#preset", preset.id).await?;
            page.ready().await?;
            for key in ["+", "+", "\u{e014}", "\u{e014}", "n", "-", "\u{e011}"] {
                page.press("#pulses", key).await?;
            }
            for key in ["\u{e014}", "\u{e012}"] {
                page.press("#charts", key).await?;
            }
            // Segments that run alone have no queue.
            let queue = page
                .eval::<bool>("Boolean(document.querySelector('[data-path=\"bus.queue_depth\"]'))")
                .await?;
            page.fill(if queue { "bus.queue_depth" } else { "bus.pulse_width_cycles" }, "9").await?;
            page.ready().await?;
            page.press("body", &format!("{CONTROL}z")).await?;
            page.ready().await?;
            page.js::<()>("return new Promise((done) => setTimeout(done, 300));", vec![]).await?;
            let seen = seen(&page).await?;
            let status = page.text("#status").await?;
            println!("{}: INP {:.0} ms ({}); {status}", preset.id, seen.inp, seen.inp_of);
        }
        Ok(())
    })
}
