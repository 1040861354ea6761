//! Numbers that change without typing: arrow keys, a dragged label, a slider, and the corners of the speed curve.

use anyhow::{Result, ensure};
use fantoccini::actions::{
    Actions, InputSource as _, KeyAction, KeyActions, MOUSE_BUTTON_LEFT, MouseActions, PointerAction,
};
use serde_json::{Value, json};
use std::time::Duration;

use crate::{
    bench::in_browser,
    native::Known,
    session::{RELEASE, SHIFT, Session, field},
};

const DISTANCE: &str = "source.motion.axes[0].moves[0].cosine.distance";
const DURATION: &str = "source.motion.axes[0].moves[0].cosine.duration_s";
const RAMP: &str = "source.motion.axes[0].moves[0].cosine.ramp_s";
const UP: char = '\u{e013}';
const DOWN: char = '\u{e015}';
const HOME: char = '\u{e011}';
const RIGHT: char = '\u{e014}';

fn with_times(duration_s: f64, ramp_s: f64) -> String {
    format!(
        r#"{{"source":{{"motion":{{"axes":[{{"moves":[{{"cosine":{{"duration_s":{duration_s},"ramp_s":{ramp_s}}}}}]}}]}}}}}}"#
    )
}

/// A mouse that is pressed at a point in CSS pixels of the window and moves through others by a tick each. A later command of
/// the driver would end the capture of the pointer, so a drag is one command.
fn dragging([x, y]: [f64; 2], through: impl IntoIterator<Item = (f64, f64)>) -> MouseActions {
    let press = MouseActions::new("mouse".into())
        .then(PointerAction::MoveTo { duration: None, x, y })
        .then(PointerAction::Down { button: MOUSE_BUTTON_LEFT });
    through.into_iter().fold(press, |mouse, (right, down)| {
        let (x, y) = (x + right, y + down);
        mouse.then(PointerAction::MoveTo { duration: Some(Duration::from_millis(20)), x, y })
    })
}

/// Drags by a distance in several moves.
async fn drag(page: &Session, from: [f64; 2], by: (f64, f64)) -> Result<()> {
    const MOVES: u32 = 10;
    let parts = (1..=MOVES).map(|part| f64::from(part) / f64::from(MOVES));
    let mouse = dragging(from, parts.map(|part| (by.0 * part, by.1 * part)));
    page.actions(mouse.then(PointerAction::Up { button: MOUSE_BUTTON_LEFT })).await
}

async fn lift(page: &Session) -> Result<()> {
    page.actions(MouseActions::new("mouse".into()).then(PointerAction::Up { button: MOUSE_BUTTON_LEFT }))
        .await
}

/// The visible handles of the speed's corners.
const CORNERS: &str = "[...document.querySelectorAll('.corner')].filter((node) => !node.hidden)";

/// The middle of an element, in CSS pixels of the window.
fn middle(element: &str) -> String {
    format!(
        "(() => {{ const node = {element}; node.scrollIntoView({{ block: 'center' }}); const box = node.getBoundingClientRect(); \
         return [Math.round(box.left + box.width / 2), Math.round(box.top + box.height / 2)]; }})()"
    )
}

fn label(path: &str) -> String {
    format!("document.querySelector({:?}).closest('.field').querySelector('.term')", field(path))
}

#[test]
fn arrow_keys_step_the_digit_before_the_cursor_and_are_one_step_of_undo() -> Result<()> {
    in_browser(|page| async move {
        let before = Known::of("{}")?.digest;
        page.open("").await?;
        page.until_digest(&before).await?;
        let css = field(DURATION);
        // 0.4: the cursor behind its last digit, then behind the 0.
        page.press(&css, &format!("{UP}{UP}{SHIFT}{UP}{RELEASE}{DOWN}")).await?;
        page.until_digest(&Known::of(&with_times(1.5, 0.2))?.digest).await?;
        assert_eq!(page.field(DURATION).await?.value, "1.5");
        page.press(&css, &format!("{HOME}{RIGHT}{UP}")).await?;
        page.until_digest(&Known::of(&with_times(2.5, 0.2))?.digest).await?;
        page.click("#undo").await?;
        page.until_digest(&before).await?;
        // A step does not leave the range: the ramp is at its maximum, half of the duration.
        page.press(&field(RAMP), &format!("{UP}")).await?;
        page.ready().await?;
        assert_eq!(page.field(RAMP).await?.value, "0.2");
        Ok(())
    })
}

