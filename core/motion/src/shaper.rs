//! Input shapers: impulses that cancel a vibration, the vibration that remains, and the shaper for a range of frequencies.
//!
//! ```
//! use stepscope_motion::shaper::{InputShaper, ShaperKind, ShaperSettings};
//!
//! let shaper = InputShaper::Mzv(ShaperSettings { frequency_hz: 45.0, damping_ratio: 0.1 }).shaper();
//! assert_eq!((shaper.kind(), shaper.impulses().len()), (ShaperKind::Mzv, 3));
//! // 19 % of the vibration remains if the machine vibrates at 36 Hz instead.
//! assert!((shaper.residual(36.0, 0.1) - 0.190_87).abs() < 1e-5);
//! ```

use crate::square_root;
use alloc::{vec, vec::Vec};
use core::f64::consts::{PI, SQRT_2};
use core::ops::RangeInclusive;
use stepscope_peripheral::parameters;

parameters! { (Clone, Debug, PartialEq)
    /// The vibration that a shaper cancels.
    pub struct ShaperSettings {
        /// 0.1 to 10000 Hz.
        pub frequency_hz: f64 = 45.0,
        /// From 0 to the maximum of the shaper.
        pub damping_ratio: f64 = 0.1,
    }
}

/// The input shaper of an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum InputShaper {
    Zv(ShaperSettings),
    Mzv(ShaperSettings),
    Zvd(ShaperSettings),
    Ei(ShaperSettings),
    TwoHumpEi(ShaperSettings),
    ThreeHumpEi(ShaperSettings),
}

impl InputShaper {
    /// Kind and settings.
    pub fn parts(&self) -> (ShaperKind, &ShaperSettings) {
        match self {
            Self::Zv(settings) => (ShaperKind::Zv, settings),
            Self::Mzv(settings) => (ShaperKind::Mzv, settings),
            Self::Zvd(settings) => (ShaperKind::Zvd, settings),
            Self::Ei(settings) => (ShaperKind::Ei, settings),
            Self::TwoHumpEi(settings) => (ShaperKind::TwoHumpEi, settings),
            Self::ThreeHumpEi(settings) => (ShaperKind::ThreeHumpEi, settings),
        }
    }

    /// The impulses of valid settings.
    pub fn shaper(&self) -> Shaper {
        let (kind, ShaperSettings { frequency_hz, damping_ratio }) = self.parts();
        Shaper::new(kind, *frequency_hz, *damping_ratio)
    }
}

/// A kind of shaper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShaperKind {
    /// Two impulses (Singer and Seering 1990).
    Zv,
    /// Three impulses, shorter than ZVD (Klipper).
    Mzv,
    /// Three impulses, less sensitive to the frequency (Singer and Seering 1990).
    Zvd,
    /// Three impulses that leave 5 % at the frequency itself (Singhose, Seering, Singer 1994).
    Ei,
    /// Four impulses (Singhose et al. 1997).
    TwoHumpEi,
    /// Five impulses (Singhose et al. 1997).
    ThreeHumpEi,
}

/// A cubic in the damping ratio.
type Cubic = [f64; 4];

/// Amplitudes and times in periods 1/f of a shaper's impulses (Singhose et al. 1997).
const TWO_HUMPS: [(Cubic, Cubic); 4] = [
    ([0.16054, 0.76699, 2.2656, -1.2275], [0.0; 4]),
    ([0.33911, 0.45081, -2.5808, 1.7365], [0.4989, 0.1627, -0.54262, 6.1618]),
    ([0.34089, -0.61533, -0.68765, 0.42261], [0.99748, 0.18382, -1.5827, 8.1712]),
    ([0.15997, -0.60246, 1.0028, -0.93145], [1.4992, -0.09297, -0.28338, 1.8571]),
];
const THREE_HUMPS: [(Cubic, Cubic); 5] = [
    ([0.11275, 0.76632, 3.2916, -1.4438], [0.0; 4]),
    ([0.23698, 0.61164, -2.5785, 4.8522], [0.49974, 0.23834, 0.44559, 12.472]),
    ([0.30008, -0.19062, -2.1456, 0.13744], [0.99849, 0.29808, -2.3646, 23.399]),
    ([0.23775, -0.73297, 0.46885, -2.0865], [1.4987, 0.10306, -2.0139, 17.032]),
    ([0.11244, -0.45439, 0.96382, -1.46], [1.9996, -0.28231, 0.61536, 5.4045]),
];

