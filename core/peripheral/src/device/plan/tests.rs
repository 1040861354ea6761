//! Compares the changes of a tick with the formulas (DESIGN A7) and with numbers of the patent.

use super::*;
use crate::{
    config::{Bus, SerialLine},
    units::Cycles,
};

#[test]
fn each_channel_steps_in_the_slots_of_the_formula() {
    for slots in 1..=127_u8 {
        for first in 0..=slots {
            // The other channels have other counts, including the extremes.
            let others = [0, slots, 1, slots - 1, slots / 2, first / 2, slots - first];
            let counts = core::array::from_fn(|i| if i % 2 == 0 { first } else { others[i / 2 % 7] });
            let (m, h) = (u32::from(slots), u32::from(slots / 2));
            let mut spread = Firing::new(&counts, slots, Distribution::Spread);
            let mut burst = Firing::new(&counts, slots, Distribution::Burst);
            for slot in 0..slots {
                let k = u32::from(slot);
                let of = |fires: &dyn Fn(u32) -> bool| mask(counts.map(|c| fires(c.into())));
                let formula = of(&|c| ((k + 1) * c + h) / m > (k * c + h) / m);
                assert_eq!(spread.slot(slot), formula, "{counts:?} of {m}, slot {k}");
                assert_eq!(burst.slot(slot), of(&|c| k < c), "{counts:?} of {m}, slot {k}");
            }
        }
    }
}

/// Three channels, two slots of 40 cycles; W = 3, D = 2, H = 1.
fn bus(dir_line: DirLine, pulse_phasing: PulsePhasing, settle_cycles: u32) -> Bus {
    Bus {
        channels: 3,
        slots: 2,
        step_period_cycles: 40,
        pulse_width_cycles: 3,
        dir_setup_cycles: 2,
        dir_hold_cycles: 1,
        distribution: Distribution::Burst,
        dir_line,
        pulse_phasing,
        settle_cycles,
        ..Bus::default()
    }
}

fn changes(bus: &Bus, commands: &[u8]) -> Vec<(u64, Lines)> {
    let config = Config::new(16_000_000, bus, &SerialLine::default()).expect("a valid configuration");
    let mut plan = Plan::new(&config);
    let mut tick = [0; MAX_CHANNELS];
    tick.iter_mut().zip(commands).for_each(|(command, &byte)| *command = byte);
    plan.set(tick);
    assert_eq!((plan.commands, plan.has_steps()), (tick, commands.iter().any(|byte| byte & 0x7f != 0)));
    plan.changes().iter().map(|change| (change.offset, change.lines)).collect()
}

