//! The main task with keys only: without a pointer, and without scripts that move the focus.

use anyhow::{Context, Result, ensure};
use fantoccini::actions::{InputSource as _, KeyAction, KeyActions};
use serde::Deserialize;
use serde_json::{Value, json};
use stepscope_core::scenario::presets::PRESETS;

use crate::{
    bench::in_browser,
    native::Known,
    session::{CONTROL, ENTER, SHIFT, Session},
};

const TAB: char = '\u{e004}';
const ALT: char = '\u{e00a}';
const RIGHT: char = '\u{e014}';
pub(crate) const DOWN: char = '\u{e015}';
/// More presses of Tab than the page has focusable elements.
const MOST: usize = 400;

/// The focused element, and whether the focus is visible.
#[derive(Clone, Debug, Deserialize, PartialEq)]
struct Focus {
    /// Its id, path in the scenario or name; empty without a focus.
    name: String,
    /// Its number among all elements of the document.
    order: i64,
    /// Width of its outline in CSS pixels, 0 for none.
    outline: f64,
    /// Contrast of the outline with the background behind it.
    contrast: f64,
    /// It is within the window, and nothing covers it.
    seen: bool,
}

const FOCUS: &str = "
    const node = document.activeElement;
    if (!node || node === document.body) return { name: '', order: -1, outline: 0, contrast: 0, seen: false };
    const rgba = (text) => { const [r, g, b, a = 1] = text.match(/[\\d.]+/g).map(Number); return { r, g, b, a }; };
    const part = (c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4);
    const light = ({ r, g, b }) => 0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b);
    let ground = { r: 255, g: 255, b: 255, a: 1 };
    // The outline is outside of the element, on the background behind it.
    for (let at = node.parentElement; at; at = at.parentElement) {
        const color = rgba(getComputedStyle(at).backgroundColor);
        if (color.a === 1) { ground = color; break; }
    }
    const style = getComputedStyle(node);
    const [one, other] = [light(rgba(style.outlineColor)), light(ground)];
    const box = node.getBoundingClientRect();
    const [left, top] = [Math.max(0, box.left), Math.max(0, box.top)];
    const [right, bottom] = [Math.min(innerWidth, box.right), Math.min(innerHeight, box.bottom)];
    const at = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
    return {
        name: node.id && !/^f\\d+$/.test(node.id) ? node.id : node.dataset.path || node.ariaLabel || node.textContent.trim().slice(0, 30),
        order: [...document.querySelectorAll('*')].indexOf(node),
        outline: style.outlineStyle === 'none' ? 0 : parseFloat(style.outlineWidth),
        contrast: (Math.max(one, other) + 0.05) / (Math.min(one, other) + 0.05),
        seen: right - left > 4 && bottom - top > 4 && at !== null && (node.contains(at) || at.contains(node) || at.closest('label')?.control === node),
    };";

async fn focus(page: &Session) -> Result<Focus> {
    page.js(FOCUS, vec![]).await
}

/// Presses a key while others are held.
pub(crate) async fn key(page: &Session, held: &[char], value: char) -> Result<()> {
    let mut keys = KeyActions::new("keys".into());
    for &value in held {
        keys = keys.then(KeyAction::Down { value });
    }
    keys = keys.then(KeyAction::Down { value }).then(KeyAction::Up { value });
    for &value in held.iter().rev() {
        keys = keys.then(KeyAction::Up { value });
    }
    page.actions(keys).await
}

async fn type_text(page: &Session, text: &str) -> Result<()> {
    for value in text.chars() {
        key(page, &[], value).await?;
    }
    Ok(())
}

/// Presses Tab, or Shift and Tab, until the element with this name has the focus; the focus is always visible.
pub(crate) async fn go(page: &Session, held: &[char], name: &str) -> Result<()> {
    let mut seen = Vec::new();
    for _ in 0..MOST {
        key(page, held, TAB).await?;
        let at = visible_focus(page).await?;
        if at.name == name {
            return Ok(());
        }
        seen.push(at.name);
    }
    anyhow::bail!("{name} is not reached by Tab; these are: {seen:?}")
}

/// The focus, which exists and is visible.
async fn visible_focus(page: &Session) -> Result<Focus> {
    let at = focus(page).await?;
    ensure!(!at.name.is_empty(), "the focus is lost");
    ensure!(at.seen, "the focus is out of sight: {at:?}");
    ensure!(at.outline >= 2.0 && at.contrast >= 3.0, "the focus can't be seen: {at:?}");
    Ok(at)
}

/// The focus has not moved, although the page was redrawn.
async fn still(page: &Session, name: &str) -> Result<()> {
    let at = visible_focus(page).await?;
    ensure!(at.name == name, "the focus was on {name} and is on {}", at.name);
    Ok(())
}

