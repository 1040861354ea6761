//! Compares shapers with numbers of 30 digits, and the recommendation with an exhaustive search.

use super::*;

#[test]
fn mzv_has_the_numbers_of_klipper() {
    let shaper = Shaper::new(ShaperKind::Mzv, 45.0, 0.1);
    let found: Vec<f64> = shaper.impulses().iter().flat_map(|i| [i.amplitude, i.time_s * 1000.0]).collect();
    let rest = [shaper.residual(36.0, 0.1) * 100.0, shaper.smoothing(5000.0, 5.0)];
    let found = found.into_iter().chain(rest).chain([shaper.max_acceleration(0.12, 5.0)]);
    let expected = [0.365_128, 0.0, 0.407_489, 8.3753, 0.227_383, 16.7506, 19.087, 0.100_58, 5965.5];
    for (found, expected) in found.zip(expected) {
        assert!((found - expected).abs() <= 1e-4 * expected, "{found} {expected}");
    }
}

#[test]
fn recommends_the_least_smoothing_within_the_residual() {
    let rows = [
        ((35.0, 60.0), (ShaperKind::TwoHumpEi, 58.8, 0.059_69, 0.163_78)),
        ((44.0, 46.0), (ShaperKind::Mzv, 46.9, 0.058_72, 0.092_59)),
    ];
    for ((low_hz, high_hz), (kind, frequency_hz, residual, smoothing)) in rows {
        let range = FrequencyRange { low_hz, high_hz, damping_ratio: 0.1, max_residual: 0.06 };
        let found = range.recommend().expect("a shaper");
        assert_eq!((found.shaper.kind(), found.shaper.frequency_hz()), (kind, frequency_hz));
        assert!((found.residual - residual).abs() < 1e-5 && (found.smoothing - smoothing).abs() < 1e-5);
    }
    let range = FrequencyRange { low_hz: 60.0, high_hz: 35.0, damping_ratio: 0.1, max_residual: 0.06 };
    assert_eq!(range.recommend(), None);
}

#[test]
fn every_shaper_cancels_its_own_frequency() {
    for kind in ShaperKind::ALL {
        let max = *kind.damping_ratios().end();
        for damping_ratio in [0.0, 0.05, max / 2.0, max] {
            let shaper = Shaper::new(kind, 50.0, damping_ratio);
            let sum: f64 = shaper.impulses().iter().map(|impulse| impulse.amplitude).sum();
            assert!((sum - 1.0).abs() < 1e-12 && shaper.impulses()[0].time_s == 0.0);
            assert!(shaper.impulses().is_sorted_by(|a, b| a.time_s < b.time_s), "{shaper:?}");
            let residual = shaper.residual(50.0, damping_ratio);
            assert!(residual < 0.06, "{kind:?} {damping_ratio}: {residual}");
        }
    }
}

/// At 50 Hz and a damping ratio of 0.15, computed with 30 digits: amplitudes; times and mean delay in ms; the residual at
/// 40 Hz and a ratio of 0.2; smoothing and maximum acceleration.
type Row = (ShaperKind, &'static [f64], &'static [f64], [f64; 4]);

#[test]
fn every_kind_has_the_numbers_of_its_formulas() {
    let rows: [Row; 6] = [
        (
            ShaperKind::Zv,
            &[0.616_952_14, 0.383_047_86],
            &[0.0, 10.114_435],
            [3.874_312_6, 0.241_390_57, 0.069_636_156, 9_775.233_8],
        ),
        (
            ShaperKind::Mzv,
            &[0.403_489_85, 0.399_115_68, 0.197_394_46],
            &[0.0, 7.585_826_1, 15.171_652],
            [6.022_422_3, 0.159_900_56, 0.080_333_777, 7_468.838_4],
        ),
        (
            ShaperKind::Zvd,
            &[0.380_629_94, 0.472_644_39, 0.146_725_66],
            &[0.0, 10.114_435, 20.228_869],
            [7.748_625_2, 0.058_269_406, 0.120_880_92, 4_963.562_5],
        ),
        (
            ShaperKind::Ei,
            &[0.406_151_68, 0.432_230_3, 0.161_618_02],
            &[0.0, 10.284_391, 20.228_869],
            [7.714_575_4, 0.025_839_108, 0.130_842_54, 4_585.664_5],
        ),
        (
            ShaperKind::TwoHumpEi,
            &[0.322_257_04, 0.354_343_15, 0.234_424_91, 0.088_974_898],
            &[0.0, 10.637_842, 20.340_401, 29.702_923],
            [11.180_558, 0.043_285_809, 0.226_455_73, 2_624.852_3],
        ),
        (
            ShaperKind::ThreeHumpEi,
            &[0.296_886_59, 0.287_086_33, 0.223_675_17, 0.131_311_87, 0.061_040_036],
            &[0.0, 11.752_195, 21.379_402, 30.526_585, 39.786_786],
            [14.593_026, 0.011_240_655, 0.369_807_56, 1_435.081_8],
        ),
    ];
    for (kind, amplitudes, times_ms, [mean_ms, residual, smoothing, acceleration]) in rows {
        let shaper = Shaper::new(kind, 50.0, 0.15);
        let impulses = shaper.impulses();
        assert_eq!((impulses.len(), shaper.frequency_hz()), (amplitudes.len(), 50.0), "{kind:?}");
        let found = impulses.iter().flat_map(|impulse| [impulse.amplitude, 1e3 * impulse.time_s]);
        let found = found.chain([
            1e3 * shaper.delay_s(),
            1e3 * shaper.mean_delay_s(),
            shaper.residual(40.0, 0.2),
            shaper.smoothing(5000.0, 5.0),
            shaper.max_acceleration(0.12, 5.0),
        ]);
        let expected = amplitudes.iter().zip(times_ms).flat_map(|(amplitude, ms)| [*amplitude, *ms]);
        let last_ms = times_ms.last().copied();
        let rest = last_ms.into_iter().chain([mean_ms, residual, smoothing, acceleration]);
        for (found, expected) in found.zip(expected.chain(rest)) {
            assert!((found - expected).abs() <= 1e-6 * expected, "{kind:?}: {found}, expected {expected}");
        }
    }
    // A corner speed that alone smooths by 0.0001 mm or more leaves no acceleration.
    assert_eq!(Shaper::new(ShaperKind::Zv, 50.0, 0.15).max_acceleration(1e-4, 5.0), 0.0);
}

