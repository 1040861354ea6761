//! Several controllers on one line: adding and selecting them, and their errors.

use anyhow::{Result, ensure};

use crate::{
    bench::in_browser,
    native::{Known, problems},
    session::{Session, field},
};

/// What the page's button adds to the default motion.
const TWO: &str = r#"{"line":{"address":0},"controllers":[{"axes":[{}]}]}"#;
const DISTANCE: &str = "controllers[0].axes[0].moves[0].cosine.distance";

/// Adds a controller to the default motion.
async fn added(page: &Session) -> Result<()> {
    page.open("").await?;
    page.until_digest(&Known::of("{}")?.digest).await?;
    ensure!(!page.visible("#controller").await?, "there is only one controller");
    page.click("[aria-label='Add controller']").await?;
    page.until_digest(&Known::digest_of(TWO, 0)?).await
}

#[test]
fn an_added_controller_is_selected_changed_and_undone() -> Result<()> {
    let shorter = r#"{"line":{"address":0},"controllers":[{"axes":[{"moves":[
        {"cosine":{"distance":{"steps":-800}}}]}]}]}"#;
    in_browser(move |page| async move {
        added(&page).await?;
        assert_eq!(page.field("line.address").await?.value, "0", "a raw line of two needs addresses");
        let drawn = page.canvas("chart-position").await?.hash;
        page.choose("#controller", "1").await?;
        page.until_digest(&Known::digest_of(TWO, 1)?).await?;
        ensure!(page.pulses().await?.ink("--step").pixels > 200);
        let foreign: u32 = page.eval("document.querySelectorAll('#packets tr.foreign').length").await?;
        ensure!(foreign > 0, "the first one's packets pass");
        page.picture("controllers").await?;

        page.fill(DISTANCE, "-800").await?;
        page.until_digest(&Known::digest_of(shorter, 1)?).await?;
        ensure!(page.canvas("chart-position").await?.hash != drawn, "the views follow the controller");
        page.choose("#controller", "0").await?;
        page.until_digest(&Known::digest_of(shorter, 0)?).await?;

        page.click("#undo").await?;
        page.until_digest(&Known::digest_of(TWO, 0)?).await?;
        page.click("#undo").await?;
        page.until_digest(&Known::of("{}")?.digest).await?;
        ensure!(!page.visible("#controller").await?);
        assert_eq!(page.field("line.address").await?.value, "", "the address goes with the controller");
        Ok(())
    })
}

#[test]
fn changing_the_source_gives_every_controller_commands() -> Result<()> {
    let packets = r#"{"line":{"address":0},"source":{"packets":{"packets":["008a","000a"]}},
        "controllers":[{"packets":["018a","010a"]}]}"#;
    let framed = r#"{"line":{"protocol":"framed","address":0},"source":{"line":{"sends":[
        {"start_cycle":1601,"frame":"000100038a0a00"},{"start_cycle":129601,"frame":"0004"}]}},"controllers":[{}]}"#;
    in_browser(move |page| async move {
        added(&page).await?;
        page.choose(&field("source#kind"), "packets").await?;
        page.until_digest(&Known::digest_of(packets, 0)?).await?;
        page.choose("#controller", "1").await?;
        page.until_digest(&Known::digest_of(packets, 1)?).await?;
        page.click("#undo").await?;
        page.until_digest(&Known::digest_of(TWO, 1)?).await?;
        page.choose("#controller", "0").await?;
        page.choose(&field("line.protocol"), "framed").await?;
        page.choose(&field("source#kind"), "line").await?;
        page.until_digest(&Known::digest_of(framed, 0)?).await?;
        ensure!(page.visible(&field("source.line.sends[0].frame")).await?, "a framed script has frames");
        Ok(())
    })
}

#[test]
fn errors_of_a_controller_are_shown_at_its_field() -> Result<()> {
    let with = |fields: &str| TWO.replace(r#"{"axes""#, &format!(r#"{{{fields},"axes""#));
    let ramp = TWO.replace(r#"[{}]"#, r#"[{"moves":[{"cosine":{"ramp_s":0.3}}]}]"#);
    let rows = [
        ("controllers[0].address", "0", with(r#""address":0"#)),
        ("controllers[0].receiver_baud", "9M", with(r#""receiver_baud":9000000"#)),
        ("controllers[0].bus.slots", "200", with(r#""bus":{"slots":200}"#)),
        ("controllers[0].bus.step_period_cycles", "640", with(r#""bus":{"step_period_cycles":640}"#)),
        ("controllers[0].bus.queue_depth", "0", with(r#""bus":{"queue_depth":0}"#)),
        ("controllers[0].axes[0].moves[0].cosine.ramp_s", "0.3", ramp),
    ];
    in_browser(move |page| async move {
        added(&page).await?;
        for (path, typed, json) in rows {
            page.fill(path, typed).await?;
            page.ready().await?;
            let found = problems(&json);
            ensure!(found.iter().any(|problem| problem.path == path), "{json}: {found:?}");
            for problem in found {
                let message = problem.cause.to_string();
                let shown = page.field(&problem.path).await?;
                ensure!(
                    shown.invalid && shown.error.contains(&message),
                    "{path}: {shown:?}, wanted {message}"
                );
            }
            page.click("#undo").await?;
            page.until_digest(&Known::digest_of(TWO, 0)?).await?;
        }
        Ok(())
    })
}

#[test]
fn a_copied_controller_has_a_new_address_and_can_be_removed() -> Result<()> {
    in_browser(|page| async move {
        added(&page).await?;
        page.click("[aria-label='Copy controller 2']").await?;
        let three = r#"{"line":{"address":0},"controllers":[{"axes":[{}]},{"address":2,"axes":[{}]}]}"#;
        page.until_digest(&Known::digest_of(three, 0)?).await?;
        assert_eq!(page.field("controllers[1].address").await?.value, "2");
        page.choose("#controller", "2").await?;
        page.until_digest(&Known::digest_of(three, 2)?).await?;
        page.click("[aria-label='Remove controller 2']").await?;
        // Two are left: the views show the last one.
        let left = r#"{"line":{"address":0},"controllers":[{"address":2,"axes":[{}]}]}"#;
        page.until_digest(&Known::digest_of(left, 1)?).await?;
        page.click("[aria-label='Remove controller 2']").await?;
        page.until_digest(&Known::digest_of(r#"{"line":{"address":0}}"#, 0)?).await?;
        // If a button disappears, the focus stays in the form.
        page.until("document.activeElement.closest('#form')").await
    })
}
