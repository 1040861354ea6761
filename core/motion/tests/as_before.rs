//! Nothing that a motion tells changes unnoticed: of many motions of each kind the curve, the breakpoints, the step times,
//! the ticks and the stored tables have the checksums of `as_before.txt`, to the last bit.
//!
//! The other tests say what is right; this one says what has changed, so that a change of a search or of a guess that was
//! meant to keep every result does, and so that a change of a result is a line in a commit. Where a checksum differs, the
//! texts behind it are written, and two commits' texts can be compared by `diff`. `STEPSCOPE_BLESS=1 cargo test -p
//! stepscope-motion as_before::` writes the checksums anew.

use crc::{CRC_64_XZ, Crc};
use rand_xoshiro::{
    Xoshiro256PlusPlus,
    rand_core::{Rng, SeedableRng},
};
use std::fmt::Write as _;
use std::num::NonZeroU32;
use std::path::Path;
use std::{env, fs};
use stepscope_motion::{
    AxisPlan, Breakpoints, Curve, Profile,
    mechanics::{Acceleration, Direct, Distance, Jerk, Mechanics, Rotary, Screw, Speed, Wheel},
    moves::{
        Axis, Constant, Cosine, CosineMethod, Dwell, Interpolation, JerkLimited, Move, Point, PointUnit,
        Points, RampShape, Ramps, ShortMove, Sine, SineSegments, Staircase, Trapezoid, TrapezoidMethod,
    },
    plan_axis,
    quantise::{AxesPath, EntryFormat, Form, Tolerance, exact_segments, stored_quickly, ticks},
};
use stepscope_peripheral::{segment::PulseTimes, units::Cycles};

const CLOCK_HZ: u32 = 16_000_000;
/// Of the widths and times that a driver asks for.
const PULSE: PulseTimes = PulseTimes { width: Cycles(40), setup: Cycles(40), hold: Cycles(0) };
/// Axes of each kind: some are refused, and what is said of these counts, too.
const AXES: usize = 100;
/// Bytes of a text that is written for a comparison, so that a folder of them stays small.
const MOST_TEXT: usize = 20_000_000;

/// Draws the numbers of moves, the same each time.
struct Draw(Xoshiro256PlusPlus);

impl Draw {
    fn below(&mut self, end: u64) -> u64 {
        self.0.next_u64() % end
    }

    /// A number between two, with few digits, as people give it, or with all.
    fn number(&mut self, from: f64, to: f64) -> f64 {
        let parts = if self.below(2) == 0 { 100 } else { 1 << 40 };
        from + (to - from) * (self.below(parts) as f64 / parts as f64)
    }

    /// A magnitude: each power of ten is as likely.
    fn magnitude(&mut self, from: f64, to: f64) -> f64 {
        let exponent = self.number(libm::log10(from), libm::log10(to));
        let number = libm::exp10(exponent);
        if self.below(2) == 0 { libm::round(number * 1000.0) / 1000.0 } else { number }
    }

    fn of<T: Clone>(&mut self, choices: &[T]) -> T {
        let index = self.below(choices.len() as u64);
        choices[usize::try_from(index).expect("there are few")].clone()
    }

    fn mechanics(&mut self) -> Mechanics {
        let (full_step_deg, microsteps) = (self.of(&[1.8, 0.9, 7.5]), self.of(&[1, 4, 16]));
        match self.below(4) {
            0 => Mechanics::Rotary(Rotary { full_step_deg, microsteps }),
            1 => Mechanics::Wheel(Wheel { full_step_deg, microsteps, radius_mm: self.magnitude(1.0, 100.0) }),
            2 => Mechanics::Screw(Screw { full_step_deg, microsteps, lead_mm: self.of(&[1.0, 5.0, 8.0]) }),
            _ => Mechanics::Direct(Direct { step_mm: self.of(&[0.01, 0.1, 0.003]) }),
        }
    }

    /// Mostly of 1 to 3000 steps, either way; some have a unit that the mechanics may not have.
    fn distance(&mut self) -> Distance {
        let sign = self.of(&[1.0, 1.0, -1.0]);
        let steps = sign * self.magnitude(1.0, 3000.0);
        match self.below(6) {
            0 => Distance::Millimetres(sign * self.magnitude(0.1, 20.0)),
            1 => Distance::Degrees(sign * self.magnitude(1.0, 400.0)),
            2 => Distance::Steps(steps),
            _ => Distance::Steps(libm::round(steps)),
        }
    }

