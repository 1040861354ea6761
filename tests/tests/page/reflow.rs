//! Small screens and large text: nothing is cut off or covered, and all targets are large enough for a finger.

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};

use crate::{bench::in_browser, session::Session};

/// Targets smaller than 24 CSS pixels in width or height (WCAG 2.5.8). Links within a sentence are exempt, and so are targets
/// with a label around them that is large enough.
pub(crate) const SMALL: &str = "
    const wanted = 'button, input, select, textarea, summary, a[href], [role=tab], [role=button], canvas[tabindex]';
    return [...document.querySelectorAll(wanted)].filter((node) => node.checkVisibility({ visibilityProperty: true }) && !node.closest('.unseen, .skip, p a'))
        .map((node) => [node, (node.closest('label') ?? node).getBoundingClientRect()])
        .filter(([, box]) => box.width < 23.9 || box.height < 23.9)
        .map(([node, box]) => `${node.id || node.ariaLabel || node.textContent.trim().slice(0, 30) || node.dataset.path} is ${box.width.toFixed(1)} x ${box.height.toFixed(1)}`);";

/// Texts that a box without a scroll bar cuts off, except table cells, choices and texts with an ellipsis.
pub(crate) const CUT: &str = "
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    const found = new Set();
    // Most texts share boxes: each box is measured once. Scrollable content is not lost.
    const known = new Map();
    const about = (node) => {
        if (!known.has(node)) {
            const { position, textOverflow, overflowX, overflowY } = getComputedStyle(node);
            const scrolls = /auto|scroll/.test(overflowX) && /auto|scroll/.test(overflowY);
            const ends = (position === 'absolute' && node.parentElement === document.body) || textOverflow === 'ellipsis' || scrolls;
            const [x, y] = [overflowX, overflowY].map((way) => /hidden|clip/.test(way));
            known.set(node, { ends, x, y, clip: node.getBoundingClientRect() });
        }
        return known.get(node);
    };
    for (let text = walker.nextNode(); text; text = walker.nextNode()) {
        const parent = text.parentElement;
        if (!text.data.trim() || !parent.checkVisibility({ visibilityProperty: true }) || parent.closest('.unseen, .skip, td, option, noscript, script')) continue;
        const range = document.createRange();
        range.selectNodeContents(text);
        const box = range.getBoundingClientRect();
        const around = parent.closest('button')?.getBoundingClientRect();
        if (around && (box.right > around.right + 1 || box.left < around.left - 1)) found.add(`${text.data.trim()} beyond its button`);
        for (let at = parent; at && at !== document.documentElement; at = at.parentElement) {
            const { ends, x, y, clip } = about(at);
            if (ends) break;
            const lost = (x && (box.right > clip.right + 2 || box.left < clip.left - 2))
                || (y && (box.bottom > clip.bottom + 2 || box.top < clip.top - 2));
            if (lost) { found.add(`${text.data.trim().slice(0, 40)} in ${at.id || at.className || at.tagName}`); break; }
        }
    }
    return [...found];";

/// Controls and labels that overlap.
const OVERLAPS: &str = "
    const nodes = [...document.querySelectorAll('button, input, select, textarea, summary, label, h1, h2, legend, .unit, output, .legend, #status')]
        // On a narrow screen the footer stays visible above scrolling content.
        .filter((node) => node.checkVisibility({ visibilityProperty: true }) && !node.closest('.unseen, .skip, .caption, footer') && !node.querySelector(':scope > .unseen'))
        .map((node) => [node, node.getBoundingClientRect()]).filter(([, box]) => box.width > 0 && box.height > 0);
    const meet = (a, b) => ({
        left: Math.max(a.left, b.left), right: Math.min(a.right, b.right), top: Math.max(a.top, b.top), bottom: Math.min(a.bottom, b.bottom),
    });
    // The part of a node that the boxes around it leave visible; each box is measured once.
    const known = new Map([[null, { left: -Infinity, right: Infinity, top: -Infinity, bottom: Infinity }]]);
    const within = (box) => {
        if (!known.has(box)) {
            const outer = within(box.parentElement);
            known.set(box, getComputedStyle(box).overflow === 'visible' ? outer : meet(outer, box.getBoundingClientRect()));
        }
        return known.get(box);
    };
    const name = (node) => node.id || node.ariaLabel || node.dataset.path || node.textContent.trim().slice(0, 30);
    const seen = nodes.map(([node, box]) => [node, meet(box, within(node.parentElement))]);
    const found = [];
    for (const [index, [one, a]] of seen.entries()) for (const [other, b] of seen.slice(index + 1)) {
        const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
        const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
        if (across > 2 && down > 2 && !one.contains(other) && !other.contains(one)) found.push(`${name(one)} and ${name(other)} by ${across.toFixed(0)} x ${down.toFixed(0)}`);
    }
    return found;";

