//! Estimates a line's bit rate: the bit time that fits most words and edges.

use super::{Edge, Fault, Format, each_word};
use std::collections::BTreeSet;

const USUAL: [u32; 27] = [
    300, 1200, 2400, 4800, 9600, 14_400, 19_200, 28_800, 31_250, 38_400, 57_600, 74_880, 76_800, 115_200,
    125_000, 128_000, 230_400, 250_000, 256_000, 460_800, 500_000, 576_000, 921_600, 1_000_000, 1_500_000,
    2_000_000, 3_000_000,
];
/// Five times a far more usual rate, so it is used only if no other fits.
const RARE: u32 = 576_000;
/// Rare rates come last in an ambiguous result.
const SELDOM: [u32; 9] = [14_400, 28_800, 31_250, 74_880, 76_800, 125_000, 128_000, 256_000, RARE];
/// Maximum deviation of a measured rate from a usual one: oscillators' tolerance.
const NEAR: f64 = 0.02;
/// Minimum samples per bit.
const MIN_BIT: f64 = 2.5;
/// Edges on which all bit times are tried, and on which the best are measured.
const TRIED_EDGES: usize = 300;
const MEASURED_EDGES: usize = 4000;
/// Ratio of consecutive trial bit times.
const STEP: f64 = 1.0 + 1.0 / 128.0;
const MAX_MEASURED: usize = 16;
/// Maximum share of faulty words.
const MAX_FAULTS: f64 = 0.2;
/// Minimum number of different bytes to accept an unusual rate.
const MIN_VALUES: usize = 3;
/// An event with a probability of one in this number is no coincidence.
const NO_CHANCE: u64 = 64;
/// Minimum pulses and words, and maximum share of faults, of a channel detected as a line.
const LINE_PULSES: usize = 12;
const LINE_WORDS: u32 = 3;
const LINE_FAULTS: f64 = 0.05;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Length of a bit, in the unit of the edges.
    pub bit: f64,
    /// Measured length of a bit, before it was rounded to a usual rate.
    pub measured: f64,
    /// Usual rate in bit/s.
    pub usual: Option<u32>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoRate {
    NoEdges,
    /// Several usual rates fit with different bytes; the nearest and most usual is first.
    Ambiguous(Vec<u32>),
    /// The best fit has too few samples per bit.
    TooCoarse,
    None,
    Format(Format),
    Inverted,
}

#[derive(Clone, Copy, Debug, Default)]
struct Quality {
    bit: f64,
    words: u32,
    faults: u32,
    /// Faults and too short pulses, per word.
    share: f64,
    /// Mean square distance of edges from whole bits, in bits.
    squares: f64,
    /// The bit time of the least squares line.
    fitted: Option<f64>,
    /// One bit per length of low pulses, in bits.
    lows: u32,
}

impl Quality {
    fn of(edges: &[Edge], bit: f64, format: Format) -> Self {
        let mut found = Self { bit, ..Self::default() };
        let (mut odd, mut counted) = (0_u32, 0_usize);
        let (mut sxx, mut sxy) = (0.0, 0.0);
        each_word(edges.iter().copied(), bit, format, &mut |_, word, more| {
            let fault = format.word(word.levels).1;
            // The recording may cut off the last word.
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
            found.lows |= low_lengths(word.levels, format);
        });
        found.share = if found.words == 0 { 1.0 } else { f64::from(odd) / f64::from(found.words) };
        found.squares = if counted == 0 { 1.0 } else { found.squares / counted as f64 };
        found.fitted = (sxx > 0.0).then(|| sxy / sxx);
        found
    }

