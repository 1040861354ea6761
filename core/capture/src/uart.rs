//! Decodes a recorded serial line: estimates the bit rate from its edges, then decodes the bytes.
//!
//! Bits are counted at fractional bit times from each start edge, so four samples per bit are enough. Below
//! [`COARSE_BIT`] samples per bit the time of the start edge itself is fitted to all edges of the word.
//!
//! ```text
//! idle ¯¯¯\___/¯¯¯\_______/¯¯¯ …      bits before an edge: n = round((edge - start) / bit)
//!         start  1   0   0   1        a bit time fits if all edges are at whole bits and stop bits are high
//! ```
//!
//! ```
//! use stepscope_capture::uart::{Edge, Format, decode, estimate};
//!
//! // The letter U, 100 samples per bit, sampled at 960 kHz.
//! let edges: Vec<Edge> = (0..10).map(|bit| Edge { at: 100 * bit, high: bit % 2 == 1 }).collect();
//! let rate = estimate(&edges, Format::default(), Some(960_000.0)).expect("a rate fits");
//! assert_eq!(rate.usual, Some(9600));
//! decode(edges, rate.bit, Format::default(), |word| assert_eq!(word.byte, b'U'));
//! ```

mod rate;

pub use rate::{Estimate, NoRate, estimate};
pub(crate) use rate::{IdleLevel, detect_line};

use core::{fmt, str::FromStr};
use std::collections::VecDeque;

/// Below this number of samples per bit, the rounding of the start edge matters. Times in a finer unit are treated like
/// samples.
pub const COARSE_BIT: f64 = 16.0;
/// Maximum number of edges per word; more are noise.
const MAX_EDGES: usize = 64;
/// Maximum deviation of a start edge, in samples: rounding plus one sample of jitter.
const MAX_START_DEVIATION: f64 = 1.5;
/// Increment of the deviations that are tried.
const DEVIATION_STEP: f64 = 0.25;

/// Parity of a serial line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Parity {
    /// No parity bit.
    #[default]
    None,
    /// Even number of ones, parity bit included.
    Even,
    /// Odd number of ones, parity bit included.
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
    pub fn new(data: u8, parity: Parity, stop: u8) -> Option<Self> {
        ((7..=8).contains(&data) && (1..=2).contains(&stop)).then_some(Self { data, parity, stop })
    }

    /// Bits per word, from the start bit to the last stop bit.
    pub fn bits(self) -> u8 {
        self.first_stop() + self.stop
    }

    fn first_stop(self) -> u8 {
        1 + self.data + u8::from(self.parity != Parity::None)
    }

    /// Byte and fault of a word; bit 0 of `levels` is the start bit.
    fn word(self, levels: u16) -> (u8, Option<Fault>) {
        let byte = (levels >> 1 & ((1 << self.data) - 1)) as u8;
        let stops = (1_u16 << self.stop) - 1;
        if levels >> self.first_stop() & stops != stops {
            return (byte, Some(Fault::Framing));
        }
        let ones = byte.count_ones() + u32::from(levels >> (1 + self.data) & 1);
        let is_parity_correct = match self.parity {
            Parity::None => true,
            Parity::Even => ones.is_multiple_of(2),
            Parity::Odd => !ones.is_multiple_of(2),
        };
        (byte, if is_parity_correct { None } else { Some(Fault::Parity) })
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

/// A change of a serial line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Time in samples, or in a finer unit such as ticks or cycles. The deviation that is tolerated at a start edge is a
    /// number of these, so a finer unit tolerates less.
    pub at: u64,
    /// Level after the edge.
    pub high: bool,
}

/// A fault of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A low stop bit.
    Framing,
    /// A wrong parity bit.
    Parity,
}

/// A decoded byte with its fault, if it has one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// Time of its start edge.
    pub start: u64,
    pub byte: u8,
    pub fault: Option<Fault>,
}

/// A word, and how well its edges fit whole bits.
#[derive(Clone, Copy, Debug, Default)]
struct FittedWord {
    /// Time of the start edge.
    start: u64,
    /// Level of each bit, from the start bit. A high start bit is a pulse too short for a word.
    levels: u16,
    /// Number of edges, including the start edge.
    edges: usize,
    /// Sum of the squared distances of edges from whole bits, in bits.
    squares: f64,
    /// Edges at the bit of the previous edge.
    coincident: usize,
    /// Sums of the least squares line; see [`rate`].
    sxx: f64,
    sxy: f64,
    /// More edges follow.
    has_next: bool,
}

