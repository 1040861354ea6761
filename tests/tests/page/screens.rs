//! Narrow screens, and both themes.

use anyhow::{Result, ensure};
use serde::Deserialize;

use crate::{
    bench::in_browser,
    native::Known,
    session::{ENTER, Session},
};

const VIEWS: [(&str, &str); 4] =
    [("motion", "chart-position"), ("pulses", "pulses"), ("packets", ""), ("spectrum", "spectrum-chart")];

/// Nothing is beyond the right edge of the document.
async fn no_sideways_scrolling(page: &Session, what: &str) -> Result<()> {
    let (content, window): (u32, u32) =
        page.eval("[document.documentElement.scrollWidth, document.documentElement.clientWidth]").await?;
    if content <= window {
        return Ok(());
    }
    let wide: Vec<String> = page
        .eval(
            "[...document.querySelectorAll('body *')].filter((node) => node.getBoundingClientRect().right > \
             document.documentElement.clientWidth + 1).map((node) => node.id || node.className || node.tagName)",
        )
        .await?;
    anyhow::bail!("{what}: {content} px in a window of {window} px: {wide:?}")
}

#[test]
fn narrow_screens_have_tabs_and_no_horizontal_scrolling() -> Result<()> {
    in_browser(|page| async move {
        for (width, height) in [(390, 844), (320, 640)] {
            page.screen(width, height).await?;
            page.open("").await?;
            if width == 390 {
                page.picture("narrow").await?;
            }
            for (view, canvas) in VIEWS {
                page.click(&format!("#tab-{view}")).await?;
                for (other, _) in VIEWS {
                    let visible = page.visible(&format!("#view-{other}")).await?;
                    assert_eq!(visible, other == view, "{other} at the tab {view}");
                }
                let selected: Vec<String> = page
                    .eval("[...document.querySelectorAll('.tabs [role=tab][aria-selected=true]')].map((t) => t.id)")
                    .await?;
                assert_eq!(selected, [format!("tab-{view}")]);
                no_sideways_scrolling(&page, &format!("{view} at {width} px")).await?;
                if view == "pulses" {
                    page.pulses().await?;
                }
                if !canvas.is_empty() {
                    let ink = if view == "pulses" { "--step" } else { "--ideal" };
                    drawn(&page, canvas, ink).await?;
                }
            }
            let packets: u32 = page.eval("document.querySelectorAll('#packets tbody tr').length").await?;
            ensure!(packets >= 3, "{packets} packets at {width} px");

            ensure!(!page.visible("#fields").await?, "the form is folded away at {width} px");
            page.click("#sheet > summary").await?;
            ensure!(page.visible("#fields").await?, "the form unfolds at {width} px");
            no_sideways_scrolling(&page, &format!("form at {width} px")).await?;
            page.fill("bus.slots", "200").await?;
            page.ready().await?;
            no_sideways_scrolling(&page, &format!("an error at {width} px")).await?;
            // The next width starts with the work of this one.
            page.fill("bus.slots", "100").await?;
            page.until("!document.querySelector('#status').textContent.startsWith('not run')").await?;
        }
        Ok(())
    })
}

/// Waits until a canvas, which may have been hidden, is drawn.
async fn drawn(page: &Session, canvas: &str, ink: &str) -> Result<()> {
    let look = async || Ok((page.canvas(canvas).await?.ink(ink).pixels > 100).then_some(()));
    page.eventually(&format!("{canvas} drawn in {ink}"), look).await
}

#[test]
fn a_packet_can_be_shown_in_the_pulses_on_a_narrow_screen() -> Result<()> {
    in_browser(|page| async move {
        page.screen(390, 844).await?;
        page.open("").await?;
        page.click("#tab-packets").await?;
        page.until("document.querySelector('#packet-2')").await?;
        page.press("#packets", &format!("{ENTER}")).await?;
        page.until("document.getElementById('tab-pulses').ariaSelected === 'true'").await?;
        ensure!(page.visible("#view-pulses").await?);
        Ok(())
    })
}

#[derive(Deserialize)]
struct Contrast {
    /// Relative luminance of the pane, 0 to 1.
    ground: f64,
    /// Contrast of the text with the pane.
    text: f64,
    /// Contrast of each curve with the pane.
    curves: Vec<(String, f64)>,
}

const CONTRAST: &str = "
    const rgb = (text) => text.match(/[\\d.]+/g).slice(0, 3).map(Number);
    const light = (color) => {
        const [r, g, b] = color.map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const ratio = (a, b) => (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    const ground = light(rgb(getComputedStyle(document.getElementById('view-motion')).backgroundColor));
    const probe = document.createElement('i');
    document.body.append(probe);
    const of = (name) => { probe.style.color = `var(${name})`; return light(rgb(getComputedStyle(probe).color)); };
    const names = ['--ideal', '--actual', '--step', '--dir', '--enable', '--wire', '--packet', '--reply', '--tick', '--axis'];
    const curves = names.map((name) => [name, ratio(of(name), ground)]);
    const text = ratio(of('--ink'), ground);
    probe.remove();
    return { ground, text, curves };";

async fn contrasts(page: &Session, dark: bool) -> Result<()> {
    let found: Contrast = page.js(CONTRAST, vec![]).await?;
    ensure!(if dark { found.ground < 0.05 } else { found.ground > 0.8 }, "a ground of {}", found.ground);
    ensure!(found.text >= 7.0, "text has {}", found.text);
    for (name, ratio) in &found.curves {
        ensure!(*ratio >= 3.0, "{name} has a contrast of {ratio} on {}", if dark { "dark" } else { "light" });
    }
    page.pulses().await?;
    page.unfold_spectrum().await?;
    // The curves on the canvases have the colors of the theme.
    for (canvas, ink) in [("chart-position", "--ideal"), ("pulses", "--step"), ("spectrum-chart", "--actual")]
    {
        drawn(page, canvas, ink).await?;
    }
    page.canvas("chart-position").await?.has_curve("--ideal")
}

#[test]
fn both_themes_follow_the_system_and_keep_the_contrast_of_every_curve() -> Result<()> {
    in_browser(|page| async move {
        page.system_colors("dark").await?;
        page.open("").await?;
        page.picture("dark").await?;
        contrasts(&page, true).await?;
        page.system_colors("light").await?;
        contrasts(&page, false).await?;
        assert_eq!(page.shown().await?.digest, Known::of("{}")?.digest);
        Ok(())
    })
}

#[test]
fn the_selected_theme_overrides_the_system_and_is_saved() -> Result<()> {
    in_browser(|page| async move {
        page.system_colors("light").await?;
        page.open("").await?;
        contrasts(&page, false).await?;
        page.click("#more").await?;
        for _ in 0..3 {
            if page.eval::<bool>("document.documentElement.dataset.theme === 'dark'").await? {
                break;
            }
            page.click("#theme").await?;
        }
        contrasts(&page, true).await?;
        page.open("").await?;
        contrasts(&page, true).await
    })
}
