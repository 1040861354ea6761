//! What helps people: the guide, terms, help, remedies, panes; and what they rely on: a history of 50 steps, every
//! digit of a number.

use std::collections::BTreeSet;

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use stepscope_core::{
    motion::{grouped, moves::Move},
    scenario::{Kinds, Scenario, Source, presets::PRESETS, schema::describe},
    sim::BUDGET_RECORDS,
};

use crate::{
    bench::{in_browser, in_sources},
    native::{Known, problems},
    session::{ENTER, SHIFT, Session, field},
};

/// What a remedy does to a scenario.
type Mend = fn(&mut Scenario);

/// See [`ENTER`].
const ESCAPE: char = '\u{e00c}';
/// See [`ENTER`].
const F1: char = '\u{e031}';
/// See [`ENTER`].
const RIGHT: char = '\u{e014}';

const FOCUS: &str = "document.activeElement.id";

#[test]
fn a_new_visitor_is_offered_the_guide_once_and_it_points_at_what_is_there() -> Result<()> {
    in_sources(|page| async move {
        for (width, height) in [(1440, 900), (390, 844)] {
            page.screen(width, height).await?;
            page.js::<Value>("localStorage.clear(); return null;", vec![]).await.ok();
            page.open("").await?;
            page.js::<Value>("localStorage.clear(); return null;", vec![]).await?;
            page.open("").await?;
            ensure!(page.visible("#welcome").await?, "the guide is not offered at {width} px");
            page.click("#welcome-start").await?;
            let steps: u32 =
                page.eval("import('./help/guide_steps.js').then((guide) => guide.STEPS.length)").await?;
            page.until("document.querySelector('#guide h2')").await?;
            for step in 1..=steps {
                let said = page.text("#guide h2").await?;
                ensure!(said.starts_with(&format!("{step} of {steps}")), "step {step}: {said}");
                assert_eq!(page.eval::<String>(FOCUS).await?, "guide-title", "step {step}");
                let pointed: Vec<bool> = page
                    .eval(
                        "[...document.querySelectorAll('.pointed')].map((node) => node.checkVisibility() && \
                         node.getBoundingClientRect().top < innerHeight && node.getBoundingClientRect().bottom > 0)",
                    )
                    .await?;
                assert_eq!(pointed, [true], "step {step} at {width} px");
                if step == 2 {
                    page.picture(&format!("guide-{width}")).await?;
                }
                if step < steps {
                    page.click("#guide [aria-label=Next]").await?;
                }
            }
            page.press("#guide-title", &format!("{ESCAPE}")).await?;
            ensure!(!page.visible("#guide").await?, "Escape leaves the guide open");
            assert_eq!(page.eval::<String>(FOCUS).await?, "more");
            page.open("").await?;
            ensure!(!page.visible("#welcome").await?, "the guide is offered twice");
        }
        page.js::<Value>("localStorage.clear(); return null;", vec![]).await?;
        page.screen(1440, 900).await?;
        page.open("").await?;
        page.click("#welcome-never").await?;
        page.open("").await?;
        ensure!(!page.visible("#welcome").await?, "no is not taken for an answer");
        Ok(())
    })
}

/// The names of the fields in the form below a path, sorted.
fn names_below(path: &str) -> String {
    format!(
        "[...new Set([...document.querySelectorAll('#fields [data-path^=\"{path}.\"]')]
             .map((node) => /^\\w+/.exec(node.dataset.path.slice({}))[0]))].sort()",
        path.len() + 1
    )
}

/// The fields of a group of the scenario's schema, sorted.
fn names_of(schema: &Value, group: &str) -> Value {
    let fields = schema["groups"][group]["fields"].as_array().into_iter().flatten();
    let names: BTreeSet<&str> = fields.filter_map(|field| field["name"].as_str()).collect();
    json!(names)
}

/// Kinds of a choice of the schema, each with its group of fields.
fn kinds_of<'a>(schema: &'a Value, choice: &str) -> impl Iterator<Item = Option<(&'a str, &'a str)>> {
    schema["groups"][choice]["fields"].as_array().into_iter().flatten().map(|kind| {
        let group = &kind["type"]["group"];
        Some((kind["name"].as_str()?, group.as_str()?))
    })
}

