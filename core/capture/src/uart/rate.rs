//! Estimates a line's bit rate: the bit time that fits most words and edges.

use super::{Edge, Fault, FittedWord, Format, fit_words};
use crate::short_sort::ShortSort as _;
use std::collections::BTreeSet;

const USUAL: [u32; 27] = [
    300, 1200, 2400, 4800, 9600, 14_400, 19_200, 28_800, 31_250, 38_400, 57_600, 74_880, 76_800, 115_200,
    125_000, 128_000, 230_400, 250_000, 256_000, 460_800, 500_000, 576_000, 921_600, 1_000_000, 1_500_000,
    2_000_000, 3_000_000,
];
/// Five times the far more usual 115200, so it is used only if no other rate fits.
const LAST_RESORT: u32 = 576_000;
/// Rare rates come last in an ambiguous result.
const RARE_RATES: [u32; 9] = [14_400, 28_800, 31_250, 74_880, 76_800, 125_000, 128_000, 256_000, LAST_RESORT];
/// Maximum deviation of a measured rate from a usual one: oscillators' tolerance.
const MAX_DEVIATION: f64 = 0.02;
/// Minimum samples per bit.
const MIN_BIT: f64 = 2.5;
/// Edges on which all bit times are tried, and on which the best are measured.
const TRIED_EDGES: usize = 300;
const MEASURED_EDGES: usize = 4000;
/// Ratio of consecutive trial bit times.
const BIT_RATIO: f64 = 1.0 + 1.0 / 128.0;
/// Maximum number of bit times that are measured on more edges.
const MAX_MEASURED: usize = 16;
/// Maximum share of faulty words.
const MAX_FAULTS: f64 = 0.2;
/// Minimum number of different bytes to accept an unusual rate.
const MIN_VALUES: usize = 3;
/// An event with a probability of less than one in this number is no coincidence.
const MIN_IMPROBABILITY: u64 = 64;
/// Minimum pulses and words, and maximum share of faults, of a channel detected as a line.
const LINE_PULSES: usize = 12;
const LINE_WORDS: u32 = 3;
const LINE_FAULTS: f64 = 0.05;

/// The bit rate of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Length of a bit, in the unit of the edges.
    pub bit: f64,
    /// Measured length of a bit, without rounding to a usual rate.
    pub measured: f64,
    /// Usual rate in bit/s.
    pub usual: Option<u32>,
}

/// Why no bit rate was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoRate {
    /// The line has fewer than two edges.
    NoEdges,
    /// Several usual rates fit with different bytes; the nearest and most usual is first.
    Ambiguous(Vec<u32>),
    /// The best fit has too few samples per bit.
    TooCoarse,
    /// No rate fits.
    NoFit,
    /// A rate fits only with this format.
    Format(Format),
    /// A rate fits only if the line is inverted.
    Inverted,
}

/// Idle level of a line; a line that idles low is inverted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum IdleLevel {
    High,
    Low,
}

/// How well a bit time fits a line.
#[derive(Clone, Copy, Debug, Default)]
struct Quality {
    bit: f64,
    words: u32,
    /// Faulty words and too short pulses, per word.
    fault_share: f64,
    /// Mean square distance of edges from whole bits, in bits.
    mean_square: f64,
    /// The bit time of the least squares line.
    refined_bit: Option<f64>,
    /// Lengths of low pulses: bit n is set for n bits.
    low_lengths: u32,
}

impl Quality {
    fn measure(edges: &[Edge], bit: f64, format: Format) -> Self {
        let mut found = Self { bit, ..Self::default() };
        let (mut faults, mut edge_count, mut squares) = (0_u32, 0_usize, 0.0);
        let (mut sxx, mut sxy) = (0.0, 0.0);
        fit_words(edges.iter().copied(), bit, format, &mut |word: &FittedWord| {
            let fault = format.word(word.levels).1;
            // The end of the recording may truncate the last word.
            if word.levels & 1 != 0 || fault == Some(Fault::Framing) && !word.has_next {
                faults += u32::from(word.has_next);
                return;
            }
            found.words += 1;
            faults += u32::from(fault.is_some() || word.coincident > 0);
            squares += word.squares;
            edge_count += word.edges - 1;
            (sxx, sxy) = (sxx + word.sxx, sxy + word.sxy);
            found.low_lengths |= low_lengths(word.levels, format);
        });
        found.fault_share = if found.words == 0 { 1.0 } else { f64::from(faults) / f64::from(found.words) };
        found.mean_square = if edge_count == 0 { 1.0 } else { squares / edge_count as f64 };
        found.refined_bit = (sxx > 0.0).then(|| sxy / sxx);
        found
    }