    fn speed(&mut self, from: f64, to: f64) -> Speed {
        match self.below(8) {
            0 => Speed::MillimetresPerSecond(self.magnitude(0.5, 100.0)),
            1 => Speed::TurnsPerMinute(self.magnitude(1.0, 300.0)),
            _ => Speed::StepsPerSecond(libm::round(self.magnitude(from, to))),
        }
    }

    fn acceleration(&mut self) -> Acceleration {
        Acceleration::StepsPerSecond2(libm::round(self.magnitude(1000.0, 1e6)))
    }

    /// Duration and a ramp that is now and then a little too long for it.
    fn times_s(&mut self) -> (f64, f64) {
        let duration_s = self.magnitude(0.02, 2.0);
        (duration_s, duration_s * self.number(0.0, 0.52))
    }

    fn sine(&mut self) -> (Distance, f64, u32) {
        (self.distance(), self.magnitude(0.05, 2.0), self.of(&[1, 2, 5]))
    }

    fn points(&mut self) -> Points {
        let mut at = Point { time_s: 0.0, position: self.of(&[0.0, 0.0, 12.25]) };
        let mut points = vec![at];
        for _ in 0..=self.below(9) {
            at.time_s += self.magnitude(0.01, 0.5);
            at.position += self.of(&[0.0, 1.0, 1.0, -1.0]) * libm::round(self.magnitude(1.0, 500.0));
            points.push(at);
        }
        Points {
            unit: self.of(&[PointUnit::Steps, PointUnit::Steps, PointUnit::Millimetres]),
            interpolation: self.of(&[Interpolation::Smooth, Interpolation::Straight]),
            points,
        }
    }

    fn each(&mut self, kind: &str) -> Move {
        match kind {
            "trapezoid exact" | "trapezoid table" => Move::Trapezoid(Trapezoid {
                distance: self.distance(),
                start_speed: self.speed(100.0, 2000.0),
                top_speed: self.speed(1000.0, 30_000.0),
                acceleration: self.acceleration(),
                method: if kind.ends_with("table") { TrapezoidMethod::Table } else { TrapezoidMethod::Exact },
                timer_hz: self.of(&[1_000_000, 16_000_000, 32_768]),
            }),
            "staircase" => Move::Staircase(Staircase {
                distance: self.distance(),
                top_speed: self.speed(900.0, 20_000.0),
                level: 1 + self.below(5) as u8,
                short_move: self.of(&[ShortMove::Document, ShortMove::Reverse]),
                start_speed: self.speed(200.0, 2000.0),
                ..Staircase::default()
            }),
            "cosine" | "sliced" => {
                let (mut duration_s, mut ramp_s) = self.times_s();
                let slice_s = self.of(&[0.001, 0.005, 0.0003]);
                let mut method = CosineMethod::Exact;
                if kind == "sliced" {
                    method = CosineMethod::Sliced;
                    // Mostly of whole slices, as the document has it.
                    if self.below(6) > 0 {
                        ramp_s = slice_s * libm::round(ramp_s / slice_s);
                        duration_s =
                            2.0 * ramp_s + slice_s * libm::floor((duration_s - 2.0 * ramp_s) / slice_s);
                    }
                }
                Move::Cosine(Cosine { distance: self.distance(), duration_s, ramp_s, method, slice_s })
            }
            "ramps" => {
                let (duration_s, ramp_s) = self.times_s();
                Move::Ramps(Ramps {
                    distance: self.distance(),
                    duration_s,
                    ramp_s,
                    shape: self.of(&[
                        RampShape::Sigmoid,
                        RampShape::Bezier,
                        RampShape::Straight,
                        RampShape::Exponential,
                    ]),
                    sigmoid_range: self.magnitude(0.1, 20.0),
                    time_constants: self.magnitude(0.1, 20.0),
                })
            }
            "sine segments" => {
                let (amplitude, period_s, periods) = self.sine();
                let max_deviation = self.of(&[0.006, 0.0, 0.05, 0.001, 1.0]);
                Move::SineSegments(SineSegments { amplitude, period_s, periods, max_deviation })
            }
            "sine" => {
                let (amplitude, period_s, periods) = self.sine();
                Move::Sine(Sine { amplitude, period_s, periods })
            }
            "jerk-limited" => Move::JerkLimited(JerkLimited {
                distance: self.distance(),
                max_speed: self.speed(500.0, 30_000.0),
                max_acceleration: self.acceleration(),
                max_jerk: Jerk::StepsPerSecond3(libm::round(self.magnitude(1e4, 1e9))),
            }),
            "points" => Move::Points(self.points()),
            "constant" => {
                Move::Constant(Constant { distance: self.distance(), speed: self.speed(10.0, 20_000.0) })
            }
            kind => panic!("no moves are drawn of the kind {kind:?}"),
        }
    }

