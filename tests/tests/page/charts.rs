//! The views of motion and spectrum: readings between two cursors, zooming, comparison with a baseline,
//! highlighted harmonics, and the values as a table and as files.

use anyhow::{Context, Result, ensure};
use fantoccini::actions::{InputSource, MOUSE_BUTTON_LEFT, MOUSE_BUTTON_RIGHT, MouseActions, PointerAction};
use serde_json::{Value, json};
use stepscope_core::{
    inspect::motion::{
        actual_motion::Pulses,
        cursor_stats,
        position_error::{self, Scaled},
    },
    peripheral::trace::steps,
};

use crate::{bench::in_browser, native::Known, session::Session};

/// A number in the format of the page.
fn number(text: &str) -> Result<f64> {
    text.trim().replace('\u{2212}', "-").parse().with_context(|| format!("`{text}` is no number"))
}

/// The numbers of a table's rows.
async fn rows(page: &Session, css: &str) -> Result<Vec<Vec<f64>>> {
    let cells: Vec<Vec<String>> = page
        .eval(&format!(
            "[...document.querySelectorAll('{css} tbody tr')].map((row) => [...row.querySelectorAll('td.number')].map((cell) => cell.textContent))"
        ))
        .await?;
    cells.iter().map(|row| row.iter().map(|cell| number(cell)).collect()).collect()
}

#[test]
fn two_cursors_show_the_means_of_the_core() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of("{}")?;
        let (a, b) = (1_600_123, 4_100_456);
        page.open(&format!("#{}&v=a{a}.b{b}", known.link)).await?;
        page.until("!document.getElementById('between').hidden").await?;
        let plan = &known.experiment.plans()[0];
        let zero_s =
            known.recording.first_tick().context("a tick")?.seconds(known.experiment.config().clock_hz());
        let (from, to) = (known.seconds(a), known.seconds(b));
        let steps = steps(&known.recording.trace, 0);
        let pulses = Pulses::of_run(0, &steps, &known.recording.packets, None, known.experiment.config());
        let ideal = cursor_stats::ideal(plan, zero_s, from, to);
        let made = cursor_stats::actual(&pulses, from, to);
        let moments = [ideal.position, ideal.speed, ideal.acceleration.context("a curve has one")?];
        let at = |t: f64| [plan.position(t - zero_s), plan.speed(t - zero_s), plan.acceleration(t - zero_s)];
        let expected: Vec<[f64; 5]> = (0..3)
            .map(|i| [at(from)[i], at(to)[i], at(to)[i] - at(from)[i], moments[i].mean, moments[i].rms])
            .collect();
        let shown = rows(&page, "#between table:nth-of-type(1)").await?;
        ensure!(shown.len() == 3 && shown.iter().all(|row| row.len() == 5), "{shown:?}");
        for (shown, expected) in shown.iter().flatten().zip(expected.iter().flatten()) {
            ensure!((shown - expected).abs() <= 1e-5 * expected.abs(), "{shown} is not {expected}");
        }
        let shown = rows(&page, "#between table:nth-of-type(2)").await?;
        for (row, moments) in [(0, made.position), (1, made.speed)] {
            for (column, expected) in [(3, moments.mean), (4, moments.rms)] {
                let shown = shown[row][column];
                ensure!((shown - expected).abs() <= 1e-5 * expected.abs(), "{shown} is not {expected}");
            }
        }
        assert_eq!(shown[0][0], f64::from(pulses.position_at(from)));
        let sentence = page.eval::<String>("document.getElementById('motion-sentence').textContent").await?;
        ensure!(sentence.contains("Between the cursors") && sentence.contains("Hz"), "spoken: {sentence}");
        page.press("#charts", "\u{e00c}").await?;
        page.until("document.getElementById('between').hidden").await
    })
}

/// Drags over the charts between two parts of their width.
async fn drag(page: &Session, from: f64, to: f64, button: u64) -> Result<()> {
    let (x, y, width): (f64, f64, f64) = page
        .eval(
            "(({ x, y, width }) => [x, y, width])(document.getElementById('charts').getBoundingClientRect())",
        )
        .await?;
    let at = |part: f64| PointerAction::MoveTo { duration: None, x: x + width * part, y: y + 40.0 };
    let mouse = MouseActions::new("mouse".into())
        .then(at(from))
        .then(PointerAction::Down { button })
        .then(at(f64::midpoint(from, to)))
        .then(at(to))
        .then(PointerAction::Up { button });
    page.actions(mouse).await
}

