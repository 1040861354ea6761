//! Loading of the page: which files load, and a stable layout.

use anyhow::{Result, ensure};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::{
    bench::in_browser,
    native::{link_of, with_distance},
    session::Session,
};

/// Records the browser's measurements of the visit, from the start of the document on.
const OBSERVE: &str = "{
    window.seen = { cls: 0, shifted: [], fetched: [] };
    const observe = (type, note) => new PerformanceObserver((list) => list.getEntries().forEach(note)).observe({ type, buffered: true });
    observe('layout-shift', (entry) => { if (!entry.hadRecentInput) { seen.cls += entry.value;
        seen.shifted.push(...entry.sources.map(({ node, previousRect: from, currentRect: to }) => `${node?.id || node?.className || node?.nodeName} in ${node?.parentElement?.className} \
        ${[from.x, from.y, from.width, from.height]} to ${[to.x, to.y, to.width, to.height]}`)); } });
    const { fetch } = window;
    window.fetch = (...given) => { seen.fetched.push(String(given[0]?.url ?? given[0])); return fetch(...given); };
}";

#[derive(Debug, Deserialize)]
struct Seen {
    cls: f64,
    shifted: Vec<String>,
    fetched: Vec<String>,
}

async fn seen(page: &Session) -> Result<Seen> {
    page.eval("window.seen").await
}

async fn seen_fetches(page: &Session) -> Result<usize> {
    Ok(seen(page).await?.fetched.len())
}

#[test]
fn each_module_is_loaded_once_from_this_site() -> Result<()> {
    in_browser(|page| async move {
        page.before_scripts(OBSERVE).await?;
        page.open("").await?;
        // The tools load in the background, after the first result.
        page.until("performance.getEntriesByType('resource').filter(({ name }) => name.endsWith('.wasm')).length === 2")
            .await?;
        let names: Vec<String> =
            page.eval("performance.getEntriesByType('resource').map(({ name }) => name)").await?;
        ensure!(names.len() > 10, "{names:?}");
        for name in &names {
            ensure!(name.starts_with(page.address()), "{name} is of another site");
        }
        let seen = seen(&page).await?;
        assert_eq!(seen.fetched.len(), 2, "{:?}", seen.fetched);
        ensure!(seen.fetched.iter().all(|name| name.ends_with(".wasm")), "{:?}", seen.fetched);
        let core: String = page.eval("document.getElementById('core').href").await?;
        assert_eq!(seen.fetched[0], core, "the first screen's module comes first");
        page.click("#study").await?;
        page.until("document.querySelector('.study-panel td') !== null").await?;
        assert_eq!(seen_fetches(&page).await?, 2, "the study uses the module that is there");
        Ok(())
    })
}

#[test]
fn a_link_loads_only_visible_views() -> Result<()> {
    in_browser(|page| async move {
        page.open(&format!("#{}", link_of(&with_distance(1200.0))?)).await?;
        let names: Vec<String> =
            page.eval("performance.getEntriesByType('resource').map(({ name }) => name)").await?;
        ensure!(names.iter().any(|name| name.contains("/assets/main.")), "the names have changed: {names:?}");
        for name in &names {
            for view in ["motor", "panel", "tabs", "live", "recording"] {
                ensure!(!name.contains(&format!("/assets/{view}.")), "{name} is loaded");
            }
        }
        Ok(())
    })
}

#[test]
fn nothing_moves_while_the_page_loads() -> Result<()> {
    in_browser(|page| async move {
        page.before_scripts(OBSERVE).await?;
        for (width, height) in [(1440, 900), (1366, 768), (1024, 768), (390, 844)] {
            page.screen(width, height).await?;
            page.open("").await?;
            ensure!(page.visible("#welcome").await?, "a first visit has the cards");
            let seen = seen(&page).await?;
            ensure!(seen.cls == 0.0, "{width} x {height}: {} by {:?}", seen.cls, seen.shifted);
        }
        Ok(())
    })
}

#[test]
fn a_part_that_fails_to_load_is_reported_and_requested_again() -> Result<()> {
    let missing = "The fields could not be loaded";
    in_browser(|page| async move {
        let block = async |files: Value| {
            page.devtools("Network.enable", json!({})).await?;
            page.devtools("Network.setBlockedURLs", json!({ "urls": files })).await
        };
        page.open("").await?;
        block(json!([
            "*/additional_parts.*",
            "*/row_list.*",
            "*/edges.*",
            "*/card_content.*",
            "*/key_list.*"
        ]))
        .await?;
        let plant = "[data-path='plant#kind']";
        page.js::<()>("document.querySelector(arguments[0]).scrollIntoView();", vec![json!(plant)]).await?;
        page.click(plant).await?;
        page.until(&format!("[...document.querySelectorAll('.item-note')].some(({{ textContent }}) => textContent.includes('{missing}'))")).await?;
        page.press("#pulses", "h").await?;
        page.until("document.getElementById('pulses-sentence').textContent.startsWith('This part of the page could not')").await?;
        page.click("#rows-open").await?;
        page.until("document.getElementById('rows-about').textContent !== ''").await?;
        page.press("#rows-open", "\u{e00c}").await?;
        page.click("#edge-panel summary").await?;
        page.until("document.getElementById('edges-count').textContent.startsWith('The table could not')")
            .await?;
        page.click("#title-pulses .term").await?;
        page.until("document.getElementById('term-card').textContent.startsWith('The text could not')")
            .await?;
        page.click("#more").await?;
        page.click("#help").await?;
        page.until("document.getElementById('keys-list').textContent.startsWith('The keys could not')")
            .await?;
        page.click("#keys-close").await?;

        block(json!([])).await?;
        page.click(plant).await?;
        page.click(plant).await?;
        page.until("document.querySelector('[data-path=\"plant.tail_s\"]') !== null").await
    })
}
