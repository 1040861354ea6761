//! No input is lost: by a reload, a link, a removed field, a structure button, another kind, or another
//! tab.

use anyhow::{Result, ensure};
use fantoccini::actions::{InputSource, MOUSE_BUTTON_LEFT, MouseActions, PointerAction};

use crate::{
    bench::in_browser,
    native::{DISTANCE, Known, link_of, with_distance},
    session::{ENTER, Session, field},
};

const SAVED: &str = "localStorage.getItem('stepscope.scenario') ?? ''";

#[test]
fn invalid_work_survives_a_reload_and_has_no_link() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.fill("bus.queue_depth", "7").await?;
        page.until(&format!("{SAVED}.includes('\"queue_depth\":7')")).await?;
        page.ready().await?;
        page.fill(DISTANCE, "0").await?;
        page.until("document.querySelector('#status').textContent.startsWith('not run')").await?;
        page.click("#share").await?;
        ensure!(page.text("#link-about").await?.starts_with("No link:"), "a link of what does not stand");
        ensure!(page.eval::<bool>("document.getElementById('copy-link').disabled").await?, "nothing to copy");

        page.open("").await?;
        assert_eq!(page.field("bus.queue_depth").await?.value, "7");
        assert_eq!(page.field(DISTANCE).await?.value, "0");
        assert_eq!(page.text("#link-message").await?, "");
        // The views show the last run, dimmed.
        let last = Known::of(r#"{"bus":{"queue_depth":7}}"#)?;
        page.until_equal("document.getElementById('digest').textContent", &last.digest.into()).await?;
        page.ready().await?;
        ensure!(page.shown().await?.stale, "it is shown as what it is not");
        page.until("document.getElementById('views').className === 'views dim'").await?;
        page.canvas("chart-position").await?.has_curve("--ideal")?;
        let mended = with_distance(500.0).replacen('{', r#"{"bus":{"queue_depth":7},"#, 1);
        page.fill(DISTANCE, "500").await?;
        page.until_digest(&Known::of(&mended)?.digest).await
    })
}

#[test]
fn undo_after_a_reload_restores_the_work_before_an_edited_link() -> Result<()> {
    in_browser(|page| async move {
        let (own, shared) = (Known::of(&with_distance(1234.0))?, Known::of(&with_distance(800.0))?);
        page.open("").await?;
        page.fill(DISTANCE, "1234").await?;
        page.until_digest(&own.digest).await?;
        page.open(&format!("#{}", shared.link)).await?;
        page.until_digest(&shared.digest).await?;
        page.fill(DISTANCE, "801").await?;
        page.until_digest(&Known::of(&with_distance(801.0))?.digest).await?;

        page.open("").await?;
        page.until_digest(&Known::of(&with_distance(801.0))?.digest).await?;
        page.click("#undo").await?;
        page.until_digest(&shared.digest).await?;
        page.click("#undo").await?;
        page.until_digest(&own.digest).await
    })
}

#[test]
fn a_removed_field_with_an_error_blocks_nothing() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.fill("source.motion.axes[0].moves[0].cosine.duration_s", "zz").await?;
        page.until("document.querySelector('#digest').classList.contains('stale')").await?;
        page.choose("[data-path='source#kind']", "packets").await?;
        page.until("!document.querySelector('#status').textContent.startsWith('not run')").await?;
        page.ready().await
    })
}

/// Types into a field, then immediately presses a structure button by its key.
async fn edit_and_press(page: &Session, path: &str, text: &str, button: &str) -> Result<()> {
    page.fill(path, text).await?;
    page.press(&format!("#fields button[aria-label='{button}']"), &ENTER.to_string()).await
}