#[test]
fn a_dragged_label_changes_its_number_and_the_picture_follows() -> Result<()> {
    in_browser(|page| async move {
        let before = Known::of("{}")?.digest;
        page.open("").await?;
        page.until_digest(&before).await?;
        // A step is 4 px and a tenth of the first digit: 40 px are 0.1 s.
        let peak = page.derived("Peak rate").await?;
        let from = page.eval(&middle(&label(DURATION))).await?;
        page.actions(dragging(from, (1..=10).map(|part| (4.0 * f64::from(part), 0.0)))).await?;
        page.until_digest(&Known::of(&with_times(0.5, 0.2))?.digest).await?;
        // The derived values follow, too, and nothing else of the form moves.
        let followed = page.derived("Peak rate").await?;
        ensure!(followed != peak, "the peak rate is {followed} as before");
        lift(&page).await?;
        assert_eq!(page.field(DURATION).await?.value, "0.50");
        ensure!(
            page.eval::<bool>("document.querySelector(':popover-open') === null").await?,
            "the help card opens for a click only"
        );
        page.click("#undo").await?;
        page.until_digest(&before).await?;
        ensure!(page.eval::<bool>("document.getElementById('undo').disabled").await?, "one step of undo");
        page.js::<()>(&format!("{}.click(); return null;", label(DURATION)), vec![]).await?;
        page.until("document.querySelector(':popover-open') !== null").await
    })
}

#[test]
fn shift_in_a_drag_multiplies_only_what_follows() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.ready().await?;
        let from = page.eval(&middle(&label(DISTANCE))).await?;
        let mouse =
            dragging(from, [(20.0, 0.0), (40.0, 0.0), (40.0, 0.0), (44.0, 0.0), (44.0, 0.0), (48.0, 0.0)])
                .then(PointerAction::Up { button: MOUSE_BUTTON_LEFT });
        let pause = || KeyAction::Pause { duration: Duration::ZERO };
        // A tick for the way to the label, for the press, and for each move.
        let keys = (0..4)
            .fold(KeyActions::new("keys".into()), |keys, _| keys.then(pause()))
            .then(KeyAction::Down { value: SHIFT })
            .then(pause())
            .then(KeyAction::Up { value: SHIFT });
        page.actions(Actions::from(mouse).and(keys)).await?;
        // Ten steps, ten more with Shift, and one.
        page.ready().await?;
        assert_eq!(page.field(DISTANCE).await?.value, "5300");
        page.click("#undo").await?;
        page.until_digest(&Known::of("{}")?.digest).await
    })
}

#[test]
fn a_held_arrow_key_is_one_step_of_undo() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.ready().await?;
        let held = format!(
            "const input = document.querySelector({:?}); input.focus(); input.setSelectionRange(9, 9); \
             const key = (type, repeat) => input.dispatchEvent(new KeyboardEvent(type, {{ key: 'ArrowUp', repeat, bubbles: true, cancelable: true }})); \
             for (let count = 0; count < 25; count += 1) key('keydown', count > 0); return input.value;",
            field(DISTANCE)
        );
        assert_eq!(page.js::<String>(&held, vec![]).await?, "3225", "the number shows each press at once");
        // The picture follows while the key is still pressed.
        let known = Known::of(
            r#"{"source":{"motion":{"axes":[{"moves":[{"cosine":{"distance":{"steps":3225}}}]}]}}}"#,
        )?;
        page.until_digest(&known.digest).await?;
        assert_eq!(page.field(DISTANCE).await?.value, "3225");
        page.js::<()>("document.activeElement.blur(); return null;", vec![]).await?;
        page.click("#undo").await?;
        page.until_digest(&Known::of("{}")?.digest).await?;
        ensure!(page.eval::<bool>("document.getElementById('undo').disabled").await?, "one step of undo");
        Ok(())
    })
}

