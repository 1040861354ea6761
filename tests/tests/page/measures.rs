//! The study's tab Measures, compared with the core, and the sensor of the spectrum.
#![allow(clippy::expect_used, clippy::panic, reason = "a missing file or program fails the test")]

use anyhow::{Result, ensure};
use serde_json::json;
use stepscope_core::{
    inspect::{
        motion::{
            actual_motion::Pulses,
            measures::Measures,
            spectrum::{AnalysisWindow, Spectrum},
        },
        recording::figures::StepFigures,
    },
    peripheral::trace::steps,
    scenario::Source,
};

use crate::{bench::in_browser, native::Known, session::Session};

/// A sine so fast that ticks are visible, with a number of samples that is no power of two.
const SINE: &str = r#"{"analysis":{"order":99,"fft_length":1000,"sensor_hz":40},"source":{"motion":{"axes":[{"moves":[
    {"sine_segments":{"amplitude":{"steps":800},"period_s":0.5,"periods":2,"max_deviation":0.0054}}]}]}}}"#;

/// Texts of the cells of the `nth` row with this header, without digit grouping.
async fn cells(page: &Session, table: &str, head: &str, nth: usize) -> Result<Vec<String>> {
    let script = "const row = [...document.querySelectorAll(`table[aria-label='${arguments[0]}'] tbody tr`)].filter((row) => row.cells[0].textContent === arguments[1])[arguments[2]];
        return row ? [...row.cells].slice(1).map((cell) => cell.textContent.replace(/\\u202f/g, '').replace('−', '-')) : [];";
    page.js(script, vec![json!(table), json!(head), json!(nth)]).await
}

/// Compares a text of four digits with a number, with any prefix of its unit.
fn close(text: &str, wanted: f64) -> Result<()> {
    let (number, unit) = text.split_once(' ').unwrap_or((text, ""));
    let scale = match unit {
        "ms" => 1e-3,
        "µs" => 1e-6,
        "ns" => 1e-9,
        "%" => 1e-2,
        _ => 1.0,
    };
    let found = number.parse::<f64>()? * scale;
    ensure!((found - wanted).abs() <= 6e-4 * wanted.abs(), "{text} is not {wanted}");
    Ok(())
}

fn measured(known: &Known) -> (Measures, [Spectrum; 2]) {
    let steps = steps(&known.recording.trace, 0);
    let run = Pulses::of_run(0, &steps, &known.recording.packets, None, known.experiment.config());
    let (plan, analysis) = (&known.experiment.plans()[0], &known.scenario.analysis);
    let Source::Motion(motion) = &known.scenario.source else { panic!("a motion") };
    let stretch = AnalysisWindow::of(plan).expect("it takes time");
    let ideal = Spectrum::ideal(plan, analysis.max_harmonic, analysis.fft_length).expect("it takes time");
    let pulses = Spectrum::of_pulses(&stretch.pulses_of(plan, &run), stretch, analysis.max_harmonic);
    let spectra = [ideal, pulses].map(|spectrum| spectrum.filtered_by(analysis.sensor_hz));
    (Measures::of(plan, &run, motion.axes.first()), spectra)
}

#[test]
fn measures_of_axes_match_the_core() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(SINE)?;
        let (found, [ideal, pulses]) = measured(&known);
        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        page.click("#study").await?;
        page.click("#study-tab-measures").await?;
        page.until("document.querySelector(\"table[aria-label='Sine by segments'] tbody tr\") !== null")
            .await?;
        let all = [found.steps, found.ticks, found.pulses];
        let rows = [
            ("RMS deviation, steps", all.map(|pair| pair.rms_steps)),
            ("area between, steps·s", all.map(|pair| pair.area_steps_s)),
            ("Euclidean distance, steps", all.map(|pair| pair.euclidean_steps)),
            ("1 − correlation", all.map(|pair| pair.uncorrelated.expect("both move"))),
        ];
        for (name, wanted) in rows {
            let cells = cells(&page, "Steps and ticks", name, 0).await?;
            // The last cell explains the row.
            ensure!(cells.len() == 4 && cells[3].len() > 10, "{name}: {cells:?}");
            cells.iter().zip(wanted).try_for_each(|(text, wanted)| close(text, wanted))?;
        }
        let errors = cells(&page, "Steps and ticks", "maximum time error", 0).await?;
        close(&errors[0], found.step_errors.largest_s)?;
        close(&errors[1], found.tick_errors.largest_s)?;
        assert_eq!(errors[2], "", "both together have no instants of their own");
        let late = cells(&page, "Duration", "delay of the last pulse", 0).await?;
        close(&late[0], found.duration.end_error_s.expect("there are pulses"))?;
        let start_stop = cells(&page, "Maxima of the ideal curve", "start-stop rate", 0).await?;
        ensure!(
            (start_stop[0].replace(" steps/s", "").parse::<f64>()? - found.peaks.start_stop_steps_s).abs()
                <= 0.5,
            "{start_stop:?}"
        );
        let distortions = [
            ("position", ideal.position.distortion, pulses.position.distortion),
            ("filtered acceleration", filtered(&ideal), filtered(&pulses)),
        ];
        for (name, ideal, pulses) in distortions {
            let cells = cells(&page, "Distortion", name, 0).await?;
            close(&cells[0], ideal.expect("a ratio"))?;
            close(&cells[1], pulses.expect("a ratio"))?;
        }
        let distance = cells(&page, "Sine by segments", "Ev", 0).await?;
        close(&distance[0], found.sine.expect("a sine").euclidean)?;

        // Another run has other figures; an axis without a motion has none.
        page.fill("source.motion.axes[0].moves[0].sine_segments.max_deviation", "0.02").await?;
        page.until(&format!(
            "document.querySelector(\"table[aria-label='Sine by segments'] td\").textContent !== '{}'",
            found.sine.expect("a sine").segments
        ))
        .await?;
        page.fill("bus.channels", "2").await?;
        page.until("!document.getElementById('study-axis').parentElement.hidden").await?;
        page.choose("#study-axis", "1").await?;
        page.until("document.getElementById('study-measures').textContent.includes('Axis 1 has no motion')")
            .await?;
        ensure!(!page.visible("table[aria-label='Duration']").await?);
        Ok(())
    })
}

