//! The study: its tabs, opening and closing it, and its numbers compared with the core.

use anyhow::{Context, Result, anyhow, ensure};
use serde_json::{Value, json};
use stepscope_core::{
    inspect::{
        export::{
            source_code::{self as export, Language, NamedTable, Origin, Source, WALKER, WALKER_FILE},
            step_tables::scheduled,
        },
        motion::{
            comparison::{Request, compare},
            sine_optimum::{Freedom, optimum},
            sine_polyline::{Distinct, Row, best, sweep},
        },
    },
    motion::{
        motor::Motor,
        step_tables::{EntryFormat, Form, Stored, Tolerance, stored, stored_steps},
    },
    peripheral::{segment::PulseTimes, trace::steps, units::Cycles},
    scenario::{Scenario, link::decode},
    sim::Experiment,
};

use crate::{bench::in_browser, exports::KEEP, native::Known, session::Session};

/// A sine whose d1 can be changed, with a title.
const SINE: &str = r#"{"title":"A sine","analysis":{"order":399},"source":{"motion":{"axes":[{"moves":[
    {"sine_segments":{"amplitude":{"steps":800},"period_s":0.5,"periods":2,"max_deviation":0.0054}}]}]}}}"#;
const D1: &str = "source.motion.axes[0].moves[0].sine_segments.max_deviation";
/// F2, in the notation of WebDriver.
const F2: char = '\u{e032}';
const ESCAPE: char = '\u{e00c}';
const ENTER: char = '\u{e007}';
const RIGHT: char = '\u{e014}';
const LEFT: char = '\u{e012}';
const HOME: char = '\u{e011}';
const END: char = '\u{e010}';

/// Texts of a row's cells, without digit grouping, by the start of its header.
async fn cells(page: &Session, table: &str, head: &str) -> Result<Vec<String>> {
    let script = "const row = [...document.querySelectorAll(`table[aria-label='${arguments[0]}'] tbody tr`)].find((row) => row.innerText.replace(/\\s+/g, ' ').trim().startsWith(arguments[1]));
        return row ? [...row.cells].map((cell) => cell.textContent.replace(/\\u202f/g, '').replace(/\\u00a0/g, ' ')) : [];";
    page.js(script, vec![json!(table), json!(head)]).await
}

/// A number with its unit, converted to the unit without a prefix.
fn value(text: &str) -> Result<f64> {
    let (number, unit) = text.split_once(' ').unwrap_or((text, ""));
    let scale = match unit {
        "" | "s" => 1.0,
        "ms" => 1e-3,
        "µs" => 1e-6,
        "ns" => 1e-9,
        "%" => 0.01,
        other => return Err(anyhow!("{other} is no unit of the study")),
    };
    Ok(number.parse::<f64>().with_context(|| text.to_owned())? * scale)
}

/// Compares a text of four digits with a number.
fn close(text: &str, wanted: f64) -> Result<()> {
    let found = value(text)?;
    ensure!((found - wanted).abs() <= 6e-4 * wanted.abs(), "{text} is not {wanted}");
    Ok(())
}

async fn fill(page: &Session, label: &str, text: &str) -> Result<()> {
    let id: String = page
        .js(
            "return [...document.querySelectorAll('.study-field label')].find((label) => label.textContent.startsWith(arguments[0])).htmlFor;",
            vec![json!(label)],
        )
        .await?;
    page.eval::<Value>(&format!("document.getElementById('{id}').select() ?? null")).await?;
    page.press(&format!("#{id}"), &format!("{text}{ENTER}")).await
}

