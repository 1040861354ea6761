//! The cursors A and B: taps set them, a finger drags their handles, keys move them, and readings are exact values of
//! their cycles.

use anyhow::{Context, Result, ensure};
use serde::Deserialize;
use serde_json::{Value, json};
use stepscope_core::{inspect::motion::actual_motion::Pulses, peripheral::trace::steps};

use crate::{
    bench::in_browser,
    native::Known,
    session::{ALT, RELEASE, SHIFT, Session},
};

const RIGHT: char = '\u{e014}';
const DELETE: char = '\u{e017}';

/// A visible handle.
#[derive(Debug, Deserialize)]
struct Handle {
    name: String,
    /// Its position for a screen reader.
    said: String,
    width: f64,
    height: f64,
    /// Its middle in the window.
    x: f64,
    y: f64,
    /// A finger on its middle hits it.
    met: bool,
}

const HANDLE: &str = "
    const node = document.querySelector(arguments[0]);
    const { x, y, width, height } = node.getBoundingClientRect();
    const at = document.elementFromPoint(x + width / 2, y + height / 2);
    return { name: node.ariaLabel, said: node.ariaValueText, width, height, x: x + width / 2, y: y + height / 2, met: node.contains(at) };";

async fn handle(page: &Session, css: &str) -> Result<Handle> {
    page.js(HANDLE, vec![json!(css)]).await
}

/// Cycle of a handle's cursor; `None` if it is not set.
pub(crate) async fn cycle(page: &Session, css: &str) -> Result<Option<u64>> {
    let said = handle(page, css).await?.said;
    let Some((_, cycle)) = said.split_once("cycle ") else {
        ensure!(said == "not set", "`{said}`");
        return Ok(None);
    };
    cycle.parse().map(Some).with_context(|| format!("`{said}`"))
}

/// Drags a handle from its middle to a position in the window with a finger.
async fn finger(page: &Session, css: &str, to: f64) -> Result<()> {
    let Handle { x, y, met, .. } = handle(page, css).await?;
    ensure!(met, "{css} lies under something else");
    let touch = async |kind: &str, points: Value| {
        page.devtools("Input.dispatchTouchEvent", json!({ "type": kind, "touchPoints": points }))
            .await
            .map(drop)
    };
    touch("touchStart", json!([{ "x": x, "y": y }])).await?;
    for part in [0.3, 0.7, 1.0] {
        touch("touchMove", json!([{ "x": x + part * (to - x), "y": y }])).await?;
    }
    touch("touchEnd", json!([])).await
}

/// Taps the charts, or the row EN of the pulses, at a position in the window with a finger.
async fn tap(page: &Session, tab: &str, x: f64) -> Result<()> {
    let (css, down) = if tab == "motion" { ("#charts", 60) } else { ("#pulses", 10) };
    let y: f64 = page
        .js(
            "const { y } = document.querySelector(arguments[0]).getBoundingClientRect(); return y + arguments[1];",
            vec![json!(css), json!(down)],
        )
        .await?;
    for (kind, points) in [("touchStart", json!([{ "x": x, "y": y }])), ("touchEnd", json!([]))] {
        page.devtools("Input.dispatchTouchEvent", json!({ "type": kind, "touchPoints": points })).await?;
    }
    Ok(())
}