#[test]
fn every_field_of_the_form_is_explained() -> Result<()> {
    in_sources(|page| async move {
        page.open("").await?;
        for id in
            ["driver-timing-broken", "sonobe-2011-segments", "glitches-and-breaks", "two-controllers-raw"]
        {
            page.preset(id).await?;
            page.ready().await?;
            let dumb: Vec<String> = page
                .eval(
                    "Promise.all([import('./form/schema.js'), import('./help/term_texts.js')]).then(([{ termOf }, { DERIVED }]) =>
                     [...document.querySelectorAll('#form .term')].map((word) => word.dataset.term)
                     .filter((term) => !(termOf(term) ?? DERIVED[term])?.text))",
                )
                .await?;
            assert_eq!(dumb, [""; 0], "{id}");
        }
        Ok(())
    })
}

#[test]
fn every_kind_of_move_has_a_form_with_all_of_its_fields() -> Result<()> {
    const MOVE: &str = "source.motion.axes[0].moves[1]";
    in_browser(|page| async move {
        let schema: Value = serde_json::from_str(&describe())?;
        page.open("").await?;
        // A new target needs a move before it.
        page.click("[aria-label='Add move to axis 0']").await?;
        let mut kinds = 0;
        for kind in kinds_of(&schema, "Move") {
            let (kind, group) = kind.context("a kind of move has a group of fields")?;
            page.choose(&field(&format!("{MOVE}#kind")), kind).await?;
            let names = names_below(&format!("{MOVE}.{kind}"));
            page.until_equal(&names, &names_of(&schema, group)).await?;
            // A slider counts its steps from its minimum, so that has to be a whole number of them, and is near its field.
            let wrong: Vec<String> = page
                .eval(
                    "[...document.querySelectorAll('#fields [type=range]:enabled')].map((slider) => [slider, slider.closest('.field').querySelector('input')])
                     .filter(([{ min, step, value }, input]) => Math.abs(min / step - Math.round(min / step)) > 1e-9 || Math.abs(value - input.value) > step / 2)
                     .map(([, input]) => input.dataset.path)",
                )
                .await?;
            assert_eq!(wrong, [""; 0], "{kind}");
            kinds += 1;
        }
        assert_eq!(kinds, Move::KINDS.len());
        Ok(())
    })
}

#[test]
fn targets_shapers_limits_and_groups_have_a_form_with_all_of_their_fields() -> Result<()> {
    const AXIS: &str = "source.motion.axes[0]";
    const GROUP: &str = "source.motion.groups[0]";
    let check = async |page: &Session, path: &str, choice: &str, schema: &Value| -> Result<()> {
        for kind in kinds_of(schema, choice) {
            let (kind, group) = kind.context("a kind has a group of fields")?;
            page.choose(&field(&format!("{path}#kind")), kind).await?;
            if kind == "position" {
                page.until(&format!("document.querySelector('{}')", field(&format!("{path}.position"))))
                    .await?;
            } else {
                page.until_equal(&names_below(&format!("{path}.{kind}")), &names_of(schema, group)).await?;
            }
            page.ready().await?;
            assert_eq!(page.text("#problems").await?, "", "{kind}");
        }
        Ok(())
    };
    in_browser(move |page| async move {
        let schema: Value = serde_json::from_str(&describe())?;
        page.open("").await?;
        page.click("[aria-label='Add move to axis 0']").await?;
        page.choose(&field(&format!("{AXIS}.moves[1]#kind")), "retarget").await?;
        check(&page, &format!("{AXIS}.moves[1].retarget.target"), "Target", &schema).await?;
        page.js::<()>(
            "for (const part of document.querySelectorAll('#fields details')) part.open = true; return null;",
            vec![],
        )
        .await?;
        page.until_equal(&names_below(&format!("{AXIS}.limits")), &names_of(&schema, "AxisLimits")).await?;
        check(&page, &format!("{AXIS}.input_shaper"), "InputShaper", &schema).await?;
        page.choose(&field(&format!("{AXIS}.input_shaper#kind")), "").await?;
        page.click("[aria-label='Add a group of moves']").await?;
        page.until(&format!("document.querySelector('{}')", field(&format!("{GROUP}#kind")))).await?;
        check(&page, GROUP, "Group", &schema).await?;
        page.until_equal(
            &names_below(&format!("{GROUP}.way_points.points[0]")),
            &json!(["positions", "speeds"]),
        )
        .await?;
        page.choose(&field(&format!("{GROUP}#kind")), "time").await?;
        page.until_equal(&names_below(&format!("{GROUP}.time.moves[0]")), &json!(["axis", "move"])).await?;
        // Groups follow the number of axes.
        page.choose(&field(&format!("{GROUP}#kind")), "line").await?;
        page.fill(&format!("{GROUP}.line.distances[0]"), "700").await?;
        page.click("[aria-label='Copy axis 0']").await?;
        page.fill(&format!("{GROUP}.line.distances[1]"), "-300").await?;
        page.click("[aria-label='Remove axis 0']").await?;
        page.ready().await?;
        assert_eq!(page.field(&format!("{GROUP}.line.distances[0]")).await?.value, "-300");
        assert_eq!(page.text("#problems").await?, "");
        Ok(())
    })
}