#[test]
fn the_study_opens_and_closes_by_button_key_and_link() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of("{}")?;
        // The study of a sine opens its own tab; Compare has nothing for it.
        page.open(&format!("#{}", Known::of(SINE)?.link)).await?;
        page.click("#study").await?;
        page.until("document.activeElement.id === 'study-tab-sine'").await?;
        page.open(&format!("#{}", known.link)).await?;
        ensure!(!page.visible("#view-study").await?, "the views come first");
        page.click("#study").await?;
        page.until("document.activeElement.id === 'study-tab-compare'").await?;
        ensure!(page.visible("#view-study").await? && !page.visible("#view-motion").await?);
        ensure!(page.visible("#fields").await?, "the form stays next to it");
        page.press("#study-tab-compare", &LEFT.to_string()).await?;
        page.until_equal("document.activeElement.id", &json!("study-tab-motor")).await?;
        page.press("#study-tab-motor", &format!("{LEFT}")).await?;
        page.until_equal("document.activeElement.id", &json!("study-tab-torque")).await?;
        page.press("#study-tab-torque", &HOME.to_string()).await?;
        page.until_equal("document.activeElement.id", &json!("study-tab-compare")).await?;
        page.press("#study-tab-compare", &END.to_string()).await?;
        page.until_equal("document.activeElement.id", &json!("study-tab-motor")).await?;
        page.press("#study-tab-motor", &LEFT.to_string()).await?;
        page.until_equal("document.activeElement.id", &json!("study-tab-torque")).await?;
        page.press("#study-tab-torque", &LEFT.to_string()).await?;
        page.until_equal("document.activeElement.id", &json!("study-tab-sine")).await?;
        ensure!(page.visible("#study-sine").await? && !page.visible("#study-torque").await?);
        page.until_equal("location.hash", &json!(format!("#{}&v=tstudy.ysine", known.link))).await?;
        page.press("#study-tab-sine", &ESCAPE.to_string()).await?;
        page.until("document.activeElement.id === 'study'").await?;
        ensure!(!page.visible("#view-study").await? && page.visible("#view-motion").await?);
        page.canvas("chart-position").await?.has_curve("--ideal")?;
        page.press("#charts", &F2.to_string()).await?;
        page.until("document.activeElement.id === 'study-tab-sine'").await?;
        page.click("#study-close").await?;
        ensure!(page.visible("#view-motion").await?);

        page.open(&format!("#{}&v=tstudy.ytables", known.link)).await?;
        ensure!(page.visible("#study-tables").await? && !page.visible("#view-motion").await?);
        page.open(&format!("#{}&v=tstudy.ynothing", known.link)).await?;
        ensure!(page.visible("#study-compare").await?, "an unknown tab is ignored");
        Ok(())
    })
}