#[test]
fn structure_buttons_act_on_the_current_form() -> Result<()> {
    const MOVE: &str = r#"{"constant":{"distance":{"steps":40},"speed":{"steps_s":1000}}}"#;
    let motion = |axes: &str, rest: &str| format!(r#"{{{rest}"source":{{"motion":{{"axes":[{axes}]}}}}}}"#);
    let axis = |moves: usize| format!(r#"{{"moves":[{}]}}"#, vec![MOVE; moves].join(","));
    let distance =
        |axis: usize, at: usize| format!("source.motion.axes[{axis}].moves[{at}].constant.distance");
    let controllers = r#""line":{"address":1},"controllers":[{"address":2,"axes":[]}],"#;
    let two = motion(&format!("{},{}", axis(1), axis(1)), r#""bus":{"channels":2},"#);
    let send = r#"{"start_cycle":2000,"bytes":"81"}"#;
    let lines = format!(r#"{{"source":{{"line":{{"sends":[{send}]}}}}}}"#);
    let glitch = r#""line":{"glitches":[{"start_cycle":5,"length_cycles":3,"level":0}]},"#;
    let list = r#"{"source":{"segments":{"channels":[{"start_cycle":5,"segments":[{"dwell":{"length_q16":65536}}]}]}}}"#;
    let rows: [(String, String, &str, &str, String, &str); 12] = [
        (motion(&axis(1), ""), distance(0, 0), "71", "Add move to axis 0", distance(0, 1), "71"),
        (motion(&axis(2), ""), distance(0, 1), "72", "Move 2 earlier", distance(0, 0), "72"),
        (motion(&axis(2), ""), distance(0, 1), "73", "Remove move 1", distance(0, 0), "73"),
        (motion(&axis(1), ""), distance(0, 0), "74", "Copy axis 0", distance(1, 0), "74"),
        (motion(&axis(1), ""), distance(0, 0), "75", "Add axis", distance(1, 0), "75"),
        (two.clone(), distance(0, 0), "76", "Copy to all: axis 0", distance(1, 0), "76"),
        (two, distance(1, 0), "77", "Remove axis 0", distance(0, 0), "77"),
        (
            motion(&axis(1), controllers),
            "controllers[0].bus.slots".into(),
            "78",
            "Copy controller 2",
            "controllers[1].bus.slots".into(),
            "78",
        ),
        (
            motion(&axis(1), controllers),
            "controllers[0].bus.slots".into(),
            "79",
            "Add controller",
            "controllers[1].bus.slots".into(),
            "79",
        ),
        (
            lines,
            "source.line.sends[0].bytes".into(),
            "05",
            "Add send",
            "source.line.sends[1].bytes".into(),
            "05",
        ),
        (
            motion(&axis(1), glitch),
            "line.glitches[0].length_cycles".into(),
            "7",
            "Add glitch",
            "line.glitches[1].length_cycles".into(),
            "7",
        ),
        (
            list.into(),
            "source.segments.channels[0].start_cycle".into(),
            "9",
            "Add list",
            "source.segments.channels[1].start_cycle".into(),
            "9",
        ),
    ];
    in_browser(|page| async move {
        for (json, path, text, button, found, expected) in rows {
            page.open(&format!("#{}", link_of(&json)?)).await?;
            edit_and_press(&page, &path, text, button).await?;
            let value = page.field(&found).await?.value;
            ensure!(value == expected, "{button} after {path}: {found} is {value}, not {expected}");
        }
        // Invalid text stays in its field, or moves with its part.
        page.open(&format!("#{}", link_of(&motion(&axis(2), ""))?)).await?;
        edit_and_press(&page, &distance(0, 1), "zz", "Add move to axis 0").await?;
        assert_eq!(page.field(&distance(0, 1)).await?.value, "zz");
        page.press("#fields button[aria-label='Remove move 1']", &ENTER.to_string()).await?;
        assert_eq!(page.field(&distance(0, 0)).await?.value, "zz");
        Ok(())
    })
}

#[test]
fn changing_the_kind_of_a_move_and_back_loses_nothing() -> Result<()> {
    const MOVE: &str = "source.motion.axes[0].moves[0]";
    let at = |field: &str| format!("{MOVE}.{field}");
    in_browser(|page| async move {
        let kind = format!("[data-path='{MOVE}#kind']");
        page.open("").await?;
        for (field, text) in [("distance", "1234"), ("duration_s", "0.5"), ("ramp_s", "0.11")] {
            page.fill(&at(&format!("cosine.{field}")), text).await?;
        }
        page.choose(&kind, "ramps").await?;
        for (field, text) in [("distance", "1234"), ("duration_s", "0.5"), ("ramp_s", "0.11")] {
            assert_eq!(page.field(&at(&format!("ramps.{field}"))).await?.value, text, "{field}");
        }
        page.choose(&kind, "trapezoid").await?;
        assert_eq!(page.field(&at("trapezoid.distance")).await?.value, "1234");
        page.fill(&at("trapezoid.distance"), "777").await?;
        page.choose(&kind, "cosine").await?;
        for (field, text) in [("distance", "777"), ("duration_s", "0.5"), ("ramp_s", "0.11")] {
            assert_eq!(page.field(&at(&format!("cosine.{field}"))).await?.value, text, "{field}");
        }
        Ok(())
    })
}

#[test]
fn a_changed_preset_is_labeled_until_it_has_a_name() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.preset("song-2021-one-turn").await?;
        page.ready().await?;
        let title = page.text("#about h2").await?;
        ensure!(
            !title.is_empty() && !page.text("#about p").await?.is_empty(),
            "a preset has a name and a note"
        );
        page.fill("bus.queue_depth", "7").await?;
        page.until_equal(
            "document.querySelector('#about h2').textContent",
            &format!("changed from {title}").into(),
        )
        .await?;
        assert_eq!(page.text("#about p").await?, "");
        page.fill("title", "Mine").await?;
        page.fill("bus.queue_depth", "8").await?;
        assert_eq!(page.text("#about h2").await?, "Mine");
        Ok(())
    })
}

/// Types 77, and 0 as soon as the results of 77 are reported, before it is run.
const BETWEEN_RUNS: &str = "const input = document.querySelector(arguments[0]);
    const note = document.querySelector('[data-note]');
    const type = (text) => { input.value = text; input.dispatchEvent(new Event('input')); };
    return new Promise((done) => {
        new MutationObserver((_, observer) => {
            if (!note.textContent.includes('77 steps')) return;
            observer.disconnect();
            type('0');
            done(true);
        }).observe(note, { childList: true, characterData: true, subtree: true });
        type('77');
    });";

#[test]
fn invalid_input_dims_the_figures_of_the_last_run() -> Result<()> {
    const NOTE: &str = "document.querySelector('[data-note]')";
    in_browser(|page| async move {
        page.open("").await?;
        let (note, derived) = (page.text("[data-note]").await?, page.text("#derived").await?);
        // Each key is validated: values between the last run and the refused number are not shown.
        page.fill(DISTANCE, "3200").await?;
        page.js::<bool>(BETWEEN_RUNS, vec![field(DISTANCE).into()]).await?;
        page.until(&format!("{NOTE}.classList.contains('stale')")).await?;
        assert_eq!((page.text("[data-note]").await?, page.text("#derived").await?), (note, derived));
        page.fill(DISTANCE, "78").await?;
        page.until(&format!("!{NOTE}.classList.contains('stale') && {NOTE}.textContent.includes('78 steps')"))
            .await
    })
}

#[test]
fn a_tab_keeps_its_work_and_offers_that_of_another() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.fill(DISTANCE, "1234").await?;
        page.until(&format!("{SAVED}.includes('1234')")).await?;
        page.ready().await?;
        // A second tab, as the browser opens it: it shares local storage, but not session storage.
        let own = page.client.window().await?;
        let second = page.client.new_window(true).await?;
        page.client.switch_to_window(second.handle).await?;
        page.open("").await?;
        assert_eq!(page.field(DISTANCE).await?.value, "1234", "a new tab begins with the last work");
        page.fill(DISTANCE, "555").await?;
        page.until(&format!("{SAVED}.includes('555')")).await?;
        page.ready().await?;
        page.client.goto("about:blank").await?;

        page.client.switch_to_window(own).await?;
        page.client.refresh().await?;
        page.listen().await?;
        page.ready().await?;
        assert_eq!(page.field(DISTANCE).await?.value, "1234", "its own stays");
        page.until(
            "document.getElementById('link-message').textContent.startsWith('Another tab has newer work')",
        )
        .await?;
        page.click("#link-message button").await?;
        assert_eq!(page.field(DISTANCE).await?.value, "555");
        page.click("#undo").await?;
        assert_eq!(page.field(DISTANCE).await?.value, "1234");
        Ok(())
    })
}