#[test]
fn a_word_opens_its_card_by_pointer_and_by_key_and_escape_closes_it() -> Result<()> {
    const OPEN: &str = "document.getElementById('term-card').matches(':popover-open')";
    in_browser(|page| async move {
        page.open("").await?;
        page.click(".derived [data-term=line_load]").await?;
        page.until(OPEN).await?;
        let said = page.text("#term-card").await?;
        ensure!(said.contains("RU 2704486"), "{said}");
        page.press(".derived [data-term=line_load]", &format!("{ESCAPE}")).await?;
        page.until(&format!("!{OPEN}")).await?;
        page.press(&field("bus.slots"), &format!("{F1}")).await?;
        page.until(OPEN).await?;
        let said = page.text("#term-card").await?;
        ensure!(said.contains("A tick is divided into slots") && said.contains("1 to 127"), "{said}");
        ensure!(
            !page.eval::<bool>("document.getElementById('keys').open").await?,
            "F1 in a field opens the help"
        );
        page.press(&field("bus.slots"), &format!("{ESCAPE}")).await?;
        page.until(&format!("!{OPEN}")).await?;
        // Every view's heading explains what stands in it.
        for (view, says) in
            [("motion", "Ideal"), ("pulses", "Digest"), ("packets", "seq"), ("spectrum", "THD")]
        {
            // With the card of the one before still open.
            page.press(&format!("#title-{view} .term"), &format!("{ENTER}")).await?;
            page.until(OPEN).await?;
            let said = page.text("#term-card").await?;
            ensure!(said.contains(says), "{view}: {said}");
        }
        // A second click on the same word closes it.
        page.click("#title-spectrum .term").await?;
        page.until(&format!("!{OPEN}")).await?;
        Ok(())
    })
}

#[test]
fn the_help_lists_every_key_and_the_help_page_every_term_and_document() -> Result<()> {
    in_sources(|page| async move {
        page.open("").await?;
        for (at, key) in [("#charts", F1), ("#pulses", '?')] {
            page.press(at, &key.to_string()).await?;
            page.until("document.getElementById('keys').open").await?;
            let unsaid: Vec<String> = page
                .eval(
                    "import('./shell/commands.js').then(({ listed }) => listed().flatMap(({ commands }) => commands)\
                     .filter(({ text }) => ![...document.querySelectorAll('#keys dd')].some((dd) => dd.textContent === text))\
                     .map(({ text }) => text))",
                )
                .await?;
            assert_eq!(unsaid, [""; 0]);
            page.click("#keys-close").await?;
            page.until("!document.getElementById('keys').open").await?;
        }
        let names: Vec<String> = page
            .eval(
                "Promise.all([import('./form/schema.js'), import('./help/term_texts.js'), import('./help/explained.js')])
                 .then(([{ terms, setExplanations }, { TERMS, DERIVED }, { EXPLAINED }]) => { setExplanations(EXPLAINED);
                 return [terms(), DERIVED, ...Object.values(TERMS)].flatMap(Object.values).map(({ name }) => name); })",
            )
            .await?;
        ensure!(names.len() > 80, "{} terms", names.len());
        page.load("help.html").await?;
        page.until("document.querySelectorAll('#terms dt').length > 0").await?;
        let said: String = page.eval("document.body.textContent").await?;
        for name in names {
            ensure!(said.contains(&name), "the help page has no {name}");
        }
        let documents: u32 = page.eval("document.querySelectorAll('#documents li').length").await?;
        ensure!(documents >= 5, "{documents} documents");
        // The same figure as the core's, grouped as people write it.
        let budget = grouped(BUDGET_RECORDS as f64).replace('\u{202f}', " ");
        ensure!(
            said.contains(&format!("more than {budget} edges")),
            "the help page does not say {budget} edges"
        );
        page.picture("help").await
    })
}