#[test]
fn the_sweep_matches_the_core_and_a_d1_can_be_applied_and_undone() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(SINE)?;
        page.open(&format!("#{}&v=tstudy.ysine", known.link)).await?;
        for (label, text) in [("d1 from", "0.004"), ("to", "0.012"), ("harmonics to", "99"), ("points", "33")]
        {
            fill(&page, label, text).await?;
        }
        page.until("document.getElementById('sine-charts')?.ariaValueMax === '32'").await?;
        let rows: Vec<Row> = sweep(0.004, 0.012, 33, 99).collect();
        page.press("#sine-charts", &format!("{RIGHT}{RIGHT}{RIGHT}{LEFT}")).await?;
        let pointed = cells(&page, "Results by d1", "selected").await?;
        let same = |cells: &[String], row: &Row| -> Result<()> {
            ensure!(cells.len() > 7, "{cells:?}");
            ensure!(cells[2] == row.segments.to_string(), "{cells:?} are not {row:?}");
            let Row { d1, distortion, euclidean, .. } = row;
            let wanted = [*d1, distortion.position, distortion.speed, distortion.acceleration, *euclidean];
            [1, 3, 4, 5, 7].into_iter().zip(wanted).try_for_each(|(at, wanted)| close(&cells[at], wanted))
        };
        same(&pointed, &rows[1])?;
        same(&cells(&page, "Results by d1", "current").await?, &Row::of(0.0054, 99))?;
        // All polylines of the range, not only those of the sweep.
        page.until("document.querySelectorAll('table[aria-label=\"Best d1 of each number of segments\"] tbody tr').length > 1").await?;
        let six =
            best(Distinct::new(0.004, 0.012, 99).filter(|row| row.segments == 6)).context("none of six")?;
        let shown = cells(&page, "Best d1 of each number of segments", "6").await?;
        ensure!(shown.len() > 2, "{shown:?}");
        close(&shown[1], six.d1)?;
        close(&shown[2], six.distortion.position)?;
        for freedom in [Freedom::OnCurve, Freedom::Free] {
            let percent = 100.0 * optimum(6, freedom, 99).context("none of six")?.distortion.position;
            let start = percent.to_string()[..5].to_owned();
            page.until(&format!("document.getElementById('sine-vertices').textContent.includes('{start}')"))
                .await?;
        }

        page.press("#sine-charts", &ENTER.to_string()).await?;
        page.until(&format!("document.querySelector('[data-path=\"{D1}\"]').value === '0.00425'")).await?;
        page.ready().await?;
        page.until_equal(
            "document.getElementById('digest').textContent",
            &json!(Known::of(&SINE.replace("0.0054", "0.00425").replace("399", "99"))?.digest),
        )
        .await?;
        page.until("[...document.querySelectorAll('#study-sine tr')].some((row) => row.innerText.includes('current') && row.cells[1].textContent === '0.00425')").await?;
        same(&cells(&page, "Results by d1", "current").await?, &rows[1])?;
        page.click("#undo").await?;
        page.until_digest(&known.digest).await?;
        // By the pointer: the last one is at the right end of the plot.
        page.js::<Value>(
            "const box = document.getElementById('sine-charts').getBoundingClientRect();
             document.getElementById('sine-charts').dispatchEvent(new MouseEvent('click', { clientX: box.right - 27, clientY: box.top + 60 })); return null;",
            vec![],
        )
        .await?;
        page.until(&format!("document.querySelector('[data-path=\"{D1}\"]').value === '0.012'")).await
    })
}

/// The visible scenario, as the core reads it.
async fn shown(page: &Session) -> Result<Scenario> {
    let link: String = page.eval("location.hash.slice(1).split('&')[0]").await?;
    decode(&link).map_err(|error| anyhow!("{error}"))
}

#[test]
fn the_best_vertices_become_points_with_their_distortion() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(&SINE.replace("\"steps\":800", "\"steps\":2000"))?;
        page.open(&format!("#{}&v=tstudy.ysine", known.link)).await?;
        // Those of the scenario's order, not of the previous one.
        let best = optimum(6, Freedom::Free, 399).context("none of six")?;
        let start = (100.0 * best.distortion.position).to_string()[..5].to_owned();
        page.until(&format!("document.getElementById('sine-vertices').textContent.includes('{start}')"))
            .await?;
        // Another order's distortion may start with the same digits; its vertices differ.
        let angle = format!("{:.3}\u{b0}", best.vertices[1].angle.to_degrees());
        page.until(&format!(
            "document.querySelector(\"table[aria-label='Best vertices'] tbody tr:nth-child(2) :nth-child(4)\").textContent === '{angle}'"
        ))
        .await?;
        page.click("[aria-label='Use: 6 segments, vertices free']").await?;
        page.until("document.getElementById('sine-note').textContent.includes('Undo restores the sine')")
            .await?;
        page.until("document.querySelector('[data-path=\"source.motion.axes[0].moves[0]#kind\"]').value === 'points'").await?;
        page.ready().await?;
        page.until(&format!("document.getElementById('digest').textContent !== '{}'", known.digest)).await?;
        // The address follows a moment later.
        page.until(&format!("!location.hash.startsWith('#{}')", known.link)).await?;
        let scenario = shown(&page).await?;
        let experiment = Experiment::new(&scenario).map_err(|problems| anyhow!("{problems:?}"))?;
        let plan = &experiment.plans()[0];
        assert_eq!(
            (plan.steps(), plan.duration_s()),
            (0, 1.0),
            "it ends where it begins, after both periods"
        );
        // Vertex by vertex, over a quarter that starts at the extreme.
        for vertex in &best.vertices {
            let t = 0.5 * vertex.angle.to_degrees() / 360.0;
            let wanted = 2000.0 * (vertex.height - best.vertices[0].height);
            let found = plan.position(t);
            ensure!((found - wanted).abs() < 1e-3, "at {t} s {found} is not {wanted}");
        }
        page.click("#undo").await?;
        page.until_digest(&known.digest).await
    })
}