#[test]
fn the_layout_does_not_shift_between_press_and_release() -> Result<()> {
    const BELOW: &str = "source.motion.axes[0].moves[0].cosine.ramp_s";
    in_browser(|page| async move {
        page.open("").await?;
        page.fill(DISTANCE, "1").await?;
        let hint = page.text("#field-hint").await?;
        ensure!(hint.len() > 20, "the hint of the field with the focus has its place: {hint}");
        let middle = format!(
            "(() => {{ const box = document.querySelector({:?}).getBoundingClientRect(); return [box.left + 5, box.top + box.height / 2]; }})()",
            field(BELOW)
        );
        let before: [f64; 2] = page.eval(&middle).await?;
        let [x, y] = before;
        let mouse = MouseActions::new("mouse".into())
            .then(PointerAction::MoveTo { duration: None, x, y })
            .then(PointerAction::Down { button: MOUSE_BUTTON_LEFT });
        page.actions(mouse).await?;
        // The input is validated meanwhile and is too small: its message waits for the release.
        page.until("document.querySelector('#status').textContent.startsWith('not run') || document.documentElement.dataset.state === 'ready'").await?;
        assert_eq!(page.eval::<[f64; 2]>(&middle).await?, before, "the field is where it was pressed");
        let up = MouseActions::new("mouse".into()).then(PointerAction::Up { button: MOUSE_BUTTON_LEFT });
        page.actions(up).await?;
        page.until(&format!("document.activeElement?.dataset.path === '{BELOW}'")).await
    })
}