#[test]
fn a_finger_places_drags_and_removes_both_cursors() -> Result<()> {
    in_browser(|page| async move {
        let phone = json!({ "width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": true });
        page.devtools("Emulation.setDeviceMetricsOverride", phone).await?;
        let touch = json!({ "enabled": true, "maxTouchPoints": 5 });
        page.devtools("Emulation.setTouchEmulationEnabled", touch).await?;
        for (tab, strip) in [("motion", "#charts-handles"), ("pulses", "#pulses-handles")] {
            page.open("").await?;
            page.click(&format!("#tab-{tab}")).await?;
            // It has its value once there is a result.
            page.until(&format!("document.querySelector('{strip} .handle').ariaValueText !== null")).await?;
            page.js::<()>(
                "document.querySelector(arguments[0]).scrollIntoView({ block: 'center' });",
                vec![json!(strip)],
            )
            .await?;
            let mut cycles = Vec::new();
            for (which, name, to) in [("a", "Cursor A", 150.0), ("b", "Cursor B", 250.0)] {
                let css = format!("{strip} .handle.{which}");
                let waiting = handle(&page, &css).await?;
                ensure!(waiting.name == name && waiting.said == "not set" && !waiting.met, "{waiting:?}");
                tap(&page, tab, to).await?;
                page.until(&format!("document.querySelector('{css}').ariaValueText !== 'not set'")).await?;
                cycles.push(cycle(&page, &css).await?.context("it is set")?);
                let placed = handle(&page, &css).await?;
                ensure!(
                    placed.width >= 44.0 && placed.height >= 44.0 && (placed.x - to).abs() <= 44.0,
                    "{placed:?} is not at {to}"
                );
            }
            ensure!(cycles[0] < cycles[1], "{tab}: {cycles:?}");
            page.picture(&format!("cursors-{tab}")).await?;
            // Both views show them, and the readings between them.
            let readings: String =
                page.eval("document.getElementById('cursor-readings').textContent").await?;
            ensure!(readings.contains("A ") && readings.contains("B−A"), "{tab}: {readings}");
            page.until("!document.getElementById('between').hidden").await?;

            // The drag starts at its position.
            let (first, css) = (format!("{strip} .handle.a"), format!("{strip} .handle.b"));
            let stays = handle(&page, &first).await?;
            finger(&page, &css, 320.0).await?;
            let later = async || Ok(cycle(&page, &css).await?.filter(|cycle| *cycle > cycles[1]));
            page.eventually(&format!("{tab}: B goes later than {cycles:?}"), later).await?;
            // In the pulses it snapped to a nearby edge of the selected row.
            ensure!((handle(&page, &first).await?.x - stays.x).abs() <= 7.0, "A stays");
            finger(&page, &css, 20.0).await?;
            page.until(&format!("document.querySelector('{css}').ariaValueText === 'not set'")).await?;
        }
        Ok(())
    })
}

#[test]
fn keys_place_a_cursor_move_it_and_remove_it() -> Result<()> {
    in_browser(|page| async move {
        for (view, strip) in [("#charts", "#charts-handles"), ("#pulses", "#pulses-handles")] {
            page.open("").await?;
            let css = format!("{strip} .handle.b");
            page.until(&format!("document.querySelector('{css}').ariaValueText === 'not set'")).await?;
            ensure!(!handle(&page, &css).await?.met, "a cursor that is not set has no handle");
            let mut before = 0;
            for (on, keys) in [
                (view, format!("{ALT}{RIGHT}{RELEASE}")),
                (css.as_str(), format!("{RIGHT}")),
                (css.as_str(), format!("{SHIFT}{RIGHT}{RELEASE}")),
            ] {
                page.press(on, &keys).await?;
                let look = async || Ok(cycle(&page, &css).await?.filter(|cycle| *cycle > before));
                before = page.eventually(&format!("{strip}: later than {before}"), look).await?;
            }
            let known = Known::of("{}")?;
            let seconds = known.seconds(before);
            ensure!((0.19..0.24).contains(&seconds), "a little beyond the middle: {seconds}");
            page.press(&css, &DELETE.to_string()).await?;
            page.until(&format!("document.querySelector('{css}').ariaValueText === 'not set'")).await?;
            page.until(&format!("document.activeElement === document.querySelector('{view}')")).await?;
        }
        Ok(())
    })
}

/// Numbers in a reading, by their labels.
pub(crate) fn reading(text: &str, name: &str) -> Result<f64> {
    let rest = text.split_once(&format!("{name} ")).with_context(|| format!("no {name} in `{text}`"))?.1;
    let number = rest.split([' ', '\u{a0}']).next().unwrap_or_default().replace('\u{2212}', "-");
    number.parse().with_context(|| format!("{name} in `{text}`"))
}