/// Results of one check of the page.
#[derive(serde::Deserialize)]
struct Seen {
    /// Widths of the content and of the window, in CSS pixels.
    wide: (u32, u32),
    /// Violations of each rule.
    rules: Vec<(String, Vec<String>)>,
}

/// All violations of the visible page, each with its location.
async fn look(page: &Session, place: &str, wrong: &mut Vec<String>) -> Result<()> {
    // In one call: the page computes its layout once for all rules.
    let rules = [("small", SMALL), ("cut off", CUT), ("overlap", OVERLAPS)];
    let rules: String = rules.map(|(rule, script)| format!("['{rule}', (() => {{ {script} }})()],")).concat();
    let script = format!(
        "const wide = [document.documentElement.scrollWidth, innerWidth]; return {{ wide, rules: [{rules}] }};"
    );
    let Seen { wide: (content, window), rules } =
        page.js(&script, vec![]).await.with_context(|| place.to_owned())?;
    for (rule, found) in rules {
        wrong.extend(found.into_iter().map(|text| format!("{place}, {rule}: {text}")));
    }
    if content > window {
        wrong.push(format!("{place}: {content} px wide in a window of {window} px"));
    }
    Ok(())
}

/// Shows each progress line as during long work, which is too fast in most runs of this test.
const SHOW_PROGRESS: &str = "
    for (const job of document.querySelectorAll('.study-job')) {
        const [text, bar, button] = job.children;
        job.hidden = bar.hidden = false;
        text.textContent = '100 of 1000 rows';
        button.textContent = 'Cancel';
    }
    return null;";
const HIDE_PROGRESS: &str =
    "for (const job of document.querySelectorAll('.study-job')) job.hidden = true; return null;";

/// Checks the whole page: on a narrow screen each tab, and the form.
async fn everywhere(page: &Session, what: &str, wrong: &mut Vec<String>) -> Result<()> {
    let tabs: Vec<String> = page
        .eval("[...document.querySelectorAll('[role=tab]')].filter((tab) => tab.checkVisibility()).map((tab) => tab.id)")
        .await?;
    for tab in &tabs {
        page.click(&format!("#{tab}")).await?;
        look(page, &format!("{what}, {tab}"), wrong).await?;
    }
    if tabs.is_empty() {
        look(page, what, wrong).await?;
        page.click("#study").await?;
    }
    for tab in ["compare", "measures", "tables", "sine", "torque", "motor"] {
        page.click(&format!("#study-tab-{tab}")).await?;
        page.until("[...document.querySelectorAll('.study-job')].every((job) => job.hidden)").await?;
        look(page, &format!("{what}, study, {tab}"), wrong).await?;
        page.js::<()>(SHOW_PROGRESS, vec![]).await?;
        look(page, &format!("{what}, study, {tab}, with progress"), wrong).await?;
        page.js::<()>(HIDE_PROGRESS, vec![]).await?;
    }
    if tabs.is_empty() {
        return page.click("#study").await;
    }
    page.click("#sheet > summary").await?;
    look(page, &format!("{what}, form"), wrong).await
}

/// Checks the page in windows of these sizes: with the default, which is loaded in each of them, and with the presets with
/// the most content, which are open while the window changes.
async fn at_sizes(page: &Session, what: &str, sizes: &[Value], wrong: &mut Vec<String>) -> Result<()> {
    for preset in ["", "driver-timing-broken", "four-controllers-framed", "patent-2019-figure-2"] {
        for (index, size) in sizes.iter().enumerate() {
            page.devtools("Emulation.setDeviceMetricsOverride", size.clone()).await?;
            if preset.is_empty() || index == 0 {
                page.open("").await?;
            }
            if !preset.is_empty() && index == 0 {
                page.preset(preset).await?;
                page.ready().await?;
            }
            // The layout has followed the window's size two frames later.
            page.js::<()>(FRAMES, vec![]).await?;
            everywhere(page, &format!("{what} at {} px {preset}", size["width"]), wrong).await?;
        }
    }
    Ok(())
}

const FRAMES: &str = "return new Promise((seen) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(seen))));";

/// A window of this size, with this number of device pixels per CSS pixel.
fn window((width, height): (u32, u32), ratio: u32) -> Value {
    json!({ "width": width, "height": height, "deviceScaleFactor": ratio, "mobile": false })
}

fn none(wrong: &[String]) -> Result<()> {
    ensure!(wrong.is_empty(), "{} things are wrong:\n{}", wrong.len(), wrong.join("\n"));
    Ok(())
}

