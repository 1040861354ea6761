//! Typing into the form: results, errors and undo.

use anyhow::{Result, ensure};

use crate::{
    bench::in_browser,
    native::{DISTANCE, Known, problems, with_distance},
    session::{CONTROL, RELEASE, SHIFT, field},
};

const DURATION: &str = "source.motion.axes[0].moves[0].cosine.duration_s";
const RAMP: &str = "source.motion.axes[0].moves[0].cosine.ramp_s";

/// Digits of a printed number, without unit and grouping.
fn digits(text: &str) -> String {
    text.chars().filter(char::is_ascii_digit).collect()
}

#[test]
fn a_typed_distance_is_computed_drawn_and_undone() -> Result<()> {
    in_browser(|page| async move {
        let (before, after) = (Known::of("{}")?, Known::of(&with_distance(1200.0))?);
        page.open("").await?;
        page.until_digest(&before.digest).await?;
        let drawn = page.canvas("chart-position").await?.hash;
        let form = page.form().await?;
        let peak = |known: &Known| format!("{:.0}", known.experiment.plans()[0].peaks().speed);
        assert_eq!(digits(&page.derived("Peak rate").await?), peak(&before));

        page.fill(DISTANCE, "1.2k").await?;
        page.until_digest(&after.digest).await?;
        ensure!(page.canvas("chart-position").await?.hash != drawn, "the position chart is as it was");
        assert_eq!(digits(&page.derived("Peak rate").await?), peak(&after));
        assert_eq!(page.field(DISTANCE).await?.value, "1.2k", "the visitor's own way of writing stays");

        page.click("#undo").await?;
        page.until_digest(&before.digest).await?;
        assert_eq!(page.form().await?, form, "one step back is the whole typing");
        assert_eq!(page.canvas("chart-position").await?.hash, drawn);
        page.click("#redo").await?;
        page.until_digest(&after.digest).await?;
        assert_eq!(page.field(DISTANCE).await?.value, "1200");

        page.press("#charts", &format!("{CONTROL}z{RELEASE}")).await?;
        page.until_digest(&before.digest).await?;
        page.press("#charts", &format!("{CONTROL}{SHIFT}z{RELEASE}")).await?;
        page.until_digest(&after.digest).await
    })
}

