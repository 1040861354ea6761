//! The driver timing check on the page: counts, margins, and steps through the violations.

use anyhow::{Result, ensure};
use serde_json::json;
use stepscope_core::{
    inspect::trace::{drivers, timing::TimingCheck},
    scenario::presets::PRESETS,
};

use crate::{
    bench::in_browser,
    native::{Known, problems},
    session::{Session, field},
};

async fn until_says(page: &Session, what: &str) -> Result<()> {
    page.until(&format!("document.getElementById('timing-sentence').textContent.includes('{what}')")).await
}

#[test]
fn violations_are_counted_and_visited_one_by_one() -> Result<()> {
    in_browser(|page| async move {
        let preset = PRESETS.iter().find(|preset| preset.id == "driver-timing-broken").expect("a preset");
        let known = Known::preset(preset)?;
        let rules = drivers::rules(known.scenario.driver_timing.as_ref().expect("it names a driver"));
        let mut check = TimingCheck::new(&rules, known.scenario.clock_hz, 1000);
        known.experiment.run(&mut check);
        let total = check.total();

        page.open("").await?;
        ensure!(!page.visible("#view-timing").await?, "the default motion has no driver");
        page.preset(preset.id).await?;
        page.until_digest(&known.digest).await?;
        assert_eq!(page.text("#health").await?, format!("{total} timing violations"));
        ensure!(page.visible("#view-timing").await? && !page.visible("#view-spectrum").await?);
        page.until(&format!("document.querySelectorAll('#violations tbody tr').length === {total}")).await?;
        let bad: u32 = page.eval("document.querySelectorAll('#margins tr.bad').length").await?;
        assert_eq!(bad as usize, check.results().iter().filter(|result| result.total() > 0).count());

        // The preset opens with the first violations in sight; away from them, the pulses have to move.
        let end = known.seconds(known.experiment.run(&mut Vec::new()).cycles().0);
        for (id, at) in [("window-end", end), ("window-start", 0.9 * end)] {
            let script = "const field = document.getElementById(arguments[0]); field.value = arguments[1]; \
                          field.dispatchEvent(new Event('change')); return true;";
            page.js::<bool>(script, vec![json!(id), json!(format!("{} ms", 1e3 * at))]).await?;
        }
        page.ready().await?;
        let pulses = page.pulses().await?.hash;
        for (index, violation) in check.violations().iter().enumerate().take(3) {
            page.click("#violation-next").await?;
            until_says(&page, &format!("Violation {} of {total}", index + 1)).await?;
            let said = page.text("#cursor-readings").await?;
            let at_us = 1e6 * known.seconds(violation.at.0);
            ensure!(said.contains(&format!("A {at_us} \u{b5}s")), "{said}, wanted {at_us}");
        }
        ensure!(page.pulses().await?.hash != pulses, "the pulses go there");
        page.picture("timing").await?;
        page.click("#violation-previous").await?;
        until_says(&page, &format!("Violation 2 of {total}")).await?;
        // The spectrum is still there.
        page.click("#view-timing [data-side='spectrum']").await?;
        ensure!(page.visible("#view-spectrum").await? && !page.visible("#view-timing").await?);
        Ok(())
    })
}

#[test]
fn drivers_and_custom_rules_can_be_selected_and_undone() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of("{}")?;
        page.open("").await?;
        page.until_digest(&known.digest).await?;
        page.choose(&field("driver_timing#kind"), "a4988").await?;
        page.until("document.getElementById('health').textContent === 'driver timing OK'").await?;
        page.until_digest(&known.digest).await?;
        page.choose(&field("driver_timing#kind"), "rules").await?;
        page.ready().await?;
        assert_eq!(
            page.field("driver_timing.rules.step_high_ns").await?.value,
            "1000",
            "they begin as the A4988's"
        );
        page.fill("driver_timing.rules.step_high_ns", "3 us").await?;
        page.until("document.getElementById('health').textContent.includes('timing violations')").await?;
        page.fill("driver_timing.rules.step_high_ns", "2 s").await?;
        page.ready().await?;
        let shown = page.field("driver_timing.rules.step_high_ns").await?;
        let wrong = problems(r#"{"driver_timing":{"rules":{"step_high_ns":2000000000}}}"#);
        ensure!(shown.invalid && shown.error.contains(&wrong[0].cause.to_string()), "{shown:?}");

        for _ in 0..2 {
            page.click("#undo").await?;
        }
        page.until("document.getElementById('health').textContent === 'driver timing OK'").await?;
        page.click("#undo").await?;
        page.until("document.getElementById('health').textContent === ''").await?;
        ensure!(!page.visible("#view-timing").await?, "the check goes with its driver");
        Ok(())
    })
}
