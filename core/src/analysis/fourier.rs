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
//! But the pulses near a point of a grid can go through the transform together. With x the time in
//! periods, g the nearest of N points and d = N*x - g, |d| <= 1/2, w = -i*2*pi*k/N:
//!
//! ```text
//! sum dir_i * exp(w*(g_i + d_i)) = sum over m of w^m/m! * F_m(k)
//! F_m = transform over the grid of the cells' moments, sum dir_i * d_i^m
//! ```
//!
//! With N >= 16*order, |w*d| <= pi/16, and after [`MOMENTS`] terms the rest is under 1e-17 of the
//! pulses' weight. So the time is [`MOMENTS`] products a pulse, whatever the order, and as many
//! transforms of N points.

use alloc::{vec, vec::Vec};
use core::f64::consts::TAU;
use rustfft::{Fft, FftDirection, algorithm::Radix4, num_complex::Complex};

/// Terms of the exponential's series: (pi/16)^12/12! < 1e-17.
const MOMENTS: usize = 12;
/// Points of the grid for each harmonic.
const GRID_A_HARMONIC: usize = 16;

/// sum dir_i * exp(-i*2*pi*k*x_i) for k = 1 ..= `order` over (x_i, dir_i), x in periods.
pub(super) fn sums(pulses: impl Iterator<Item = (f64, f64)>, order: usize) -> Vec<Complex<f64>> {
    let points = (GRID_A_HARMONIC * order.max(1)).next_power_of_two();
    let cells = moments(pulses, points);
    let transform = Radix4::new(points, FftDirection::Forward);
    let mut sums = vec![Complex { re: 0.0, im: 0.0 }; order];
    let mut line = vec![Complex { re: 0.0, im: 0.0 }; points];
    // Horner's rule, the last moment first.
    for moment in (0..MOMENTS).rev() {
        for (place, cell) in line.iter_mut().zip(&cells) {
            *place = Complex { re: cell.get(moment).copied().unwrap_or(0.0), im: 0.0 };
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

/// The moments 0 .. [`MOMENTS`] of the pulses around each of so many points of a period.
fn moments(pulses: impl Iterator<Item = (f64, f64)>, points: usize) -> Vec<[f64; MOMENTS]> {
    let mut cells = vec![[0.0; MOMENTS]; points];
    for (x, direction) in pulses {
        let place = (x - libm::floor(x)) * points as f64;
        let nearest = libm::floor(place + 0.5);
        // Half a cell before the end of the period is the cell of its start.
        if let Some(cell) = cells.get_mut(nearest as usize % points) {
            let mut weight = direction;
            for moment in cell {
                *moment += weight;
                weight *= place - nearest;
            }
        }
    }
    cells
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