impl ShaperKind {
    /// All kinds, in the order of their delays.
    pub const ALL: [Self; 6] = [Self::Zv, Self::Mzv, Self::Zvd, Self::Ei, Self::TwoHumpEi, Self::ThreeHumpEi];

    /// Name in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Zv => "zv",
            Self::Mzv => "mzv",
            Self::Zvd => "zvd",
            Self::Ei => "ei",
            Self::TwoHumpEi => "two_hump_ei",
            Self::ThreeHumpEi => "three_hump_ei",
        }
    }

    /// Damping ratios for which its impulses are defined.
    pub const fn damping_ratios(self) -> RangeInclusive<f64> {
        let max = match self {
            Self::Zv | Self::Mzv | Self::Zvd => 0.99,
            Self::Ei => 0.4,
            Self::TwoHumpEi => 0.3,
            Self::ThreeHumpEi => 0.2,
        };
        0.0..=max
    }

    /// Amplitudes, not yet divided by their sum, and times in periods 1/f.
    fn impulses(self, z: f64) -> Vec<(f64, f64)> {
        let root = square_root(1.0 - z * z);
        let k = libm::exp(-z * PI / root);
        let m = libm::exp(-0.75 * z * PI / root);
        // The damped period.
        let period = 1.0 / root;
        let cubic = |[a, b, c, d]: Cubic| a + z * (b + z * (c + z * d));
        let cubics = |(amplitude, time): &(Cubic, Cubic)| (cubic(*amplitude), cubic(*time));
        match self {
            Self::Zv => vec![(1.0, 0.0), (k, period / 2.0)],
            Self::Mzv => {
                let a = 1.0 - square_root(0.5);
                vec![(a, 0.0), ((SQRT_2 - 1.0) * m, 0.375 * period), (a * m * m, 0.75 * period)]
            }
            Self::Zvd => vec![(1.0, 0.0), (2.0 * k, period / 2.0), (k * k, period)],
            Self::Ei => {
                let first = cubic([0.262_160_5, 0.861_744, 0.654_648, 0.0]);
                let last = cubic([0.262_227, -0.761_741, 0.606_763, 0.0]);
                let middle = cubic([0.4999, 0.044_525_575, -0.058_525_5, 0.930_273]);
                vec![(first, 0.0), (1.0 - first - last, middle * period), (last, period)]
            }
            Self::TwoHumpEi => TWO_HUMPS.iter().map(cubics).collect(),
            Self::ThreeHumpEi => THREE_HUMPS.iter().map(cubics).collect(),
        }
    }
}

/// An impulse of a shaper: part of the motion, and its delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulse {
    pub amplitude: f64,
    pub time_s: f64,
}

/// A shaper for a frequency and a damping ratio.
#[derive(Clone, Debug, PartialEq)]
pub struct Shaper {
    kind: ShaperKind,
    frequency_hz: f64,
    /// Invariant: the amplitudes add up to 1, and the first delay is 0.
    impulses: Vec<Impulse>,
}

impl Shaper {
    /// The shaper of a kind for a frequency above 0 and a damping ratio of [`ShaperKind::damping_ratios`].
    pub fn new(kind: ShaperKind, frequency_hz: f64, damping_ratio: f64) -> Self {
        let raw = kind.impulses(damping_ratio);
        let sum: f64 = raw.iter().map(|(amplitude, _)| amplitude).sum();
        let impulses = raw
            .iter()
            .map(|(amplitude, periods)| Impulse {
                amplitude: amplitude / sum,
                time_s: periods / frequency_hz,
            })
            .collect();
        Self { kind, frequency_hz, impulses }
    }

    pub fn kind(&self) -> ShaperKind {
        self.kind
    }

    /// The frequency in Hz that it cancels.
    pub fn frequency_hz(&self) -> f64 {
        self.frequency_hz
    }

    /// Its impulses, rising in time from 0.
    pub fn impulses(&self) -> &[Impulse] {
        &self.impulses
    }

    /// Delay of the last impulse in s: the axis ends later by this time.
    pub fn delay_s(&self) -> f64 {
        self.impulses.last().map_or(0.0, |last| last.time_s)
    }