    /// One move, or two with a pause between them.
    fn axis(&mut self, kind: &str) -> Axis {
        let mut moves = vec![self.each(kind)];
        if self.below(3) == 0 {
            moves.push(Move::Dwell(Dwell { duration_s: self.magnitude(0.001, 0.1) }));
            moves.push(self.each(kind));
        }
        Axis { mechanics: self.mechanics(), moves, ..Axis::default() }
    }
}

/// Adds what a plan tells to a text.
type Tell = fn(&AxisPlan, &mut String);

/// What a line of the file is about.
const ASPECTS: [(&str, Tell); 5] = [
    ("curve", curves),
    ("breakpoints", breakpoints),
    ("step times", step_times),
    ("ticks", in_ticks),
    ("tables", tables),
];

const KINDS: [&str; 11] = [
    "trapezoid exact",
    "trapezoid table",
    "staircase",
    "cosine",
    "sliced",
    "ramps",
    "sine segments",
    "sine",
    "jerk-limited",
    "points",
    "constant",
];

/// A line of a text; a text takes all.
macro_rules! tell {
    ($text:expr, $($words:tt)*) => { writeln!($text, $($words)*).expect("a text takes every line") };
}

fn bits(numbers: &[f64]) -> String {
    numbers.iter().map(|number| format!(" {number:?}")).collect()
}

fn curves(plan: &AxisPlan, text: &mut String) {
    let whole_s = plan.duration_s();
    tell!(
        text,
        "{} steps, {} of them, in {whole_s:?} s, {:?}",
        plan.steps(),
        plan.step_count(),
        plan.peaks()
    );
    for part in -1..=21 {
        let t = whole_s * f64::from(part) / 20.0;
        let place = [plan.position(t), plan.speed(t), plan.acceleration(t)];
        tell!(text, "{t:?}:{} {}", bits(&place), plan.steps_due(t));
    }
    for planned in plan.moves() {
        let profile = &planned.profile;
        let peaks = profile.peaks();
        tell!(text, "{:?} {:?} {} {:?}", planned.start_s, profile.duration_s(), profile.steps(), peaks);
        for limit in [2000.0, 100_000.0] {
            tell!(text, "{}", profile.detail(limit));
        }
        if one_way(profile) {
            let steps = profile.steps().unsigned_abs() as f64;
            let places = [1e-9, 0.01, 0.25, 0.5, 0.75, 0.99].map(|part| profile.time_s(part * steps));
            tell!(text, "{}", bits(&places));
        }
    }
}

fn one_way(profile: &Profile) -> bool {
    let turns = matches!(profile, Profile::Sine(_) | Profile::SineSegments(_) | Profile::Points(_));
    !turns && profile.steps() != 0
}

fn breakpoints(plan: &AxisPlan, text: &mut String) {
    for planned in plan.moves() {
        tell!(text, "{}", bits(&planned.profile.breakpoints_s()));
    }
    let (breakpoints, whole_s) = (Breakpoints::of(plan), plan.duration_s());
    for (from, to) in [(-0.1, 1.1), (0.0, 1.0), (0.21, 0.93), (0.5, 0.6), (0.4, 0.4)] {
        let (from_s, to_s) = (whole_s * from, whole_s * to);
        tell!(text, "{from} to {to}: {:?}", breakpoints.period_within(from_s, to_s));
        breakpoints.intervals(from_s, to_s, &mut |interval| tell!(text, "{interval:?}"));
    }
}

fn step_times(plan: &AxisPlan, text: &mut String) {
    for (instant, due) in plan.due_instants(CLOCK_HZ) {
        tell!(text, "{instant:?} {} {}", due.cycle, due.right);
    }
    for planned in plan.moves() {
        let count = planned.profile.step_count();
        for k in [0, 1, 2, count / 2, count, count + 1] {
            tell!(text, "{k} {:?}", planned.profile.step_cycle(k, CLOCK_HZ));
        }
    }
}

