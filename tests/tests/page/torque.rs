//! The motor of an axis: its fields, the warning at a move, and the study's tab Torque compared with the core.
#![allow(clippy::expect_used, clippy::panic, reason = "a missing file or program fails the test")]

use anyhow::{Result, ensure};
use serde_json::{Value, json};
use stepscope_core::{
    inspect::motion::torque::{Demand, Machine},
    motion::moves::Axis,
    peripheral::trace::steps,
    scenario::{Scenario, Source},
};

use crate::{bench::in_browser, native::Known, session::Session};

/// Two axes; the load of the first one's move is too large for its motor.
const SHORT: &str = r#"{"title":"A heavy load","bus":{"channels":2},"source":{"motion":{"axes":[
    {"moves":[{"cosine":{}},{"dwell":{}}],"motor":{"load_inertia_g_cm2":9955,"load_torque_mn_m":100}},{}]}}}"#;
const AXIS: &str = "source.motion.axes[0]";

/// Texts of a table's cells, row by row, without digit grouping.
async fn cells(page: &Session, table: &str) -> Result<Vec<Vec<String>>> {
    let script = "return [...document.querySelectorAll(`table[aria-label='${arguments[0]}'] tbody tr`)].map((row) => [...row.cells].map((cell) => cell.textContent.replace(/\\u202f/g, '')));";
    page.js(script, vec![json!(table)]).await
}

/// The notes of the first axis' moves.
const NOTES: &str =
    "[...document.querySelectorAll(`[data-note^='source.motion.axes[0]']`)].map((note) => note.textContent)";

fn first_axis(json: &str) -> Axis {
    let Ok(Source::Motion(motion)) = Scenario::from_json(json).map(|scenario| scenario.source) else {
        panic!("{json} is no motion");
    };
    motion.axes[0].clone()
}

#[test]
fn sufficient_torque_removes_the_warning() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(SHORT)?;
        page.open(&format!("#{}", known.link)).await?;
        let notes: Vec<String> = page.eval(NOTES).await?;
        let short = "too little torque: 346.7 mN·m needed of 282.8 at 0.1000 s";
        ensure!(notes.len() == 2 && notes[0].contains(short) && !notes[1].contains('⚠'), "{notes:?}");
        page.fill(&format!("{AXIS}.motor.peak_current_a"), "2.12").await?;
        page.until(&format!("{NOTES}.every((note) => !note.includes('⚠'))")).await?;
        // A run is the same with and without a motor.
        page.until_digest(&known.digest).await?;
        // The unchanged motor of the paper.
        page.click(&format!("[data-path='{AXIS}.motor#kind']")).await?;
        page.until(&format!("!document.querySelector(`[data-path='{AXIS}.motor.supply_v']`)")).await?;
        page.click(&format!("[data-path='{AXIS}.motor#kind']")).await?;
        page.until(&format!("document.querySelector(`[data-path='{AXIS}.motor.supply_v']`)?.value === '24'"))
            .await?;
        page.fill(&format!("{AXIS}.motor.supply_v"), "0").await?;
        page.until("document.getElementById('problems').hidden === false").await?;
        Ok(())
    })
}