    /// Mean delay in s.
    pub fn mean_delay_s(&self) -> f64 {
        self.impulses.iter().map(|impulse| impulse.amplitude * impulse.time_s).sum()
    }

    /// Part of the vibration that remains after the last impulse at a frequency and damping ratio.
    pub fn residual(&self, frequency_hz: f64, damping_ratio: f64) -> f64 {
        let w = 2.0 * PI * frequency_hz;
        let wd = w * square_root(1.0 - damping_ratio * damping_ratio);
        let end_s = self.delay_s();
        let (mut re, mut im) = (0.0, 0.0);
        for Impulse { amplitude, time_s } in &self.impulses {
            let size = amplitude * libm::exp(-damping_ratio * w * (end_s - time_s));
            let (sine, cosine) = libm::sincos(wd * time_s);
            re += size * cosine;
            im += size * sine;
        }
        libm::hypot(re, im)
    }

    /// What each impulse leaves at a frequency, and its factor from there to a frequency higher by `step_hz`.
    fn vectors(&self, frequency_hz: f64, step_hz: f64, damping_ratio: f64) -> Vec<Vector> {
        let root = square_root(1.0 - damping_ratio * damping_ratio);
        let end_s = self.delay_s();
        let vector = |impulse: &Impulse| {
            let at = |frequency_hz: f64| {
                let w = 2.0 * PI * frequency_hz;
                let size = libm::exp(-damping_ratio * w * (end_s - impulse.time_s));
                let (sine, cosine) = libm::sincos(w * root * impulse.time_s);
                (size * cosine, size * sine)
            };
            let (re, im) = at(frequency_hz);
            Vector { at: (impulse.amplitude * re, impulse.amplitude * im), turn: at(step_hz) }
        };
        self.impulses.iter().map(vector).collect()
    }

    /// P1, P2 and P.
    fn moments(&self) -> (f64, f64, f64) {
        let mean = self.mean_delay_s();
        let mut moments = (0.0, 0.0, 0.0);
        for Impulse { amplitude, time_s } in &self.impulses {
            let x = time_s - mean;
            let later = libm::fmax(x, 0.0);
            moments.0 += amplitude * later;
            moments.1 += amplitude * later * later;
            moments.2 += amplitude * x * x;
        }
        moments
    }

    /// Smoothing in mm at an acceleration in mm/s^2 and a corner speed in mm/s, as in Klipper.
    pub fn smoothing(&self, acceleration: f64, corner_speed: f64) -> f64 {
        let (first, second, all) = self.moments();
        let half = acceleration / 2.0;
        libm::fmax(SQRT_2 * (corner_speed * first + half * second), half * all)
    }

    /// The largest acceleration in mm/s^2 with at most `smoothing` mm at a corner speed in mm/s.
    pub fn max_acceleration(&self, smoothing: f64, corner_speed: f64) -> f64 {
        let (first, second, all) = self.moments();
        let bound =
            libm::fmin(SQRT_2 * (smoothing - SQRT_2 * corner_speed * first) / second, 2.0 * smoothing / all);
        libm::fmax(0.0, bound)
    }
}

/// A complex number, and the factor that leads to the one at the next frequency.
struct Vector {
    at: (f64, f64),
    turn: (f64, f64),
}

fn product(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

/// Frequencies are multiples of 0.1 Hz.
const STEPS_PER_HZ: f64 = 10.0;
/// Lowest and highest frequency of a range.
const MIN_HZ: f64 = 0.1;
const MAX_HZ: f64 = 1000.0;

/// Frequencies of a machine's vibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrequencyRange {
    pub low_hz: f64,
    pub high_hz: f64,
    pub damping_ratio: f64,
    /// Part of the vibration that may remain, such as 0.06.
    pub max_residual: f64,
}

/// The shaper with the minimum smoothing that leaves at most the allowed vibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Recommendation {
    pub shaper: Shaper,
    /// Largest part of the vibration that remains.
    pub residual: f64,
    /// In mm.
    pub smoothing: f64,
}

/// Acceleration in mm/s^2 of the smoothing that is compared, as in Klipper.
pub const SMOOTHING_ACCELERATION: f64 = 5000.0;
/// Corner speed in mm/s of the smoothing that is compared, as in Klipper.
pub const SMOOTHING_CORNER_SPEED: f64 = 5.0;

