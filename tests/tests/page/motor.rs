//! The view Motor and the study's tab Motor, compared with the core: verdicts, numbers, rates; and a motor
//! selected from the list.
#![allow(clippy::expect_used, reason = "a missing file or program fails the test")]

use anyhow::{Result, ensure};
use serde_json::json;
use stepscope_core::{
    inspect::plant::{outcome::settling, report::PlantReport},
    plant::{
        rates::{RAMP_STEPS_S2, pulls, search, starts},
        settling::SHARE,
    },
    scenario::presets::PLANT_PRESETS,
};

use crate::{bench::in_browser, native::Known, session::Session};

/// The text of the view for the visible motor.
const VERDICT: &str = "document.getElementById('motor-verdict').textContent.replace(/\\u202f/g, '')";

fn report(known: &Known) -> PlantReport {
    let mut run = known.experiment.start();
    while !run.advance_each(u64::MAX, &mut [Vec::new()]) {}
    PlantReport::of(&known.experiment, &run, 0).expect("a plant")
}

/// Values of a table of the study, without its first column.
async fn values(page: &Session, table: &str) -> Result<Vec<String>> {
    let script = "return [...document.querySelectorAll(`table[aria-label='${arguments[0]}'] tbody tr`)].map((row) => row.cells[1].textContent.replace(/\\u202f/g, ''));";
    page.js(script, vec![json!(table)]).await
}

/// Waits until the searches of the study have ended.
async fn until_found(page: &Session) -> Result<()> {
    page.until("document.querySelectorAll('#study-motor .study-job').length === 4").await?;
    page.until("document.querySelectorAll(`table[aria-label='Motor limits'] tbody tr`).length > 3").await?;
    page.until("[...document.querySelectorAll('#study-motor .study-job')].every((job) => job.hidden)").await
}

#[test]
fn every_preset_with_a_plant_shows_the_results_of_the_core() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        for preset in PLANT_PRESETS {
            let known = Known::preset(preset)?;
            let report = report(&known);
            page.preset(preset.id).await?;
            page.until_digest(&known.digest).await?;
            let motor = &report.motors[0];
            page.until(&format!("{VERDICT}.includes('Motor 0 {}')", motor.verdict)).await?;
            let digest = format!("'plant digest {}'", report.plant.digest);
            page.until(&format!("document.getElementById('motor-numbers').textContent.includes({digest})"))
                .await?;
            let told: String = page.eval(VERDICT).await?;
            ensure!(told.contains("Overload") == report.plant.overload_cycle.is_some(), "{told}");
            ensure!(
                told.contains('⚠') != (motor.slips == 0 && report.plant.overload_cycle.is_none()),
                "{told}"
            );
            let drawn: Vec<bool> = page
                .eval("[...document.querySelectorAll('#motor-charts .chart:not([hidden]) canvas')].map((c) => c.width > 200 && c.height > 60)")
                .await?;
            // OVERLOAD opens with the two charts that show it.
            let charts = if preset.view.contains(".q") { 2 } else { 4 };
            ensure!(drawn == vec![true; charts], "{}: {drawn:?}", preset.id);
        }
        Ok(())
    })
}

#[test]
fn the_view_explains_a_stall() -> Result<()> {
    in_browser(|page| async move {
        let preset = PLANT_PRESETS.iter().find(|preset| preset.id == "song-2021-stall").expect("a preset");
        let known = Known::preset(preset)?;
        let setup = known.experiment.plants().expect("a plant").setups[0].single_motor(0).expect("a motor");
        let most = search(|rate| starts(&setup, rate, setup.motors[0].steps_per_turn())).expect("a plant");
        page.open(&format!("#{}", known.link)).await?;
        page.until(&format!("{VERDICT}.includes('loses 188 full steps')")).await?;
        let why = format!("above its start-stop rate of {} steps/s", most.expect("it starts").floor());
        page.until(&format!("{VERDICT}.includes('{why}')")).await
    })
}