#[test]
fn an_axis_without_a_sine_is_offered_one() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.click("#study").await?;
        page.click("#study-tab-sine").await?;
        page.until("document.getElementById('sine-charts')?.ariaValueMax === '499'").await?;
        page.press("#sine-charts", &format!("{RIGHT}{ENTER}")).await?;
        page.until("document.querySelector('#study-sine .study-note button')?.textContent === 'Add one with d1 = 0.002'").await?;
        page.click("#study-sine .study-note button").await?;
        page.until("document.querySelector('[data-path=\"source.motion.axes[0].moves[1].sine_segments.max_deviation\"]')?.value === '0.002'").await?;
        page.ready().await?;
        // The button is removed; its message has the focus until an undo makes it wrong.
        ensure!(page.eval::<bool>("document.activeElement.id === 'sine-note'").await?);
        ensure!(page.text("#sine-note").await?.starts_with("Axis 0 now ends with a sine"));
        page.until("document.querySelector(\"[aria-label='Use: 6 segments, best d1']\")").await?;
        page.press("[aria-label='Use: 6 segments, best d1']", &ENTER.to_string()).await?;
        page.until(
            "document.getElementById('sine-note').textContent.startsWith('Move 2 of axis 0 now has d1 = ')",
        )
        .await?;
        page.ready().await?;
        ensure!(page.eval::<bool>("document.activeElement.ariaLabel === 'Use: 6 segments, best d1'").await?);
        page.click("#undo").await?;
        page.until("document.getElementById('sine-note').textContent === ''").await
    })
}

#[test]
fn a_long_sweep_shows_its_progress_and_can_be_canceled() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.click("#study").await?;
        page.click("#study-tab-sine").await?;
        page.until("document.getElementById('sine-charts')?.ariaValueMax === '499'").await?;
        page.until("document.querySelector('#study-sine .study-job').hidden").await?;
        fill(&page, "harmonics to", "1000").await?;
        page.until("document.getElementById('sine-charts').textContent.includes('harmonics 2 to 1000')")
            .await?;
        page.until("document.querySelector('#study-sine .study-job').hidden").await?;
        fill(&page, "points", "20000").await?;
        page.until(
            "/^[1-9]\\d* of 20000 points/.test(document.querySelector('#study-sine .study-job').innerText)",
        )
        .await?;
        page.until("document.querySelector('#study-sine .study-job button').offsetWidth > 0").await?;
        // By its key: the button may move while the numbers next to it grow.
        page.press("#study-sine .study-job button", &ENTER.to_string()).await?;
        page.until("document.querySelector('#study-sine .study-job').innerText.startsWith('Canceled: ')")
            .await?;
        // The previous sweep is still there: it can be selected, and its best row applied.
        page.press("#sine-charts", &RIGHT.to_string()).await?;
        for head in ["selected", "best by position"] {
            let row = cells(&page, "Results by d1", head).await?;
            ensure!(row.len() == 9 && row[1].starts_with("0.0") && row[8] == "Use", "{row:?}");
        }
        // Nothing continues in the background, and the next sweep is complete.
        fill(&page, "harmonics to", "9").await?;
        fill(&page, "points", "12").await?;
        page.until("document.getElementById('sine-charts')?.ariaValueMax === '11'").await?;
        page.until("document.querySelector('#study-sine .study-job').hidden").await
    })
}