#[test]
fn the_torque_tab_has_the_numbers_and_curves_of_the_core() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(SHORT)?;
        page.open(&format!("#{}&v=tstudy.ytorque", known.link)).await?;
        page.until("document.getElementById('torque-verdict')?.textContent !== ''").await?;
        let axis = first_axis(SHORT);
        let machine = Machine::of(&axis).expect("a motor");
        let demand = Demand::of(&machine, &known.experiment.plans()[0]);
        let shortage = demand.shortages[0];
        let rows = cells(&page, "Too little torque").await?;
        ensure!(rows.len() == 1 && demand.shortage_count == 1, "{rows:?}");
        let expected = [
            format!("{:.2} ms", shortage.from_s * 1e3),
            format!("{:.1} ms", shortage.to_s * 1e3),
            format!("{:.1} mN·m", -shortage.worst.margin_mn_m()),
        ];
        ensure!(rows[0][..3] == expected, "{rows:?} is not {expected:?}");
        let facts = cells(&page, "The motor").await?;
        let corner = format!("{} steps/s", machine.corner_rate().expect("a corner") as u64);
        ensure!(facts[1][1] == corner, "{facts:?}");
        let outcome: String = page.eval("document.getElementById('torque-verdict').textContent").await?;
        ensure!(outcome.starts_with("⚠ Too little torque in one interval"), "{outcome}");
        // The other axis has no motor; the button adds the paper's.
        page.eval::<Value>("(() => { const axes = document.getElementById('study-axis'); axes.value = '1'; axes.dispatchEvent(new Event('change')); return null; })()").await?;
        page.until("document.querySelector('#study-torque button[aria-label^=\"Add the \"]')").await?;
        page.click("#study-torque button[aria-label^='Add the ']").await?;
        page.until_equal(
            "document.getElementById('torque-verdict').textContent",
            &json!("Enough torque throughout."),
        )
        .await?;
        page.fill("source.motion.axes[1].motor.working_rate_hz", "19200").await?;
        page.until(
            "document.querySelector(\"table[aria-label='Ramps'] tbody\").textContent.includes('0.2333 s')",
        )
        .await?;
        Ok(())
    })
}

/// 4000 steps at 50 000 steps/s from the start, as a list of segments.
const LIST: &str = r#"{"title":"At once","bus":{"channels":2},"source":{"segments":{"channels":[{"segments":[
    {"steps":{"count":4000,"interval_q16":20971520,"dir":1}}]}]}}}"#;

#[test]
fn steps_without_a_motion_are_checked_against_a_motor() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(LIST)?;
        page.open(&format!("#{}&v=tstudy.ytorque", known.link)).await?;
        page.until_digest(&known.digest).await?;
        let says = async |text: &str| {
            page.until(&format!(
                "document.getElementById('study-torque').innerText.includes({})",
                json!(text)
            ))
            .await
        };
        says("There is no motor: select one").await?;
        page.until("document.querySelectorAll('#study-torque select option').length > 5").await?;
        page.choose("#study-torque select", "song-2021").await?;
        // A driver's selection sends a change event, but no input event like a user's.
        page.until("document.getElementById('torque-verdict').textContent !== ''").await?;
        let machine =
            Machine::of(&Axis { motor: Some(Default::default()), ..Axis::default() }).expect("a motor");
        let steps = steps(&known.recording.trace, 0);
        let demand = Demand::of_steps(&machine, &steps, known.experiment.config().clock_hz());
        let shown = async || {
            let facts = cells(&page, "The motor").await?;
            let of = |name: &str| facts.iter().find(|row| row[0] == name).map(|row| row[1].clone());
            anyhow::Ok((of("Minimum margin"), of("Maximum jump of speed")))
        };
        let least = demand.min_margin.expect("it moves").margin_mn_m();
        let expected = (Some(least), demand.jump);
        let (margin, jump) = shown().await?;
        let margin =
            margin.and_then(|text| text.replace('\u{2212}', "-").split(' ').next()?.parse::<f64>().ok());
        ensure!(
            margin.zip(expected.0).is_some_and(|(found, known)| (found - known).abs() < 0.06),
            "{margin:?} {expected:?}"
        );
        assert_eq!(jump, Some("50000 steps/s".to_owned()), "{expected:?}");
        let outcome: String = page.eval("document.getElementById('torque-verdict').textContent").await?;
        assert_eq!(outcome.contains("Too little torque"), demand.shortage_count > 0, "{outcome}");
        says("The acceleration of steps is averaged over the natural period of the rotor, 3.54").await?;
        page.picture("torque-of-steps").await?;
        // The other channel has no list.
        page.choose("#study-axis", "1").await?;
        says("Channel 1 has no steps, so it needs no torque.").await?;
        // A plant has its own motor, and there is nothing to select.
        page.choose("#study-axis", "0").await?;
        page.click("[data-path='plant#kind']").await?;
        says("Channel 0: torque of its motor and torque needed by the steps; there is no plan.").await?;
        ensure!(!page.visible("#study-torque select").await?);
        Ok(())
    })
}