#[test]
fn a_finger_that_scrolls_the_form_changes_no_number() -> Result<()> {
    in_browser(|page| async move {
        let phone = json!({ "width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": true });
        page.devtools("Emulation.setDeviceMetricsOverride", phone).await?;
        page.devtools("Emulation.setTouchEmulationEnabled", json!({ "enabled": true, "maxTouchPoints": 5 }))
            .await?;
        let touch = async |kind: &str, points: Value| {
            page.devtools("Input.dispatchTouchEvent", json!({ "type": kind, "touchPoints": points })).await
        };
        let known = Known::of("{}")?;
        for (across, along) in [(24.0, -80.0), (72.0, -80.0), (50.0, 10.0)] {
            page.open(&format!("#{}", known.link)).await?;
            page.until_digest(&known.digest).await?;
            page.js::<()>("document.getElementById('sheet').open = true; return null;", vec![]).await?;
            let [x, y]: [f64; 2] = page.eval(&middle(&label(DISTANCE))).await?;
            let scrolled: f64 = page.eval("scrollY").await?;
            touch("touchStart", json!([{ "x": x, "y": y }])).await?;
            for part in 1..=10 {
                let part = f64::from(part) / 10.0;
                touch("touchMove", json!([{ "x": x + across * part, "y": y + along * part }])).await?;
            }
            touch("touchEnd", json!([])).await?;
            if along.abs() > across {
                page.until(&format!("scrollY > {scrolled} + 20")).await?;
                assert_eq!(page.field(DISTANCE).await?.value, "3200");
                page.until_digest(&known.digest).await?;
            } else {
                // The first move of a finger counts for nothing: 40 px are ten steps.
                page.until(&format!("document.querySelector('{}').value === '4200'", field(DISTANCE)))
                    .await?;
            }
        }
        Ok(())
    })
}

#[test]
fn a_slider_moves_the_ramp_within_half_of_the_duration() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        let slider = format!(
            "document.querySelector({:?}).closest('.field').querySelector('[type=range]')",
            field(RAMP)
        );
        assert_eq!(
            page.eval::<Vec<String>>(&format!("[{slider}.min, {slider}.max, {slider}.value]")).await?,
            ["0", "0.2", "0.2"]
        );
        let script = format!(
            "{slider}.value = '0.05'; {slider}.dispatchEvent(new Event('input')); {slider}.value = '0.1'; \
             {slider}.dispatchEvent(new Event('input')); {slider}.dispatchEvent(new Event('change')); return true;"
        );
        page.js::<bool>(&script, vec![]).await?;
        page.until_digest(&Known::of(&with_times(0.4, 0.1))?.digest).await?;
        page.click("#undo").await?;
        page.until_digest(&Known::of("{}")?.digest).await
    })
}

#[test]
fn a_dragged_corner_of_the_speed_changes_ramp_and_top_speed() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(&with_times(0.4, 0.1))?;
        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        page.until_equal(&format!("{CORNERS}.length"), &json!(2)).await?;
        // To the left and down: a shorter ramp and a lower top speed.
        drag(&page, page.eval(&middle(&format!("{CORNERS}[0]"))).await?, (-30.0, 10.0)).await?;
        page.until("document.getElementById('undo').disabled === false && document.documentElement.dataset.state === 'ready'").await?;
        let [duration, ramp] = [page.field(DURATION).await?.value, page.field(RAMP).await?.value];
        ensure!(ramp.parse::<f64>()? < 0.1, "the ramp lasts {ramp} s");
        ensure!(
            3200.0 / (duration.parse::<f64>()? - ramp.parse::<f64>()?) < 3200.0 / 0.3,
            "the top speed of {duration} s"
        );
        page.click("#undo").await?;
        page.until_digest(&known.digest).await
    })
}

/// Records each number that a field shows.
const RECORD: &str = "
    const input = document.querySelector(arguments[0]);
    window.shown = [Number(input.value)];
    const record = () => {
        const value = Number(input.value);
        if (value !== window.shown.at(-1)) window.shown.push(value);
        requestAnimationFrame(record);
    };
    record();
    return null;";

