//! `cargo xtask bench --page`: how long the page as it is shipped takes in Chromium. Its frames over ten million edges,
//! its loading, its answers to keys. The times are of this machine and this moment: they are printed, and no test judges
//! them. Where `STEPSCOPE_RESULTS` names a file they go there, too, as JSON: `frames`, `loading`, `answers`, a list each.
#![cfg(not(target_arch = "wasm32"))]
#![allow(dead_code, reason = "what the tests have is shared whole, and little of it is needed here")]

#[path = "../tests/page/bench.rs"]
mod bench;
#[path = "../tests/page/browser.rs"]
mod browser;
#[path = "../tests/page/devtools.rs"]
mod devtools;
#[path = "../tests/page/native.rs"]
mod native;
#[path = "../tests/page/pool.rs"]
mod pool;
#[path = "../tests/page/programs.rs"]
mod programs;
#[path = "../tests/page/session.rs"]
mod session;

use std::{cell::RefCell, env, fs, rc::Rc};

use anyhow::Result;
use serde::Deserialize;
use serde_json::{Value, json};
use stepscope_core::scenario::presets::{PLANT_PRESETS, PRESETS};

use crate::{
    bench::in_browser,
    native::Known,
    session::{CONTROL, Session},
};

fn main() -> Result<()> {
    let results = json!({
        "frames": measured(|page| async move { frames(&page).await })?,
        "loading": measured(|page| async move { loading(&page).await })?,
        "answers": measured(|page| async move { answers(&page).await })?,
    });
    if let Some(file) = env::var_os("STEPSCOPE_RESULTS") {
        fs::write(file, results.to_string())?;
    }
    Ok(())
}

/// What a measurement in a browser gives.
fn measured<F>(measure: fn(Session) -> F) -> Result<Vec<Value>>
where
    F: Future<Output = Result<Vec<Value>>> + 'static,
{
    let found = Rc::new(RefCell::new(Vec::new()));
    let place = Rc::clone(&found);
    in_browser(|page| async move {
        place.replace(measure(page).await?);
        Ok(())
    })?;
    Ok(found.take())
}

/// Sixteen motors at their fastest, for seconds.
fn ten_million_edges() -> String {
    let axes: Vec<Value> = (0..16)
        .map(|axis| {
            let speed = 90_000 - 700 * axis;
            json!({"moves":[{"constant":{"distance":{"steps":4 * speed},"speed":{"steps_s":speed}}}]})
        })
        .collect();
    json!({"clock_hz":100_000_000,"bus":{"channels":16,"slots":100,"step_period_cycles":1000,
        "pulse_width_cycles":20,"pulses":"staggered","settle_cycles":60},
        "line":{"baud":4_000_000},"source":{"motion":{"axes":axes}}})
    .to_string()
}

/// Turns the wheel over the middle of the pulses.
const WHEEL: &str = "
    const canvas = document.getElementById('pulses');
    const { left, width } = canvas.getBoundingClientRect();
    for (let i = 0; i < arguments[0]; i++) canvas.dispatchEvent(new WheelEvent('wheel', { deltaY: -300, cancelable: true, clientX: left + width / 2 }));
    return null;";