#[test]
fn a_listed_motor_is_added_and_removed_by_undo() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of("{}")?;
        page.open("").await?;
        page.click("#view-motion [data-side='motor']").await?;
        page.until("document.querySelectorAll('#motor-choice option').length > 10").await?;
        page.click("#motor-choice .main").await?;
        page.until(&format!("{VERDICT}.includes('Motor 0 follows')")).await?;
        // The edges are the same.
        page.until_digest(&known.digest).await?;
        page.click("#motor-choice > summary").await?;
        page.choose("#motor-choice [aria-label='Motor']", "17hs4401").await?;
        page.choose("#motor-choice [aria-label='Driver']", "a4988").await?;
        page.until(
            "document.querySelector('#motor-choice .note').textContent.includes('typical values only')",
        )
        .await?;
        page.click("#motor-choice button").await?;
        let field =
            "document.querySelector(`[data-path='source.motion.axes[0].motor.resistance_ohm']`)?.value";
        page.until(&format!("{field} === '1.5'")).await?;
        page.until(&format!("{VERDICT}.includes('Motor 0 follows')")).await?;
        page.until("!document.getElementById('motor-choice').open").await?;
        for _ in 0..2 {
            page.click("#undo").await?;
        }
        page.until("document.getElementById('motor-body').hidden").await?;
        page.until("!document.querySelector(`[data-path='plant.source_ohm']`)").await
    })
}

#[test]
fn the_motor_tab_of_the_study_matches_the_command() -> Result<()> {
    in_browser(|page| async move {
        let preset =
            PLANT_PRESETS.iter().find(|preset| preset.id == "patent-2019-figure-2").expect("a preset");
        let known = Known::preset(preset)?;
        let setup = known.experiment.plants().expect("a plant").setups[0].single_motor(0).expect("a motor");
        page.open(&format!("#{}&v=tstudy.ymotor", known.link)).await?;
        until_found(&page).await?;
        let found = values(&page, "Motor limits").await?;
        let rate = |found: Option<f64>| format!("{} steps/s", found.expect("a rate").floor());
        let start = search(|rate| starts(&setup, rate, setup.motors[0].steps_per_turn())).expect("a plant");
        let pull = search(|rate| pulls(&setup, rate, RAMP_STEPS_S2)).expect("a plant");
        ensure!(found[..2] == [rate(start), rate(pull)], "{found:?}");
        // The patent's figures: a settling time that can be applied, and the ratio of the peaks.
        let slot = known.experiment.config().tick().0 / u64::from(known.experiment.config().slots());
        let reached = settling(&setup, 0, slot, SHARE).expect("a plant").0.reached.expect("it settles");
        let text: String = page.eval("document.getElementById('study-motor').textContent").await?;
        ensure!(text.contains(&format!("{reached} cycles")) && text.contains("times less"), "{text}");
        page.click("#study-motor [aria-label^='Use as settling time']").await?;
        page.until(&format!(
            "document.querySelector(`[data-path='bus.settle_cycles']`).value === '{reached}'"
        ))
        .await
    })
}

#[test]
fn a_link_stores_whether_motion_or_motor_is_open() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(r#"{"plant":{}}"#)?;
        page.open(&format!("#{}&v=omotion", known.link)).await?;
        let shown = |view: &str| format!("document.getElementById('view-{view}').checkVisibility()");
        page.until(&shown("motion")).await?;
        ensure!(!page.eval::<bool>(&shown("motor")).await?, "both are open");
        page.click("#view-motion [data-side='motor']").await?;
        page.until(&shown("motor")).await?;
        page.until("location.hash.includes('omotor')").await?;
        Ok(())
    })
}

#[test]
fn each_controllers_motor_has_its_curve_and_settling_time() -> Result<()> {
    in_browser(|page| async move {
        let json = r#"{"line":{"address":1},"plant":{},"bus":{"channels":2},"controllers":[{"address":2,"bus":{"channels":2},"axes":[{},{}]}],
            "source":{"motion":{"axes":[{},{}]}}}"#;
        let known = Known::of(json)?;
        page.open(&format!("#{}&v=k1.tstudy.ymotor", known.link)).await?;
        until_found(&page).await?;
        page.until(
            "document.querySelector('#study-motor .study-note').textContent.includes('of controller 2')",
        )
        .await?;
        // The default motor, which no axis defines, has a torque curve, too.
        let shown =
            "[...document.querySelectorAll('#study-motor .torque-chart')].map((chart) => !chart.hidden)";
        page.until(&format!("{shown}.every(Boolean)")).await?;
        page.click("#study-motor [aria-label^='Use as settling time']").await?;
        let value =
            |path: &str| format!("document.querySelector(`[data-path='{path}.settle_cycles']`).value");
        page.until(&format!("{} > 100", value("controllers[0].bus"))).await?;
        ensure!(page.eval::<String>(&value("bus")).await? == "0", "it went into the first controller's");
        Ok(())
    })
}