#[test]
fn experiments_are_saved_by_name_and_undo_survives_a_reload() -> Result<()> {
    const NAMES: &str = "[...document.querySelectorAll('#experiment-list li > :first-child')].map((each) => each.textContent)";
    in_browser(|page| async move {
        page.open("").await?;
        page.fill(DISTANCE, "1234").await?;
        page.ready().await?;
        // The panel's script loads after the panel: until then nothing can be pressed, but the name can be typed.
        assert!(page.eval::<bool>("!!document.getElementById('experiment-list').closest('[inert]') && document.getElementById('experiment-save').disabled").await?);
        page.click("#experiments").await?;
        page.until_equal("document.activeElement.id", &serde_json::json!("experiment-name")).await?;
        page.until("document.getElementById('experiment-save').offsetWidth > 0").await?;
        page.until("!document.getElementById('experiment-save').disabled").await?;
        page.until("document.getElementById('experiments-export').disabled").await?;
        // A name that is typed stays while the panel is closed.
        page.press("#experiment-name", "Rig").await?;
        page.click("#experiments").await?;
        page.until("!document.getElementById('experiments-panel').checkVisibility()").await?;
        page.click("#experiments").await?;
        page.until_equal("document.getElementById('experiment-name').value", &serde_json::json!("Rig"))
            .await?;
        page.press("#experiment-name", &format!("{ENTER}")).await?;
        page.until_equal(NAMES, &serde_json::json!(["Rig"])).await?;
        page.click("#experiment-new").await?;
        page.until_digest(&Known::of("{}")?.digest).await?;
        assert_eq!(page.field("title").await?.value, "");

        page.open("").await?;
        page.ready().await?;
        // Listed next to the presets, and opened by its name.
        page.preset("own:Rig").await?;
        page.until_digest(&Known::of(&with_distance(1234.0))?.digest).await?;
        assert_eq!(page.field("title").await?.value, "Rig");
        page.click("#undo").await?;
        page.until_digest(&Known::of("{}")?.digest).await?;
        // The previous undo step is from the previous visit.
        page.click("#undo").await?;
        page.until_digest(&Known::of(&with_distance(1234.0))?.digest).await?;

        page.click("#experiments").await?;
        page.until_equal(NAMES, &serde_json::json!(["Rig"])).await?;
        page.click("[aria-label='Remove Rig']").await?;
        page.until_equal(NAMES, &serde_json::json!([])).await?;
        page.click("[aria-label='Restore Rig']").await?;
        page.until_equal(NAMES, &serde_json::json!(["Rig"])).await
    })
}

#[test]
fn a_motion_too_fast_for_its_bus_has_remedies() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.fill("bus.step_period_cycles", "2000").await?;
        page.until(
            "document.querySelector('#offers h2')?.textContent.startsWith('The motion needs up to 16')",
        )
        .await?;
        ensure!(
            page.text("#offers").await?.contains("set the slot to 1000 cycles"),
            "the first that would do"
        );
        page.click("#offers button").await?;
        page.until_digest(&Known::of(r#"{"bus":{"step_period_cycles":1000}}"#)?.digest).await?;
        ensure!(!page.visible("#offers").await?, "it was taken");
        page.click("#undo").await?;
        page.until("!document.getElementById('offers').hidden").await
    })
}

#[test]
fn damaged_storage_does_not_stop_the_page() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        for (place, key) in [
            ("localStorage", "experiments"),
            ("localStorage", "latest"),
            ("sessionStorage", "latest"),
            ("sessionStorage", "history"),
        ] {
            for text in ["{", "null", "7", r#"[{"title":5},null]"#, r#"{"version":"development","past":{}}"#]
            {
                page.eval::<bool>(&format!("({place}.setItem('stepscope.{key}', {text:?}), true)")).await?;
                page.open("").await?;
                page.until_digest(&Known::of("{}")?.digest)
                    .await
                    .map_err(|error| error.context(format!("{place} {key}: {text}")))?;
            }
        }
        // Stored by an earlier version: its former names are read.
        let old = r#"[{"title":"Old","bus":{"pulses":"staggered","settle_cycles":60}}]"#;
        page.eval::<bool>(&format!("(localStorage.setItem('stepscope.experiments', {old:?}), true)")).await?;
        page.open("").await?;
        page.preset("own:Old").await?;
        page.until_digest(&Known::of(r#"{"bus":{"pulse_phasing":"staggered","settle_cycles":60}}"#)?.digest)
            .await
    })
}