/// A table computed natively with the page's options.
fn native(known: &Known, form: &str, format: EntryFormat, error_us: u64) -> Result<Stored> {
    let config = known.experiment.config();
    let form = match form {
        "exact" => Form::Exact,
        "document" => Form::Document,
        _ => Form::Quick(Tolerance::of(Cycles(error_us * u64::from(config.clock_hz()) / 1_000_000))),
    };
    let pulse = PulseTimes::from(config);
    let stored = match known.experiment.plans().first() {
        Some(plan) => stored(plan, form, format, pulse, config.clock_hz()),
        None => stored_steps(&scheduled(&steps(&known.recording.trace, 0)), form, format, pulse),
    };
    stored.map_err(|cause| anyhow!("{cause}"))
}

async fn tables_are_the_cores(page: &Session, known: &Known, error_us: u64) -> Result<()> {
    for (name, form) in
        [("Exact list", "exact"), ("Table of the paper", "document"), ("Compressed", "compressed")]
    {
        for format in EntryFormat::ALL {
            let entry = match format.name {
                "q16" => "20 bytes, 1/65536 cycle",
                "q8" => "8 bytes, 1/256 cycle",
                _ => "8 bytes, whole cycles",
            };
            let shown = cells(page, "Stored forms", &format!("{name} {entry}")).await?;
            let Ok(table) = native(known, form, format, error_us) else {
                let why = cells(page, "Stored forms", name).await?;
                ensure!(why.len() == 3 && why[2].len() > 20, "{why:?}");
                continue;
            };
            ensure!(shown.len() == 8, "{name} {}: {shown:?}", format.name);
            let (entries, bytes) = (table.entries.len(), table.bytes());
            ensure!(shown[2] == entries.to_string(), "{shown:?}");
            let own = table.document_bytes.filter(|_| form == "document");
            ensure!(shown[3] == own.map_or(bytes.to_string(), |own| format!("{bytes} ({own})")), "{shown:?}");
            close(&shown[4], table.error.steps as f64 / entries as f64)?;
            close(&shown[5], known.seconds(table.error.max_cycles))?;
            close(&shown[6], table.error.rms() / f64::from(known.experiment.config().clock_hz()))?;
            ensure!(shown[7] == format!("{}, exact", table.error.steps), "{shown:?}");
        }
    }
    Ok(())
}

async fn same_file(page: &Session, language: &str, name: &str, expected: &str) -> Result<()> {
    page.click(&format!("#study-tables [data-language={language}]")).await?;
    page.until(&format!("window.saved['{name}']")).await?;
    let found: String = page.js("return window.saved[arguments[0]].text();", vec![json!(name)]).await?;
    ensure!(found == expected, "{name} has other bytes: {found}");
    Ok(())
}

