//! The page as it opens: the default motion, computed and drawn, under the headers of a host.

use std::collections::BTreeMap;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::{
    bench::in_browser,
    native::{DISTANCE, Known, with_distance},
    session::Shown,
};

#[test]
fn the_page_opens_and_draws_the_default_motion() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of("{}")?;
        page.open("").await?;
        let shown = page.shown().await?;
        assert_eq!(shown, Shown { ready: true, digest: known.digest.clone(), stale: false });
        page.picture("wide").await?;

        for id in ["chart-position", "chart-speed", "chart-acceleration"] {
            let canvas = page.canvas(id).await?;
            canvas.has_curve("--ideal").with_context(|| format!("{id}: {canvas:?}"))?;
            ensure!(canvas.colors >= 3, "{id} has labels, axes and curves: {canvas:?}");
        }
        for id in ["chart-position", "chart-speed"] {
            let canvas = page.canvas(id).await?;
            ensure!(canvas.ink("--actual").columns > 300.0, "{id} shows what the pulses make: {canvas:?}");
        }
        let pulses = page.pulses().await?;
        for ink in ["--step", "--dir", "--enable", "--wire"] {
            ensure!(pulses.ink(ink).columns > 300.0, "the pulses have a row in {ink}: {pulses:?}");
        }
        let overview = page.canvas("overview").await?;
        ensure!(overview.colors >= 2, "the overview is drawn: {overview:?}");
        page.unfold_spectrum().await?;
        let spectrum = page.canvas("spectrum-chart").await?;
        for ink in ["--ideal", "--actual"] {
            ensure!(spectrum.ink(ink).pixels > 100, "the spectrum has stems in {ink}: {spectrum:?}");
        }

        let packets: u32 = page.eval("Number(document.getElementById('packets').ariaRowCount) - 1").await?;
        assert_eq!(packets as usize, known.recording.packets.rows().len());
        let rows: Vec<String> =
            page.eval("[...document.querySelectorAll('#packets tbody td:nth-child(3)')].map((cell) => cell.textContent)").await?;
        ensure!(rows.len() >= 3, "the table shows packets: {rows:?}");
        for (index, hex) in rows.iter().enumerate() {
            let bytes: Vec<String> =
                known.recording.packets.bytes(index).iter().map(|byte| format!("{byte:02x}")).collect();
            assert_eq!(hex.to_lowercase(), bytes.join(" "), "packet {index}");
        }
        let harmonics: u32 =
            page.eval("Number(document.getElementById('harmonics').ariaRowCount) - 1").await?;
        ensure!(
            harmonics >= u32::from(known.scenario.analysis.max_harmonic),
            "{harmonics} harmonics in the table"
        );
        let note = page.text("#spectrum-note").await?;
        ensure!(note.contains("not periodic"), "one move has no distortion, and the note states it: {note}");
        Ok(())
    })
}

#[test]
fn the_overview_is_drawn_when_it_is_shown_again() -> Result<()> {
    const STRIP: &str = "document.getElementById('overview')";
    in_browser(|page| async move {
        page.open("").await?;
        page.ready().await?;
        // The same width, but hidden: it is requested, and there is nothing to draw.
        page.eval::<String>(&format!("{STRIP}.style.height = '0'")).await?;
        page.until(&format!("{STRIP}.clientHeight === 0")).await?;
        page.fill(DISTANCE, "800").await?;
        page.until_digest(&Known::of(&with_distance(800.0))?.digest).await?;
        // Blank, because nothing has been drawn since.
        page.eval::<u32>(&format!("{STRIP}.width = 300")).await?;
        ensure!(page.canvas("overview").await?.colors < 2, "nothing is drawn out of sight");
        page.eval::<String>(&format!("{STRIP}.style.height = ''")).await?;
        page.eventually("the strip", async || Ok((page.canvas("overview").await?.colors >= 2).then_some(())))
            .await
    })
}

#[test]
fn the_page_is_served_with_its_headers_and_policy() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        let given: BTreeMap<String, String> = page
            .js("return fetch(location.href).then((answer) => Object.fromEntries(answer.headers));", vec![])
            .await?;
        let web = std::env::var("STEPSCOPE_WEB")?;
        let rules = std::fs::read_to_string(std::path::Path::new(&web).join("_headers"))?;
        let stated: Vec<(&str, &str)> = rules
            .lines()
            .skip_while(|line| *line != "/*")
            .skip(1)
            .take_while(|line| line.starts_with(' '))
            .filter_map(|line| line.trim().split_once(": "))
            .collect();
        ensure!(stated.len() >= 4, "_headers states little for all paths: {stated:?}");
        for (name, value) in &stated {
            assert_eq!(given.get(&name.to_lowercase()).map(String::as_str), Some(*value), "{name}");
        }
        let header = given.get("content-security-policy").context("no policy")?;
        let meta: String = page
            .eval("document.querySelector('meta[http-equiv=\"Content-Security-Policy\"]').content")
            .await?;
        assert_eq!(
            *header,
            format!("{meta}; frame-ancestors 'none'"),
            "the policy in the page is the header's"
        );
        for part in ["default-src 'none'", "script-src 'self' 'wasm-unsafe-eval'", "connect-src 'self'"] {
            ensure!(meta.split("; ").any(|each| each == part), "{part} is not in {meta}");
        }
        Ok(())
    })
}

#[test]
fn no_request_goes_to_another_host() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.preset("sonobe-2011-table").await?;
        page.until("document.documentElement.dataset.state === 'ready'").await?;
        page.click("#more").await?;
        page.click("#theme").await?;
        page.click("#share").await?;
        page.click("#copy-link").await?;
        page.ready().await?;
        let origin = page.address().trim_end_matches('/').to_owned();
        let asked: Vec<String> =
            page.eval("performance.getEntriesByType('resource').map((entry) => entry.name)").await?;
        ensure!(asked.iter().any(|name| name.ends_with(".wasm")), "the engine is not among {asked:?}");
        for name in &asked {
            ensure!(name.starts_with(&format!("{origin}/")) || name.starts_with("data:"), "requested {name}");
        }
        let links: Vec<Value> = page
            .eval("[...document.querySelectorAll('[src], link[href]')].map((node) => node.src || node.href)")
            .await?;
        for link in links.iter().filter_map(Value::as_str) {
            ensure!(link.starts_with(&origin) || link.starts_with("data:"), "the page has {link}");
        }
        Ok(())
    })
}