#[test]
fn each_mode_has_the_edges_of_the_contract() {
    use {
        DirLine::{Common, PerChannel},
        PulsePhasing::{Simultaneous, Staggered},
    };
    // One step right, one left, two right; no steps; DIR only.
    let (all, none, left) = ([0x81, 0x01, 0x82], [0x80, 0, 0x80], [0, 0, 1]);
    // DIR of the first and the last channel, and of all.
    let (own, common) = (0x5_0000, 0x7_0000);
    type Row<'a> = (DirLine, PulsePhasing, u32, &'a [u8], &'a [(u64, Lines)]);
    let rows: &[Row<'_>] = &[
        (PerChannel, Simultaneous, 0, &all, &[(0, own), (2, own | 7), (5, own), (42, own | 4), (45, own)]),
        (PerChannel, Simultaneous, 0, &none, &[(0, own)]),
        // d = min(10, floor(40/3)); in the second slot only one channel steps.
        (
            PerChannel,
            Staggered,
            10,
            &all,
            &[
                (0, own),
                (2, own | 1),
                (5, own),
                (12, own | 2),
                (15, own),
                (22, own | 4),
                (25, own),
                (42, own | 4),
                (45, own),
            ],
        ),
        // d = floor(40/3) = 13.
        (
            PerChannel,
            Staggered,
            100,
            &[0x81, 0x81, 0x81],
            &[
                (0, common),
                (2, common | 1),
                (5, common),
                (15, common | 2),
                (18, common),
                (28, common | 4),
                (31, common),
            ],
        ),
        // Distances below W: pulses overlap, touch, and coincide.
        (PerChannel, Staggered, 2, &[1, 1, 1], &[(0, 0), (2, 1), (4, 3), (5, 2), (6, 6), (7, 4), (9, 0)]),
        (PerChannel, Staggered, 3, &[1, 1, 1], &[(0, 0), (2, 1), (5, 2), (8, 4), (11, 0)]),
        (PerChannel, Staggered, 0, &[1, 1, 1], &[(0, 0), (2, 7), (5, 0)]),
        // Left at s + D, DIR at s + D + W + H, right at s + 2D + W + H; both changes of DIR in every slot.
        (
            Common,
            Simultaneous,
            0,
            &all,
            &[
                (0, 0),
                (2, 2),
                (5, 0),
                (6, common),
                (8, common | 5),
                (11, common),
                (40, 0),
                (46, common),
                (48, common | 4),
                (51, common),
            ],
        ),
        (Common, Simultaneous, 0, &left, &[(0, 0), (2, 4), (5, 0), (6, common)]),
        (Common, Simultaneous, 0, &none, &[]),
        // The left one, then the right ones; DIR rises D before the first pulse to the right, and stays high.
        (
            Common,
            Staggered,
            10,
            &all,
            &[
                (0, 0),
                (2, 2),
                (5, 0),
                (10, common),
                (12, common | 1),
                (15, common),
                (22, common | 4),
                (25, common),
                (42, common | 4),
                (45, common),
            ],
        ),
        (Common, Staggered, 10, &none, &[]),
    ];
    for (dir_line, phasing, settle, commands, expected) in rows {
        let bus = bus(*dir_line, *phasing, *settle);
        assert_eq!(changes(&bus, commands), *expected, "{dir_line:?} {phasing:?} {settle} {commands:x?}");
    }
}

#[test]
fn edges_match_the_numbers_of_the_patent() {
    // With D = W = 1 and H = 0 a common DIR line takes five cycles per step of all motors.
    let five = Bus {
        dir_setup_cycles: 1,
        pulse_width_cycles: 1,
        dir_hold_cycles: 0,
        ..bus(DirLine::Common, PulsePhasing::Simultaneous, 0)
    };
    let common = 0x7_0000;
    let expected = [(0, 0), (1, 2), (2, common), (3, common | 5), (4, common)];
    assert_eq!(changes(&five, &[0x81, 0x01, 0x81]), expected);
    // Ts = 2.048 ms and dp = 0.518 ms at 16 MHz: four motors step every 0.512 ms.
    let staggered = Bus {
        channels: 4,
        slots: 1,
        step_period_cycles: 32_768,
        settle_cycles: 8_288,
        ..bus(DirLine::PerChannel, PulsePhasing::Staggered, 0)
    };
    let rises: Vec<u64> =
        changes(&staggered, &[1, 1, 1, 1]).iter().filter(|(_, lines)| *lines != 0).map(|c| c.0).collect();
    assert_eq!(rises, [2, 2 + 8_192, 2 + 2 * 8_192, 2 + 3 * 8_192]);
}

#[test]
fn full_slots_end_with_the_last_fall() {
    // L = W + max(D + H, 1) = Ts: the fall of the last pulse is H before the end.
    let full = Bus {
        step_period_cycles: 6,
        slots: 127,
        channels: 1,
        ..bus(DirLine::PerChannel, PulsePhasing::Simultaneous, 0)
    };
    let found = changes(&full, &[0xff]);
    assert_eq!(found.len(), 1 + 2 * 127);
    let config = Config::new(16_000_000, &full, &SerialLine::default()).expect("a valid configuration");
    assert_eq!((found.last(), config.tick()), (Some(&(6 * 127 - 1, 0x1_0000)), Cycles(6 * 127)));
}
