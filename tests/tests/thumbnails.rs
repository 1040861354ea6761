//! Thumbnails of the presets and recordings for the page's gallery, drawn from their runs.
//! `STEPSCOPE_BLESS=1 cargo test -p stepscope-tests --test all thumbnails` writes `web/start/thumbnails.js`.

mod path;
mod runs;

use path::Path;
use runs::Shown;
use std::{env, fmt::Write as _, fs, ops::Range};
use stepscope_core::{
    capture::samples::SAMPLES,
    inspect::{
        motion::{curves, spectra::Spectra},
        packets::packet_table::PacketTable,
        plant::log::{CycleWindow, MOTOR, PlantLog, SUPPLY},
        trace::changes::Changes,
    },
    peripheral::signal::{Levels, Record},
    scenario::{
        Source,
        presets::{CONTROLLER_PLANT_PRESETS, CONTROLLER_PRESETS, PLANT_PRESETS, PRESETS, Preset},
    },
};

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../web/start/thumbnails.js");
/// Size of a thumbnail and its margin, in pixels.
const WIDTH: usize = 120;
const HEIGHT: i32 = 40;
const MARGIN: f64 = 2.0;
/// A column that a curve crosses by less than this has one point, in pixels.
const JUMP: f64 = 6.0;
/// Up to this number of signals, DIR is drawn.
const MAX_ROWS: usize = 5;
/// Characters of a line of the file.
const LINE: usize = 120;
/// Maximum characters of one.
const MAX_LENGTH: usize = 640;
/// Harmonics of a spectrum, and its lowest level in dB.
const HARMONICS: usize = 40;
const LOWEST_DB: f64 = -110.0;
/// Errors of the rotor that are drawn, in full steps; smaller and larger ones are seen in rotor and command.
const ERRORS: Range<f64> = 0.2..4.0;
/// Records of a recording whose pulses are too dense to be drawn as a whole.
const FIRST_RECORDS: usize = 60;

#[test]
fn thumbnails_show_the_runs_of_their_presets() {
    let lists = [PRESETS, PLANT_PRESETS, CONTROLLER_PRESETS, CONTROLLER_PLANT_PRESETS];
    let mut text = String::from(
        "/** Thumbnails of presets and recordings as SVG paths, 120 x 40: written by tests/tests/thumbnails.rs, STEPSCOPE_BLESS=1. */\n\
         /** @type {{[id: string]: string}} */\nexport const THUMBNAILS = {\n",
    );
    let presets = lists.into_iter().flatten().map(|preset| (preset.id, thumbnail(preset)));
    let recordings = SAMPLES.iter().map(|sample| (sample.id, recording(&runs::recorded(sample))));
    for (id, path) in presets.chain(recordings) {
        assert!((10..MAX_LENGTH).contains(&path.len()), "{id}: {} characters: {path}", path.len());
        // In the format of the page's formatter.
        let key = if id.contains('-') { format!("\"{id}\"") } else { id.to_owned() };
        let gap = if key.len() + path.len() + "  : \"\",".len() > LINE { "\n    " } else { " " };
        writeln!(text, "  {key}:{gap}\"{path}\",").expect("a string");
    }
    text.push_str("};\n");
    if env::var_os("STEPSCOPE_BLESS").is_some() {
        fs::write(FILE, &text).expect("the file can be written");
    }
    let found = fs::read_to_string(FILE).expect("the file can be read");
    assert!(found == text, "{FILE} differs (STEPSCOPE_BLESS=1 writes it)");
}

