//! Fourier sums: of samples by rustfft, and of pulses straight from their times.
//!
//! A pulse at time t turns the speed into dir*delta(t), so the k-th Fourier coefficient of the
//! speed over a stretch of length L with fundamental f0 is the plain sum over the pulses
//!
//! ```text
//! v_k = (1/L) * sum dir_i * exp(-i*2*pi*k*f0*t_i)
//! ```
//!
//! There is nothing to sample: a pulse train has no highest frequency, so every sampling would
//! fold its upper spectrum into the harmonics, and clock-cycle edges between samples would move.
//! exp(-i*2*pi*k*x) comes from k by one complex product a harmonic, begun anew with sine and
//! cosine every [`RESEED`] harmonics, so its error stays under 1e-12.

use alloc::{vec, vec::Vec};
use core::f64::consts::TAU;
use rustfft::{Fft, FftDirection, algorithm::Radix4, num_complex::Complex};

/// Harmonics that one sine and cosine serve.
const RESEED: usize = 32;
/// Pulses that go through the harmonics side by side.
const LANES: usize = 8;

/// The fractional part, 0 to 1.
fn fraction(x: f64) -> f64 {
    x - libm::floor(x)
}

/// sum dir_i * exp(-i*2*pi*k*x_i) for k = 1 ..= `order` over (x_i, dir_i), x in periods.
pub(super) fn sums(pulses: impl Iterator<Item = (f64, f64)>, order: usize) -> Vec<Complex<f64>> {
    let mut sums = vec![Complex { re: 0.0, im: 0.0 }; order];
    let mut group = Group { phase: [0.0; LANES], weight: [0.0; LANES] };
    let mut filled = 0;
    for (x, direction) in pulses {
        if let (Some(phase), Some(weight)) = (group.phase.get_mut(filled), group.weight.get_mut(filled)) {
            (*phase, *weight) = (fraction(x), direction);
        }
        filled += 1;
        if filled == LANES {
            group.add_to(&mut sums);
            (group.weight, filled) = ([0.0; LANES], 0);
        }
    }
    group.add_to(&mut sums);
    sums
}

/// Some pulses: phases in periods, and what each weighs (a free place nothing).
struct Group {
    phase: [f64; LANES],
    weight: [f64; LANES],
}

impl Group {
    fn add_to(&self, sums: &mut [Complex<f64>]) {
        let turn = self.powers(1);
        for (block, sums) in sums.chunks_mut(RESEED).enumerate() {
            let mut at = self.powers(block * RESEED + 1);
            for ((re, im), weight) in at.re.iter_mut().zip(&mut at.im).zip(&self.weight) {
                *re *= weight;
                *im *= weight;
            }
            for sum in sums {
                sum.re += at.re.iter().sum::<f64>();
                sum.im += at.im.iter().sum::<f64>();
                at.turn(&turn);
            }
        }
    }

    /// exp(-i*2*pi*k*x) of each.
    fn powers(&self, k: usize) -> Lanes {
        let mut lanes = Lanes { re: [0.0; LANES], im: [0.0; LANES] };
        for ((re, im), x) in lanes.re.iter_mut().zip(&mut lanes.im).zip(&self.phase) {
            let (sine, cosine) = libm::sincos(TAU * fraction(k as f64 * x));
            (*re, *im) = (cosine, -sine);
        }
        lanes
    }
}

/// Complex numbers side by side.
struct Lanes {
    re: [f64; LANES],
    im: [f64; LANES],
}

impl Lanes {
    fn turn(&mut self, by: &Self) {
        let factors = by.re.iter().zip(&by.im);
        for ((re, im), (by_re, by_im)) in self.re.iter_mut().zip(&mut self.im).zip(factors) {
            (*re, *im) = (*re * by_re - *im * by_im, *re * by_im + *im * by_re);
        }
    }
}

/// Amplitudes of harmonics 1 ..= `order` of samples that fill one period, by rustfft.
///
/// `samples` is a power of two long; harmonics from half of it on do not exist and are left out.
pub(super) fn amplitudes(samples: &[f64], order: usize) -> Vec<f64> {
    let mut line: Vec<Complex<f64>> = samples.iter().map(|&re| Complex { re, im: 0.0 }).collect();
    if line.len().is_power_of_two() {
        // Radix4 alone, not the planner: a third of the code in the page, and no SIMD variants,
        // whose last bits differ.
        Radix4::new(line.len(), FftDirection::Forward).process(&mut line);
    }
    let (half, scale) = (line.len() / 2, 2.0 / line.len() as f64);
    line.iter().take(half).skip(1).take(order).map(|c| magnitude(*c) * scale).collect()
}

/// |c|.
pub(super) fn magnitude(c: Complex<f64>) -> f64 {
    libm::sqrt(c.re * c.re + c.im * c.im)
}