impl FrequencyRange {
    /// The largest residual in the range, or some residual above `bound`.
    fn residual(&self, shaper: &Shaper, bound: f64) -> f64 {
        let damping_ratios = [0.75, 1.0, 1.5].map(|factor| factor * self.damping_ratio);
        let mut largest = 0.0;
        // The ends first: there most candidates fail.
        for frequency_hz in [self.low_hz, self.high_hz] {
            for damping_ratio in damping_ratios {
                largest = libm::fmax(largest, shaper.residual(frequency_hz, damping_ratio));
            }
        }
        let from = libm::ceil(self.low_hz * STEPS_PER_HZ) as u64;
        let to = libm::floor(self.high_hz * STEPS_PER_HZ) as u64;
        for damping_ratio in damping_ratios {
            let mut vectors = shaper.vectors(from as f64 / STEPS_PER_HZ, 1.0 / STEPS_PER_HZ, damping_ratio);
            for _ in from..=to {
                if largest > bound {
                    return largest;
                }
                let mut sum = (0.0, 0.0);
                for vector in &mut vectors {
                    sum = (sum.0 + vector.at.0, sum.1 + vector.at.1);
                    vector.at = product(vector.at, vector.turn);
                }
                largest = libm::fmax(largest, square_root(sum.0 * sum.0 + sum.1 * sum.1));
            }
        }
        largest
    }

    /// The recommended shaper; if all exceed the allowed vibration, the one that leaves the minimum. `None` if no kind
    /// allows the damping ratio, or if the frequencies are not within 0.1 to 1000 Hz and rising.
    pub fn recommend(&self) -> Option<Recommendation> {
        if !(self.low_hz >= MIN_HZ && self.low_hz <= self.high_hz && self.high_hz <= MAX_HZ) {
            return None;
        }
        let from = libm::ceil(self.low_hz / 2.0 * STEPS_PER_HZ) as u64;
        let to = libm::floor(self.high_hz * 3.0 * STEPS_PER_HZ) as u64;
        let mut best: Option<Recommendation> = None;
        for kind in ShaperKind::ALL {
            if !kind.damping_ratios().contains(&self.damping_ratio) {
                continue;
            }
            // Smoothing falls with the frequency, so the highest one that passes is the kind's best.
            for tenths in (from.max(1)..=to).rev() {
                let shaper = Shaper::new(kind, tenths as f64 / STEPS_PER_HZ, self.damping_ratio);
                let bound = match &best {
                    Some(best) if best.residual > self.max_residual => best.residual,
                    _ => self.max_residual,
                };
                let residual = self.residual(&shaper, bound);
                if residual > bound && best.is_some() {
                    continue;
                }
                let smoothing = shaper.smoothing(SMOOTHING_ACCELERATION, SMOOTHING_CORNER_SPEED);
                let passes = residual <= self.max_residual;
                let better = match &best {
                    None => true,
                    Some(best) if best.residual <= self.max_residual => passes && smoothing < best.smoothing,
                    Some(best) => passes || residual < best.residual,
                };
                if better {
                    // A residual that broke off at the bound is only a lower bound.
                    let residual = if passes { residual } else { self.residual(&shaper, f64::INFINITY) };
                    best = Some(Recommendation { shaper, residual, smoothing });
                }
                if passes {
                    break;
                }
            }
        }
        best
    }
}

/// Vibration in steps that a train of steps leaves at `end_s` in an oscillator of a frequency and damping ratio. A step is its
/// time in s, and whether it goes to the right.
pub fn train_residual(
    steps: impl IntoIterator<Item = (f64, bool)>,
    end_s: f64,
    frequency_hz: f64,
    damping_ratio: f64,
) -> f64 {
    let root = square_root(1.0 - damping_ratio * damping_ratio);
    let w = 2.0 * PI * frequency_hz;
    let (mut re, mut im) = (0.0, 0.0);
    for (time_s, right) in steps {
        let since_s = end_s - time_s;
        let size = libm::exp(-damping_ratio * w * since_s) * if right { 1.0 } else { -1.0 };
        let (sine, cosine) = libm::sincos(w * root * since_s);
        (re, im) = (re + size * cosine, im + size * sine);
    }
    libm::hypot(re, im) / root
}

#[cfg(test)]
mod tests;