/// Adds a violation of each rule to the page.
const SPOIL: &str = "
    const put = (tag, id, style) => {
        const node = Object.assign(document.createElement(tag), { id, textContent: id });
        const bare = { position: 'fixed', boxSizing: 'border-box', padding: 0, minWidth: 0, minHeight: 0, whiteSpace: 'nowrap' };
        Object.assign(node.style, bare, style);
        document.body.append(node);
    };
    put('button', 'x', { left: 0, top: 0, width: '10px', height: '12px', overflow: 'auto' });
    put('p', 'longer-than-its-box', { left: '200px', top: 0, width: '30px', overflow: 'hidden' });
    put('button', 'under', { left: '300px', top: 0, width: '80px', height: '40px' });
    put('button', 'over', { left: '350px', top: '10px', width: '80px', height: '40px' });
    document.body.style.minWidth = '5000px';
    return null;";

#[test]
fn each_rule_finds_its_violation() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.js::<()>(SPOIL, vec![]).await?;
        let mut wrong = Vec::new();
        look(&page, "here", &mut wrong).await?;
        for expected in [
            "here, small: x is 10.0 x 12.0",
            "here, cut off: longer-than-its-box in longer-than-its-box",
            "here, overlap: under and over by 30 x 30",
            "here: 5000 px wide in a window of 1440 px",
        ] {
            ensure!(wrong.iter().any(|found| found == expected), "{expected}: not among {wrong:?}");
        }
        Ok(())
    })
}

#[test]
fn nothing_is_cut_off_and_targets_are_large_on_any_screen() -> Result<()> {
    in_browser(|page| async move {
        let mut wrong = Vec::new();
        let sizes = [(1440, 900), (1024, 768), (320, 640)].map(|size| window(size, 1));
        at_sizes(&page, "plainly", &sizes, &mut wrong).await?;
        none(&wrong)
    })
}

#[test]
fn at_twice_the_zoom_nothing_is_cut_off() -> Result<()> {
    in_browser(|page| async move {
        let mut wrong = Vec::new();
        // A window of 1280 x 1024 at 200 %: half the CSS pixels, each of four device pixels (WCAG 1.4.4).
        at_sizes(&page, "200 % zoom", &[window((640, 512), 2)], &mut wrong).await?;
        none(&wrong)
    })
}

#[test]
fn with_text_of_twice_the_size_nothing_is_cut_off() -> Result<()> {
    in_browser(|page| async move {
        let mut wrong = Vec::new();
        page.before_scripts(
            "addEventListener('DOMContentLoaded', () => { const root = document.documentElement; \
             root.style.fontSize = `${2 * parseFloat(getComputedStyle(root).fontSize)}px`; });",
        )
        .await?;
        let sizes = [(1440, 900), (390, 844)].map(|size| window(size, 1));
        at_sizes(&page, "large letters", &sizes, &mut wrong).await?;
        none(&wrong)
    })
}

#[test]
fn forced_colors_keep_every_control_and_curve_visible() -> Result<()> {
    in_browser(|page| async move {
        let features = json!({ "features": [{ "name": "forced-colors", "value": "active" }] });
        page.devtools("Emulation.setEmulatedMedia", features).await?;
        page.open("").await?;
        page.unfold_spectrum().await?;
        page.picture("forced").await?;
        ensure!(page.eval::<bool>("matchMedia('(forced-colors: active)').matches").await?);
        // In forced colors, a button or a field still has its border.
        let bare: Vec<String> = page
            .eval(
                "[...document.querySelectorAll('button, input, select, textarea')].filter((node) => node.checkVisibility() && \
                 node.type !== 'checkbox' && !node.closest('.problems, summary') && getComputedStyle(node).borderTopStyle === 'none')\
                 .map((node) => node.id || node.ariaLabel || node.textContent)",
            )
            .await?;
        ensure!(bare.is_empty(), "no border: {bare:?}");
        for (canvas, least) in [("chart-position", 300), ("pulses", 300), ("spectrum-chart", 100)] {
            let differs: u32 = page.js(DRAWN, vec![json!(canvas)]).await?;
            ensure!(differs > least, "{canvas}: {differs} pixels differ clearly from the ground");
        }
        Ok(())
    })
}

/// Pixels of a canvas with a contrast of at least 3:1 to their background.
const DRAWN: &str = "
    const canvas = document.getElementById(arguments[0]);
    const part = (c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4);
    const light = (r, g, b) => 0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b);
    const ground = light(...getComputedStyle(canvas.closest('.view')).backgroundColor.match(/[\\d.]+/g).slice(0, 3).map(Number));
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let pixels = 0;
    for (let at = 0; at < data.length; at += 4) {
        if (data[at + 3] < 200) continue;
        const own = light(data[at], data[at + 1], data[at + 2]);
        if ((Math.max(own, ground) + 0.05) / (Math.min(own, ground) + 0.05) >= 3) pixels++;
    }
    return pixels;";
