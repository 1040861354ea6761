//! Decodes a recorded serial line: bit rate from its edges, then its bytes.
//!
//! Bits are sampled at fractional bit times from each start edge, so four samples per bit are enough. Below
//! [`COARSE_BIT`] samples per bit the position of the start edge itself is fitted to all edges of the word.
//!
//! ```text
//! idle ¯¯¯\___/¯¯¯\_______/¯¯¯ …      edge n bits after the start edge: round((edge - start) / bit) = n
//!         start  1   0   0   1        words with edges that are no whole bits, or a low stop bit, do not fit
//! ```

mod rate;

pub use rate::{Estimate, NoRate, estimate, looks_like_a_line};

use core::{fmt, str::FromStr};
use std::collections::VecDeque;

/// Below this number of samples per bit the start edge's rounding matters.
pub const COARSE_BIT: f64 = 16.0;
/// More edges per word are noise.
const MAX_EDGES: usize = 64;
/// In samples: rounding, plus one sample of jitter.
const START_OFF: f64 = 1.5;
const START_STEP: f64 = 0.25;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Parity {
    #[default]
    None,
    /// Even number of ones, parity bit included.
    Even,
    Odd,
}

/// Data bits, parity and stop bits of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Format {
    data: u8,
    parity: Parity,
    stop: u8,
}

impl Default for Format {
    fn default() -> Self {
        Self { data: 8, parity: Parity::None, stop: 1 }
    }
}

impl Format {
    /// 7 or 8 data bits, a parity and 1 or 2 stop bits; `None` for other formats.
    #[must_use]
    pub fn new(data: u8, parity: Parity, stop: u8) -> Option<Self> {
        ((7..=8).contains(&data) && (1..=2).contains(&stop)).then_some(Self { data, parity, stop })
    }

    /// Bits per word, from the start bit to the last stop bit.
    #[must_use]
    pub fn bits(self) -> u8 {
        self.first_stop() + self.stop
    }

    fn first_stop(self) -> u8 {
        1 + self.data + u8::from(self.parity != Parity::None)
    }

    /// Bit 0 of `levels` is the start bit.
    fn word(self, levels: u16) -> (u8, Option<Fault>) {
        let byte = (levels >> 1 & ((1 << self.data) - 1)) as u8;
        let stops = (1_u16 << self.stop) - 1;
        if levels >> self.first_stop() & stops != stops {
            return (byte, Some(Fault::Framing));
        }
        let ones = byte.count_ones() + u32::from(levels >> (1 + self.data) & 1);
        let right = match self.parity {
            Parity::None => true,
            Parity::Even => ones.is_multiple_of(2),
            Parity::Odd => !ones.is_multiple_of(2),
        };
        (byte, if right { None } else { Some(Fault::Parity) })
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parity = match self.parity {
            Parity::None => 'N',
            Parity::Even => 'E',
            Parity::Odd => 'O',
        };
        write!(f, "{}{parity}{}", self.data, self.stop)
    }
}