fn in_ticks(plan: &AxisPlan, text: &mut String) {
    for (slot_count, tick_cycles) in [(100, 32_000), (127, 20_000)] {
        match ticks(std::slice::from_ref(plan), AxesPath::MOTION, 2, slot_count, tick_cycles, CLOCK_HZ) {
            Ok(orders) => tell!(text, "{} {:?}", orders.len(), orders.bytes()),
            Err(problems) => tell!(text, "{problems:?}"),
        }
    }
}

fn tables(plan: &AxisPlan, text: &mut String) {
    match exact_segments(std::slice::from_ref(plan), AxesPath::MOTION, 1, PULSE, CLOCK_HZ) {
        Ok(list) => tell!(text, "{list:?}"),
        Err(problems) => tell!(text, "{problems:?}"),
    }
    let parts =
        |cycles, parts| Tolerance { interval_part: NonZeroU32::new(parts), ..Tolerance::of(Cycles(cycles)) };
    let tolerances = [parts(0, 0), parts(400, 2), parts(16_000, 0)];
    let compressed = tolerances.map(Form::Compressed);
    for form in [Form::Exact, Form::Document].into_iter().chain(compressed) {
        let form_text = match form {
            Form::Compressed(Tolerance { cycles, interval_part, .. }) => {
                format!("Compressed(Tolerance {{ cycles: {cycles:?}, interval_part: {interval_part:?} }})")
            }
            form => format!("{form:?}"),
        };
        for format in EntryFormat::ALL {
            match stored_quickly(plan, form, format, PULSE, CLOCK_HZ) {
                Ok(table) => {
                    let (error, kept) = (table.error, table.document_bytes);
                    tell!(text, "{form_text} {} {kept:?} {error:?} {:?}", table.bytes(), error.rms());
                    for entry in &table.entries {
                        tell!(text, "{} {} {}", entry.interval, entry.count, entry.add);
                    }
                }
                Err(cause) => tell!(text, "{form_text} {cause}"),
            }
        }
    }
}

/// The texts of a kind, one for each aspect; what is refused stands in the first.
fn told(kind: &str) -> [String; ASPECTS.len()] {
    let mut draw = Draw(Xoshiro256PlusPlus::seed_from_u64(0));
    let mut texts = [const { String::new() }; ASPECTS.len()];
    let mut planned = 0;
    for _ in 0..AXES {
        let axis = draw.axis(kind);
        match plan_axis(&axis, "x") {
            Ok(plan) => {
                planned += 1;
                for ((_, tell), text) in ASPECTS.iter().zip(&mut texts) {
                    tell!(text, "{axis:?}");
                    tell(&plan, text);
                }
            }
            Err(problems) => {
                let [first, ..] = &mut texts;
                for problem in problems {
                    tell!(first, "{}: {}", problem.path, problem.cause);
                }
            }
        }
    }
    assert!(planned >= AXES / 4, "of {kind} only {planned} axes could be planned");
    texts
}

#[test]
fn curves_step_times_and_tables_are_as_before() {
    let crc = Crc::<u64>::new(&CRC_64_XZ);
    let (mut found, mut texts) = (String::new(), Vec::new());
    for kind in KINDS {
        for ((aspect, _), text) in ASPECTS.iter().zip(told(kind)) {
            let line = format!("{kind}, {aspect}: {:016x}", crc.checksum(text.as_bytes()));
            tell!(found, "{line}");
            texts.push((line, text));
        }
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/as_before.txt");
    if env::var_os("STEPSCOPE_BLESS").is_some() {
        return fs::write(&file, found).expect("the checksums can be written");
    }
    let expected = fs::read_to_string(&file).expect("the checksums can be read");
    let kept: Vec<&str> = expected.lines().collect();
    let mut changed = String::new();
    for (line, text) in texts.iter().filter(|(line, _)| !kept.contains(&line.as_str())) {
        let (name, _) = line.split_once(':').expect("a line has a name and a checksum");
        let path =
            Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}.txt", name.replace([' ', ','], "_")));
        let end = text.floor_char_boundary(MOST_TEXT);
        fs::write(&path, text.get(..end).unwrap_or_default()).expect("the text can be written");
        tell!(changed, "{name}: see {}", path.display());
    }
    assert!(changed.is_empty() && kept.len() == texts.len(), "changed, or not written down:\n{changed}");
}