const SHOWN: &str =
    "['window-start', 'window-end'].map((id) => document.getElementById(id).value).join(' to ')";

#[test]
fn a_box_zooms_in_and_back_restores_the_range() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        let whole: String = page.eval(SHOWN).await?;
        drag(&page, 0.3, 0.6, MOUSE_BUTTON_RIGHT).await?;
        page.until(&format!("{SHOWN} !== '{whole}'")).await?;
        let first: String = page.eval(SHOWN).await?;
        page.click("[data-time=box]").await?;
        drag(&page, 0.2, 0.5, MOUSE_BUTTON_LEFT).await?;
        page.until(&format!("{SHOWN} !== '{first}'")).await?;
        let second: String = page.eval(SHOWN).await?;
        page.press("#charts", "\u{e00c}").await?;
        page.until("document.querySelector('[data-time=box]').ariaPressed === 'false'").await?;
        // A drag without a box moves the time, in many messages and one undo step.
        drag(&page, 0.5, 0.4, MOUSE_BUTTON_LEFT).await?;
        page.until(&format!("{SHOWN} !== '{second}'")).await?;
        page.press("#charts", "\u{e003}").await?;
        page.until_equal(SHOWN, &json!(second)).await?;
        page.click("[data-time=back]").await?;
        page.until_equal(SHOWN, &json!(first)).await?;
        page.click("[data-time=back]").await?;
        page.until_equal(SHOWN, &json!(whole)).await?;
        page.until("document.querySelector('[data-time=back]').disabled").await
    })
}

/// Counts the strokes on each canvas.
const COUNT: &str = "window.strokes = {}; for (const name of ['stroke', 'fillText', 'strokeRect']) {
    const real = CanvasRenderingContext2D.prototype[name];
    CanvasRenderingContext2D.prototype[name] = function (...given) {
        window.strokes[this.canvas.id] = (window.strokes[this.canvas.id] ?? 0) + 1; return real.apply(this, given); }; }";

#[test]
fn a_moving_pointer_redraws_only_the_cursor_layer() -> Result<()> {
    in_browser(|page| async move {
        page.before_scripts(COUNT).await?;
        page.open("").await?;
        page.js::<Value>("window.strokes = {}; return null;", vec![]).await?;
        let (x, y, width): (f64, f64, f64) = page
            .eval("(({ x, y, width }) => [x, y, width])(document.getElementById('charts').getBoundingClientRect())")
            .await?;
        let mut mouse = MouseActions::new("mouse".into());
        for part in 3..9 {
            let x = x + width * f64::from(part) / 10.0;
            mouse = mouse.then(PointerAction::MoveTo { duration: None, x, y: y + 40.0 });
        }
        page.actions(mouse).await?;
        page.until("document.getElementById('motion-time').textContent.includes('cycle')").await?;
        page.until("document.getElementById('read-speed').textContent.includes('actual')").await?;
        let drawn: std::collections::BTreeMap<String, u32> = page.eval("window.strokes").await?;
        for layer in ["charts-cursor", "pulses-cursor"] {
            ensure!(drawn.get(layer).is_some_and(|strokes| *strokes > 0), "{layer} follows: {drawn:?}");
        }
        for chart in ["chart-position", "chart-speed", "chart-acceleration", "pulses", "spectrum-chart"] {
            ensure!(!drawn.contains_key(chart), "{chart} was drawn again: {drawn:?}");
        }
        Ok(())
    })
}