#[test]
fn what_went_wrong_on_purpose_is_told_and_mended_in_one_step() -> Result<()> {
    let mended: [(&str, &str, Mend); 2] = [
        ("driver-timing-broken", "STEP high", |scenario| {
            scenario.bus.pulse_width_cycles = 31;
            scenario.bus.dir_setup_cycles = 11;
        }),
        ("raw-noisy-line", "no check", |scenario| {
            scenario.line.protocol = stepscope_core::peripheral::config::Protocol::Framed;
        }),
    ];
    in_browser(move |page| async move {
        page.open("").await?;
        ensure!(!page.visible("#remedy").await?, "a remedy for what is not broken");
        for (id, says, mend) in mended {
            let preset = PRESETS.iter().find(|preset| preset.id == id).context("the preset is there")?;
            let broken = Known::preset(preset)?;
            let mut scenario = preset.scenario();
            mend(&mut scenario);
            page.preset(id).await?;
            page.until_digest(&broken.digest).await?;
            let said = page.text("#remedy").await?;
            ensure!(said.contains(says), "{id}: {said}");
            page.click("#remedy button").await?;
            page.until_digest(&Known::of(&scenario.to_json())?.digest).await.context(id)?;
            ensure!(!page.visible("#remedy").await?, "{id} is not mended");
            page.click("#undo").await?;
            page.until_digest(&broken.digest).await?;
            ensure!(page.visible("#remedy").await?, "{id} is broken again, and nothing is said");
        }
        Ok(())
    })
}

#[test]
fn an_axis_is_copied_to_all_others_in_one_step() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.preset("framed-link").await?;
        page.ready().await?;
        let before = page.form().await?;
        let preset = PRESETS.iter().find(|preset| preset.id == "framed-link").context("it is there")?;
        let mut scenario = preset.scenario();
        if let Source::Motion(motion) = &mut scenario.source {
            motion.axes = vec![motion.axes[1].clone(); motion.axes.len()];
        }
        page.click("[aria-label=\"Copy to all: axis 1\"]").await?;
        page.until_digest(&Known::of(&scenario.to_json())?.digest).await?;
        page.click("#undo").await?;
        page.until_digest(&Known::preset(preset)?.digest).await?;
        assert_eq!(page.form().await?, before);
        Ok(())
    })
}

/// What keys do in two fields in turn, a number each, digit by digit.
const TYPE_IN_TURN: &str = "
    const [paths, first, last] = arguments;
    for (let value = first; value <= last; value += 1) {
        const field = document.querySelector(`[data-path='${paths[value % 2]}']`);
        field.focus();
        for (let digits = 1; digits <= String(value).length; digits += 1) {
            field.value = String(value).slice(0, digits);
            field.dispatchEvent(new InputEvent('input', { bubbles: true }));
        }
        field.dispatchEvent(new Event('change', { bubbles: true }));
    }
    return null;";

#[test]
fn fifty_changes_can_be_undone_and_a_typed_number_is_one_of_them() -> Result<()> {
    const FIELDS: [&str; 2] = ["bus.slots", "bus.queue_depth"];
    in_browser(|page| async move {
        page.open("").await?;
        // Two digits each; a change of the other field ends the one before. The last ones by keys.
        page.js::<()>(TYPE_IN_TURN, vec![json!(FIELDS), json!(41), json!(90)]).await?;
        for value in 91..=95 {
            page.fill(FIELDS[value % 2], &value.to_string()).await?;
        }
        let undone: u32 = page
            .eval(
                "(() => { const undo = document.getElementById('undo'); let steps = 0; \
                 while (!undo.disabled && steps < 99) { undo.click(); steps += 1; } return steps; })()",
            )
            .await?;
        assert_eq!(undone, 50);
        // The fifty last are gone: 46 to 95.
        assert_eq!(page.field(FIELDS[1]).await?.value, "45");
        assert_eq!(page.field(FIELDS[0]).await?.value, "44");
        Ok(())
    })
}

#[test]
fn times_of_segments_keep_every_digit() -> Result<()> {
    const LIST: &str = "source.segments.channels[0].segments";
    // 2^53 + 1 is no number of JavaScript.
    const TYPED: &str = "2 9007199254740993 0 right";
    let json = r#"{"source":{"segments":{"channels":[{"segments":[{"steps":{"count":2,"interval_q16":9007199254740993}}]}]}}}"#;
    in_browser(move |page| async move {
        let known = Known::of(json)?;
        page.open("").await?;
        page.choose(&field("source#kind"), "segments").await?;
        page.ready().await?;
        page.fill(LIST, TYPED).await?;
        page.until_digest(&known.digest).await?;
        // Kept on this device, and read again.
        page.open("").await?;
        page.until_digest(&known.digest).await?;
        assert_eq!(page.field(LIST).await?.value, TYPED);
        page.fill(LIST, "dwell 99999999999999999999").await?;
        page.ready().await?;
        let shown = page.field(LIST).await?;
        ensure!(shown.invalid && shown.error.contains("18446744073709551615"), "{shown:?}");
        Ok(())
    })
}

