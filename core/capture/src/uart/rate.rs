//! The bit rate of a line: of all bit times that its shortest pulse allows, the one that most words and edges fit.

use super::{Edge, Fault, Format, each_word};

/// Rates that lines have.
const USUAL: [u32; 26] = [
    300, 1200, 2400, 4800, 9600, 14_400, 19_200, 28_800, 31_250, 38_400, 57_600, 74_880, 76_800, 115_200,
    128_000, 230_400, 250_000, 256_000, 460_800, 500_000, 576_000, 921_600, 1_000_000, 1_500_000, 2_000_000,
    3_000_000,
];
/// How far a measured rate may be from a usual one: oscillators are that far off.
const NEAR: f64 = 0.02;
/// Least samples per bit.
const LEAST_BIT: f64 = 2.5;
/// Edges that all bit times are tried on, and those that the best of them are measured on.
const TRIED_EDGES: usize = 300;
const MEASURED_EDGES: usize = 4000;
/// From one bit time that is tried to the next.
const STEP: f64 = 1.0 + 1.0 / 128.0;
/// Bit times that are measured.
const MAX_MEASURED: usize = 16;
/// Share of words that may have faults at a rate that fits.
const MAX_FAULTS: f64 = 0.2;
/// Pulses, words and share of faults of a channel that is taken for a line by what it does.
const LINE_PULSES: usize = 12;
const LINE_WORDS: u32 = 3;
const LINE_FAULTS: f64 = 0.05;

/// A rate that fits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// How long a bit is, in the unit of the edges.
    pub bit: f64,
    /// The same as measured, where `bit` is that of a usual rate.
    pub measured: f64,
    /// The usual rate that it is, in bits per second.
    pub usual: Option<u32>,
}

/// Why there is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoRate {
    /// The line does not change.
    NoEdges,
    /// All words have one low pulse of one length, which several usual rates fit; none of them may be meant.
    Ambiguous(Vec<u32>),
    /// No rate fits.
    None,
    /// None fits, but with another format one does.
    Format(Format),
    /// None fits, but one does with the line inverted.
    Inverted,
}

/// How well a bit time fits.
#[derive(Clone, Copy, Debug, Default)]
struct Quality {
    bit: f64,
    words: u32,
    faults: u32,
    /// Faults and pulses too short for a bit, by words.
    share: f64,
    /// Mean square of how far edges are from whole bits, in bits.
    squares: f64,
    /// Of the least squares line: the bit time.
    fitted: Option<f64>,
    /// A bit for each length of low pulses, in bits.
    lows: u32,
    /// Words with more than one low pulse.
    several: u32,
}

impl Quality {
    fn of(edges: &[Edge], bit: f64, format: Format) -> Self {
        let mut found = Self { bit, ..Self::default() };
        let (mut odd, mut counted) = (0_u32, 0_usize);
        let (mut sxx, mut sxy) = (0.0, 0.0);
        each_word(edges.iter().copied(), bit, format, &mut |_, word, more| {
            let fault = format.word(word.levels).1;
            // The last word may be cut off.
            if word.levels & 1 != 0 || fault == Some(Fault::Framing) && !more {
                odd += u32::from(more);
                return;
            }
            found.words += 1;
            odd += u32::from(fault.is_some() || word.met > 0);
            found.faults += u32::from(fault.is_some());
            found.squares += word.squares;
            counted += word.edges - 1;
            (sxx, sxy) = (sxx + word.sxx, sxy + word.sxy);
            found.several += u32::from(word.edges > 2);
            found.lows |= low_lengths(word.levels, format);
        });
        found.share = if found.words == 0 { 1.0 } else { f64::from(odd) / f64::from(found.words) };
        found.squares = if counted == 0 { 1.0 } else { found.squares / counted as f64 };
        found.fitted = (sxx > 0.0).then(|| sxy / sxx);
        found
    }

    /// The bit time that the edges themselves have, and how well it fits.
    fn refined(self, edges: &[Edge], format: Format) -> Self {
        let mut best = self;
        for _ in 0..4 {
            let Some(bit) = best.fitted.filter(|bit| *bit >= LEAST_BIT && *bit != best.bit) else { break };
            let next = Self::of(edges, bit, format);
            if next.cost() > best.cost() {
                break;
            }
            best = next;
        }
        best
    }