#[test]
fn numbers_and_files_of_tables_match_the_core() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(SINE)?;
        page.before_scripts(KEEP).await?;
        page.open(&format!("#{}&v=tstudy.ytables", known.link)).await?;
        let made = "document.querySelectorAll('table[aria-label=\"Stored forms\"] tbody tr').length > 5 && document.querySelector('#study-tables .study-job').hidden";
        page.until(made).await?;
        tables_are_the_cores(&page, &known, 25).await?;
        let coarse = native(&known, "compressed", EntryFormat::Q16, 100)?.entries.len();
        fill(&page, "Maximum error", "100 us").await?;
        page.until(&format!(
            "[...document.querySelectorAll('#study-tables tr')].some((row) => row.innerText.includes('Compressed') && row.cells[2].textContent === '{coarse}')"
        ))
        .await?;
        tables_are_the_cores(&page, &known, 100).await?;

        page.click("input[value='document-q8']").await?;
        let table = native(&known, "document", EntryFormat::Q8, 100)?;
        for (language, ending) in
            [(Language::C, ".h"), (Language::Avr, "-avr.h"), (Language::Rust, ".rs"), (Language::Csv, ".csv")]
        {
            let mut text = String::new();
            let request = export::Request {
                scenario: Some(b"a-sine.json"),
                steps: None,
                axis: None,
                form: "document",
                error_us: 100.0,
                interval_part: None,
                is_early: false,
                is_quick: true,
                entries: "q8",
                language: language.name(),
                name: "axis_0",
            };
            let scenario = decode(&known.link).map_err(|error| anyhow!("{error}"))?;
            let origin = Origin::new(&request, &scenario, None);
            let tables = [NamedTable { name: "axis_0".into(), table: &table }];
            let clock_hz = known.experiment.config().clock_hz();
            Source { name: "axis_0", tables: &tables, clock_hz, origin: &origin }
                .write(language, &mut text)?;
            let name = format!("a-sine-axis-0-document-q8{ending}");
            same_file(&page, language.name(), &name, &text).await?;
        }
        same_file(&page, "walker", WALKER_FILE, WALKER).await?;
        // The export panel has the selected table, too, and states that it is not exact.
        page.click("#export").await?;
        page.until("document.querySelector('#export-list [data-file]') !== null").await?;
        page.until("document.querySelector('[data-file=\"a-sine-axis-0-document-q8-avr.h\"]')?.innerText.includes('rounded as in the paper')").await?;

        // A motion without a paper's table explains this; without axes the steps of the run are stored.
        let cosine = Known::of("{}")?;
        page.open(&format!("#{}&v=tstudy.ytables", cosine.link)).await?;
        page.until(made).await?;
        tables_are_the_cores(&page, &cosine, 25).await?;
        let packets = Known::of(r#"{"source":{"packets":{"packets":["8a"]}}}"#)?;
        page.open(&format!("#{}&v=tstudy.ytables", packets.link)).await?;
        page.until(
            "document.querySelector('#study-tables .study-note').textContent.replace(/\\u202f/g, '').startsWith('Channel 0: 10 steps, as shown in the views')",
        )
        .await?;
        page.until(made).await?;
        tables_are_the_cores(&page, &packets, 25).await
    })
}

const MOVE: &str = "source.motion.axes[0].moves[0]";

