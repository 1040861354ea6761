//! Fourier sums of samples (rustfft), and of pulses directly from their times.
//!
//! Pulses are not sampled, because a pulse train has no maximum frequency and would alias. The k-th coefficient is a sum
//! over the pulses. Pulses near one grid point share a transform, with x the time in periods, g the nearest of N points
//! and d = N*x - g, |d| <= 1/2:
//!
//! ```text
//! sum dir_i * exp(w*(g_i + d_i)) = sum over m of w^m/m! * F_m(k)
//! F_m = transform over the grid of the cells' moments, sum dir_i * d_i^m
//! ```
//!
//! With N >= 16*order, |w*d| <= pi/16, and the remainder after [`MOMENTS`] terms is below 1e-17. So the cost per
//! pulse does not depend on the order.

use alloc::{sync::Arc, vec, vec::Vec};
use core::f64::consts::TAU;
use rustfft::algorithm::{BluesteinsAlgorithm, Radix4};
use rustfft::{Fft, FftDirection, num_complex::Complex};

/// (pi/16)^12/12! < 1e-17.
const MOMENTS: usize = 12;
const GRID_POINTS_PER_HARMONIC: usize = 16;

/// sum dir_i * exp(-i*2*pi*k*x_i) for k = 1 ..= `order` over (x_i, dir_i), x in periods.
pub(crate) fn sums(pulses: impl Iterator<Item = (f64, f64)>, order: usize) -> Vec<Complex<f64>> {
    let points = (GRID_POINTS_PER_HARMONIC * order.max(1)).next_power_of_two();
    let cells = moments(pulses, points);
    let transform = Radix4::new(points, FftDirection::Forward);
    let mut sums = vec![Complex { re: 0.0, im: 0.0 }; order];
    let mut line = vec![Complex { re: 0.0, im: 0.0 }; points];
    for moment in (0..MOMENTS).rev() {
        for (point, cell) in line.iter_mut().zip(&cells) {
            *point = Complex { re: cell.get(moment).copied().unwrap_or(0.0), im: 0.0 };
        }
        transform.process(&mut line);
        for (k, (sum, term)) in (1_u32..).zip(sums.iter_mut().zip(line.iter().skip(1))) {
            // *sum = term + *sum*w/(moment + 1), with w = -i*turn.
            let turn = TAU * f64::from(k) / points as f64 / (moment + 1) as f64;
            *sum = Complex { re: term.re + sum.im * turn, im: term.im - sum.re * turn };
        }
    }
    sums
}

/// Moments 0 .. [`MOMENTS`] of the pulses around each grid point.
fn moments(pulses: impl Iterator<Item = (f64, f64)>, points: usize) -> Vec<[f64; MOMENTS]> {
    let mut cells = vec![[0.0; MOMENTS]; points];
    for (x, direction) in pulses {
        let point = (x - libm::floor(x)) * points as f64;
        let nearest = libm::floor(point + 0.5);
        // The last half cell of a period belongs to its first cell.
        if let Some(cell) = cells.get_mut(nearest as usize % points) {
            let mut weight = direction;
            for moment in cell {
                *moment += weight;
                weight *= point - nearest;
            }
        }
    }
    cells
}

/// Amplitudes of harmonics 1 ..= `order` of samples of one period, below half the number of samples.
pub(crate) fn amplitudes(samples: &[f64], order: usize) -> Vec<f64> {
    let mut line: Vec<Complex<f64>> = samples.iter().map(|&re| Complex { re, im: 0.0 }).collect();
    transform(&mut line);
    let (half, scale) = (line.len().div_ceil(2), 2.0 / line.len() as f64);
    line.iter().take(half).skip(1).take(order).map(|c| magnitude(*c) * scale).collect()
}

/// Radix4 and Bluestein, because the SIMD variants of the planner change the last bits.
fn transform(line: &mut [Complex<f64>]) {
    let points = line.len();
    if points.is_power_of_two() {
        Radix4::new(points, FftDirection::Forward).process(line);
    } else if points > 0 {
        let inner = Radix4::new((2 * points - 1).next_power_of_two(), FftDirection::Forward);
        BluesteinsAlgorithm::new(points, Arc::new(inner)).process(line);
    }
}

pub(crate) fn magnitude(c: Complex<f64>) -> f64 {
    libm::sqrt(c.re * c.re + c.im * c.im)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Amplitude of harmonic `k` by the sum that defines it, its angles in whole parts of a turn.
    fn by_definition(samples: &[f64], k: usize) -> f64 {
        let points = samples.len();
        let (mut re, mut im) = (0.0, 0.0);
        for (i, sample) in samples.iter().enumerate() {
            let (sine, cosine) = libm::sincos(TAU * (i * k % points) as f64 / points as f64);
            re += sample * cosine;
            im -= sample * sine;
        }
        2.0 * magnitude(Complex { re, im }) / points as f64
    }

    #[test]
    fn amplitudes_of_any_length_equal_the_plain_sum() {
        // Powers of two, primes, odd, even, and the shortest.
        for points in [16, 17, 18, 100, 127, 255, 256, 360, 1000, 1009, 2048, 3000, 4099] {
            let samples: Vec<f64> =
                (0..points).map(|i| f64::from(i * i % 4093) / 4093.0 + f64::from(i % 7)).collect();
            let points = samples.len();
            let found = amplitudes(&samples, 10_000);
            assert_eq!(found.len(), (points - 1) / 2, "all below half of {points}");
            for (k, amplitude) in (1..).zip(&found).step_by(1 + points / 100) {
                let expected = by_definition(&samples, k);
                assert!((amplitude - expected).abs() < 1e-11, "{points} points, {k}: {amplitude} {expected}");
            }
        }
        assert!(amplitudes(&[1.0], 5).is_empty());
        assert!(amplitudes(&[], 5).is_empty());
    }

    #[test]
    fn a_sine_has_one_line_at_any_length() {
        for points in [16, 25, 97, 1000, 65_535] {
            let samples: Vec<f64> = (0..points)
                .map(|i| 3.0 * libm::sin(TAU * f64::from(i * 5 % points) / f64::from(points)))
                .collect();
            for (k, amplitude) in (1..).zip(amplitudes(&samples, 1000)) {
                let expected = if k == 5 { 3.0 } else { 0.0 };
                assert!((amplitude - expected).abs() < 1e-11, "{points} points, {k}: {amplitude}");
            }
        }
    }
}