#[test]
fn measures_of_steps_without_a_motion_match_the_core() -> Result<()> {
    in_browser(|page| async move {
        // Back and forth four times, and an idle channel.
        let list = r#"{"bus":{"channels":2},"source":{"segments":{"channels":[{"segments":[
            {"steps":{"count":100,"interval_q16":524288000,"dir":1}},{"steps":{"count":100,"interval_q16":262144000,"dir":0}},
            {"steps":{"count":100,"interval_q16":524288000,"dir":1}},{"steps":{"count":100,"interval_q16":262144000,"dir":0}},
            {"steps":{"count":100,"interval_q16":524288000,"dir":1}},{"steps":{"count":100,"interval_q16":262144000,"dir":0}},
            {"steps":{"count":100,"interval_q16":524288000,"dir":1}}]}]}}}"#;
        let known = Known::of(list)?;
        let clock_hz = known.experiment.config().clock_hz();
        let figures = StepFigures::of(steps(&known.recording.trace, 0), clock_hz).expect("it steps");
        page.open(&format!("#{}&v=tstudy.ymeasures", known.link)).await?;
        page.until_digest(&known.digest).await?;
        page.until("document.querySelector(\"table[aria-label='Steps'] tbody tr\") !== null").await?;
        let one = async |name: &str| {
            let cells = cells(&page, "Steps", name, 0).await?;
            ensure!(cells.len() == 2 && cells[1].len() > 8, "{name}: {cells:?}");
            anyhow::Ok(cells[0].clone())
        };
        for (name, wanted) in [
            ("steps", figures.steps),
            ("right", figures.right),
            ("left", figures.left),
            ("reversals", figures.turns),
            ("position", figures.position.unsigned_abs().into()),
        ] {
            assert_eq!(one(name).await?, wanted.to_string(), "{name}");
        }
        close(&one("shortest interval").await?, figures.shortest_interval_s.expect("steps"))?;
        close(&one("longest interval").await?, figures.longest_interval_s.expect("steps"))?;
        let rate = one("maximum rate").await?;
        assert_eq!(rate, format!("{} steps/s", figures.max_rate_steps_s.expect("steps")));
        // They move back and forth evenly, so the pulses have a distortion.
        let distortion = cells(&page, "Distortion", "speed", 0).await?;
        ensure!(distortion[0] == "–" && distortion[1].ends_with('%'), "{distortion:?}");
        for table in ["Steps and ticks", "Duration", "Maxima of the ideal curve"] {
            ensure!(!page.visible(&format!("table[aria-label='{table}']")).await?, "{table}");
        }
        page.picture("measures-of-steps").await?;
        page.choose("#study-axis", "1").await?;
        page.until("document.getElementById('study-measures').textContent.includes('Axis 1 has no motion')")
            .await?;
        ensure!(!page.visible("table[aria-label='Steps']").await?);
        Ok(())
    })
}

fn filtered(spectrum: &Spectrum) -> Option<f64> {
    spectrum.acceleration_filtered.as_ref()?.distortion
}

#[test]
fn distortion_follows_the_bandwidth_of_the_sensor() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(&SINE.replace(",\"sensor_hz\":40", ""))?;
        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        page.choose("#spectrum-quantity", "acceleration").await?;
        page.until("document.getElementById('thd').textContent.startsWith('THD of acceleration')").await?;
        ensure!(!page.text("#thd").await?.contains("filtered"));
        assert_eq!(page.field("analysis.sensor_hz").await?.value, "", "nothing is filtered by itself");
        page.fill("analysis.sensor_hz", "40").await?;
        page.until("document.getElementById('thd').textContent.includes('filtered by the sensor: ideal')")
            .await?;
        let said = page.text("#thd").await?;
        let (_, [ideal, _]) = measured(&Known::of(SINE)?);
        let wanted = 100.0 * filtered(&ideal).expect("a ratio");
        let text =
            said.rsplit_once("ideal ").map(|(_, rest)| rest.split(' ').next().unwrap_or("")).unwrap_or("");
        ensure!((text.parse::<f64>()? - wanted).abs() < 1e-3 * wanted, "{said} instead of {wanted}");
        // It is drawn, too: the filtered part of each harmonic.
        let drawn = "document.getElementById('spectrum-chart').toDataURL()";
        let unfiltered: String = page.eval(drawn).await?;
        page.choose("#spectrum-quantity", "acceleration_filtered").await?;
        page.until("document.getElementById('thd').textContent.startsWith('THD of acceleration, filtered by the sensor to harmonic')").await?;
        ensure!(page.text("#thd").await?.contains(text), "the same figure");
        ensure!(page.eval::<String>(drawn).await? != unfiltered, "other stems");
        page.click("#undo").await?;
        page.until("document.getElementById('spectrum-quantity').value === 'acceleration'").await?;
        page.fill("analysis.sensor_hz", "-1").await?;
        page.ready().await?;
        ensure!(page.field("analysis.sensor_hz").await?.invalid);
        page.fill("analysis.fft_length", "15").await?;
        page.ready().await?;
        ensure!(page.field("analysis.fft_length").await?.error.contains("16"));
        Ok(())
    })
}