#[test]
fn the_residual_of_a_train_of_steps_decays() {
    let steps = [(0.01, true), (0.02, true), (0.025, false)];
    let found = train_residual(steps, 0.03, 36.0, 0.3);
    assert!((found - 0.883_290_776_775).abs() < 1e-11, "{found}");
}

/// The rule itself: every candidate, with every frequency.
fn by_exhaustive_search(range: &FrequencyRange) -> Option<Recommendation> {
    let residual = |shaper: &Shaper| {
        let tenths = (0..10_000).map(|tenths| f64::from(tenths) / 10.0);
        let inside = tenths.filter(|hz| (range.low_hz..=range.high_hz).contains(hz));
        let all: Vec<f64> = inside.chain([range.low_hz, range.high_hz]).collect();
        let ratios = [0.75, 1.0, 1.5].map(|factor| factor * range.damping_ratio);
        let at = |hz: &f64| ratios.map(|ratio| shaper.residual(*hz, ratio)).into_iter().fold(0.0, f64::max);
        all.iter().map(at).fold(0.0, f64::max)
    };
    let kinds = ShaperKind::ALL.into_iter();
    let kinds = kinds.filter(|kind| kind.damping_ratios().contains(&range.damping_ratio));
    let candidates = kinds.flat_map(|kind| {
        let tenths = (1..10_000).map(|tenths| f64::from(tenths) / 10.0);
        let within = tenths.filter(|hz| range.low_hz / 2.0 <= *hz && *hz <= 3.0 * range.high_hz);
        within.map(move |hz| Shaper::new(kind, hz, range.damping_ratio))
    });
    let all: Vec<Recommendation> = candidates
        .map(|shaper| {
            let smoothing = shaper.smoothing(SMOOTHING_ACCELERATION, SMOOTHING_CORNER_SPEED);
            Recommendation { residual: residual(&shaper), smoothing, shaper }
        })
        .collect();
    let passing = all.iter().filter(|candidate| candidate.residual <= range.max_residual);
    let best = passing.min_by(|a, b| a.smoothing.total_cmp(&b.smoothing));
    best.or_else(|| all.iter().min_by(|a, b| a.residual.total_cmp(&b.residual))).cloned()
}

#[test]
fn recommends_what_an_exhaustive_search_finds() {
    let rows = [
        ([20.0, 20.0], 0.0, 0.05),
        ([19.95, 21.07], 0.1, 0.06),
        // All kinds exceed the allowed vibration: the one that leaves the minimum.
        ([18.0, 24.0], 0.1, 1e-4),
        ([12.0, 13.0], 0.35, 0.02),
        ([0.1, 0.2], 0.1, 0.5),
    ];
    for ([low_hz, high_hz], damping_ratio, max_residual) in rows {
        let range = FrequencyRange { low_hz, high_hz, damping_ratio, max_residual };
        let found = range.recommend().expect("a shaper");
        let expected = by_exhaustive_search(&range).expect("a candidate");
        assert_eq!((found.shaper, found.smoothing), (expected.shaper, expected.smoothing), "{range:?}");
        assert!((found.residual - expected.residual).abs() < 1e-9, "{range:?}: {}", found.residual);
    }
}

#[test]
fn refuses_ranges_without_a_shaper() {
    let recommends = |low_hz: f64, high_hz: f64, damping_ratio: f64| {
        FrequencyRange { low_hz, high_hz, damping_ratio, max_residual: 1.0 }.recommend().is_some()
    };
    assert!(recommends(1000.0, 1000.0, 0.99) && recommends(0.1, 0.1, 0.0));
    let refused =
        [(0.09, 1.0, 0.1), (999.0, 1000.1, 0.1), (2.0, 1.9, 0.1), (f64::NAN, 1.0, 0.1), (1.0, 1.0, 1.0)];
    for (low_hz, high_hz, damping_ratio) in refused {
        assert!(!recommends(low_hz, high_hz, damping_ratio), "{low_hz} to {high_hz} Hz, {damping_ratio}");
    }
}

#[test]
fn every_kind_has_its_damping_ratios() {
    let found = ShaperKind::ALL.map(|kind| *kind.damping_ratios().end());
    assert_eq!(found, [0.99, 0.99, 0.99, 0.4, 0.3, 0.2]);
}