#[test]
fn a_reading_is_the_value_in_the_cycle_of_the_cursor() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of("{}")?;
        let plan = &known.experiment.plans()[0];
        let zero_s =
            known.recording.first_tick().context("a tick")?.seconds(known.experiment.config().clock_hz());
        let steps = steps(&known.recording.trace, 0);
        let pulses = Pulses::of_run(0, &steps, &known.recording.packets, None, known.experiment.config());
        // With the whole run visible a pixel has some ten thousand cycles with several steps.
        for cycle in [1_600_123, 3_201_462, 4_100_456] {
            page.open(&format!("#{}&v=a{cycle}", known.link)).await?;
            let digits = cycle.to_string();
            page.until(&format!(
                "document.getElementById('motion-time').textContent.replace(/\\D/g, '').endsWith('{digits}')"
            ))
            .await?;
            ensure!(page.text("#motion-time").await?.starts_with("A "), "whose reading it is");
            let t = known.seconds(cycle);
            let position = page.text("#read-position").await?;
            assert_eq!(reading(&position, "actual")?, f64::from(pulses.position_at(t)), "{position}");
            for (quantity, ideal) in [
                ("position", plan.position(t - zero_s)),
                ("speed", plan.speed(t - zero_s)),
                ("acceleration", plan.acceleration(t - zero_s)),
            ] {
                let text = page.text(&format!("#read-{quantity}")).await?;
                let shown = reading(&text, "ideal")?;
                ensure!((shown - ideal).abs() <= 1e-5 * ideal.abs(), "{text}, wanted {ideal}");
                ensure!(!text.contains(" to "), "a range: {text}");
            }
        }

        // So is the difference from a baseline, while both runs last.
        let later = Known::of(
            r#"{"source":{"motion":{"axes":[{"moves":[{"trapezoid":{"distance":{"steps":3000}}}]}]}}}"#,
        )?;
        let cycle = 4_100_456;
        page.click("#keep-run").await?;
        page.until("document.getElementById('compared').textContent.includes('Baseline')").await?;
        page.follow(&format!("{}&v=a{cycle}", later.link)).await?;
        page.until_digest(&later.digest).await?;
        page.click("#show-difference").await?;
        page.until("document.getElementById('read-position').textContent.includes('difference')").await?;
        let own = stepscope_core::peripheral::trace::steps(&later.recording.trace, 0);
        let own = Pulses::of_run(0, &own, &later.recording.packets, None, later.experiment.config());
        let t = known.seconds(cycle);
        let wanted = f64::from(own.position_at(t)) - f64::from(pulses.position_at(t));
        assert_eq!(reading(&page.text("#read-position").await?, "difference")?, wanted);
        Ok(())
    })
}

/// Handles and flags that cover a reading, or the name of a chart.
const COVERED: &str = "
    const seen = (css) => [...document.querySelectorAll(css)].filter((node) => node.checkVisibility() && node.textContent.trim());
    const over = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
    return seen('.caption > *, #cursor-readings, #hover-reading, .legend, .axes button').flatMap((text) => seen('.handle > span, .flag')
        .filter((flag) => over(text.getBoundingClientRect(), flag.getBoundingClientRect())).map((flag) => `${flag.textContent} on ${text.textContent}`));";

#[test]
fn handles_and_flags_do_not_cover_a_reading() -> Result<()> {
    in_browser(|page| async move {
        for (width, height) in [(1440, 900), (390, 844)] {
            page.screen(width, height).await?;
            for cycles in ["a10.b20", "a3200000.b3300000", "a6300000.b6400000"] {
                let known = Known::of("{}")?;
                page.open(&format!("#{}&v={cycles}", known.link)).await?;
                for tab in ["motion", "pulses"] {
                    if width < 900 {
                        page.click(&format!("#tab-{tab}")).await?;
                    }
                    let canvas = if tab == "motion" { "#charts" } else { "#pulses" };
                    page.press(canvas, &format!("{SHIFT}1{RELEASE}")).await?;
                    page.until("document.querySelector('.flag') !== null").await?;
                    let covered: Vec<String> = page.js(COVERED, vec![]).await?;
                    ensure!(covered.is_empty(), "{width} x {height}, {tab}, {cycles}: {covered:?}");
                    page.press(canvas, &format!("{SHIFT}1{RELEASE}")).await?;
                    page.until("document.querySelector('.flag') === null").await?;
                }
            }
        }
        Ok(())
    })
}