#[test]
fn an_experiment_can_be_done_with_keys_only() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.allow_clipboard().await?;

        // A preset.
        go(&page, &[], "preset").await?;
        key(&page, &[], ENTER).await?;
        page.until("document.activeElement.id === 'gallery-search'").await?;
        type_text(&page, PRESETS[0].id).await?;
        page.until("document.querySelectorAll('#gallery [data-entry]').length === 1").await?;
        key(&page, &[], ENTER).await?;
        page.until_digest(&Known::preset(&PRESETS[0])?.digest).await.context("the first preset")?;
        still(&page, "preset").await?;

        // A number.
        go(&page, &[], "bus.step_period_cycles").await?;
        key(&page, &[CONTROL], 'a').await?;
        let mut scenario: Value = serde_json::from_str(PRESETS[0].json)?;
        let period = Known::preset(&PRESETS[0])?.scenario.bus.step_period_cycles + 8;
        type_text(&page, &period.to_string()).await?;
        scenario["bus"]["step_period_cycles"] = json!(period);
        let known = Known::of(&scenario.to_string())?;
        page.until_digest(&known.digest).await.context("the number")?;
        still(&page, "bus.step_period_cycles").await?;

        // The result, where a screen reader finds it.
        assert_eq!(page.text("#digest").await?, known.digest);
        ensure!(page.text("#status").await?.contains("edges"));

        // The pulses: an edge, both cursors.
        go(&page, &[], "pulses").await?;
        key(&page, &[], 'n').await?;
        page.until("document.getElementById('pulses-sentence').textContent.includes('edge at')").await?;
        key(&page, &[SHIFT], RIGHT).await?;
        key(&page, &[ALT], RIGHT).await?;
        page.until("document.getElementById('cursor-readings').textContent.includes('B−A')").await?;
        still(&page, "pulses").await?;

        // A packet.
        go(&page, &[], "packets").await?;
        for value in [DOWN, DOWN, ENTER] {
            key(&page, &[], value).await?;
        }
        page.until("document.querySelector('#packet-2')?.ariaSelected === 'true'").await?;
        page.until("document.getElementById('packet-detail').textContent.startsWith('#2')").await?;
        still(&page, "packets").await?;

        // The link.
        go(&page, &[SHIFT], "share").await?;
        key(&page, &[], ENTER).await?;
        page.until("!document.getElementById('copy-link').disabled").await?;
        go(&page, &[], "copy-link").await?;
        key(&page, &[], ENTER).await?;
        page.until("document.getElementById('copy-link').textContent === 'Copied'").await?;
        still(&page, "copy-link").await?;
        let link = page.clipboard().await?;
        // It is no longer a preset, and its label shows that.
        let title = scenario["title"].as_str().context("a preset has a title")?;
        scenario["title"] = json!(format!("changed from {title}"));
        scenario["note"] = json!("");
        let known = Known::of(&scenario.to_string())?;
        ensure!(link.contains(&format!("#{}", known.link)), "{link}");
        Ok(())
    })
}

#[test]
fn tab_reaches_every_control_in_the_order_of_the_page() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        for (preset, width) in [("", 1440), ("driver-timing-broken", 1440), ("", 390)] {
            page.screen(width, 900).await?;
            // By a link, because after a click Tab would continue from there.
            let link = match PRESETS.iter().find(|each| each.id == preset) {
                Some(preset) => format!("#{}", Known::preset(preset)?.link),
                None => String::new(),
            };
            page.open(&link).await?;
            let what = format!("{preset} at {width} px");
            // In a group of buttons with arrow keys, only one is reached by Tab.
            let wanted: usize = page
                .eval(
                    "(window.wanted = [...document.querySelectorAll('a[href], button, input, select, textarea, summary, \
                     [tabindex]')].filter((node) => node.tabIndex >= 0 && !node.disabled && \
                     node.checkVisibility({ visibilityProperty: true }))).length",
                )
                .await?;
            ensure!(wanted > 5, "{what} has {wanted} places for the focus");
            let mut places: Vec<Focus> = Vec::new();
            loop {
                key(&page, &[], TAB).await?;
                let at = focus(&page).await?;
                if at.name.is_empty() || places.first().is_some_and(|first| first.order == at.order) {
                    break;
                }
                ensure!(
                    at.seen && at.outline >= 2.0 && at.contrast >= 3.0,
                    "{what}: the focus can't be seen: {at:?}"
                );
                if let Some(last) = places.last() {
                    ensure!(last.order < at.order, "{what}: {} comes before {}", last.name, at.name);
                }
                page.eval::<usize>("(window.reached ??= new Set()).add(document.activeElement).size").await?;
                places.push(at);
                ensure!(places.len() < MOST, "{what}: Tab never ends");
            }
            let names: Vec<&str> = places.iter().map(|place| place.name.as_str()).collect();
            // Elements that appeared or disappeared meanwhile, such as messages, are not required.
            let missed: Vec<String> = page
                .eval(
                    "wanted.filter((node) => node.isConnected && !reached.has(node)).map((node) => node.outerHTML.slice(0, 99))",
                )
                .await?;
            ensure!(missed.is_empty(), "{what}: {missed:?} are never reached: {names:?}");
        }
        Ok(())
    })
}
