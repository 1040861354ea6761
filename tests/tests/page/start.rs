//! The first screen: starter cards, the gallery, presets in their views, and the way back.

use anyhow::{Context, Result, ensure};
use serde_json::json;
use stepscope_core::scenario::presets::{CONTROLLER_PRESETS, PLANT_PRESETS, PRESETS, Preset};

use crate::{
    bench::in_browser,
    keyboard::{go, key},
    native::{DISTANCE, Known, with_distance},
    session::{ENTER, Session},
};

const FOCUS: &str = "document.activeElement.dataset.path || document.activeElement.id";
const WELCOME: &str = "document.getElementById('welcome').checkVisibility()";
const ENGINE: &str = "document.querySelector('[data-path=\"source.motion.engine\"]').value";
const ESCAPE: char = '\u{e00c}';

fn preset(id: &str) -> Result<&'static Preset> {
    let all = PRESETS.iter().chain(PLANT_PRESETS).chain(CONTROLLER_PRESETS);
    all.clone().find(|preset| preset.id == id).with_context(|| id.to_owned())
}

/// A card by the start of its title.
async fn press_card(page: &Session, within: &str, title: &str) -> Result<()> {
    let script = "const card = [...document.querySelectorAll(`${arguments[0]} .card`)]
        .find((each) => each.textContent.startsWith(arguments[1])); card.click(); return true;";
    page.js::<bool>(script, vec![json!(within), json!(title)]).await.map(drop)
}

#[test]
fn new_visitors_see_three_working_cards() -> Result<()> {
    in_browser(|page| async move {
        for (width, height) in [(1366, 768), (390, 844)] {
            for (title, focus, view) in [
                ("Plan a move", "source.motion.axes[0].moves[0].cosine.distance", "study-tables"),
                ("Check pulses", "driver_timing", "margins"),
            ] {
                page.screen(width, height).await?;
                page.js::<bool>("localStorage.clear(); sessionStorage.clear(); return true;", vec![])
                    .await
                    .ok();
                page.open("").await?;
                page.js::<bool>("localStorage.clear(); sessionStorage.clear(); return true;", vec![]).await?;
                page.open("").await?;
                ensure!(page.eval::<bool>(WELCOME).await?, "no cards at {width} px");
                press_card(&page, "#welcome", title).await?;
                // On a phone, the view comes first and the form stays folded above it.
                let focus = if width < 900 { "views" } else { focus };
                page.until(&format!("({FOCUS}).startsWith('{focus}')")).await.context(title)?;
                ensure!(page.eval::<bool>("document.getElementById('sheet').open").await? == (width >= 900));
                page.until(&format!("document.getElementById('{view}')?.checkVisibility()")).await?;
                if title == "Plan a move" {
                    page.until_equal(ENGINE, &json!("segments")).await?;
                }
                ensure!(!page.eval::<bool>(WELCOME).await?, "the cards are still there");
                page.open("").await?;
                ensure!(!page.eval::<bool>(WELCOME).await?, "the cards are back");
            }
        }
        // They are in the gallery as well.
        page.click("#preset").await?;
        page.until("document.querySelectorAll('#gallery[open] > .cards .card').length === 3").await?;
        page.js::<bool>(
            "document.getElementById('open-file').addEventListener('click', (event) => { event.preventDefault(); window.asked = true; });
             return true;",
            vec![],
        )
        .await?;
        press_card(&page, "#gallery > .cards", "Open a capture").await?;
        page.until("window.asked && !document.getElementById('gallery').open").await
    })
}

#[test]
fn links_and_saved_work_show_no_cards() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::preset(preset("song-2021-plateau")?)?;
        page.open(&format!("#{}", known.link)).await?;
        ensure!(!page.eval::<bool>(WELCOME).await?, "cards above a link");
        page.open("").await?;
        ensure!(page.eval::<bool>(WELCOME).await?, "no cards");
        page.fill(DISTANCE, "900").await?;
        page.until_digest(&Known::of(&with_distance(900.0))?.digest).await?;
        ensure!(page.eval::<bool>(WELCOME).await?, "the form moves while something is typed");
        page.open("").await?;
        ensure!(!page.eval::<bool>(WELCOME).await?, "cards above own work");
        Ok(())
    })
}