    /// Follows the least squares bit time while it fits better.
    fn refined(self, edges: &[Edge], format: Format) -> Self {
        let mut best = self;
        for _ in 0..4 {
            let Some(bit) = best.refined_bit.filter(|bit| *bit >= MIN_BIT && *bit != best.bit) else { break };
            let next = Self::measure(edges, bit, format);
            if next.cost() > best.cost() {
                break;
            }
            best = next;
        }
        best
    }

    fn cost(&self) -> f64 {
        self.fault_share + 4.0 * self.mean_square
    }

    fn fits(&self) -> bool {
        // The errors of slow edges and of sampling.
        let max_mean_square = 0.02 + 0.25 / (self.bit * self.bit);
        self.words > 0 && self.fault_share <= MAX_FAULTS && self.mean_square <= max_mean_square
    }

    /// Whether it has no more faults than `best`, and sampling explains the larger distances of its edges.
    fn fits_as_well_as(&self, best: &Self) -> bool {
        self.fault_share <= best.fault_share + 0.001
            && self.mean_square <= 2.0 * best.mean_square + 0.2 / (self.bit * self.bit)
    }
}

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

/// Estimates the rate of a line that idles high. `hz` is the number of units of the edges per second, if known.
/// Errors: [`NoRate`], with the format or polarity that would fit.
pub fn estimate(edges: &[Edge], format: Format, hz: Option<f64>) -> Result<Estimate, NoRate> {
    match best(edges, format, hz) {
        Err(NoRate::NoFit) => {}
        Ok(found) if is_inverted(edges, format, found.measured) => return Err(NoRate::Inverted),
        found => return found,
    }
    let is_line = |edges: &[Edge], format| {
        best_quality(edges, format).is_some_and(|best| best.fault_share <= LINE_FAULTS)
    };
    let others = ["8E1", "8O1", "7N1", "8N1"].into_iter().filter_map(|text| text.parse().ok());
    if let Some(other) = others.filter(|other| *other != format).find(|other| is_line(edges, *other)) {
        return Err(NoRate::Format(other));
    }
    Err(if is_line(&inverted(edges), format) { NoRate::Inverted } else { NoRate::NoFit })
}

/// Whether the inverted line fits better. Back-to-back text fits nearly as well with either polarity.
fn is_inverted(edges: &[Edge], format: Format, bit: f64) -> bool {
    if !edges.first().is_some_and(|first| first.high) {
        return false;
    }
    let edges = edges.get(..MEASURED_EDGES).unwrap_or(edges);
    let own = Quality::measure(edges, bit, format);
    let ends_low = edges.last().is_some_and(|last| !last.high);
    best_quality(&inverted(edges), format).is_some_and(|other| {
        other.fault_share < own.fault_share || ends_low && other.fault_share <= own.fault_share
    })
}

fn inverted(edges: &[Edge]) -> Vec<Edge> {
    edges.iter().map(|edge| Edge { high: !edge.high, ..*edge }).collect()
}

fn best(edges: &[Edge], format: Format, hz: Option<f64>) -> Result<Estimate, NoRate> {
    if edges.len() < 2 {
        return Err(NoRate::NoEdges);
    }
    let edges = edges.get(..MEASURED_EDGES).unwrap_or(edges);
    let best = best_quality(edges, format);
    if is_too_coarse(edges, format, best) {
        return Err(NoRate::TooCoarse);
    }
    let mut best = best.ok_or(NoRate::NoFit)?;
    if let Some(hz) = hz {
        let fitting = fitting_usual(edges, format, hz, &best);
        match fitting.as_slice() {
            [(only, _)] => best = *only,
            [] if words(edges, best.bit, format).values() < MIN_VALUES => return Err(NoRate::NoFit),
            [] => {}
            several => return Err(NoRate::Ambiguous(by_distance(several, hz))),
        }
    }
    let measured = best.bit;
    let usual = hz.and_then(|hz| usual(hz, &best)).filter(|rate| {
        let bit = hz.unwrap_or_default() / f64::from(*rate);
        words(edges, bit, format) == words(edges, measured, format)
    });
    let bit = usual.zip(hz).map_or(measured, |(rate, hz)| hz / f64::from(rate));
    Ok(Estimate { bit, measured, usual })
}