#[test]
fn where_segments_run_alone_the_form_asks_for_nothing_of_the_line() -> Result<()> {
    let has = async |page: &Session, path: &str| {
        page.eval::<bool>(&format!("document.querySelector('{}') !== null", field(path))).await
    };
    in_browser(move |page| async move {
        page.open("").await?;
        for (path, there) in [("line.baud", true), ("bus.slots", true), ("bus.pulse_width_cycles", true)] {
            assert_eq!(has(&page, path).await?, there, "{path}");
        }
        page.choose(&field("source.motion.engine"), "segments").await?;
        page.ready().await?;
        for (path, there) in [("line.baud", false), ("bus.slots", false), ("bus.pulse_width_cycles", true)] {
            assert_eq!(has(&page, path).await?, there, "{path}");
        }
        assert_eq!(page.derived("On the line").await?, "nothing");
        Ok(())
    })
}

#[test]
fn hex_that_is_no_bytes_is_told_with_its_place_and_the_remedy() -> Result<()> {
    const PACKETS: &str = "source.packets.packets";
    in_browser(|page| async move {
        page.open("").await?;
        page.choose(&field("source#kind"), "packets").await?;
        page.ready().await?;
        page.fill(PACKETS, "8a\n8g").await?;
        page.ready().await?;
        let shown = page.field(PACKETS).await?;
        let wanted = problems(r#"{"source":{"packets":{"packets":["8a","8g"]}}}"#)[0].cause.to_string();
        ensure!(wanted.contains("\u{201c}g\u{201d} in byte 1"), "{wanted}");
        ensure!(shown.invalid && shown.error.contains(&format!("Line 2: {wanted}")), "{shown:?}");
        Ok(())
    })
}

/// Inner size of an element in CSS pixels.
async fn size(page: &Session, css: &str) -> Result<(f64, f64)> {
    let script = "const { width, height } = document.querySelector(arguments[0]).getBoundingClientRect(); return [width, height];";
    page.js(script, vec![json!(css)]).await
}

#[test]
fn panes_are_resized_folded_and_maximised_by_keys_and_stay_so() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.unfold_spectrum().await?;
        let now = async |id: &str| {
            page.eval::<String>(&format!("document.getElementById('{id}').ariaValueNow")).await
        };
        for (edge, pane, across) in [
            ("edge-form", "#sheet", true),
            ("edge-motion", "#view-motion", false),
            ("edge-pulses", "#view-pulses", false),
            ("edge-packets", "#view-packets", true),
        ] {
            let of =
                async || size(&page, pane).await.map(|(width, height)| if across { width } else { height });
            let (before, value) = (of().await?, now(edge).await?);
            page.press(&format!("#{edge}"), &format!("{SHIFT}{RIGHT}")).await?;
            let after = page
                .eventually(&format!("{edge} moves"), async || {
                    let after = of().await?;
                    Ok((after > before + 20.0).then_some(after))
                })
                .await?;
            ensure!(after < before + 120.0, "{edge}: {before} px became {after} px");
            ensure!(now(edge).await? != value, "{edge} says {value} as before");
        }
        let wide = size(&page, "#sheet").await?.0;
        page.click("#view-packets .fold").await?;
        page.until("!document.getElementById('packets').checkVisibility()").await?;
        page.open("").await?;
        ensure!((size(&page, "#sheet").await?.0 - wide).abs() < 2.0, "the form's width is not kept");
        ensure!(!page.visible("#packets").await?, "the folded view is not kept");
        ensure!(page.visible("#title-packets").await?, "nothing is left of the folded view");
        page.click("#view-packets .fold").await?;
        page.until("document.getElementById('packets').checkVisibility()").await?;

        page.press("#edge-form", &format!("{ENTER}")).await?;
        page.until("!document.getElementById('sheet').checkVisibility()").await?;
        page.press("#edge-form", &format!("{ENTER}")).await?;
        page.until("document.getElementById('sheet').checkVisibility()").await?;

        let small = size(&page, "#view-pulses").await?.1;
        page.press("#pulses", "f").await?;
        page.until("!document.getElementById('view-motion').checkVisibility()").await?;
        ensure!(size(&page, "#view-pulses").await?.1 > 2.0 * small, "the view does not take the place");
        page.pulses().await?;
        page.press("#pulses", "f").await?;
        page.until("document.getElementById('view-motion').checkVisibility()").await?;
        // In a field a letter is a letter.
        page.press("#window-start", "f").await?;
        ensure!(page.visible("#view-motion").await?);
        Ok(())
    })
}