    fn refined(self, edges: &[Edge], format: Format) -> Self {
        let mut best = self;
        for _ in 0..4 {
            let Some(bit) = best.fitted.filter(|bit| *bit >= MIN_BIT && *bit != best.bit) else { break };
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
        // The error of sampling and slow edges.
        let max_squares = 0.02 + 0.25 / (self.bit * self.bit);
        self.words > 0 && self.share <= MAX_FAULTS && self.squares <= max_squares
    }

    /// No more faults than `best`, and edges off by no more than sampling explains.
    fn fits_as_well_as(&self, best: &Self) -> bool {
        self.share <= best.share + 0.001 && self.squares <= 2.0 * best.squares + 0.2 / (self.bit * self.bit)
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

/// Estimates the rate of a line that is high when idle. `hz` converts the unit of edges to seconds, if known.
/// Errors: [`NoRate`], with what would help where something does.
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

/// Back-to-back text fits nearly as well with inverted polarity.
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
    let best = best_quality(edges, format);
    if is_too_coarse(edges, format, best) {
        return Err(NoRate::TooCoarse);
    }
    let mut best = best.ok_or(NoRate::None)?;
    if let Some(hz) = hz {
        let fitting = fitting_usual(edges, format, hz, &best);
        match fitting.as_slice() {
            [(only, _)] => best = *only,
            [] if words(edges, best.bit, format).values() < MIN_VALUES => return Err(NoRate::None),
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
    let max_share = best.map_or(LINE_FAULTS, |best| best.share.min(LINE_FAULTS));
    core::iter::successors(Some(1.0), |bit| Some(bit * STEP)).take_while(|bit| *bit < MIN_BIT).any(|bit| {
        let found = Quality::of(tried, bit, format);
        found.fits() && found.share <= max_share
    })
}

#[derive(PartialEq)]
struct Words(Vec<(u8, Option<Fault>)>);

impl Words {
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

/// Usual rates that fit about as well as the best bit time, with different bytes. Few different bytes may fit
/// several, so all usual rates are tried.
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
        let first = Quality::of(tried, bit, format).refined(tried, format);
        if !first.fits() {
            return None;
        }
        let own = Quality::of(edges, first.bit, format).refined(edges, format);
        let fits = own.fits() && own.fits_as_well_as(best) && usual(hz, &own) == Some(*rate);
        fits.then_some((own, *rate))
    };
    let mut found: Vec<(Quality, u32)> = USUAL.iter().filter_map(fit).collect();
    found.dedup_by(|next, before| words(edges, next.0.bit, format) == words(edges, before.0.bit, format));
    // The lowest may be right despite pauses.
    if let Some((lowest, rate)) = found.first().copied() {
        let is_likely = |(own, other): &(Quality, u32)| {
            *other == rate || *other != RARE && !is_too_fast(tried, own.bit, lowest.bit / own.bit, format)
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

/// Whether the rate is a multiple of the right one: edges fall only on every second or third bit more often than by
/// chance, or most words are followed by a short pause.
fn is_too_fast(edges: &[Edge], bit: f64, times: f64, format: Format) -> bool {
    let mut different = BTreeSet::new();
    // From six times on nearly each low bit of the lower rate is a word.
    let short = if times > 5.5 { 9.0 * times } else { 10.0 };
    let (mut before, mut pauses, mut others) = (None, 0, 0);
    each_word(edges.iter().copied(), bit, format, &mut |start, word, _| {
        // Words that are repeated count once.
        different.insert(word.levels);
        if let Some(before) = before.replace(start) {
            let pause = (start - before) as f64 / bit - f64::from(format.bits());
            *(if (1.3..short).contains(&pause) { &mut pauses } else { &mut others }) += 1;
        }
    });
    let places = || {
        different.iter().flat_map(|levels| {
            (1..format.bits()).filter(move |at| (levels >> at ^ levels >> (at - 1)) & 1 == 1)
        })
    };
    let is_multiple = |divisor: u8| {
        let on = places().filter(|at| at % divisor == 0).count();
        let off = places().count() - on;
        // The start of the next word may lie anywhere. One edge of `divisor` is at such a bit by chance.
        let more = on.saturating_sub(4 * off) as u32;
        u64::from(divisor).saturating_pow(more) >= NO_CHANCE
    };
    pauses > others || (2..=4).any(is_multiple)
}

fn usual(hz: f64, found: &Quality) -> Option<u32> {
    let off = |usual: &u32| distance(hz, found.bit, *usual);
    // A word measures its bit time to a sample in nine bits; many words do so better by the root of their number.
    let by_samples = |off: f64| off * 9.0 * found.bit;
    let is_near = |off: f64| off <= NEAR || by_samples(off) * by_samples(off) * f64::from(found.words) <= 1.0;
    USUAL.into_iter().filter(|usual| is_near(off(usual))).min_by(|a, b| off(a).total_cmp(&off(b)))
}

fn distance(hz: f64, bit: f64, rate: u32) -> f64 {
    (hz / bit / f64::from(rate) - 1.0).abs()
}

fn by_distance(fitting: &[(Quality, u32)], hz: f64) -> Vec<u32> {
    let mut rates: Vec<(u32, bool, u32)> = fitting
        .iter()
        .map(|(found, rate)| {
            ((100.0 * distance(hz, found.bit, *rate) + 0.5) as u32, SELDOM.contains(rate), *rate)
        })
        .collect();
    rates.sort_unstable();
    rates.into_iter().map(|(.., rate)| rate).collect()
}

/// Length of the shortest pulse; up to a twentieth of the pulses may be shorter glitches.
fn shortest_pulse(edges: &[Edge]) -> Option<f64> {
    let pulses = edges.iter().zip(edges.iter().skip(1));
    let mut lengths: Vec<u64> = pulses.map(|(from, to)| to.at.saturating_sub(from.at)).collect();
    lengths.sort_unstable();
    lengths.get(lengths.len() / 20).map(|length| *length as f64)
}

fn best_quality(edges: &[Edge], format: Format) -> Option<Quality> {
    let tried = edges.get(..TRIED_EDGES).unwrap_or(edges);
    let shortest = shortest_pulse(tried)?;
    let mut bit = (shortest / 10.0).max(MIN_BIT);
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
    let best =
        *all.iter().filter(|each| each.fits_as_well_as(&best)).max_by(|a, b| a.bit.total_cmp(&b.bit))?;
    best.fits().then_some(best)
}

/// Detects a serial line by its edges; returns whether it is inverted (low when idle). A channel whose active pulses
/// all have one length carries steps.
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
