//! Compares charts with `wasm/tests/pictures/*.svg`. `STEPSCOPE_BLESS=1 cargo test -p stepscope-wasm --lib pictures` writes
//! them; check them before committing.

use super::{Axis, Colors, Series, Shape, Spec, svg};
use std::{env, f64::consts::LOG10_2, fs, path::Path};

struct Theme {
    name: &'static str,
    label: &'static str,
    axis: &'static str,
    grid: &'static str,
    ideal: &'static str,
    actual: &'static str,
    baseline: &'static str,
}

const THEMES: [Theme; 2] = [
    Theme {
        name: "light",
        label: "#535d69",
        axis: "#76808c",
        grid: "#e6e9ed",
        ideal: "#d55e00",
        actual: "#0072b2",
        baseline: "#00704f",
    },
    Theme {
        name: "dark",
        label: "#a4afbd",
        axis: "#8590a0",
        grid: "#262c35",
        ideal: "#e69f00",
        actual: "#56b4e9",
        baseline: "#3ad3a5",
    },
];

type Drawing = fn(&Theme) -> Spec;

fn axis(min: f64, max: f64, unit: &str, prefix: bool, label_px: f64) -> Axis {
    Axis { min, max, unit: unit.into(), prefix, label_px, ticks: Vec::new(), labels: String::new() }
}

fn series(color: &str, opacity: f64, width: f64, dash: f64, x: &[f64], shape: Shape) -> Series {
    Series { color: color.into(), opacity, width, dash, x: x.to_vec(), shape }
}

fn chart(theme: &Theme, x: Axis, y: Axis, series: Vec<Series>) -> Spec {
    let colors = Colors { label: theme.label.into(), axis: theme.axis.into(), grid: theme.grid.into() };
    Spec { ratio: 2.0, font: "sans-serif".into(), font_px: 11.0, x, y, colors, series }
}

/// A trapezoid with a staircase, and another one dashed.
fn motion(theme: &Theme) -> Spec {
    let x: Vec<f64> = (0..200).map(|column| (f64::from(column) + 0.5) * 0.002).collect();
    let trapezoid = |ramp_s: f64, top: f64| {
        x.iter().map(|t| (t.min(0.4 - t) / ramp_s).min(1.0) * top).collect::<Vec<f64>>()
    };
    let ideal = trapezoid(0.1, 12_000.0);
    let steps: Vec<f64> = ideal.iter().map(|speed| (speed / 1000.0).round() * 1000.0).collect();
    let rises: Vec<f64> = steps.iter().skip(1).chain(steps.last()).copied().collect();
    let low = steps.iter().zip(&rises).map(|(a, b)| a.min(*b)).collect();
    let high = steps.iter().zip(&rises).map(|(a, b)| a.max(*b)).collect();
    let series = vec![
        series(theme.actual, 0.55, 4.0, 0.0, &x, Shape::Band { min: low, max: high }),
        series(theme.ideal, 1.0, 1.6, 0.0, &x, Shape::Line { y: ideal }),
        series(theme.baseline, 1.0, 1.8, 5.0, &x, Shape::Line { y: trapezoid(0.18, 15_000.0) }),
    ];
    chart(theme, axis(0.0, 0.4, "s", true, 20.0), axis(-1200.0, 16_200.0, "", true, 68.0), series)
}

/// A dense curve with a gap and a spike.
fn band(theme: &Theme) -> Spec {
    let x: Vec<f64> = (0..120).map(f64::from).collect();
    let swing = |column: usize| {
        if column == 60 { f64::NAN } else { 20.0 + ((column * 37) % 50) as f64 }
    };
    let max = (0..120).map(|column| if column == 90 { 400.0 } else { swing(column) }).collect();
    let min = (0..120).map(|column| -swing(column)).collect();
    let series = vec![series(theme.actual, 1.0, 1.6, 0.0, &x, Shape::Band { min, max })];
    chart(theme, axis(0.0, 119.0, "", false, 20.0), axis(-108.0, 432.0, "", true, 68.0), series)
}

/// Two series of stems over frequency, in dB.
fn spectrum(theme: &Theme) -> Spec {
    spectrum_over(theme, axis(0.0, 10.25, "Hz", true, 20.0), |hz| hz)
}

/// The same with logarithmic frequency.
fn spectrum_log(theme: &Theme) -> Spec {
    let ticks = vec![-LOG10_2, 0.0, LOG10_2, 1.0 - LOG10_2, 1.0];
    let labels = "500 mHz\n1 Hz\n2 Hz\n5 Hz\n10 Hz".into();
    let frequency = axis(-0.75, 1.15, "Hz", true, 20.0);
    spectrum_over(theme, Axis { ticks, labels, ..frequency }, log10)
}

/// A logarithm that is bit-identical on every machine.
fn log10(value: f64) -> f64 {
    let (mut mantissa, mut whole) = (value, 0.0);
    while mantissa > 1.0 {
        (mantissa, whole) = (mantissa / 10.0, whole + 1.0);
    }
    let part = (mantissa - 1.0) / (mantissa + 1.0);
    let terms = (0..200).map(|k| 2.0 * (0..=2 * k).fold(1.0, |power, _| power * part) / f64::from(2 * k + 1));
    whole + terms.sum::<f64>() / std::f64::consts::LN_10
}

fn spectrum_over(theme: &Theme, frequency: Axis, place: fn(f64) -> f64) -> Spec {
    let n: Vec<f64> = (1..=40).map(f64::from).collect();
    let x: Vec<f64> = n.iter().map(|n| place(n * 0.25)).collect();
    let level = |odd: f64| {
        let level = |n: &f64| if n % 2.0 == 0.0 { f64::NEG_INFINITY } else { (1.0 - n) * odd };
        n.iter().map(level).collect::<Vec<f64>>()
    };
    let series = vec![
        series(theme.ideal, 1.0, 3.0, 0.0, &x, Shape::Stems { y: level(2.0), shift: -2.0 }),
        series(theme.actual, 1.0, 3.0, 0.0, &x, Shape::Stems { y: level(1.8), shift: 2.0 }),
    ];
    chart(theme, frequency, axis(-120.0, 10.0, "dB", false, 58.0), series)
}

#[test]
fn pictures_are_unchanged() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pictures");
    let drawings: [(&str, Drawing); 4] =
        [("motion", motion), ("band", band), ("spectrum", spectrum), ("spectrum-log", spectrum_log)];
    for theme in &THEMES {
        for (name, make) in drawings {
            let (text, _) = svg((1200, 400), &make(theme)).expect("draws");
            let file = folder.join(format!("{name}-{}.svg", theme.name));
            if env::var_os("STEPSCOPE_BLESS").is_some() {
                fs::create_dir_all(&folder).expect("a folder");
                fs::write(&file, &text).expect("writes");
            }
            let known = fs::read_to_string(&file).unwrap_or_default();
            let differs = known.lines().zip(text.lines()).find(|(known, now)| known != now);
            assert_eq!(differs, None, "{} (STEPSCOPE_BLESS=1 writes it)", file.display());
            assert_eq!(known.lines().count(), text.lines().count(), "{}", file.display());
        }
    }
}