#[test]
fn the_last_corner_follows_the_pointer_evenly() -> Result<()> {
    const PX: f64 = 72.0;
    in_browser(|page| async move {
        let known = Known::of(&with_times(0.4, 0.1))?;
        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        page.until_equal(&format!("{CORNERS}.length"), &json!(2)).await?;
        let first: [f64; 2] = page.eval(&middle(&format!("{CORNERS}[0]"))).await?;
        let last: [f64; 2] = page.eval(&middle(&format!("{CORNERS}[1]"))).await?;
        page.js::<()>(RECORD, vec![json!(field(RAMP))]).await?;
        drag(&page, last, (-PX, 0.0)).await?;
        // The corners are at 0.1 and 0.3 s. The axes of the chart stay, although each run is longer than the one before.
        let seconds_per_px = 0.2 / (last[0] - first[0]);
        let wanted = 0.1 + PX * seconds_per_px;
        page.ready().await?;
        let ramps: Vec<f64> = page.eval("window.shown").await?;
        ensure!(ramps.is_sorted() && ramps.len() > 1, "the ramp goes back: {ramps:?}");
        let ramp: f64 = page.field(RAMP).await?.value.parse()?;
        // A pixel, and the third digit of the ramp.
        ensure!((ramp - wanted).abs() <= seconds_per_px + 0.0005, "the ramp lasts {ramp} s, not {wanted} s");
        // The top speed is the same.
        let duration: f64 = page.field(DURATION).await?.value.parse()?;
        ensure!((duration - ramp - 0.3).abs() < 1e-9, "{duration} s with ramps of {ramp} s");
        page.click("#undo").await?;
        page.until_digest(&known.digest).await
    })
}

#[test]
fn a_click_beside_the_middle_of_a_corner_changes_nothing_and_sets_the_cursor() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(&with_times(0.4, 0.1))?;
        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        page.until_equal(&format!("{CORNERS}.length"), &json!(2)).await?;
        let [x, y]: [f64; 2] = page.eval(&middle(&format!("{CORNERS}[0]"))).await?;
        drag(&page, [x + 8.0, y], (1.0, 0.0)).await?;
        page.until("document.querySelector('#charts-handles .handle.a').ariaValueText !== 'not set'").await?;
        page.ready().await?;
        page.until_digest(&known.digest).await?;
        // A drag that starts there moves the corner by the length of the drag.
        let next: [f64; 2] = page.eval(&middle(&format!("{CORNERS}[1]"))).await?;
        let seconds_per_px = 0.2 / (next[0] - x);
        drag(&page, [x + 8.0, y], (30.0, 0.0)).await?;
        page.ready().await?;
        let ramp: f64 = page.field(RAMP).await?.value.parse()?;
        let wanted = 0.1 + 30.0 * seconds_per_px;
        ensure!((ramp - wanted).abs() <= seconds_per_px + 0.0005, "the ramp lasts {ramp} s, not {wanted} s");
        let duration: f64 = page.field(DURATION).await?.value.parse()?;
        ensure!((duration - ramp - 0.3).abs() < 1e-9, "the top speed changed: {duration} s with {ramp} s");
        Ok(())
    })
}

#[test]
fn text_that_is_no_number_survives_a_drag_of_a_corner() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(&with_times(0.4, 0.1))?;
        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        page.until_equal(&format!("{CORNERS}.length"), &json!(2)).await?;
        let at: [f64; 2] = page.eval(&middle(&format!("{CORNERS}[0]"))).await?;
        page.fill(DISTANCE, "48oo").await?;
        page.until_equal(&format!("{CORNERS}.length"), &json!(0)).await?;
        drag(&page, at, (-30.0, 10.0)).await?;
        page.ready().await?;
        let shown = page.field(DISTANCE).await?;
        ensure!(shown.value == "48oo" && shown.invalid, "{shown:?}");
        assert_eq!(page.field(RAMP).await?.value, "0.1");
        // Undo discards it, back to the last number on the way, and Redo restores it.
        page.click("#undo").await?;
        assert_eq!(page.field(DISTANCE).await?.value, "48");
        page.until_equal(&format!("{CORNERS}.length"), &json!(2)).await?;
        page.click("#redo").await?;
        assert_eq!(page.field(DISTANCE).await?.value, "48oo");
        // Another unit leaves it, too.
        page.choose(&format!("[data-path='{DISTANCE}#unit']"), "deg").await?;
        assert_eq!(page.field(DISTANCE).await?.value, "48oo");
        Ok(())
    })
}