#[test]
fn an_expanded_list_covers_nothing_and_closes_for_a_motor() -> Result<()> {
    in_browser(|page| async move {
        for (width, height) in [(1366, 768), (390, 844)] {
            page.screen(width, height).await?;
            page.open("").await?;
            if width < 900 {
                page.click("#tab-motor").await?;
            } else {
                page.click("#view-motion [data-side='motor']").await?;
            }
            page.until("document.getElementById('motor-choice').open").await?;
            page.preset("patent-2019-figure-2").await?;
            page.until(&format!("{VERDICT}.includes('follows')")).await?;
            page.until("!document.getElementById('motor-choice').open").await?;
            // Both show their contents, and the button that opened them closes them.
            for fold in ["#motor-choice", "#motor-choice + details"] {
                page.click(&format!("{fold} > summary")).await?;
                page.until(&format!("document.querySelector('{fold}').open")).await?;
                let room =
                    format!("document.querySelector('{fold} > .record-pane > :first-child').clientHeight");
                ensure!(page.eval::<f64>(&room).await? > 20.0, "{fold} has no visible content at {width} px");
                page.click(&format!("{fold} > summary")).await?;
                page.until(&format!("!document.querySelector('{fold}').open")).await?;
            }
        }
        Ok(())
    })
}

#[test]
fn lost_steps_are_marked_to_the_end_and_all_charts_fit() -> Result<()> {
    in_browser(|page| async move {
        let json = r#"{"plant":{},"source":{"motion":{"engine":"segments","axes":[{"motor":{"load_inertia_g_cm2":2000},
            "moves":[{"cosine":{"distance":{"steps":12800},"duration_s":0.4,"ramp_s":0.02}}]}]}}}"#;
        let known = Known::of(json)?;
        let report = report(&known);
        ensure!(report.slips.len() > 100, "only {} slips", report.slips.len());
        page.open(&format!("#{}", known.link)).await?;
        page.until(&format!("{VERDICT}.includes('loses')")).await?;
        let chart = "document.querySelectorAll('#motor-charts .chart canvas')[1]";
        page.until(&format!("{chart}.width > 200")).await?;
        // The chart of the error is red up to the last lost step.
        let last =
            report.slips.last().expect("a slip").cycle as f64 / known.experiment.cost().end_cycle as f64;
        let red = format!(
            "(() => {{ const c = {chart}; const {{ data, width }} = c.getContext('2d').getImageData(0, c.height >> 1, c.width, 1);              let at = 0; for (let x = 0; x < width; x++) if (data[4 * x] > 150 && data[4 * x + 1] < 140 && data[4 * x + 3] > 60) at = x;              return (at / 2 - 68) / (width / 2 - 94); }})()"
        );
        page.eventually("marks to the end", async || {
            let at: f64 = page.eval(&red).await?;
            Ok(((at - last).abs() < 0.03).then_some(()))
        })
        .await?;
        for at in 0..7 {
            let press = format!("#motor-quantities button:nth-child({})", at + 1);
            if page
                .eval::<bool>(&format!("document.querySelector('{press}').ariaPressed === 'false'"))
                .await?
            {
                page.click(&press).await?;
            }
        }
        let rooms: Vec<f64> = page
            .eval("[...document.querySelectorAll('#motor-charts .chart')].map((chart) => chart.clientHeight)")
            .await?;
        ensure!(rooms.len() == 7 && rooms.iter().all(|room| *room >= 70.0), "{rooms:?}");
        let ends = "[document.querySelector('#motor-charts .overlay'), document.querySelector('#motor-charts .chart:nth-child(7)')].map((node) => node.getBoundingClientRect().bottom)";
        let ends: Vec<f64> = page.eval(ends).await?;
        ensure!((ends[0] - ends[1]).abs() < 3.0, "the cursors end at {ends:?}");
        Ok(())
    })
}
