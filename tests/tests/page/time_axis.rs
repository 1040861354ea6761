//! The shared time axis of motion, pulses and packets.

use anyhow::{Context, Result, anyhow, ensure};
use fantoccini::actions::{
    InputSource, KeyAction, KeyActions, MOUSE_BUTTON_LEFT, MouseActions, PointerAction, WheelAction,
    WheelActions,
};
use serde::Deserialize;
use stepscope_core::inspect::packets::log::LoggedPacket;

use crate::{
    bench::in_browser,
    native::Known,
    session::{END, ENTER, SHIFT, Session},
};

/// The visible part of the time axis, in s.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Window {
    start: f64,
    end: f64,
}

impl Window {
    fn length(self) -> f64 {
        self.end - self.start
    }
}

/// Reads the number fields of the pulses.
async fn window(page: &Session) -> Result<Window> {
    let (start, end): (String, String) = page
        .eval("[document.getElementById('window-start').value, document.getElementById('window-end').value]")
        .await?;
    Ok(Window { start: seconds(&start)?, end: seconds(&end)? })
}

/// Reads a time as the page prints it, such as `12.5 ms`.
fn seconds(text: &str) -> Result<f64> {
    let (number, unit) =
        text.trim().split_once([' ', '\u{a0}', '\u{202f}']).with_context(|| format!("`{text}`"))?;
    let scale = match unit {
        "s" => 1.0,
        "ms" => 1e-3,
        "\u{b5}s" => 1e-6,
        "ns" => 1e-9,
        _ => return Err(anyhow!("`{text}` is no time")),
    };
    Ok(number.replace('\u{2212}', "-").parse::<f64>().with_context(|| format!("`{text}`"))? * scale)
}

/// The window has a packet and its tick, and little more.
fn holds(known: &Known, packet: &LoggedPacket, window: Window) -> Result<()> {
    let start = known.seconds(packet.start.0);
    let end = known.seconds(packet.tick_end.unwrap_or(packet.end).0);
    ensure!(window.start <= start && end <= window.end, "{packet:?} is not in {window:?}");
    ensure!(window.length() < 20.0 * (end - start), "{packet:?} is lost in {window:?}");
    Ok(())
}

async fn chosen(page: &Session) -> Result<Vec<usize>> {
    page.eval("[...document.querySelectorAll('#packets tr[aria-selected=true]')].map((row) => Number(row.dataset.index))")
        .await
}

#[test]
fn a_selected_packet_is_shown_in_pulses_and_curves() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of("{}")?;
        let packets = known.recording.packets.rows();
        page.open("").await?;
        let (pulses, curve) = (page.canvas("pulses").await?.hash, page.canvas("chart-position").await?.hash);

        page.click("#packet-1 td").await?;
        page.until("document.getElementById('window-start').value !== '0 s'").await?;
        holds(&known, &packets[1], window(&page).await?)?;
        assert_eq!(chosen(&page).await?, [1]);
        for (id, before) in [("pulses", pulses), ("chart-position", curve)] {
            redrawn(&page, id, &before).await?;
        }
        let label: String = page.eval("document.getElementById('pulses').ariaLabel").await?;
        let start: String = page.eval("document.getElementById('window-start').value").await?;
        ensure!(label.contains(&start), "the pulses say what they show: {label}");

        // By keys only: the last packet.
        page.press("#packets", &format!("{END}{ENTER}")).await?;
        let last = packets.len() - 1;
        page.until(&format!("document.querySelector('#packet-{last}')?.ariaSelected === 'true'")).await?;
        page.until(&format!("document.getElementById('window-start').value !== '{start}'")).await?;
        holds(&known, &packets[last], window(&page).await?)?;
        assert_eq!(chosen(&page).await?, [last]);
        Ok(())
    })
}

async fn redrawn(page: &Session, id: &str, before: &str) -> Result<()> {
    let look = async || Ok((page.canvas(id).await?.hash != before).then_some(()));
    page.eventually(&format!("{id} was redrawn"), look).await
}

/// Position of an element in the window, in CSS pixels.
#[derive(Deserialize)]
struct Place {
    x: f64,
    y: f64,
    width: f64,
    height: f64,
}

impl Place {
    async fn of(page: &Session, id: &str) -> Result<Self> {
        page.eval(&format!("document.getElementById('{id}').getBoundingClientRect().toJSON()")).await
    }

    /// A point at these fractions of the width and height.
    fn point(&self, across: f64, down: f64) -> (i64, i64) {
        ((self.x + self.width * across) as i64, (self.y + self.height * down) as i64)
    }
}