    fn cost(&self) -> f64 {
        self.share + 4.0 * self.squares
    }

    fn fits(&self) -> bool {
        // What sampling and slow edges explain.
        let most = 0.02 + 0.25 / (self.bit * self.bit);
        self.words > 0 && self.share <= MAX_FAULTS && self.squares <= most
    }
}

/// The lengths of a word's low pulses as bits of a mask.
fn low_lengths(levels: u16, format: Format) -> u32 {
    let (mut mask, mut length) = (0, 0);
    for bit in 0..format.bits() {
        if levels >> bit & 1 == 0 {
            length += 1;
        } else {
            mask |= u32::from(length > 0) << length;
            length = 0;
        }
    }
    mask
}

/// The rate of a line that is high when idle, in a unit of which `hz` are a second, where that is known.
///
/// # Errors
/// [`NoRate`], with what would help where something does.
pub fn estimate(edges: &[Edge], format: Format, hz: Option<f64>) -> Result<Estimate, NoRate> {
    match best(edges, format, hz) {
        Err(NoRate::None) => {}
        Ok(found) if is_inverted(edges, format, found.measured) => return Err(NoRate::Inverted),
        found => return found,
    }
    let found = |edges: &[Edge], format| best_quality(edges, format).filter(|best| best.share <= LINE_FAULTS);
    let others = ["8E1", "8O1", "7N1", "8N1"].into_iter().filter_map(|text| text.parse().ok());
    if let Some(other) = others.filter(|other| *other != format).find(|other| found(edges, *other).is_some())
    {
        return Err(NoRate::Format(other));
    }
    if found(&inverted(edges), format).is_some() {
        return Err(NoRate::Inverted);
    }
    Err(NoRate::None)
}

/// Whether a line that begins low fits better inverted. Back-to-back text fits nearly as well in the other polarity.
fn is_inverted(edges: &[Edge], format: Format, bit: f64) -> bool {
    if !edges.first().is_some_and(|first| first.high) {
        return false;
    }
    let edges = edges.get(..MEASURED_EDGES).unwrap_or(edges);
    let own = Quality::of(edges, bit, format);
    let ends_low = edges.last().is_some_and(|last| !last.high);
    best_quality(&inverted(edges), format)
        .is_some_and(|other| other.share < own.share || ends_low && other.share <= own.share)
}

fn inverted(edges: &[Edge]) -> Vec<Edge> {
    edges.iter().map(|edge| Edge { high: !edge.high, ..*edge }).collect()
}

fn best(edges: &[Edge], format: Format, hz: Option<f64>) -> Result<Estimate, NoRate> {
    if edges.len() < 2 {
        return Err(NoRate::NoEdges);
    }
    let edges = edges.get(..MEASURED_EDGES).unwrap_or(edges);
    let mut best = best_quality(edges, format).ok_or(NoRate::None)?;
    let near = |quality: &Quality| hz.and_then(|hz| usual(hz, quality.bit));
    if best.lows.count_ones() == 1 && best.several == 0 {
        // One pulse per word, of one length, may be any number of bits.
        let length = best.bit * f64::from(best.lows.trailing_zeros());
        let each = (1..=9).map(|bits| length / f64::from(bits)).filter(|bit| *bit >= LEAST_BIT);
        let fitting = each.map(|bit| Quality::of(edges, bit, format)).filter(Quality::fits);
        let all: Vec<(Quality, u32)> = fitting.filter_map(|each| Some((each, near(&each)?))).collect();
        match all.as_slice() {
            [(only, _)] => best = only.refined(edges, format),
            [] if hz.is_some() => return Err(NoRate::None),
            [] => {}
            several => return Err(NoRate::Ambiguous(several.iter().map(|(_, rate)| *rate).collect())),
        }
    }
    let measured = best.bit;
    let usual = near(&best).filter(|rate| {
        let bit = hz.unwrap_or_default() / f64::from(*rate);
        let words = |bit| {
            let mut words = Vec::new();
            super::decode(edges.iter().copied(), bit, format, |word| words.push((word.byte, word.fault)));
            words
        };
        words(bit) == words(measured)
    });
    let bit = usual.zip(hz).map_or(measured, |(rate, hz)| hz / f64::from(rate));
    Ok(Estimate { bit, measured, usual })
}