#[test]
fn the_comparison_matches_the_core_and_a_shape_can_be_applied() -> Result<()> {
    in_browser(|page| async move {
        let given = r#"{"source":{"motion":{"axes":[{"moves":[{"cosine":{"distance":{"steps":6400},"duration_s":0.4,"ramp_s":0.1}}],"motor":{}}]}}}"#;
        let known = Known::of(given)?;
        page.open(&format!("#{}&v=tstudy", known.link)).await?;
        page.until(
            "document.querySelectorAll('table[aria-label=\"Kinds of motion\"] tbody tr').length === 12",
        )
        .await?;
        for row in compare(&Request { motor: Some(Motor::default()), ..Request::new(6400, 0.4, 0.1) }) {
            let name = row.candidate.name();
            let shown = cells(&page, "Kinds of motion", name).await?;
            ensure!(shown.len() == 8, "{shown:?}");
            let cost = row.cost.map_err(|problems| anyhow!("{problems:?}"))?;
            let peaks = cost.peaks;
            // Written to the whole step.
            let whole = |text: &str, wanted: f64| -> Result<()> {
                ensure!((value(text)? - wanted).abs() <= 0.5, "{text} is not {wanted}");
                Ok(())
            };
            let jumps = |text: &str, wanted: f64| -> Result<()> {
                let number =
                    text.strip_prefix("unbounded, jumps by ").and_then(|rest| rest.split(' ').next());
                whole(number.context("no jump")?, wanted).with_context(|| text.to_owned())
            };
            whole(&shown[1], peaks.speed)?;
            if peaks.jump > 0.0 {
                jumps(&shown[2], peaks.jump)?;
                ensure!(shown[3] == "unbounded", "{shown:?}");
            } else {
                whole(&shown[2], peaks.acceleration)?;
                if peaks.acceleration_jump > 0.0 {
                    jumps(&shown[3], peaks.acceleration_jump)?;
                } else {
                    whole(&shown[3], peaks.jerk)?;
                }
            }
            let torque = cost.torque.context("there is a motor")?;
            ensure!(shown[4].starts_with('✕') != torque.is_met, "{shown:?}");
            let least = torque.min_margin.context("a move takes time")?;
            if least.available_mn_m > 0.0 {
                let part = value(shown[4].trim_start_matches("✕ "))?;
                let wanted = least.needed_mn_m.abs() / least.available_mn_m;
                ensure!((part - wanted).abs() <= 6e-3 * wanted, "{shown:?} is not {wanted}");
            } else {
                ensure!(shown[4].ends_with("none left"), "{shown:?}");
            }
            ensure!((shown[5] == "none") == (cost.time_error.abs() < 1e-9), "{shown:?}");
            close(&shown[6], cost.last_step_s)?;
            ensure!((shown[7] == "in use") == (name == "Cosine, exact"), "{shown:?}");
        }
        // They overlap, and each is visible.
        let speeds = page.canvas("compare-speeds").await?;
        for ink in ["--actual", "--ideal", "--enable", "--wire"] {
            ensure!(speeds.ink(ink).columns > 100.0, "{ink} has {} columns", speeds.ink(ink).columns);
        }

        // The largest finite peak uses at least half of the scale; infinite peaks are excluded.
        let reach = "(() => {
            const canvas = document.querySelector(\"canvas[aria-label='Acceleration, Cosine, exact']\");
            const { data, width, height } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
            const colored = (y) => Array.from({ length: width }, (_, x) => 4 * (y * width + x)).some((at) =>
                data[at + 3] > 200 && Math.max(...data.slice(at, at + 3)) - Math.min(...data.slice(at, at + 3)) > 60);
            const rows = Array.from({ length: height }, (_, y) => y).filter(colored);
            return (rows.at(-1) - rows[0]) / height; })()";
        let reach: f64 = page.eval(reach).await?;
        ensure!(reach > 0.3, "the acceleration of a cosine reaches over {reach} of its chart");

        page.click("[aria-label='Use: Bezier']").await?;
        page.until(&format!(
            "document.querySelector('[data-path=\"{MOVE}.ramps.shape\"]')?.value === 'bezier'"
        ))
        .await?;
        let bezier = r#"{"source":{"motion":{"axes":[{"moves":[{"ramps":{"distance":{"steps":6400},"duration_s":0.4,"ramp_s":0.1,"shape":"bezier"}}],"motor":{}}]}}}"#;
        page.until_digest(&Known::of(bezier)?.digest).await?;
        page.until("document.querySelector('#study-compare tr.chosen').innerText.startsWith('Bezier')")
            .await?;
        page.click("#undo").await?;
        page.until_digest(&known.digest).await?;

        // A move of another kind determines steps and time; the ramp is given here.
        let constant = r#"{"source":{"motion":{"axes":[{"moves":[{"constant":{"distance":{"steps":1000},"speed":{"steps_s":2000}}}]}]}}}"#;
        page.open(&format!("#{}&v=tstudy", Known::of(constant)?.link)).await?;
        fill(&page, "Ramp", "50 ms").await?;
        page.until("document.querySelector('[aria-label=\"Use: Straight\"]')").await?;
        let straight = compare(&Request::new(1000, 0.5, 0.05))
            .remove(4)
            .cost
            .map_err(|problems| anyhow!("{problems:?}"))?;
        let peak = format!("{}", straight.peaks.acceleration.round());
        page.until(&format!(
            "[...document.querySelectorAll('#study-compare tr')].some((row) => row.innerText.includes('Straight') && row.cells[2].textContent.replace(/\\s/g, '') === '{peak}')"
        ))
        .await
    })
}