/// Moves by a wheel's step a frame and keeps the times between frames.
const FRAMES: &str = "
    const [what] = arguments;
    const canvas = document.getElementById('pulses');
    const { left, width } = canvas.getBoundingClientRect();
    const times = [];
    let last = null;
    delete window.frameTimes;
    const next = (now) => {
        if (last !== null) times.push(now - last);
        last = now;
        if (times.length === 180) { window.frameTimes = times; return; }
        const there = times.length % 120 < 60 ? 1 : -1;
        canvas.dispatchEvent(new WheelEvent('wheel', { deltaX: what === 'pan' ? 25 * there : 0, deltaY: what === 'pan' ? 0 : -60 * there, cancelable: true, clientX: left + width * 0.6 }));
        requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
    return null;";

/// The pulses' frames while they are zoomed and dragged about.
async fn frames(page: &Session) -> Result<Vec<Value>> {
    let mut rows = Vec::new();
    let known = Known::of(&ten_million_edges())?;
    page.open(&format!("#{}", known.link)).await?;
    page.click("#run-anyway").await?;
    page.until_digest(&known.digest).await?;
    println!("frames over {} records", known.recording.trace.len());
    for view in ["all views", "pulses alone"] {
        if view == "pulses alone" {
            page.js::<()>("document.getElementById('view-motion').hidden = true; return null;", vec![])
                .await?;
        }
        for (what, zoom) in [("zoom", 0), ("pan", 3), ("pan", 12)] {
            page.click("#zoom-fit").await?;
            page.js::<()>(WHEEL, vec![json!(zoom)]).await?;
            page.js::<()>(FRAMES, vec![json!(what)]).await?;
            let mut times: Vec<f64> = page
                .eventually("180 frames", async || {
                    page.eval::<Option<Vec<f64>>>("window.frameTimes ?? null").await
                })
                .await?;
            times.sort_by(f64::total_cmp);
            let at = |part: f64| times[((times.len() - 1) as f64 * part) as usize];
            println!(
                "{view}, {what} at {zoom}: p50 {:.1} ms, p95 {:.1} ms, longest {:.1} ms",
                at(0.5),
                at(0.95),
                at(1.0)
            );
            rows.push(json!({
                "view": view, "what": what, "zoom": zoom, "p50_ms": at(0.5), "p95_ms": at(0.95), "longest_ms": at(1.0),
            }));
        }
    }
    Ok(rows)
}

/// Notes, from the document's beginning on, what the browser measures of the visit.
const OBSERVE: &str = "{
    window.seen = { lcp: 0, lcpOf: '', cls: 0, inp: 0, inpOf: '' };
    const observers = [];
    const observe = (type, note, options = {}) => {
        const hear = (list) => list.forEach(note);
        const observer = new PerformanceObserver((list) => hear(list.getEntries()));
        observer.observe({ type, buffered: true, ...options });
        observers.push(() => hear(observer.takeRecords()));
    };
    window.look = () => { for (const take of observers) take(); return seen; };
    observe('largest-contentful-paint', (entry) => { seen.lcp = entry.startTime; seen.lcpOf = String(entry.element?.id || entry.element?.className || entry.element?.tagName); });
    observe('layout-shift', (entry) => { if (!entry.hadRecentInput) seen.cls += entry.value; });
    observe('event', (entry) => { if (entry.interactionId && entry.duration > seen.inp) { seen.inp = entry.duration; seen.inpOf = entry.name; } }, { durationThreshold: 16 });
}";

/// What [`OBSERVE`] noted, after the frame in which the last event was answered.
const LOOK: &str = "return new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(() => \
    setTimeout(() => drawn(look())))));";

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Seen {
    lcp: f64,
    lcp_of: String,
    cls: f64,
    inp: f64,
    inp_of: String,
}

/// Several visits, the later ones with the files on the device.
async fn loading(page: &Session) -> Result<Vec<Value>> {
    let mut rows = Vec::new();
    page.before_scripts(OBSERVE).await?;
    for (width, height) in [(1440, 900), (390, 844)] {
        page.screen(width, height).await?;
        for visit in ["first", "second", "third"] {
            page.open("").await?;
            let stands: f64 = page.eval("performance.now()").await?;
            let seen: Seen = page.js(LOOK, vec![]).await?;
            println!(
                "{width} x {height}, {visit} visit: LCP {:.0} ms ({}), first result {stands:.0} ms, CLS {}",
                seen.lcp, seen.lcp_of, seen.cls
            );
            rows.push(json!({
                "width": width, "height": height, "visit": visit, "lcp_ms": seen.lcp, "first_result_ms": stands, "cls": seen.cls,
            }));
        }
    }
    Ok(rows)
}

/// How long the page is silent after a key, with each preset.
async fn answers(page: &Session) -> Result<Vec<Value>> {
    let mut rows = Vec::new();
    page.before_scripts(OBSERVE).await?;
    for preset in PRESETS.iter().chain(PLANT_PRESETS) {
        page.open("").await?;
        page.preset(preset.id).await?;
        page.ready().await?;
        for key in ["+", "+", "\u{e014}", "\u{e014}", "n", "-", "\u{e011}"] {
            page.press("#pulses", key).await?;
        }
        // Those with a plant show the motor in their place.
        let charts = if page.visible("#charts").await? { "#charts" } else { "#pulses" };
        for key in ["\u{e014}", "\u{e012}"] {
            page.press(charts, key).await?;
        }
        // Segments that run alone have no queue.
        let queue =
            page.eval::<bool>("Boolean(document.querySelector('[data-path=\"bus.queue_depth\"]'))").await?;
        page.fill(if queue { "bus.queue_depth" } else { "bus.pulse_width_cycles" }, "9").await?;
        page.ready().await?;
        page.press("body", &format!("{CONTROL}z")).await?;
        page.ready().await?;
        let seen: Seen = page.js(LOOK, vec![]).await?;
        let status = page.text("#status").await?;
        println!("{}: INP {:.0} ms ({}); {status}", preset.id, seen.inp, seen.inp_of);
        rows.push(json!({ "preset": preset.id, "inp_ms": seen.inp, "of": seen.inp_of }));
    }
    Ok(rows)
}