impl FromStr for Format {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let format = match text.as_bytes() {
            [data @ b'7'..=b'8', parity, stop @ b'1'..=b'2'] => {
                let parity = match parity.to_ascii_uppercase() {
                    b'N' => Some(Parity::None),
                    b'E' => Some(Parity::Even),
                    b'O' => Some(Parity::Odd),
                    _ => None,
                };
                parity.and_then(|parity| Self::new(data - b'0', parity, stop - b'0'))
            }
            _ => None,
        };
        format.ok_or("use 7 or 8 data bits, parity N, E or O, and 1 or 2 stop bits, such as 8N1, 7E1 or 8O2")
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// In any unit: samples, ticks or cycles.
    pub at: u64,
    pub high: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A low stop bit.
    Framing,
    /// A wrong parity bit.
    Parity,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// Its start edge.
    pub start: u64,
    pub byte: u8,
    pub fault: Option<Fault>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Fitted {
    levels: u16,
    edges: usize,
    /// In bits.
    squares: f64,
    met: usize,
    /// Sums of the least squares line; see [`rate`].
    sxx: f64,
    sxy: f64,
}

/// Decodes a line that is high when idle, with alternating edges in order of time; a bit lasts `bit`. A word that
/// ends with the recording and a low line has a framing error.
pub fn decode(edges: impl IntoIterator<Item = Edge>, bit: f64, format: Format, mut take: impl FnMut(Word)) {
    each_word(edges, bit, format, &mut |start, fitted: &Fitted, _| {
        let (byte, fault) = format.word(fitted.levels);
        if fitted.levels & 1 == 0 {
            take(Word { start, byte, fault });
        }
    });
}

/// Also calls for pulses too short for a start bit, whose bit 0 is then high. Passes the start edge, the fit, and
/// whether more edges follow.
fn each_word(
    edges: impl IntoIterator<Item = Edge>,
    bit: f64,
    format: Format,
    take: &mut dyn FnMut(u64, &Fitted, bool),
) {
    let mut edges = edges.into_iter();
    let mut pending: VecDeque<Edge> = VecDeque::with_capacity(MAX_EDGES);
    let mut times = Vec::with_capacity(MAX_EDGES);
    let reach = (f64::from(format.bits()) - 0.5) * bit + START_OFF;
    loop {
        let Some(start) = pending.pop_front().or_else(|| edges.next()) else { return };
        if start.high {
            continue;
        }
        // One edge after the word is enough.
        while pending.len() < MAX_EDGES
            && pending.back().is_none_or(|last| ((last.at - start.at) as f64) < reach)
            && let Some(edge) = edges.next()
        {
            pending.push_back(edge);
        }
        times.clear();
        times.push(0.0);
        times.extend(pending.iter().map(|edge| (edge.at - start.at) as f64).take_while(|at| *at < reach));
        let fitted = fit(&times, bit, format);
        pending.drain(..(fitted.edges - 1).min(pending.len()));
        take(start.at, &fitted, !pending.is_empty());
    }
}

fn rounded(number: f64) -> i64 {
    (number + 0.5).max(0.0) as i64
}

fn fit(times: &[f64], bit: f64, format: Format) -> Fitted {
    let mut best = fit_from(times, bit, format, 0.0);
    if bit >= COARSE_BIT {
        return best.0;
    }
    let max_off = START_OFF.min(0.4 * bit);
    let mut off = START_STEP;
    while off <= max_off {
        for off in [off, -off] {
            let other = fit_from(times, bit, format, off);
            if other.1 < best.1 {
                best = other;
            }
        }
        off += START_STEP;
    }
    best.0
}

fn fit_from(times: &[f64], bit: f64, format: Format, off: f64) -> (Fitted, f64) {
    let bits = i64::from(format.bits());
    let mut fitted = Fitted { edges: 1, ..Fitted::default() };
    let (mut levels, mut last) = (0_u16, 0_i64);
    let mut cost = (off / bit) * (off / bit);
    let (mut n, mut sum_x, mut sum_y, mut sum_xx, mut sum_xy) = (1.0, 0.0, 0.0, 0.0, 0.0);
    for at in times.iter().skip(1) {
        let whole = rounded((at - off) / bit);
        if whole >= bits {
            break;
        }
        let far = (at - off) / bit - whole as f64;
        (cost, fitted.squares) = (cost + far * far, fitted.squares + far * far);
        if whole == last {
            fitted.met += 1;
            cost += 1.0;
        }
        fitted.edges += 1;
        last = whole;
        levels ^= u16::MAX << whole;
        let x = whole as f64;
        (n, sum_x, sum_y) = (n + 1.0, sum_x + x, sum_y + at);
        (sum_xx, sum_xy) = (sum_xx + x * x, sum_xy + x * at);
    }
    fitted.levels = levels;
    fitted.sxx = sum_xx - sum_x * sum_x / n;
    fitted.sxy = sum_xy - sum_x * sum_y / n;
    // Of two similar fits, prefer the one with a stop bit.
    let framing = format.word(levels).1 == Some(Fault::Framing);
    (fitted, cost + if framing { 0.1 } else { 0.0 })
}

#[cfg(test)]
mod tests;