#[test]
fn a_baseline_is_drawn_and_measured_next_to_a_later_run() -> Result<()> {
    in_browser(|page| async move {
        let baseline = Known::of(r#"{"title":"S-curve"}"#)?;
        let later = Known::of(
            r#"{"source":{"motion":{"axes":[{"moves":[{"trapezoid":{"distance":{"steps":3000}}}]}]}}}"#,
        )?;
        page.open(&format!("#{}", baseline.link)).await?;
        page.until_digest(&baseline.digest).await?;
        assert_eq!(page.canvas("chart-position").await?.ink("--baseline").pixels, 0);
        page.click("#keep-run").await?;
        page.until("document.getElementById('compared').textContent.includes('Baseline: S-curve')").await?;

        // Another experiment, without reloading the page.
        page.follow(&later.link).await?;
        page.until_digest(&later.digest).await?;
        page.until("document.getElementById('compared').textContent.includes('maximum difference')").await?;
        for chart in ["chart-position", "chart-speed", "chart-acceleration"] {
            let look =
                async || Ok((page.canvas(chart).await?.ink("--baseline").columns > 100.0).then_some(()));
            page.eventually(&format!("{chart} has the baseline's curve"), look).await?;
        }
        let cycles = |known: &Known| known.experiment.run(&mut Vec::new()).cycles().0;
        let (own, other) = (steps(&later.recording.trace, 0), steps(&baseline.recording.trace, 0));
        let scaled =
            |steps| Scaled { steps, hz: f64::from(baseline.experiment.config().clock_hz()), unit: 1.0 };
        let common_s = baseline.seconds(cycles(&later).min(cycles(&baseline)));
        let apart = position_error::compare(scaled(&own), scaled(&other), common_s);
        let told = page.text("#compared").await?.replace('\u{2212}', "-");
        ensure!(
            told.contains(&format!("maximum difference {} steps", apart.largest.abs())),
            "{} in {told}",
            apart.largest
        );
        let rows: Vec<Vec<String>> = page
            .eval("[...document.querySelectorAll('#compared-tables tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent))")
            .await?;
        for fact in ["duration", "peak speed", "peak acceleration", "RMS lag", "edges"] {
            let row =
                rows.iter().find(|row| row[0] == fact).with_context(|| format!("{fact} in {rows:?}"))?;
            ensure!(row.len() == 4 && row[1..].iter().all(|cell| !cell.is_empty()), "{row:?}");
        }
        let duration = rows.iter().find(|row| row[0] == "duration").context("a duration")?;
        assert_eq!(duration[1], "400 ms", "{duration:?}");
        page.press("#charts", "\u{e008}\u{e012}").await?;
        page.until("/ideal .*baseline /.test(document.getElementById('read-position').textContent)").await?;

        let both = page.canvas("chart-position").await?.hash;
        page.click("#show-difference").await?;
        page.until("document.getElementById('caption-position').textContent.includes('minus the baseline')")
            .await?;
        let look = async || Ok((page.canvas("chart-position").await?.hash != both).then_some(()));
        page.eventually("the difference is drawn", look).await?;
        assert_eq!(page.canvas("chart-position").await?.ink("--baseline").pixels, 0);

        page.click("[aria-label='Clear the baseline']").await?;
        page.until("document.getElementById('compared').hidden").await?;
        let look =
            async || Ok((page.canvas("chart-speed").await?.ink("--baseline").pixels == 0).then_some(()));
        page.eventually("the baseline's curve is missing", look).await
    })
}

#[test]
fn hovering_over_a_harmonic_highlights_its_stem_and_row() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.preset("sine-2022-d0006").await?;
        page.until("document.getElementById('thd').textContent.includes('0.26')").await?;
        let note = page.text("#spectrum-note").await?;
        for said in ["no window", "coherent", "harmonics 2 to 1000", "250 mHz"] {
            ensure!(note.contains(said), "{said} in {note}");
        }
        // Chart and table next to each other.
        page.click("#view-spectrum .most").await?;
        page.until("document.getElementById('harmonics').checkVisibility()").await?;
        let dark = page.canvas("spectrum-cursor").await?.hash;
        page.press("#spectrum-pane", "\u{e014}\u{e014}\u{e014}").await?;
        let highlighted =
            "[...document.querySelectorAll('#harmonics .highlighted')].map((row) => row.dataset.n).join()";
        page.until_equal(highlighted, &json!("3")).await?;
        let third = page.canvas("spectrum-cursor").await?.hash;
        ensure!(third != dark, "the stem is marked");
        let spoken: String = page.eval("document.getElementById('spectrum-pane').ariaValueText").await?;
        ensure!(
            spoken.contains("harmonic 3") && spoken.contains("dB") && spoken.contains("750 mHz"),
            "{spoken}"
        );
        page.press("#spectrum-pane", "\u{e010}").await?;
        page.until_equal(highlighted, &json!("1000")).await?;
        page.press("#spectrum-pane", "\u{e011}").await?;
        page.until_equal(highlighted, &json!("1")).await?;
        let (x, y): (f64, f64) = page
            .eval("(({ x, y }) => [x + 4, y + 4])(document.querySelector('#harmonics tr[data-n=\"5\"] td').getBoundingClientRect())")
            .await?;
        let to = PointerAction::MoveTo { duration: None, x, y };
        page.actions(MouseActions::new("mouse".into()).then(to)).await?;
        page.until_equal(highlighted, &json!("5")).await?;
        page.press("#spectrum-pane", "\u{e00c}").await?;
        page.until_equal(highlighted, &json!("")).await
    })
}