/// What the preset shows when it opens: its tab in its window.
fn thumbnail(preset: &Preset) -> String {
    let shown = Shown::of(preset);
    let mut parts = preset.view.split('.');
    let tab = parts.clone().find_map(|part| part.strip_prefix('t')).expect("a view has a tab");
    let window = parts.find_map(|part| part.split_once('-')).map_or(0..shown.end(), |(start, end)| {
        let cycle = |text: &str| text.parse().expect("a cycle");
        cycle(start)..cycle(end)
    });
    assert!(window.end <= shown.end(), "{}: the window ends after the run", preset.id);
    match tab {
        "motion" | "panel" => motion(&shown, window),
        "motor" => motor(&shown, window),
        "packets" => packets(&shown, window),
        "spectrum" => spectrum(&shown),
        "pulses" | "timing" => pulses(&shown.stored.trace, window),
        _ => panic!("{}: there is no thumbnail of {tab}", preset.id),
    }
}

type Window = Range<u64>;

/// The speed of all axes; of tick packets, which have no curve, their positions.
fn motion(shown: &Shown, window: Window) -> String {
    let (start_s, end_s) = (window.start as f64 / shown.hz(), window.end as f64 / shown.hz());
    let window = curves::Window { start_s, end_s, columns: WIDTH };
    let has_positions = matches!(shown.scenario.source, Source::Packets(_));
    let bands: Vec<curves::Band> = (0..shown.channels())
        .map(|channel| match shown.experiment.plans().get(usize::from(channel)) {
            Some(plan) => curves::ideal(plan, shown.zero_s(), window).speed,
            None => {
                let actual = curves::actual(&shown.pulses(channel), window);
                if has_positions { actual.position } else { actual.speed }
            }
        })
        .collect();
    lines(bands.iter().map(|band| (&band.min[..], &band.max[..])))
}

/// The supply current of tick packets; otherwise the rotor's error, or rotor and command if the error is large.
fn motor(shown: &Shown, window: Window) -> String {
    let log = shown.plant.as_ref().expect("the preset has a plant");
    let value =
        |name| PlantLog::motor_index(0) + MOTOR.iter().position(|each| *each == name).expect("a value");
    let supply = SUPPLY.iter().position(|each| *each == "sensor_a").expect("a value");
    let values = [supply, value("error"), value("rotor"), value("command")];
    let window = CycleWindow { from: window.start, to: window.end, columns: WIDTH / 2 };
    let bands = log.curves(&shown.stored.trace, window, &values);
    let largest =
        bands[1].max.iter().chain(&bands[1].min).fold(0.0, |largest: f64, error| largest.max(error.abs()));
    let drawn = match shown.scenario.source {
        Source::Packets(_) => &bands[..1],
        _ if ERRORS.contains(&largest) => &bands[1..2],
        _ => &bands[2..],
    };
    lines(drawn.iter().map(|band| (&band.min[..], &band.max[..])))
}

/// Curves with one scale, which includes 0.
fn lines<'a>(bands: impl Iterator<Item = (&'a [f64], &'a [f64])> + Clone) -> String {
    let values = bands.clone().flat_map(|(min, max)| min.iter().chain(max)).filter(|value| value.is_finite());
    let (low, high) =
        values.fold((0.0_f64, 0.0_f64), |(low, high), &value| (low.min(value), high.max(value)));
    let room = f64::from(HEIGHT) - 2.0 * MARGIN;
    let y = |value: f64| MARGIN + (high - value) / (high - low).max(f64::MIN_POSITIVE) * room;
    let mut path = Path::default();
    for (min, max) in bands {
        let x = |column: usize| (column as f64 + 0.5) * WIDTH as f64 / min.len() as f64;
        let mut points: Vec<(f64, f64)> = Vec::new();
        for (column, (&min, &max)) in min.iter().zip(max).enumerate().filter(|(_, (min, _))| min.is_finite())
        {
            if (y(min) - y(max)).abs() < JUMP {
                points.push((x(column), y(f64::midpoint(min, max))));
                continue;
            }
            let rises = points.last().is_none_or(|&(_, last)| (last - y(min)).abs() <= (last - y(max)).abs());
            let ends = if rises { [min, max] } else { [max, min] };
            points.extend(ends.map(|value| (x(column), y(value))));
        }
        path.curve(&points);
    }
    path.finish()
}

