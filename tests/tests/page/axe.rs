//! Automatic checks of accessibility: axe-core in many states of the page (WCAG 2.2 AA and axe's best practice).
//!
//! `STEPSCOPE_AXE` is the path of axe's script, which runs in the shipped page but is not part of it.

use std::fs;

use anyhow::{Context, Result, ensure};
use serde_json::json;

use crate::{bench::in_browser, browser::named, session::Session};

const RUN: &str = "
    const tags = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'];
    return axe.run(document, { runOnly: { type: 'tag', values: tags }, resultTypes: ['violations'] }).then(({ violations, passes }) => ({
        rules: violations.length + passes.length,
        found: violations.map(({ id, help, nodes }) => `${id}: ${help}\\n` + nodes.slice(0, 8).map(({ target, any, all, none }) =>
            `    ${target.join(' ')}: ${[...any, ...all, ...none].map(({ message }) => message).join('; ')}`).join('\\n')),
    }));";

#[derive(serde::Deserialize)]
struct Answer {
    /// Rules that applied to something.
    rules: usize,
    found: Vec<String>,
}

/// Adds the current violations to `wrong`.
pub(crate) async fn look(page: &Session, state: &str, wrong: &mut Vec<String>) -> Result<()> {
    if !page.eval::<bool>("'axe' in window").await? {
        let script = fs::read_to_string(named("STEPSCOPE_AXE")?).context("axe's script can't be read")?;
        page.js::<bool>(&format!("{script}\nreturn true;"), vec![]).await?;
    }
    let Answer { rules, found } = page.js(RUN, vec![]).await.with_context(|| state.to_owned())?;
    ensure!(rules > 12, "axe checked only {rules} rules");
    wrong.extend(found.into_iter().map(|text| format!("{state}: {text}")));
    Ok(())
}

pub(crate) fn none(wrong: &[String]) -> Result<()> {
    ensure!(wrong.is_empty(), "axe finds\n{}", wrong.join("\n"));
    Ok(())
}

#[test]
fn axe_finds_nothing_on_a_wide_screen_in_any_theme() -> Result<()> {
    in_browser(|page| async move {
        let mut wrong = Vec::new();
        page.open("").await?;
        for (state, features) in [
            ("light", json!([{ "name": "prefers-color-scheme", "value": "light" }])),
            ("dark", json!([{ "name": "prefers-color-scheme", "value": "dark" }])),
            ("forced colors", json!([{ "name": "forced-colors", "value": "active" }])),
        ] {
            page.devtools("Emulation.setEmulatedMedia", json!({ "features": features })).await?;
            look(&page, state, &mut wrong).await?;
        }
        none(&wrong)
    })
}

#[test]
fn axe_finds_nothing_in_any_kind_of_experiment() -> Result<()> {
    in_browser(|page| async move {
        let mut wrong = Vec::new();
        page.open("").await?;
        page.click("#preset").await?;
        page.until("document.querySelector('#gallery[open] [data-entry]')").await?;
        look(&page, "the gallery", &mut wrong).await?;
        page.click("#gallery [aria-label=Close]").await?;
        for preset in [
            "driver-timing-broken",
            "four-controllers-framed",
            "sonobe-2011-segments",
            "patent-2019-figure-2",
        ] {
            page.preset(preset).await?;
            page.ready().await?;
            look(&page, preset, &mut wrong).await?;
        }
        none(&wrong)
    })
}

#[test]
fn axe_finds_nothing_in_any_tab_of_the_study() -> Result<()> {
    in_browser(|page| async move {
        let mut wrong = Vec::new();
        page.open("").await?;
        page.preset("sine-2022-d0006").await?;
        page.ready().await?;
        page.click("#study").await?;
        for tab in ["compare", "measures", "tables", "sine", "torque"] {
            page.click(&format!("#study-tab-{tab}")).await?;
            page.until(&format!(
                "[...document.querySelectorAll('#study-{tab} .study-job')].every((job) => job.hidden)"
            ))
            .await?;
            look(&page, tab, &mut wrong).await?;
        }
        page.preset("patent-2019-figure-2").await?;
        page.ready().await?;
        page.click("#study").await?;
        page.click("#study-tab-motor").await?;
        page.until("document.querySelectorAll('#study-motor tbody tr').length > 4").await?;
        look(&page, "motor", &mut wrong).await?;
        none(&wrong)
    })
}

#[test]
fn axe_finds_nothing_on_a_narrow_screen_at_any_tab() -> Result<()> {
    in_browser(|page| async move {
        let mut wrong = Vec::new();
        page.screen(390, 844).await?;
        page.open("").await?;
        page.preset("driver-timing-broken").await?;
        page.ready().await?;
        let tabs: Vec<String> = page
            .eval("[...document.querySelectorAll('[role=tab]:not([hidden])')].map((tab) => tab.id)")
            .await?;
        ensure!(tabs.len() >= 4, "{tabs:?}");
        for tab in tabs {
            page.click(&format!("#{tab}")).await?;
            look(&page, &tab, &mut wrong).await?;
        }
        page.click("#sheet > summary").await?;
        look(&page, "the form unfolded", &mut wrong).await?;
        none(&wrong)
    })
}

#[test]
fn axe_finds_nothing_in_errors_and_dialogs() -> Result<()> {
    in_browser(|page| async move {
        let mut wrong = Vec::new();
        page.open("#c=1.z.broken").await?;
        look(&page, "a broken link", &mut wrong).await?;
        page.fill("bus.slots", "200").await?;
        page.fill("bus.channels", "many").await?;
        page.ready().await?;
        look(&page, "problems in the form", &mut wrong).await?;
        // Every message and every dialog, however it is opened.
        page.eval::<u32>(
            "[...document.querySelectorAll('.notice')].filter((notice) => !(notice.hidden = false)).length",
        )
        .await?;
        look(&page, "messages", &mut wrong).await?;
        // The gallery is empty until it opens; it is checked with the kinds of experiments.
        page.eval::<()>("document.getElementById('gallery').remove()").await?;
        let dialogs: usize = page.eval("document.querySelectorAll('dialog').length").await?;
        for index in 0..dialogs {
            let id: String = page
                .eval(&format!("((dialog) => (dialog.open || dialog.showModal(), dialog.id))(document.querySelectorAll('dialog')[{index}])"))
                .await?;
            look(&page, &format!("dialog {id}"), &mut wrong).await?;
            page.eval::<Option<()>>(&format!("document.querySelectorAll('dialog')[{index}].close()")).await?;
        }
        none(&wrong)
    })
}