/// Whether a bit shorter than [`MIN_BIT`] fits at least as well. A line with more samples per bit has longer pulses.
fn is_too_coarse(edges: &[Edge], format: Format, best: Option<Quality>) -> bool {
    let tried = edges.get(..TRIED_EDGES).unwrap_or(edges);
    if shortest_pulse(tried).is_none_or(|shortest| shortest > MIN_BIT) {
        return false;
    }
    let max_share = best.map_or(LINE_FAULTS, |best| best.fault_share.min(LINE_FAULTS));
    core::iter::successors(Some(1.0), |bit| Some(bit * BIT_RATIO)).take_while(|bit| *bit < MIN_BIT).any(
        |bit| {
            let found = Quality::measure(tried, bit, format);
            found.fits() && found.fault_share <= max_share
        },
    )
}

#[derive(PartialEq)]
struct Words(Vec<(u8, Option<Fault>)>);

impl Words {
    /// Number of different bytes.
    fn values(&self) -> usize {
        self.0.iter().map(|(byte, _)| *byte).collect::<BTreeSet<u8>>().len()
    }

    fn is_text(&self) -> bool {
        let is_text = |(byte, fault): &(u8, Option<Fault>)| {
            fault.is_none() && matches!(byte, b' '..=b'~' | b'\r' | b'\n' | b'\t')
        };
        self.values() > 1 && self.0.iter().all(is_text)
    }
}

fn words(edges: &[Edge], bit: f64, format: Format) -> Words {
    let mut words = Vec::new();
    super::decode(edges.iter().copied(), bit, format, |word| words.push((word.byte, word.fault)));
    Words(words)
}

/// Usual rates that fit about as well as the best bit time, with different bytes.
fn fitting_usual(edges: &[Edge], format: Format, hz: f64, best: &Quality) -> Vec<(Quality, u32)> {
    let tried = edges.get(..TRIED_EDGES).unwrap_or(edges);
    let fit = |rate: &u32| {
        let bit = hz / f64::from(*rate);
        if usual(hz, best) == Some(*rate) {
            return Some((*best, *rate));
        }
        if bit < MIN_BIT {
            return None;
        }
        let trial = Quality::measure(tried, bit, format).refined(tried, format);
        if !trial.fits() {
            return None;
        }
        let own = Quality::measure(edges, trial.bit, format).refined(edges, format);
        let fits = own.fits() && own.fits_as_well_as(best) && usual(hz, &own) == Some(*rate);
        fits.then_some((own, *rate))
    };
    let mut found: Vec<(Quality, u32)> = USUAL.iter().filter_map(fit).collect();
    found.dedup_by(|next, before| words(edges, next.0.bit, format) == words(edges, before.0.bit, format));
    // Pauses do not exclude the lowest rate.
    if let Some((lowest, rate)) = found.first().copied() {
        let is_likely = |(own, other): &(Quality, u32)| {
            *other == rate
                || *other != LAST_RESORT && !is_too_fast(tried, own.bit, lowest.bit / own.bit, format)
        };
        found.retain(is_likely);
    }
    let is_text = |(own, _): &&(Quality, u32)| words(edges, own.bit, format).is_text();
    let mut texts = found.iter().filter(is_text);
    if let (Some(only), None) = (texts.next(), texts.next()) {
        return vec![*only];
    }
    found
}

/// Whether the rate is `multiple` times the correct one: edges fall only on every second, third or fourth bit more often
/// than by chance, or most words are followed by a short pause.
fn is_too_fast(edges: &[Edge], bit: f64, multiple: f64, format: Format) -> bool {
    let mut different = BTreeSet::new();
    // From six times on, nearly each low bit of the lower rate is a word.
    let max_pause = if multiple > 5.5 { 9.0 * multiple } else { 10.0 };
    let (mut last, mut pauses, mut others) = (None, 0, 0);
    fit_words(edges.iter().copied(), bit, format, &mut |word: &FittedWord| {
        // Repeated words count once.
        different.insert(word.levels);
        if let Some(last) = last.replace(word.start) {
            let pause = (word.start - last) as f64 / bit - f64::from(format.bits());
            *(if (1.3..max_pause).contains(&pause) { &mut pauses } else { &mut others }) += 1;
        }
    });
    let edge_bits = || {
        different.iter().flat_map(|levels| {
            (1..format.bits()).filter(move |at| (levels >> at ^ levels >> (at - 1)) & 1 == 1)
        })
    };
    let is_multiple = |divisor: u8| {
        let on = edge_bits().filter(|at| at % divisor == 0).count();
        let off = edge_bits().count() - on;
        // Some edges may be starts of next words. By chance, one edge in `divisor` is at such a bit.
        let excess = on.saturating_sub(4 * off) as u32;
        u64::from(divisor).saturating_pow(excess) >= MIN_IMPROBABILITY
    };
    pauses > others || (2..=4).any(is_multiple)
}