#[test]
fn the_gallery_is_searched_and_closed_by_keys() -> Result<()> {
    const FOUND: &str =
        "[...document.querySelectorAll('#gallery [data-entry]')].map((card) => card.dataset.entry)";
    in_browser(|page| async move {
        page.open("").await?;
        go(&page, &[], "preset").await?;
        key(&page, &[], ENTER).await?;
        page.until_equal(FOCUS, &json!("gallery-search")).await?;
        let all: Vec<String> = page.eval(FOUND).await?;
        key(&page, &[], ENTER).await?;
        ensure!(
            page.eval::<bool>("document.getElementById('gallery').open").await?,
            "nothing is searched for"
        );
        for (search, some, max) in [
            ("noise", "framed-noisy-line", 6),
            ("glitches", "glitches-and-breaks", 4),
            ("motor", "song-2021-motor", all.len() / 2),
            ("capture", "recorded-late-packet", 3),
        ] {
            page.press("#gallery-search", search).await?;
            let found: Vec<String> = page.eval(FOUND).await?;
            ensure!(found.iter().any(|id| id == some) && found.len() <= max, "{search} finds {found:?}");
            page.js::<()>("document.getElementById('gallery-search').value = '';", vec![]).await?;
        }
        page.press("#gallery-search", "drv8825").await?;
        page.until_equal(FOUND, &json!(["driver-timing-broken"])).await?;
        key(&page, &[], ESCAPE).await?;
        // The first Escape may only clear the search.
        key(&page, &[], ESCAPE).await?;
        page.until("!document.getElementById('gallery').open").await?;
        page.until_equal(FOCUS, &json!("preset")).await?;
        key(&page, &[], ENTER).await?;
        page.until("document.getElementById('gallery').open").await?;
        page.click("#gallery .group [aria-label=Recordings]").await?;
        page.until_equal(FOUND, &json!(["recorded-step-table", "recorded-late-packet"])).await?;
        ensure!(page.text("#gallery-list").await?.matches("import dialog").count() == 2);
        Ok(())
    })
}

#[test]
fn a_preset_opens_in_its_view_at_its_moment() -> Result<()> {
    const SHOWN: &str = "document.querySelector('.view.open')?.id";
    in_browser(|page| async move {
        for (width, height) in [(1440, 900), (390, 844)] {
            page.screen(width, height).await?;
            page.open("").await?;
            for (id, view) in [
                ("patent-2019-overload", "view-motor"),
                ("framed-link", "view-packets"),
                ("patent-2019-common-dir", "view-pulses"),
                ("sine-2022-d0006", "view-spectrum"),
                ("controller-homing", "view-panel"),
                ("song-2021-one-turn", "view-motion"),
            ] {
                let preset = preset(id)?;
                page.preset(id).await?;
                page.until_digest(&Known::preset(preset)?.digest).await.context(id)?;
                page.until_equal(SHOWN, &json!(view)).await.with_context(|| format!("{id} at {width} px"))?;
                ensure!(page.visible(&format!("#{view}")).await?, "{view} of {id} at {width} px");
                let view = if preset.view == "tmotion" { "" } else { preset.view };
                page.until(&format!(
                    "(new URLSearchParams(location.hash.slice(1)).get('v') ?? '') === '{view}'"
                ))
                .await
                .context(id)?;
            }
        }
        Ok(())
    })
}

#[test]
fn back_returns_to_the_experiment_before_and_forward_to_the_next() -> Result<()> {
    in_browser(|page| async move {
        let own = Known::of(&with_distance(900.0))?;
        let (turn, plateau) = (preset("song-2021-one-turn")?, preset("song-2021-plateau")?);
        page.open("").await?;
        page.fill(DISTANCE, "900").await?;
        page.until_digest(&own.digest).await?;
        let first: u32 = page.eval("history.length").await?;
        for each in [turn, plateau] {
            page.preset(each.id).await?;
            page.until_digest(&Known::preset(each)?.digest).await?;
        }
        page.click("#experiments").await?;
        page.until("!document.getElementById('experiment-save').disabled").await?;
        page.click("#experiment-new").await?;
        page.until_digest(&Known::of("{}")?.digest).await?;
        assert_eq!(page.eval::<u32>("history.length").await?, first + 3);
        for digest in [Known::preset(plateau)?.digest, Known::preset(turn)?.digest, own.digest] {
            page.client.back().await?;
            page.until_digest(&digest).await?;
        }
        assert_eq!(page.field(DISTANCE).await?.value, "900");
        page.client.forward().await?;
        page.until_digest(&Known::preset(turn)?.digest).await?;
        ensure!(!page.visible("#link-message").await?, "going back is no link of another");
        // After a reload only the addresses are left.
        page.client.refresh().await?;
        page.ready().await?;
        page.client.back().await?;
        page.until_digest(&Known::of(&with_distance(900.0))?.digest).await
    })
}
