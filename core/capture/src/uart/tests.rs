use super::*;

/// A random generator with the same numbers on every machine.
struct Seeded(u64);

impl Seeded {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// From 0 to 1.
    fn part(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The edges of bytes at `bit` samples per bit; `gap` is the pause before each byte in bits, `jitter` moves edges.
fn line(
    bytes: &[u8],
    bit: f64,
    format: Format,
    mut gap: impl FnMut() -> f64,
    mut jitter: impl FnMut() -> i64,
) -> Vec<Edge> {
    let mut edges: Vec<Edge> = Vec::new();
    let (mut at, mut high) = (20.0 * bit, true);
    for byte in bytes {
        at += gap() * bit;
        let ones = u32::from(byte & (((1_u16 << format.data) - 1) as u8)).count_ones();
        let parity = match format.parity {
            Parity::None => None,
            Parity::Even => Some(ones % 2 == 1),
            Parity::Odd => Some(ones % 2 == 0),
        };
        let data = (0..format.data).map(|k| byte >> k & 1 == 1);
        let levels = core::iter::once(false).chain(data).chain(parity);
        for level in levels.chain([true, true].into_iter().take(format.stop.into())) {
            if level != high {
                // The first sample after the edge shows the new level.
                let edge = ((at as u64 + 1) as i64 + jitter()) as u64;
                edges.push(Edge { at: edge, high: level });
                high = level;
            }
            at += bit;
        }
    }
    edges
}

fn decoded(edges: &[Edge], bit: f64, format: Format) -> (Vec<u8>, usize) {
    let (mut bytes, mut faults) = (Vec::new(), 0);
    decode(edges.iter().copied(), bit, format, |word| {
        bytes.push(word.byte);
        faults += usize::from(word.fault.is_some());
    });
    (bytes, faults)
}

#[test]
fn all_bytes_are_decoded_from_4_samples_per_bit_on() {
    let mut seeded = Seeded(7);
    let mut wrong = Vec::new();
    for step in 0..=120 {
        let bit = 4.0 + f64::from(step) / 20.0;
        for count in [12, 60] {
            let bytes: Vec<u8> = (0..count).map(|_| seeded.next() as u8).collect();
            let phase = seeded.part();
            let mut gaps = Seeded(seeded.next());
            let edges =
                line(&bytes, bit, Format::default(), || phase + (gaps.next() % 3) as f64 * gaps.part(), || 0);
            match estimate(&edges, Format::default(), None) {
                Ok(found) if decoded(&edges, found.bit, Format::default()) == (bytes, 0) => {}
                other => wrong.push((bit, count, other)),
            }
        }
    }
    assert!(wrong.is_empty(), "{} {wrong:?}", wrong.len());
}

#[test]
fn edges_with_a_jitter_of_one_sample_are_decoded() {
    let mut seeded = Seeded(11);
    let mut wrong = Vec::new();
    // Below six samples per bit, two edges with this jitter make some words ambiguous: there it is half a sample.
    for step in 0..=120 {
        let bit = 4.0 + f64::from(step) / 20.0;
        let range = if bit < 6.0 { 2 } else { 3 };
        let bytes: Vec<u8> = (0..60).map(|_| seeded.next() as u8).collect();
        let (mut gaps, mut off) = (Seeded(seeded.next()), Seeded(seeded.next()));
        let edges =
            line(&bytes, bit, Format::default(), || gaps.part() * 2.0, || (off.next() % range) as i64 - 1);
        match estimate(&edges, Format::default(), None) {
            Ok(found) if decoded(&edges, found.bit, Format::default()) == (bytes.clone(), 0) => {}
            Ok(found) => {
                let (got, faults) = decoded(&edges, found.bit, Format::default());
                let bad = got.iter().zip(&bytes).filter(|(a, b)| a != b).count();
                wrong.push(format!("{bit} T {} len {} bad {bad} faults {faults}", found.bit, got.len()));
            }
            Err(why) => wrong.push(format!("{bit} {why:?}")),
        }
    }
    assert!(wrong.is_empty(), "{} {wrong:#?}", wrong.len());
}

/// At 4 samples per bit the rate of one word may be 2.8 % off, but not that of fifty: half of 250000 baud is not 128000.
#[test]
fn ambiguous_rates_are_only_those_that_fit() {
    for byte in 0..=255_u8 {
        let edges = line(&[byte; 50], 4.0, Format::default(), || 0.37, || 0);
        if let Err(NoRate::Ambiguous(rates)) = measured(&edges, 1e6) {
            assert!(!rates.contains(&128_000), "{byte:02x} {rates:?}");
            assert!(rates.contains(&250_000), "{byte:02x} {rates:?}");
        }
    }
}

fn measured(edges: &[Edge], hz: f64) -> Result<(Option<u32>, Vec<u8>), NoRate> {
    let found = estimate(edges, Format::default(), Some(hz))?;
    Ok((found.usual, decoded(edges, found.bit, Format::default()).0))
}

#[test]
fn a_few_bytes_are_decoded_if_one_usual_rate_fits() {
    for (bytes, baud, expected) in [
        (&b"U"[..], 9600_u32, Ok(())),
        (b"U", 115_200, Ok(())),
        (b"A", 115_200, Ok(())),
        (b"ok", 250_000, Ok(())),
        (b"\x00", 9600, Ok(())),
        // At 19200 baud this is FE 80.
        (b"\x0f", 9600, Err(NoRate::Ambiguous(vec![9600, 19_200]))),
        (b"\x00\x00\x00", 9600, Ok(())),
        (b"UUUUUUUU", 19_200, Ok(())),
        (b"\x00\xff\x00", 57_600, Ok(())),
        // Nine bits at 115200 baud last as long as three at 38400.
        (b"\x00", 115_200, Err(NoRate::Ambiguous(vec![38_400, 115_200, 76_800]))),
    ] {
        for hz in [1e9, 24e6, 4e6] {
            for gap in [0.4, 13.3] {
                let edges = line(bytes, hz / f64::from(baud), Format::default(), || gap, || 0);
                let expected = expected.clone().map(|()| (Some(baud), bytes.to_vec()));
                assert_eq!(measured(&edges, hz), expected, "{bytes:x?} {baud} {hz} {gap}");
            }
        }
    }
    assert_eq!(measured(&[], 1e6), Err(NoRate::NoEdges));
}

/// Usual rates come before others; if several fit, the result is ambiguous.
#[test]
fn repeated_bytes_are_decoded_or_ambiguous() {
    let mut wrong = Vec::new();
    let (mut decoded, mut ambiguous) = (0, 0);
    for (baud, ratio) in
        [(250_000, 4.0), (115_200, 500.0 / 115.2), (9600, 50.0 / 9.6), (115_200, 8.68), (19_200, 16.0)]
    {
        for (count, together) in [(50, 1), (50, 7), (50, 50), (12, 3), (100, 2)] {
            for byte in (0..=255_u8).step_by(if together == 7 { 1 } else { 5 }) {
                let bytes = vec![byte; count];
                let mut at = 0;
                let gap = || {
                    at += 1;
                    if together < 50 && at % together == 0 { 50.37 } else { 0.0 }
                };
                let edges = line(&bytes, ratio, Format::default(), gap, || 0);
                match measured(&edges, f64::from(baud) * ratio) {
                    Ok((Some(usual), found)) if usual == baud && found == bytes => decoded += 1,
                    Err(NoRate::Ambiguous(rates)) if rates.contains(&baud) => ambiguous += 1,
                    other => wrong.push(format!(
                        "{baud} {ratio} {count} {together} {byte:02x} {:?}",
                        other.map(|(rate, bytes)| (rate, bytes.len(), bytes.first().copied()))
                    )),
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {decoded} and {ambiguous} {wrong:#?}", wrong.len());
    assert!(decoded > 3 * ambiguous, "{decoded} {ambiguous}");
}

#[test]
fn random_bytes_at_any_ratio_are_decoded_without_a_baud_rate() {
    let mut seeded = Seeded(5);
    for step in 0..240 {
        let ratio = 4.0 + f64::from(step) / 20.0;
        let bytes: Vec<u8> = (0..8).map(|_| seeded.next() as u8).collect();
        let mut gaps = Seeded(seeded.next());
        let edges = line(&bytes, ratio, Format::default(), || gaps.part() * 3.0, || 0);
        assert_eq!(measured(&edges, 115_200.0 * ratio), Ok((Some(115_200), bytes)), "{ratio}");
    }
}

#[test]
fn an_unusual_rate_is_accepted() {
    let bytes: Vec<u8> = (0..50).map(|k: u8| k.wrapping_mul(73)).collect();
    for (baud, usual) in [(187_500.0, None), (140_000.0, None), (117_000.0, Some(115_200)), (10_400.0, None)]
    {
        let edges = line(&bytes, 8e6 / baud, Format::default(), || 0.0, || 0);
        let found = estimate(&edges, Format::default(), Some(8e6)).expect("it fits");
        assert_eq!(found.usual, usual, "{baud}");
        assert!((8e6 / found.measured / baud - 1.0).abs() < 1e-3, "{found:?}");
        assert_eq!(decoded(&edges, found.bit, Format::default()), (bytes.clone(), 0));
    }
}

#[test]
fn all_formats_are_decoded_and_a_wrong_format_is_corrected() {
    let text: Vec<u8> = b"Hello, World! M114 X:12.50 Y:0.00\r\n".iter().copied().cycle().take(120).collect();
    for (format, gap, proposed) in [
        ("8N1", 0.0, None),
        ("8N2", 0.0, None),
        ("7E1", 0.0, None),
        ("7O2", 0.3, None),
        ("8E1", 0.0, Some("8E1")),
        ("8E1", 0.7, Some("8E1")),
        ("8O1", 3.3, Some("8O1")),
        ("8O2", 0.0, Some("8O1")),
        ("7N1", 0.0, Some("7N1")),
    ] {
        let kind: Format = format.parse().expect("a format");
        assert_eq!(kind.to_string(), format);
        for bit in [4.7, 8.68, 104.0] {
            let edges = line(&text, bit, kind, || gap, || 0);
            let found = estimate(&edges, kind, None).expect("it fits");
            assert_eq!(decoded(&edges, found.bit, kind), (text.clone(), 0), "{format} {bit}");
            let as_8n1 = estimate(&edges, Format::default(), None).map(|_| ());
            let expected = proposed.map_or(Ok(()), |text| Err(NoRate::Format(text.parse().expect("one"))));
            assert_eq!(as_8n1, expected, "{format} {gap} {bit}");
        }
    }
    for text in ["", "8", "9N1", "8X1", "8N3", "8N0", "8N11", "6E1"] {
        assert!(text.parse::<Format>().is_err(), "{text}");
    }
    assert_eq!("7e2".parse::<Format>().map(|format| format.to_string()), Ok("7E2".into()));
}

#[test]
fn an_inverted_line_is_detected_and_noise_is_not_a_line() {
    let mut seeded = Seeded(3);
    let bytes: Vec<u8> = (0..80).map(|_| seeded.next() as u8).collect();
    let edges = line(&bytes, 20.0, Format::default(), || 1.7, || 0);
    let turned: Vec<Edge> = edges.iter().map(|edge| Edge { high: !edge.high, ..*edge }).collect();
    assert_eq!(estimate(&turned, Format::default(), None), Err(NoRate::Inverted));
    assert_eq!((detect_line(&edges), detect_line(&turned)), (Some(IdleLevel::High), Some(IdleLevel::Low)));
    for seed in 0..20 {
        let (mut seeded, mut at) = (Seeded(seed), 0);
        let noise: Vec<Edge> = (0..400)
            .map(|k| {
                at += 20 + seeded.next() % 400;
                Edge { at, high: k % 2 == 1 }
            })
            .collect();
        assert_eq!(estimate(&noise, Format::default(), Some(1e6)), Err(NoRate::NoFit), "{seed}");
    }
}

#[test]
fn step_pulses_are_not_a_line() {
    // Pulses of one width at a constant rate, square waves and a ramp, with both polarities.
    for (width, interval) in [(10.0, 40.0), (50.0, 100.0), (2.0, 9.0), (20.0, 220.0)] {
        for accelerates in [0.0, 0.01, 0.3] {
            let mut at = 100.0;
            let mut edges = Vec::new();
            for k in 0..200 {
                let now = interval * (1.0 + accelerates * f64::from(200 - k));
                edges.push(Edge { at: at as u64, high: true });
                // Some firmware has pulses of half the interval.
                let high = if width * 2.0 >= interval { now / 2.0 } else { width };
                edges.push(Edge { at: (at + high) as u64, high: false });
                at += now;
            }
            let turned: Vec<Edge> = edges.iter().map(|edge| Edge { high: !edge.high, ..*edge }).collect();
            let found = (detect_line(&edges), detect_line(&turned));
            assert_eq!(found, (None, None), "{width} {interval} {accelerates}");
        }
    }
}

#[test]
fn rates_of_125000_and_128000_baud_are_distinguished() {
    let bytes: Vec<u8> = (0..60_u8).map(|k| k.wrapping_mul(73) ^ 0x55).collect();
    for hz in [1e6, 4e6, 24e6, 1e9] {
        for (baud, gap) in [(125_000_u32, 0.3), (125_000, 2.0), (128_000, 0.3), (250_000, 0.3)] {
            if hz / f64::from(baud) < 4.0 {
                continue;
            }
            let edges = line(&bytes, hz / f64::from(baud), Format::default(), || gap, || 0);
            assert_eq!(measured(&edges, hz), Ok((Some(baud), bytes.clone())), "{baud} {hz} {gap}");
        }
    }
}

/// Times in whole microseconds give two ticks per bit at 500000 baud and less at higher rates.
#[test]
fn too_few_ticks_per_bit_are_an_error() {
    let text = b"G1 X10.25 Y-3.5 F1200\r\nok\r\nG28\r\n";
    let mixed: Vec<u8> = (0..60_u8).map(|k| k.wrapping_mul(73) ^ 0x55).collect();
    for bytes in [&text[..], &mixed, b"UUUUUUUU", &[0x33; 20], &[0x0f, 0xc3, 0x3c, 0xff, 0x03]] {
        for baud in [460_800_u32, 500_000, 921_600] {
            for gap in [0.0, 0.37, 7.9] {
                let edges = line(bytes, 1e6 / f64::from(baud), Format::default(), || gap, || 0);
                let found = measured(&edges, 1e6);
                let is_coarse = found == Err(NoRate::TooCoarse);
                // With about one tick per bit, some lines fit no rate at all.
                assert!(is_coarse || baud > 900_000 && found.is_err(), "{bytes:x?} {baud} {gap}: {found:?}");
            }
        }
    }
}

#[test]
fn two_bytes_are_decoded_at_their_rate() {
    use crate::uart::{Edge, Format, Word, decode, estimate};

    // 'U' and 'A', 8.68 samples per bit.
    let mut edges = Vec::new();
    let mut high = true;
    for (start, byte) in [(100.0, 0x55_u16), (200.0, 0x41)] {
        for (k, bit) in (0..10).map(|k| (k, (byte << 1 | 0x200) >> k & 1 == 1)) {
            if bit != high {
                edges.push(Edge { at: (start + 8.68 * f64::from(k)) as u64, high: bit });
                high = bit;
            }
        }
    }
    let found = estimate(&edges, Format::default(), Some(1e6)).expect("a rate fits");
    assert_eq!(found.usual, Some(115_200));
    let mut bytes = Vec::new();
    decode(edges, found.bit, Format::default(), |word: Word| bytes.push(word.byte));
    assert_eq!(bytes, [0x55, 0x41]);
}