const ROWS: &str = "document.querySelectorAll('#study-compare tbody tr').length";
const USABLE: &str = "document.querySelectorAll('#study-compare tbody button:enabled').length";

#[test]
fn a_shape_is_applied_only_to_the_selected_axis() -> Result<()> {
    in_browser(|page| async move {
        let one = r#"{"moves":[{"cosine":{"distance":{"steps":6400},"duration_s":0.4,"ramp_s":0.1}}]}"#;
        let known = Known::of(&format!(
            r#"{{"bus":{{"channels":2}},"source":{{"motion":{{"axes":[{one},{one}]}}}}}}"#
        ))?;
        page.open(&format!("#{}&v=tstudy", known.link)).await?;
        page.until_equal(ROWS, &json!(12)).await?;
        page.choose("#study-axis", "1").await?;
        page.until(
            "document.querySelector('#study-compare .study-bar').textContent.includes('Axis 1, move 1')",
        )
        .await?;
        page.until_equal(USABLE, &json!(11)).await?;
        page.press("[aria-label='Use: Bezier']", &ENTER.to_string()).await?;
        page.until("document.querySelector('[data-path=\"source.motion.axes[1].moves[0].ramps.shape\"]')?.value === 'bezier'").await?;
        ensure!(
            page.eval::<bool>(
                "!document.querySelector('[data-path=\"source.motion.axes[0].moves[0].ramps.shape\"]')"
            )
            .await?
        );
        // The button is removed: its row has the focus.
        page.until("document.querySelector('#study-compare tr.chosen')?.innerText.startsWith('Bezier')")
            .await?;
        page.until("document.activeElement.matches('#study-compare tr.chosen')").await?;

        // A form with a problem accepts nothing.
        page.fill("source.motion.axes[1].moves[0].ramps.duration_s", "0").await?;
        page.until_equal(USABLE, &json!(0)).await?;
        page.fill("source.motion.axes[1].moves[0].ramps.duration_s", "0.4").await?;
        page.until_equal(USABLE, &json!(11)).await?;
        // A ramp that no shape can have is reported once, at its field.
        fill(&page, "Ramp", "0.5").await?;
        page.until(
            "document.querySelector('#study-compare .study-field .error').textContent.includes('0.5 s')",
        )
        .await?;
        page.until_equal(ROWS, &json!(0)).await?;
        fill(&page, "Ramp", "100 ms").await?;
        page.until_equal(ROWS, &json!(12)).await?;
        // Another source leaves no rows of the previous axis.
        page.choose("[data-path='source#kind']", "packets").await?;
        page.until_equal(ROWS, &json!(0)).await?;
        page.until("document.querySelector('#study-compare .study-field').hidden").await
    })
}

#[test]
fn the_focus_stays_in_the_tab_when_a_button_disappears() -> Result<()> {
    in_browser(|page| async move {
        page.open("").await?;
        page.click("#study").await?;
        page.click("#study-tab-torque").await?;
        page.until("document.querySelector('#study-torque .study-note button')").await?;
        page.press("#study-torque .study-note button", &ENTER.to_string()).await?;
        page.until("document.getElementById('torque-verdict').textContent !== ''").await?;
        ensure!(page.eval::<bool>("document.activeElement.matches('#study-torque .study-note')").await?);
        // Work that ends while its Cancel button has the focus.
        page.click("#study-tab-sine").await?;
        fill(&page, "points", "20000").await?;
        page.until(
            "(() => { const press = document.querySelector('#study-sine .study-job button'); press.focus(); return document.activeElement === press && press.textContent === 'Cancel'; })()",
        )
        .await?;
        page.until("document.querySelector('#study-sine .study-job').hidden").await?;
        page.until_equal("document.activeElement.id", &json!("study-sine")).await
    })
}