/// A recording; its first pulses, if it has steps.
fn recording(trace: &[Record]) -> String {
    let has_steps = trace.iter().any(|record| record.levels.step() != 0);
    let last = trace.get(FIRST_RECORDS).filter(|_| has_steps).or(trace.last()).expect("it has records");
    pulses(trace, 0..last.cycle.0 + last.cycle.0 / 50)
}

/// The signals that change: EN, DIR (unless there are many), STEP, RX and TX.
fn pulses(trace: &[Record], window: Window) -> String {
    let mut changes = Changes::default();
    changes.extend(trace);
    let columns = changes.columns(trace, window.start, window.end, WIDTH, 0);
    let ever = |levels: &[u64]| levels.iter().fold(0, |all, levels| all | levels);
    let changing = ever(&columns.high) & ever(&columns.low);
    let mut bits: Vec<u32> = (0..u64::BITS).filter(|bit| changing >> bit & 1 == 1).collect();
    if bits.len() > MAX_ROWS {
        bits.retain(|bit| Levels(1 << bit).dir() == 0);
    }
    let lane = (f64::from(HEIGHT) - MARGIN) / bits.len().max(1) as f64;
    let mut path = Path::default();
    for (row, bit) in bits.into_iter().enumerate() {
        let top = (MARGIN + row as f64 * lane).round() as i32;
        let height = ((lane - lane.min(4.0) / 2.0).round() as i32).max(1);
        let column = |index: usize| {
            let has = |levels: &[u64]| levels.get(index).is_some_and(|levels| levels >> bit & 1 == 1);
            (has(&columns.high), has(&columns.low), has(&columns.last))
        };
        path.levels((0..WIDTH).map(column), top, height);
    }
    path.finish()
}

/// Received bytes above, replies below; those with an error are crossed out, those for others are half as high.
fn packets(shown: &Shown, window: Window) -> String {
    let table = PacketTable::new(&shown.experiment, &shown.run, 0, &shown.stored.packets);
    let x = |cycle: u64| {
        ((cycle.clamp(window.start, window.end) - window.start) as f64 * WIDTH as f64
            / (window.end - window.start) as f64)
            .round() as i32
    };
    let mut path = Path::default();
    for row in (0..table.len()).filter_map(|index| table.row(index)) {
        if row.start_cycle >= window.end || row.line_end_cycle <= window.start {
            continue;
        }
        let top = if row.kind == "reply" { HEIGHT / 2 + 2 } else { 2 };
        let height = if row.mark == "foreign" { 8 } else { 16 };
        let (from, to) = (x(row.start_cycle), x(row.line_end_cycle).max(x(row.start_cycle) + 1));
        path.rectangle(from, top, to - from, height);
        if row.mark == "bad" {
            path.line((from, top), (to, top + height));
            path.line((from, top + height), (to, top));
        }
    }
    path.finish()
}

/// The first harmonics of the pulses' position, in dB of the fundamental.
fn spectrum(shown: &Shown) -> String {
    let axis = shown.scenario.analysis.axis;
    let plan = shown.experiment.plans().get(usize::from(axis));
    let spectra = Spectra::of(&shown.scenario, plan, &shown.pulses(axis));
    let amplitudes = spectra.actual.expect("the preset has a spectrum").position.amplitudes;
    let fundamental = amplitudes.first().copied().expect("a fundamental");
    let mut path = Path::default();
    for (index, amplitude) in amplitudes.iter().take(HARMONICS).enumerate() {
        let db = 20.0 * libm::log10(amplitude / fundamental);
        let height = ((1.0 - db / LOWEST_DB).max(0.0) * (f64::from(HEIGHT) - 2.0 * MARGIN)).round() as i32;
        if height > 0 {
            let x = 2 + (index * (WIDTH - 2) / HARMONICS) as i32;
            path.line((x, HEIGHT - 2), (x, HEIGHT - 2 - height));
        }
    }
    path.finish()
}