#[test]
fn corners_are_shown_only_on_a_visible_curve_that_is_not_shaped() -> Result<()> {
    const TWO: &str = r#"{"bus":{"channels":2},"source":{"motion":{"axes":[{"moves":[{"cosine":{"ramp_s":0.1}}]},{"moves":[{"cosine":{"duration_s":0.5}}]}]}}}"#;
    const SHAPED: &str = r#"{"source":{"motion":{"axes":[{"moves":[{"cosine":{"ramp_s":0.1}}],"input_shaper":{"zv":{"frequency_hz":45,"damping_ratio":0.1}}}]}}}"#;
    in_browser(|page| async move {
        let known = Known::of(TWO)?;
        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        page.until_equal(&format!("{CORNERS}.length"), &json!(2)).await?;
        page.click("#motion-axes [data-axis='0']").await?;
        page.until_equal(&format!("{CORNERS}.length"), &json!(0)).await?;
        page.click("#motion-axes [data-axis='0']").await?;
        page.until_equal(&format!("{CORNERS}.length"), &json!(2)).await?;
        let known = Known::of(SHAPED)?;
        page.follow(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        page.until_equal(&format!("{CORNERS}.length"), &json!(0)).await
    })
}

#[test]
fn nothing_moves_between_the_clicks_of_a_double_click() -> Result<()> {
    in_browser(|page| async move {
        page.screen(1366, 768).await?;
        page.open("").await?;
        // The last field that is visible at the bottom of the form.
        let script = "(() => { const form = document.getElementById('sheet-scroll').getBoundingClientRect(); \
            const seen = [...document.querySelectorAll('#fields .box > input')].filter((node) => node.checkVisibility() && node.getBoundingClientRect().bottom < form.bottom); \
            const node = seen[seen.length - 1]; window.target = node; const box = node.getBoundingClientRect(); return [Math.round(box.left + 9), Math.round(box.top + 9)]; })()";
        let [x, y]: [f64; 2] = page.eval(script).await?;
        let click = |mouse: MouseActions| {
            mouse
                .then(PointerAction::Down { button: MOUSE_BUTTON_LEFT })
                .then(PointerAction::Up { button: MOUSE_BUTTON_LEFT })
        };
        let mouse = MouseActions::new("mouse".into()).then(PointerAction::MoveTo { duration: None, x, y });
        page.actions(click(mouse)).await?;
        let before: f64 = page.eval("target.getBoundingClientRect().top").await?;
        page.actions(click(MouseActions::new("mouse".into()))).await?;
        ensure!(page.eval::<bool>("document.activeElement === target").await?, "the field has the focus");
        assert!((page.eval::<f64>("target.getBoundingClientRect().top").await? - before).abs() < 0.5);
        ensure!(
            before.round() + 9.0 - y <= 1.0 && y - before - 9.0 <= 1.0,
            "the field moved by {}",
            before + 9.0 - y
        );
        Ok(())
    })
}

#[test]
fn on_a_phone_a_chart_stays_in_sight_over_the_form_and_the_note_is_visible() -> Result<()> {
    in_browser(|page| async move {
        page.screen(390, 844).await?;
        page.open(&format!("#{}", Known::preset(&stepscope_core::scenario::presets::PRESETS[0])?.link))
            .await?;
        ensure!(page.visible("#about p").await?, "the note is not in the folded form");
        page.click("#sheet > summary").await?;
        page.js::<()>(
            "document.querySelector('[data-path=\"bus.slots\"]').scrollIntoView({ block: 'center' }); return null;",
            vec![],
        )
        .await?;
        page.until("(() => { const { top, bottom, height } = document.getElementById('mini').getBoundingClientRect(); return top >= -1 && bottom < 150 && height > 80; })()").await?;
        ensure!(page.canvas("mini").await?.inks["--ideal"].pixels > 100, "the curve is drawn");
        Ok(())
    })
}