#[test]
fn keys_move_a_cursor_and_a_table_shows_its_values() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.press("#charts", "\u{e008}\u{e014}").await?;
        page.until(
            "/Cursor A at .*position: .*speed: /.test(document.getElementById('motion-spoken').textContent)",
        )
        .await?;
        page.click("#motion-data summary").await?;
        page.until_equal("document.querySelectorAll('#record-rows tr').length", &json!(50)).await?;
        let head: Vec<String> = page
            .eval("[...document.querySelectorAll('#record-head th')].map((cell) => cell.textContent)")
            .await?;
        assert_eq!(head.len(), 6, "time and five curves: {head:?}");
        ensure!(head[1..].iter().all(|cell| cell.contains("steps")), "with their units: {head:?}");
        let first = page.text("#record-rows").await?;
        page.click("#record-buttons button:last-child").await?;
        page.until("document.getElementById('record-page').textContent.includes('51 to 100')").await?;
        ensure!(page.text("#record-rows").await? != first, "another page has other rows");
        let details: String =
            page.eval("document.getElementById('charts').getAttribute('aria-details')").await?;
        assert_eq!(details, "motion-data");
        Ok(())
    })
}

/// Stores the saved files by name instead of downloading them.
const KEEP: &str = "window.saved = {}; const make = URL.createObjectURL;
    URL.createObjectURL = (blob) => { window.last = blob; return make.call(URL, blob); };
    HTMLAnchorElement.prototype.click = function () { window.saved[this.download] = window.last; };";

#[test]
fn charts_are_saved_as_visible_pictures_and_tables() -> Result<()> {
    in_browser(|page| async move {
        page.before_scripts(KEEP).await?;
        page.open("").await?;
        page.click("#export").await?;
        page.until("document.querySelector('#export-list [data-file]') !== null").await?;
        for ends in ["-motion.svg", "-motion.csv", "-motion.png", "-spectrum.svg", "-spectrum.png"] {
            page.click(&format!("[data-file$='{ends}']")).await?;
            page.until(&format!("Object.keys(window.saved).some((name) => name.endsWith('{ends}'))")).await?;
            page.until("!document.querySelector('#export-list button').disabled").await?;
        }
        let read = "const name = Object.keys(window.saved).find((name) => name.endsWith(arguments[0]));
            return window.saved[name]";
        let text = async |ends: &str| page.js::<String>(&format!("{read}.text();"), vec![json!(ends)]).await;
        let csv = text("-motion.csv").await?;
        ensure!(csv.starts_with("time (s),position ideal min (steps),"), "{}", &csv[..200]);
        ensure!(csv.lines().count() > 500, "{} lines", csv.lines().count());
        ensure!(csv.lines().all(|line| line.split(',').count() == 11), "a column is missing");
        for (ends, charts) in [("-motion.svg", 3), ("-spectrum.svg", 1)] {
            let svg = text(ends).await?;
            let parsed: u32 = page
                .js(
                    "const doc = new DOMParser().parseFromString(arguments[0], 'image/svg+xml');
                    return doc.querySelector('parsererror') ? 0 : doc.querySelectorAll('svg > svg').length;",
                    vec![json!(svg)],
                )
                .await?;
            assert_eq!(parsed, charts, "{ends}");
        }
        for ends in ["-motion.png", "-spectrum.png"] {
            let (width, height): (u32, u32) = page
                .js(&format!("{read}.arrayBuffer().then((bytes) => [16, 20].map((at) => new DataView(bytes).getUint32(at)));"), vec![json!(ends)])
                .await?;
            ensure!(width == 2000 && height > 700, "{ends}: {width} x {height}");
        }
        Ok(())
    })
}
