//! Numbers that change without typing: arrow keys, a dragged label, a slider, and the corners of the speed curve.

use anyhow::{Result, ensure};
use fantoccini::actions::{InputSource as _, MOUSE_BUTTON_LEFT, MouseActions, PointerAction};
use serde_json::json;
use std::time::Duration;

use crate::{
    bench::in_browser,
    native::Known,
    session::{RELEASE, SHIFT, Session, field},
};

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

/// Presses at the middle of an element and drags by a distance in several moves, without lifting.
async fn press_and_drag(page: &Session, script: &str, by: (f64, f64)) -> Result<()> {
    const MOVES: u32 = 10;
    let [x, y]: [f64; 2] = page.eval(script).await?;
    let mut mouse = MouseActions::new("mouse".into())
        .then(PointerAction::MoveTo { duration: None, x, y })
        .then(PointerAction::Down { button: MOUSE_BUTTON_LEFT });
    for step in 1..=MOVES {
        let share = f64::from(step) / f64::from(MOVES);
        let (x, y) = (x + by.0 * share, y + by.1 * share);
        mouse = mouse.then(PointerAction::MoveTo { duration: Some(Duration::from_millis(20)), x, y });
    }
    page.actions(mouse).await
}

async fn lift(page: &Session) -> Result<()> {
    page.actions(MouseActions::new("mouse".into()).then(PointerAction::Up { button: MOUSE_BUTTON_LEFT }))
        .await
}

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
        press_and_drag(&page, &middle(&label(DURATION)), (40.0, 0.0)).await?;
        page.until_digest(&Known::of(&with_times(0.5, 0.2))?.digest).await?;
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
        const CORNERS: &str = "[...document.querySelectorAll('.corner')].filter((node) => !node.hidden)";
        page.until_equal(&format!("{CORNERS}.length"), &json!(2)).await?;
        // To the left and down: a shorter ramp and a lower top speed.
        press_and_drag(&page, &middle(&format!("{CORNERS}[0]")), (-30.0, 10.0)).await?;
        lift(&page).await?;
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