/// The nearest usual rate within the tolerance of oscillators, or of the measurement.
fn usual(hz: f64, found: &Quality) -> Option<u32> {
    let deviation = |usual: &u32| distance(hz, found.bit, *usual);
    let is_near = |deviation: f64| {
        // A word measures nine bits to one sample; the error falls with the root of the number of words.
        let samples = deviation * 9.0 * found.bit;
        deviation <= MAX_DEVIATION || samples * samples * f64::from(found.words) <= 1.0
    };
    let near = USUAL.into_iter().filter(|usual| is_near(deviation(usual)));
    near.min_by(|a, b| deviation(a).total_cmp(&deviation(b)))
}

/// Relative deviation of a rate.
fn distance(hz: f64, bit: f64, rate: u32) -> f64 {
    (hz / bit / f64::from(rate) - 1.0).abs()
}

fn by_distance(fitting: &[(Quality, u32)], hz: f64) -> Vec<u32> {
    let mut rates: Vec<(u32, bool, u32)> = fitting
        .iter()
        .map(|(found, rate)| {
            ((100.0 * distance(hz, found.bit, *rate) + 0.5) as u32, RARE_RATES.contains(rate), *rate)
        })
        .collect();
    rates.sort_short_by_key(|rate| *rate);
    rates.into_iter().map(|(.., rate)| rate).collect()
}

/// Length of the shortest pulse; up to a twentieth of the pulses may be shorter glitches.
fn shortest_pulse(edges: &[Edge]) -> Option<f64> {
    let pulses = edges.iter().zip(edges.iter().skip(1));
    let mut lengths: Vec<u64> = pulses.map(|(from, to)| to.at.saturating_sub(from.at)).collect();
    lengths.sort_unstable();
    lengths.get(lengths.len() / 20).map(|length| *length as f64)
}

/// The best of all bit times that the shortest pulse allows.
fn best_quality(edges: &[Edge], format: Format) -> Option<Quality> {
    let tried = edges.get(..TRIED_EDGES).unwrap_or(edges);
    let shortest = shortest_pulse(tried)?;
    let mut bit = (shortest / 10.0).max(MIN_BIT);
    let mut all = Vec::new();
    while bit <= shortest * 1.35 + 1.5 {
        all.push(Quality::measure(tried, bit, format));
        bit *= BIT_RATIO;
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
        Quality::measure(measured, first.bit, format).refined(measured, format)
    };
    let all: Vec<Quality> = lowest.into_iter().take(MAX_MEASURED).map(refined).collect();
    let best = *all.iter().min_by(|a, b| a.cost().total_cmp(&b.cost()))?;
    // Of similar fits the longest bit is correct: fractions of it split each bit.
    let best =
        *all.iter().filter(|each| each.fits_as_well_as(&best)).max_by(|a, b| a.bit.total_cmp(&b.bit))?;
    best.fits().then_some(best)
}

/// Detects a serial line by its edges. Pulses of about one length are those of BIT_RATIO or an encoder.
pub(crate) fn detect_line(edges: &[Edge]) -> Option<IdleLevel> {
    if edges.len() <= LINE_PULSES {
        return None;
    }
    let edges = edges.get(..TRIED_EDGES).unwrap_or(edges);
    let (starts_high, ends_high) = (!edges.first()?.high, edges.last()?.high);
    let cost = |idle: IdleLevel| {
        let normal = if idle == IdleLevel::Low { inverted(edges) } else { edges.to_vec() };
        let best = best_quality(&normal, Format::default()).filter(|best| best.low_lengths > 0)?;
        let (max_length, min_length) = (best.low_lengths.ilog2(), best.low_lengths.trailing_zeros());
        let is_line = best.fault_share <= LINE_FAULTS && best.words >= LINE_WORDS;
        (is_line && max_length * 2 >= min_length * 3).then_some(best.cost())
    };
    let mut found: Option<(f64, IdleLevel)> = None;
    for idle in [IdleLevel::High, IdleLevel::Low] {
        // A channel that starts and ends at one level idles at it.
        if starts_high == ends_high && starts_high != (idle == IdleLevel::High) {
            continue;
        }
        if let Some(cost) = cost(idle)
            && found.is_none_or(|(min_cost, _)| cost < min_cost)
        {
            found = Some((cost, idle));
        }
    }
    found.map(|(_, idle)| idle)
}
