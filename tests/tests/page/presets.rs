//! The experiments of the papers, one after another.

use anyhow::{Context, Result, ensure};
use serde_json::json;
use stepscope_core::{
    capture::samples::SAMPLES,
    inspect::motion::spectrum::Spectrum,
    scenario::{
        Source,
        presets::{CONTROLLER_PLANT_PRESETS, CONTROLLER_PRESETS, PLANT_PRESETS, PRESETS, Preset, Task},
    },
};

use crate::{bench::in_browser, native::Known, session::Session};

#[test]
fn digests_links_and_distortions_of_presets_match_the_core() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.click("#preset").await?;
        page.until("document.querySelector('#gallery[open] [data-entry]')").await?;
        let offered: Vec<String> = page
            .eval("[...document.querySelectorAll('#gallery [data-entry]')].map((card) => card.dataset.entry)")
            .await?;
        // Task by task; presets with a plant are tested in `motor`, those with a panel in `panel`.
        let panels = CONTROLLER_PRESETS.iter().chain(CONTROLLER_PLANT_PRESETS);
        let all: Vec<&Preset> = PRESETS.iter().chain(PLANT_PRESETS).chain(panels).collect();
        let mut tasks: Vec<Task> = Vec::new();
        for preset in &all {
            if !tasks.contains(&preset.task) {
                tasks.push(preset.task);
            }
        }
        let mut grouped: Vec<&str> = Vec::new();
        for task in tasks {
            grouped.extend(all.iter().filter(|preset| preset.task == task).map(|preset| preset.id));
        }
        // Below them the recordings; see `recording`.
        grouped.extend(SAMPLES.iter().map(|sample| sample.id));
        assert_eq!(offered, grouped);
        page.click("#gallery [aria-label=Close]").await?;
        let mut periodic = 0;
        for preset in PRESETS {
            let known = Known::preset(preset)?;
            page.preset(preset.id).await?;
            page.until_digest(&known.digest).await.with_context(|| preset.id)?;
            // The view of the address leaves out the default tab.
            let view = preset.view.trim_end_matches("tmotion").trim_end_matches('.');
            let view = if view.is_empty() { String::new() } else { format!("&v={view}") };
            let link = json!(format!("#{}{view}", known.link));
            page.until_equal("location.hash", &link).await.with_context(|| preset.id)?;
            ensure!(!page.visible("#budget").await?, "{} is over the budget", preset.id);
            ensure!(
                page.eval::<String>("document.title").await?.contains(&known.scenario.title),
                "{}",
                preset.id
            );
            let pulses = page.pulses().await?;
            ensure!(pulses.ink("--step").pixels > 200, "{}: {pulses:?}", preset.id);
            let rows: u32 = page.eval("document.querySelectorAll('#packets tbody tr').length").await?;
            let sends = known.experiment.segments().is_none();
            assert_eq!(rows > 0, sends, "{} shows {rows} packets", preset.id);
            if matches!(known.scenario.source, Source::Motion(_)) {
                // The range of the chart is that of all axes; the whole curve fills it without the others.
                page.click("#zoom-fit").await?;
                let hide = "const other = () => document.querySelector('#motion-axes button:not(.selected)[aria-pressed=true]'); \
                            for (let press = other(); press; press = other()) press.click(); return true;";
                page.js::<bool>(hide, vec![]).await?;
                let curve = async || Ok(page.canvas("chart-position").await?.has_curve("--ideal").ok());
                page.eventually(&format!("the ideal curve of {}", preset.id), curve).await?;
            }
            periodic += u32::from(distortion(&page, preset, &known).await?);
        }
        ensure!(periodic > 0, "no preset repeats its motion");
        Ok(())
    })
}

/// The number between a word and the percent sign behind it.
fn percent_after(text: &str, word: &str) -> Result<f64> {
    let rest = text.split_once(word).and_then(|(_, rest)| rest.split_once('%'));
    let (number, _) = rest.with_context(|| format!("no {word} in `{text}`"))?;
    number.trim().parse().with_context(|| format!("`{text}`"))
}

/// Compares the visible distortion with the core's; returns whether there is one.
async fn distortion(page: &Session, preset: &Preset, known: &Known) -> Result<bool> {
    let analysis = &known.scenario.analysis;
    let Some(plan) = known.experiment.plans().get(usize::from(analysis.axis)) else { return Ok(false) };
    let Some(ideal) = Spectrum::ideal(plan, analysis.max_harmonic, analysis.fft_length) else {
        return Ok(false);
    };
    if !ideal.window.periodic {
        return Ok(false);
    }
    for (quantity, harmonics) in
        [("position", &ideal.position), ("speed", &ideal.speed), ("acceleration", &ideal.acceleration)]
    {
        page.choose("#spectrum-quantity", quantity).await?;
        let said = page.text("#thd").await?;
        ensure!(said.contains(quantity), "{}: {said}", preset.id);
        if let Some(distortion) = harmonics.distortion {
            let (shown, wanted) = (percent_after(&said, "ideal ")?, 100.0 * distortion);
            ensure!(
                (shown - wanted).abs() <= 1e-4 * wanted.abs() + 1e-7,
                "{}: {said}, wanted {wanted}",
                preset.id
            );
        }
    }
    Ok(true)
}