/// Decodes a line that idles high, with alternating edges in order of time. `bit` is the length of a bit in the unit of
/// the edges. A word that ends with the recording and a low line has a framing error.
pub fn decode(edges: impl IntoIterator<Item = Edge>, bit: f64, format: Format, mut take: impl FnMut(Word)) {
    fit_words(edges, bit, format, &mut |word: &FittedWord| {
        let (byte, fault) = format.word(word.levels);
        if word.levels & 1 == 0 {
            take(Word { start: word.start, byte, fault });
        }
    });
}

/// Fits each word to whole bits, and each pulse that is too short for a start bit.
fn fit_words(
    edges: impl IntoIterator<Item = Edge>,
    bit: f64,
    format: Format,
    take: &mut dyn FnMut(&FittedWord),
) {
    let mut edges = edges.into_iter();
    let mut pending: VecDeque<Edge> = VecDeque::with_capacity(MAX_EDGES);
    let mut times = Vec::with_capacity(MAX_EDGES);
    let length = (f64::from(format.bits()) - 0.5) * bit + MAX_START_DEVIATION;
    loop {
        let Some(start) = pending.pop_front().or_else(|| edges.next()) else { return };
        if start.high {
            continue;
        }
        // One edge after the word is enough.
        while pending.len() < MAX_EDGES
            && pending.back().is_none_or(|last| ((last.at - start.at) as f64) < length)
            && let Some(edge) = edges.next()
        {
            pending.push_back(edge);
        }
        times.clear();
        times.push(0.0);
        times.extend(pending.iter().map(|edge| (edge.at - start.at) as f64).take_while(|at| *at < length));
        let fitted = fit(&times, bit, format);
        pending.drain(..(fitted.edges - 1).min(pending.len()));
        take(&FittedWord { start: start.at, has_next: !pending.is_empty(), ..fitted });
    }
}

/// Rounded half up; 0 for negative numbers.
fn rounded_from_zero(number: f64) -> i64 {
    (number + 0.5).max(0.0) as i64
}

/// Fits the edges of a word, and with few samples per bit its start edge.
fn fit(times: &[f64], bit: f64, format: Format) -> FittedWord {
    let (mut best, mut min_cost) = fit_from(times, bit, format, 0.0);
    if bit >= COARSE_BIT {
        return best;
    }
    let max_deviation = MAX_START_DEVIATION.min(0.4 * bit);
    let mut deviation = DEVIATION_STEP;
    while deviation <= max_deviation {
        for signed in [deviation, -deviation] {
            let (fitted, cost) = fit_from(times, bit, format, signed);
            if cost < min_cost {
                (best, min_cost) = (fitted, cost);
            }
        }
        deviation += DEVIATION_STEP;
    }
    best
}

/// Fits the edges to whole bits from a start edge that deviates; returns the fit and its cost.
fn fit_from(times: &[f64], bit: f64, format: Format, deviation: f64) -> (FittedWord, f64) {
    let bits = i64::from(format.bits());
    let mut fitted = FittedWord { edges: 1, ..FittedWord::default() };
    let (mut levels, mut last) = (0_u16, 0_i64);
    let mut cost = (deviation / bit) * (deviation / bit);
    let (mut n, mut sum_x, mut sum_y, mut sum_xx, mut sum_xy) = (1.0, 0.0, 0.0, 0.0, 0.0);
    for at in times.iter().skip(1) {
        let whole = rounded_from_zero((at - deviation) / bit);
        if whole >= bits {
            break;
        }
        let distance = (at - deviation) / bit - whole as f64;
        (cost, fitted.squares) = (cost + distance * distance, fitted.squares + distance * distance);
        if whole == last {
            fitted.coincident += 1;
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
    // Of two similar fits, the one with a stop bit is better.
    let has_framing_error = format.word(levels).1 == Some(Fault::Framing);
    (fitted, cost + if has_framing_error { 0.1 } else { 0.0 })
}

#[cfg(test)]
mod tests;