/// The usual rate next to a bit time, as near as oscillators, or the samples of a word, explain.
fn usual(hz: f64, bit: f64) -> Option<u32> {
    let rate = hz / bit;
    let off = |usual: &u32| (rate / f64::from(*usual) - 1.0).abs();
    let most = NEAR.max(1.0 / (9.0 * bit));
    USUAL.into_iter().filter(|usual| off(usual) <= most).min_by(|a, b| off(a).total_cmp(&off(b)))
}

/// The bit time that fits best, where one fits.
fn best_quality(edges: &[Edge], format: Format) -> Option<Quality> {
    let tried = edges.get(..TRIED_EDGES).unwrap_or(edges);
    let pulses = tried.iter().zip(tried.iter().skip(1));
    let mut lengths: Vec<u64> = pulses.map(|(from, to)| to.at.saturating_sub(from.at)).collect();
    lengths.sort_unstable();
    // Up to a twentieth of the pulses may be glitches.
    let shortest = *lengths.get(lengths.len() / 20)? as f64;
    let mut bit = (shortest / 10.0).max(LEAST_BIT);
    let mut all = Vec::new();
    while bit <= shortest * 1.35 + 1.5 {
        all.push(Quality::of(tried, bit, format));
        bit *= STEP;
    }
    let cost = |index: usize| all.get(index).map_or(f64::MAX, Quality::cost);
    let mut lowest: Vec<&Quality> = all
        .iter()
        .enumerate()
        .filter(|(index, each)| {
            each.cost() <= index.checked_sub(1).map_or(f64::MAX, cost) && each.cost() <= cost(index + 1)
        })
        .map(|(_, each)| each)
        .collect();
    lowest.sort_by(|a, b| a.cost().total_cmp(&b.cost()).then(b.bit.total_cmp(&a.bit)));
    let measured = edges.get(..MEASURED_EDGES).unwrap_or(edges);
    let refined = |each: &Quality| {
        let first = each.refined(tried, format);
        Quality::of(measured, first.bit, format).refined(measured, format)
    };
    let all: Vec<Quality> = lowest.into_iter().take(MAX_MEASURED).map(refined).collect();
    let best = *all.iter().min_by(|a, b| a.cost().total_cmp(&b.cost()))?;
    // Of those that fit as well the longest bit: shorter ones split each bit in several.
    let as_well = |each: &&Quality| {
        each.share <= best.share + 0.001 && each.squares <= 2.0 * best.squares + 0.2 / (each.bit * each.bit)
    };
    let best = *all.iter().filter(as_well).max_by(|a, b| a.bit.total_cmp(&b.bit))?;
    best.fits().then_some(best)
}

/// Whether a channel is a serial line by what it does, and whether it is inverted: low when idle. Its first level is the
/// opposite of its first edge's. A channel whose active pulses all have one length is none: those are steps.
#[must_use]
pub fn looks_like_a_line(edges: &[Edge]) -> Option<bool> {
    if edges.len() <= LINE_PULSES {
        return None;
    }
    let edges = edges.get(..TRIED_EDGES).unwrap_or(edges);
    let (first, last) = (!edges.first()?.high, edges.last()?.high);
    let quality = |inverts: bool| {
        let turned = if inverts { inverted(edges) } else { edges.to_vec() };
        let best = best_quality(&turned, Format::default()).filter(|best| best.lows > 0)?;
        // Pulses of about one length are those of STEP or an encoder.
        let varies = best.lows.ilog2() * 2 >= best.lows.trailing_zeros() * 3;
        let is_line = best.share <= LINE_FAULTS && best.words >= LINE_WORDS && varies;
        is_line.then_some(best.cost())
    };
    // A channel that begins and ends at one level is idle at it.
    let mut found: Option<(f64, bool)> = None;
    for inverts in [false, true] {
        if first == last && first == inverts {
            continue;
        }
        if let Some(cost) = quality(inverts)
            && found.is_none_or(|(least, _)| cost < least)
        {
            found = Some((cost, inverts));
        }
    }
    found.map(|(_, inverts)| inverts)
}