#[test]
fn prefixes_units_and_times_are_accepted_as_people_type_them() -> Result<()> {
    let rows = [
        (DISTANCE, "6.4 k", with_distance(6400.0)),
        (DISTANCE, "-180 \u{b0}", with_distance(1.0).replace(r#"{"steps":1}"#, r#"{"deg":-180}"#)),
        (DURATION, "500 ms", with_move(r#""duration_s":0.5"#)),
        (DURATION, "0,6", with_move(r#""duration_s":0.6"#)),
        (RAMP, "50000 us", with_move(r#""ramp_s":0.05"#)),
        ("line.baud", "230.4k", r#"{"line":{"baud":230400}}"#.to_owned()),
        ("bus.pulse_width_cycles", "3 us", r#"{"bus":{"pulse_width_cycles":48}}"#.to_owned()),
        ("clock_hz", "20M", r#"{"clock_hz":20000000}"#.to_owned()),
        ("run_cycles", "20 ms", r#"{"run_cycles":320000}"#.to_owned()),
        ("run_cycles", "320000", r#"{"run_cycles":320000}"#.to_owned()),
    ];
    in_browser(move |page| async move {
        page.open("").await?;
        let default = Known::of("{}")?.digest;
        for (path, typed, json) in rows {
            page.fill(path, typed).await?;
            let known = Known::of(&json)?;
            page.until_digest(&known.digest)
                .await
                .map_err(|error| error.context(format!("{path}: {typed}")))?;
            page.click("#undo").await?;
            page.until_digest(&default).await?;
        }
        Ok(())
    })
}

fn with_move(settings: &str) -> String {
    format!(r#"{{"source":{{"motion":{{"axes":[{{"moves":[{{"cosine":{{{settings}}}}}]}}]}}}}}}"#)
}

#[test]
fn cycle_fields_show_cycles_and_byte_fields_accept_hex() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.fill("bus.pulse_width_cycles", "3 us").await?;
        page.press(&field("bus.slots"), "").await?;
        assert_eq!(page.field("bus.pulse_width_cycles").await?.value, "48");
        page.choose("[data-path='source#kind']", "packets").await?;
        page.fill("source.packets.packets", "0x8A\n0x05").await?;
        page.until_digest(
            &Known::of(r#"{"bus":{"pulse_width_cycles":48},"source":{"packets":{"packets":["8a","05"]}}}"#)?
                .digest,
        )
        .await
    })
}

#[test]
fn an_invalid_value_shows_range_and_remedy_and_the_last_result() -> Result<()> {
    let rows = [
        ("bus.slots", "200", r#"{"bus":{"slots":200}}"#),
        ("bus.slots", "300", r#"{"bus":{"slots":300}}"#),
        ("bus.queue_depth", "0", r#"{"bus":{"queue_depth":0}}"#),
        ("line.baud", "0", r#"{"line":{"baud":0}}"#),
        ("bus.channels", "17", r#"{"bus":{"channels":17}}"#),
        (RAMP, "300 ms", r#"{"source":{"motion":{"axes":[{"moves":[{"cosine":{"ramp_s":0.3}}]}]}}}"#),
    ];
    in_browser(move |page| async move {
        let known = Known::of("{}")?;
        page.open("").await?;
        page.until_digest(&known.digest).await?;
        for (path, typed, json) in rows {
            page.fill(path, typed).await?;
            page.ready().await?;
            let shown = page.field(path).await?;
            ensure!(shown.invalid, "{path} {typed}: aria-invalid is not set");
            for problem in problems(json).iter().filter(|problem| problem.path == path) {
                let message = problem.cause.to_string();
                ensure!(
                    shown.error.contains(&message),
                    "{path} {typed}: `{}`, wanted `{message}`",
                    shown.error
                );
                ensure!(shown.described.contains(&message), "{path} {typed}: not read to whom cannot see");
            }
            ensure!(!shown.error.is_empty(), "{path} {typed}: no message at the field");
            let header = page.shown().await?;
            ensure!(header.digest == known.digest && header.stale, "{path} {typed}: {header:?}");
            ensure!(page.eval::<bool>("document.getElementById('views').classList.contains('dim')").await?);
            let drawn = page.canvas("chart-position").await?;
            drawn.has_curve("--ideal")?;

            page.click("#undo").await?;
            page.until_digest(&known.digest).await?;
            let shown = page.field(path).await?;
            ensure!(!shown.invalid && shown.error.is_empty(), "{path} after undo: {shown:?}");
            ensure!(!page.eval::<bool>("document.getElementById('views').classList.contains('dim')").await?);
        }
        Ok(())
    })
}

#[test]
fn all_problems_are_shown_and_each_disappears_when_fixed() -> Result<()> {
    let wrong = [
        ("bus.slots", "200", "100", "127"),
        ("bus.queue_depth", "0", "16", "255"),
        ("line.baud", "0", "115200", "baud"),
        (RAMP, "soon", "0.2", "not a number"),
    ];
    in_browser(move |page| async move {
        let known = Known::of("{}")?;
        page.open("").await?;
        for (path, bad, ..) in wrong {
            page.fill(path, bad).await?;
        }
        for (index, (mended, _, good, _)) in wrong.iter().enumerate() {
            page.ready().await?;
            for (path, _, _, says) in &wrong[index..] {
                let shown = page.field(path).await?;
                ensure!(
                    shown.invalid && shown.error.contains(says),
                    "{path} with {} problems: {shown:?}",
                    wrong.len() - index
                );
            }
            ensure!(page.visible("#problems").await?, "the list of problems is hidden");
            let listed = page.text("#problems").await?;
            let told = wrong[index..].iter().filter(|(_, _, _, says)| listed.contains(says)).count();
            ensure!(
                told >= wrong.len().min(index + 3) - index,
                "{told} problems are listed with their locations: {listed}"
            );
            page.fill(mended, good).await?;
            let mended = page.find(&field(mended)).await?;
            page.until(&format!(
                "!document.querySelector('#{}').ariaInvalid",
                mended.attr("id").await?.unwrap_or_default()
            ))
            .await?;
        }
        page.until_digest(&known.digest).await?;
        ensure!(!page.visible("#problems").await?, "the list of problems stays");
        Ok(())
    })
}

#[test]
fn segments_are_typed_as_lines_and_errors_name_their_line() -> Result<()> {
    const LIST: &str = "source.segments.channels[0].segments";
    let of = |segments: &str| {
        format!(r#"{{"source":{{"segments":{{"channels":[{{"segments":[{segments}]}}]}}}}}}"#)
    };
    let typed = of(
        r#"{"steps":{"count":3,"add_q16":-65536}},{"dwell":{"length_q16":65536000}},{"steps":{"count":2,"dir":0}}"#,
    );
    let early = of(r#"{"dwell":{}},{"steps":{"interval_q16":1}}"#);
    in_browser(move |page| async move {
        page.open("").await?;
        page.choose(&field("source#kind"), "segments").await?;
        page.ready().await?;
        let example = page.shown().await?.digest;
        page.fill(LIST, "3 1048576000 -65536\ndwell 65536000\n2 1048576000 0 left").await?;
        page.until_digest(&Known::of(&typed)?.digest).await?;
        page.fill(LIST, "dwell 0\n1 1 0 right").await?;
        page.ready().await?;
        let shown = page.field(LIST).await?;
        let wanted = problems(&early)[0].cause.to_string();
        ensure!(shown.invalid && shown.error.contains(&format!("Line 2: {wanted}")), "{shown:?}");
        page.fill(LIST, "dwell 0\nfaster").await?;
        page.ready().await?;
        let shown = page.field(LIST).await?;
        ensure!(shown.invalid && shown.error.contains("Line 2: \u{201c}faster\u{201d}"), "{shown:?}");
        // The draft, and all edits of one field without leaving it.
        for _ in 0..2 {
            page.click("#undo").await?;
        }
        page.until_digest(&example).await?;
        page.click("#undo").await?;
        page.until_digest(&Known::of("{}")?.digest).await
    })
}
