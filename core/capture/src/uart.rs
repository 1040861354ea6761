//! Bytes of a recorded serial line: its bit rate from its edges, its bytes, and whether a channel is a serial line at all.
//!
//! Bits are sampled at fractional bit times from each start edge, so four samples per bit are enough. Below
//! [`COARSE_BIT`] samples per bit the position of the start edge itself is fitted to all edges of the word.
//!
//! ```text
//! idle ¯¯¯\___/¯¯¯\_______/¯¯¯ …      edge n bits after the start edge: round((edge - start) / bit) = n
//!         start  1   0   0   1        words with edges that are no whole bits, or a low stop bit, do not fit
//! ```
//!
//! ```
//! use stepscope_capture::uart::{Edge, Format, Word, decode, estimate};
//!
//! // 'U' and 'A', 8.68 samples per bit.
//! let mut edges = Vec::new();
//! let mut high = true;
//! for (start, byte) in [(100.0, 0x55_u16), (200.0, 0x41)] {
//!     for (k, bit) in (0..10).map(|k| (k, (byte << 1 | 0x200) >> k & 1 == 1)) {
//!         if bit != high {
//!             edges.push(Edge { at: (start + 8.68 * f64::from(k)) as u64, high: bit });
//!             high = bit;
//!         }
//!     }
//! }
//! let found = estimate(&edges, Format::default(), Some(1e6)).expect("a rate fits");
//! assert_eq!(found.usual, Some(115_200));
//! let mut bytes = Vec::new();
//! decode(edges, found.bit, Format::default(), |word: Word| bytes.push(word.byte));
//! assert_eq!(bytes, [0x55, 0x41]);
//! ```

mod rate;

pub use rate::{Estimate, NoRate, estimate, looks_like_a_line};

use core::{fmt, str::FromStr};
use std::collections::VecDeque;

/// Samples per bit below which the start edge's own rounding matters.
pub const COARSE_BIT: f64 = 16.0;
/// Edges of one word that are considered; more are noise.
const MAX_EDGES: usize = 64;
/// How far a start edge may be off, in samples: its rounding, and one sample of jitter.
const START_OFF: f64 = 1.5;
/// Steps in which that is searched, in samples.
const START_STEP: f64 = 0.25;

/// Parity of a word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Parity {
    /// No parity bit.
    #[default]
    None,
    /// An even number of ones, the parity bit included.
    Even,
    /// An odd number.
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
    /// `data` bits (7 or 8), a parity and `stop` bits (1 or 2); `None` where there is no such format.
    #[must_use]
    pub fn new(data: u8, parity: Parity, stop: u8) -> Option<Self> {
        ((7..=8).contains(&data) && (1..=2).contains(&stop)).then_some(Self { data, parity, stop })
    }

    /// Bits of a word from its start bit to its last stop bit.
    #[must_use]
    pub fn bits(self) -> u8 {
        self.first_stop() + self.stop
    }

    fn first_stop(self) -> u8 {
        1 + self.data + u8::from(self.parity != Parity::None)
    }

    /// The byte of a word's levels, bit 0 being the start bit, and what is wrong with it.
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

/// A change of a line's level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// When, in any unit: samples, ticks or cycles.
    pub at: u64,
    /// The level from then on.
    pub high: bool,
}

/// What is wrong with a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A stop bit was low.
    Framing,
    /// Its parity bit does not fit.
    Parity,
}

/// A word of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// Its start edge.
    pub start: u64,
    /// Its data.
    pub byte: u8,
    /// What is wrong with it.
    pub fault: Option<Fault>,
}

/// A word as its edges fit the bit time.
#[derive(Clone, Copy, Debug, Default)]
struct Fitted {
    /// Levels of its bits, bit 0 being the start bit.
    levels: u16,
    /// Edges that belong to it.
    edges: usize,
    /// Sum of the squares of how far its edges are from whole bits, in bits.
    squares: f64,
    /// Edges that meet another one in a bit.
    met: usize,
    /// Sums for the least squares line through its edges: see [`rate`].
    sxx: f64,
    sxy: f64,
}

/// Decodes a line that is high when idle. Its edges alternate, and rise in time; a bit lasts `bit`. A word that ends the
/// recording with its line low counts as one with a framing error.
pub fn decode(edges: impl IntoIterator<Item = Edge>, bit: f64, format: Format, mut take: impl FnMut(Word)) {
    each_word(edges, bit, format, &mut |start, fitted: &Fitted, _| {
        let (byte, fault) = format.word(fitted.levels);
        if fitted.levels & 1 == 0 {
            take(Word { start, byte, fault });
        }
    });
}

/// Calls for each word, and for each pulse that is too short for a start bit, whose bit 0 is then high: its start edge, how it
/// fits, and whether edges come after it.
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

/// The nearest whole number of a number that is not negative.
fn rounded(number: f64) -> i64 {
    (number + 0.5).max(0.0) as i64
}

/// Fits a word to its edges, the first of which is the start edge, at 0.
fn fit(times: &[f64], bit: f64, format: Format) -> Fitted {
    let mut best = fit_from(times, bit, format, 0.0);
    if bit >= COARSE_BIT {
        return best.0;
    }
    let most = START_OFF.min(0.4 * bit);
    let mut off = START_STEP;
    while off <= most {
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

/// The same where the start is `off` later than its edge, and what that costs.
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
        // From this bit on the level is another one.
        levels ^= u16::MAX << whole;
        let x = whole as f64;
        (n, sum_x, sum_y) = (n + 1.0, sum_x + x, sum_y + at);
        (sum_xx, sum_xy) = (sum_xx + x * x, sum_xy + x * at);
    }
    fitted.levels = levels;
    fitted.sxx = sum_xx - sum_x * sum_x / n;
    fitted.sxy = sum_xy - sum_x * sum_y / n;
    // Of two that fit about as well the one with a stop bit.
    let framing = format.word(levels).1 == Some(Fault::Framing);
    (fitted, cost + if framing { 0.1 } else { 0.0 })
}

#[cfg(test)]
mod tests;