#[test]
fn every_zoom_control_changes_the_range_and_fit_restores_it() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        let whole = window(&page).await?;
        for id in ["charts", "pulses"] {
            let (x, y) = Place::of(&page, id).await?.point(0.5, 0.3);
            let mut wheel = WheelActions::new("wheel".into());
            wheel.push(WheelAction::Scroll { duration: None, x, y, delta_x: 0, delta_y: -400 });
            page.actions(wheel).await?;
            let zoomed = changed(&page, whole).await.with_context(|| format!("wheel over {id}"))?;
            ensure!(zoomed.length() < 0.8 * whole.length(), "wheel over {id}: {zoomed:?}");
            ensure!(zoomed.start > whole.start && zoomed.end < whole.end, "around the pointer: {zoomed:?}");
            page.click("#zoom-fit").await?;
            assert_eq!(changed(&page, zoomed).await?, whole);

            page.press(&format!("#{id}"), "+").await?;
            let zoomed = changed(&page, whole).await?;
            ensure!((zoomed.length() / whole.length() - 0.5).abs() < 0.01, "+ over {id}: {zoomed:?}");
            page.press(&format!("#{id}"), "\u{e014}").await?;
            let moved = changed(&page, zoomed).await?;
            ensure!(moved.start > zoomed.start, "arrow over {id}: {moved:?}");
            page.press(&format!("#{id}"), "-").await?;
            let wider = changed(&page, moved).await?;
            ensure!(wider.length() > moved.length(), "- over {id}: {wider:?}");
            page.press(&format!("#{id}"), "+\u{e011}").await?;
            page.until_equal("document.getElementById('window-start').value", &"0 s".into()).await?;
            assert_eq!(window(&page).await?, whole, "Home over {id}");
        }
        page.click("#zoom-in").await?;
        let zoomed = changed(&page, whole).await?;
        page.click("#zoom-out").await?;
        assert_eq!(changed(&page, zoomed).await?, whole);

        for (field, text) in [("#window-end", "120 ms"), ("#window-start", "100 ms")] {
            page.press(field, &format!("{}a{}{text}{ENTER}", '\u{e009}', '\u{e000}')).await?;
        }
        let typed = window(&page).await?;
        ensure!((typed.start - 0.1).abs() < 1e-6 && (typed.end - 0.12).abs() < 1e-6, "{typed:?}");
        Ok(())
    })
}

/// Waits for a window that differs from this one.
async fn changed(page: &Session, before: Window) -> Result<Window> {
    let look = async || Ok(Some(window(page).await?).filter(|now| *now != before));
    page.eventually(&format!("another time than {before:?}"), look).await
}

#[test]
fn clicks_set_cursors_in_all_views_with_their_difference() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        let place = Place::of(&page, "charts").await?;
        for (across, shift) in [(0.4, false), (0.7, true)] {
            let (x, y) = place.point(across, 0.2);
            let mouse = MouseActions::new("mouse".into())
                .then(PointerAction::MoveTo { duration: None, x: x as f64, y: y as f64 })
                .then(PointerAction::Down { button: MOUSE_BUTTON_LEFT })
                .then(PointerAction::Up { button: MOUSE_BUTTON_LEFT });
            let keys = KeyActions::new("keys".into());
            let keys = if shift { keys.then(KeyAction::Down { value: SHIFT }) } else { keys };
            let keys = keys.pause(std::time::Duration::ZERO).pause(std::time::Duration::ZERO);
            let actions = fantoccini::actions::Actions::from(keys).and(mouse);
            page.actions(actions).await?;
        }
        page.until("/B−A/.test(document.getElementById('cursor-readings').textContent)").await?;
        let readings = page.text("#cursor-readings").await?;
        ensure!(readings.contains("Hz"), "one over the difference: {readings}");
        for overlay in ["charts-cursor", "pulses-cursor"] {
            let canvas = page.canvas(overlay).await?;
            for ink in ["--cursor-a", "--cursor-b"] {
                ensure!(canvas.ink(ink).rows > 0.5 * canvas.height, "{ink} on {overlay}: {canvas:?}");
            }
        }
        Ok(())
    })
}

#[test]
fn the_next_edge_matches_the_trace_and_is_announced() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of("{}")?;
        // Bit 0 is STEP0, the row that is selected first.
        let high = |index: usize| known.recording.trace.get(index).map(|record| record.levels.0 & 1);
        let rise = (1..known.recording.trace.len())
            .find(|&index| high(index - 1) == Some(0) && high(index) == Some(1))
            .context("the default motion steps")?;
        let cycle = known.recording.trace[rise].cycle.0;
        page.open("").await?;
        page.press("#pulses", "n").await?;
        page.until(&format!(
            "document.getElementById('pulses-sentence').textContent.includes('cycle {cycle}')"
        ))
        .await?;
        Ok(())
    })
}
