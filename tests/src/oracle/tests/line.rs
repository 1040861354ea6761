//! A4: the sender's bits, the receiver's samples, glitches, framing errors, forced levels.

use super::*;

/// 1000/90 = 11.1 cycles per bit: B = floor(2090/180) = 11, samples at t + 5 + 11*i, the stop bit at t + 104.
fn uneven() -> Config {
    Config { clock_hz: 1_000, baud: 90, receiver_baud: 90, ..base() }
}

fn heard(config: &Config, input: &Input) -> Vec<(u64, RxEvent)> {
    hear(config, &line_levels(config, input))
}

/// (cycle, length, level).
type ForcedLevel = (u64, u64, bool);

fn forced(entries: &[ForcedLevel], cycles: u64) -> Input {
    Input { sends: Vec::new(), forced: entries.to_vec(), cycles }
}

#[test]
fn a_sender_holds_bit_k_from_floor_k_clock_over_baud() {
    // "[t0 + floor(k*clock_hz/baud), t0 + floor((k+1)*clock_hz/baud))": floors 0 11 22 33 44 55 66 77 88
    // 100 111.
    let rx = |byte: u8| edges(&run(&uneven(), &sent(&[(1, &[byte])], 300)), bits::RX);
    let (low, high) = (false, true);
    assert_eq!(
        rx(0x55),
        [1, 12, 23, 34, 45, 56, 67, 78, 89, 101]
            .into_iter()
            .zip([low, high].into_iter().cycle())
            .collect::<Vec<_>>()
    );
    assert_eq!(rx(0xFF), [(1, low), (12, high)]);
    assert_eq!(rx(0x00), [(1, low), (101, high)]);
    // "least significant first".
    assert_eq!(rx(0x01), [(1, low), (12, high), (23, low), (101, high)]);
    assert_eq!(rx(0x80), [(1, low), (89, high)]);
}

#[test]
fn byte_j_of_a_send_starts_at_floor_10_j_clock_over_baud() {
    // floor(10_000*j/90): 111 cycles per byte, and 112 to the tenth: "the floors can leave one
    // cycle".
    let input = sent(&[(1, &[0xFF; 10])], 1_200);
    let falls: Vec<u64> = edges(&run(&uneven(), &input), bits::RX)
        .into_iter()
        .filter(|(_, level)| !level)
        .map(|(cycle, _)| cycle)
        .collect();
    assert_eq!(falls, [1, 112, 223, 334, 445, 556, 667, 778, 889, 1_001]);
    // The ninth byte's stop bit ends at 889 + 111 = 1000, and the line is high in the remaining cycle.
    let input = Input { forced: vec![(989, 11, false)], ..input };
    let rx = edges(&run(&uneven(), &input), bits::RX);
    assert_eq!(rx[rx.len() - 4..], [(989, false), (1_000, true), (1_001, false), (1_012, true)]);
}

#[test]
fn the_receivers_bit_time_is_rounded_half_up() {
    let bit_time = |clock_hz, receiver_baud| bit_time(&Config { clock_hz, receiver_baud, ..base() });
    assert_eq!(bit_time(1_000, 90), 11);
    assert_eq!(bit_time(105, 10), 11);
    assert_eq!(bit_time(104, 10), 10);
    assert_eq!(bit_time(16_000_000, 115_200), 139);
    assert_eq!(bit_time(16_000_000, 1_000_000), 16);
}

#[test]
fn a_byte_is_delivered_at_its_stop_sample() {
    // t + floor(B/2) + 9*B.
    assert_eq!(heard(&base(), &sent(&[(10, &[0xA7])], 400)), [(162, RxEvent::Byte(0xA7))]);
    assert_eq!(heard(&uneven(), &sent(&[(10, &[0xA7])], 400)), [(114, RxEvent::Byte(0xA7))]);
    // A run ends with cycle N-1.
    assert_eq!(heard(&uneven(), &sent(&[(10, &[0xA7])], 115)).len(), 1);
    assert_eq!(heard(&uneven(), &sent(&[(10, &[0xA7])], 114)).len(), 0);
    // Without pauses, through the cycle that the floors leave.
    let expected: Vec<_> = [1, 112, 223, 334, 445, 556, 667, 778, 889, 1_001]
        .into_iter()
        .zip(1..)
        .map(|(start, byte)| (start + 104, RxEvent::Byte(byte)))
        .collect();
    assert_eq!(heard(&uneven(), &sent(&[(1, &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10])], 1_200)), expected);
}

#[test]
fn data_bit_i_is_sampled_in_one_cycle_only() {
    // "data bit i (0..=7) is sampled at t + floor(B/2) + (i+1)*B": here 10 + 5 + 11*(i+1).
    for i in 0..8 {
        let sample = 26 + 11 * i;
        for (glitch, expected) in [(sample - 1, 0), (sample, 1 << i), (sample + 1, 0)] {
            let input = Input { forced: vec![(glitch, 1, true)], ..sent(&[(10, &[0])], 400) };
            assert_eq!(
                heard(&uneven(), &input),
                [(114, RxEvent::Byte(expected))],
                "one cycle high at {glitch}"
            );
        }
    }
}

#[test]
fn the_stop_bit_is_sampled_in_one_cycle_only() {
    for (glitch, expected) in [(113, RxEvent::Byte(0)), (114, RxEvent::FramingError), (115, RxEvent::Byte(0))]
    {
        let input = Input { forced: vec![(glitch, 1, false)], ..sent(&[(10, &[0])], 118) };
        assert_eq!(heard(&uneven(), &input), [(114, expected)], "one cycle low at {glitch}");
    }
}

#[test]
fn the_start_bit_is_sampled_again_in_its_middle() {
    // "It looks again at t + floor(B/2): if the line is high it was a glitch": t = 10, sampled again in
    // cycle 15.
    for (glitch, expected) in [(14, 1), (15, 0), (16, 1)] {
        let input = Input { forced: vec![(glitch, 1, true)], ..sent(&[(10, &[0xFF])], 400) };
        assert_eq!(heard(&uneven(), &input).len(), expected, "one cycle high at {glitch}");
    }
}

#[test]
fn after_a_glitch_the_receiver_arms_in_the_next_cycle() {
    // B = 16: low at 10, sampled again at 18. A start bit from 19 on is a new t; one that covers 18
    // belongs to t = 10.
    for (start, t) in [(14, 10), (18, 10), (19, 19), (20, 20)] {
        let input = Input { forced: vec![(10, 1, false)], ..sent(&[(start, &[0x5A])], 400) };
        assert_eq!(heard(&base(), &input), [(t + 152, RxEvent::Byte(0x5A))], "a byte sent at {start}");
    }
    // Low before the sample and still low at 19, but high at 18.
    let input = forced(&[(10, 200, false), (18, 1, true)], 400);
    assert_eq!(heard(&base(), &input), [(19 + 152, RxEvent::FramingError)]);
}

#[test]
fn after_a_delivery_the_receiver_arms_in_the_next_cycle() {
    // Delivered at 153, the stop bit lasts until 160: a low there is already the next start bit.
    for (low_from, expected) in [(153, 1), (154, 154 + 152), (155, 155 + 152)] {
        let input = Input { forced: vec![(low_from, 40, false)], ..sent(&[(1, &[0xFF])], 400) };
        let heard = heard(&base(), &input);
        if low_from == 153 {
            assert_eq!(heard, [(153, RxEvent::FramingError)]);
        } else {
            assert_eq!(
                heard,
                [(153, RxEvent::Byte(0xFF)), (expected, RxEvent::Byte(0xFE))],
                "low from {low_from}"
            );
        }
    }
}

#[test]
fn after_a_framing_error_the_receiver_arms_one_cycle_after_the_line_is_high() {
    // "arms in the cycle after the first cycle, counted from the one after the sample, in which the line is
    // high".
    let rows: &[(&[ForcedLevel], &[u64])] = &[
        // A break from 1 to 300: high at 301, armed at 302 and low there.
        (&[(1, 300, false), (302, 100, false)], &[153, 302 + 152]),
        // High at 301 and 302; low at 303.
        (&[(1, 300, false), (303, 100, false)], &[153, 303 + 152]),
        // High in the cycle after the sample, low again in the next: armed in time.
        (&[(1, 153, false), (155, 100, false)], &[153, 155 + 152]),
        // Low without end: one error.
        (&[(1, 1_000, false)], &[153]),
        // High before the sample does not count.
        (&[(1, 1_000, false), (140, 5, true)], &[153]),
    ];
    for (entries, expected) in rows {
        // The second low of 100 cycles has its stop sample at +152, long after its end: a byte.
        let cycles: Vec<u64> =
            heard(&base(), &forced(entries, 1_000)).iter().map(|(cycle, _)| *cycle).collect();
        assert_eq!(&cycles, expected, "{entries:?}");
    }
}

#[test]
fn a_slow_receiver_reads_the_stop_bit_as_a_data_bit() {
    // The sender's bit is 16, B = 18: data bits sampled at t + 9 + 18*(i+1) = 27 45 63 81 99 117 135 153,
    // the stop bit at 171. The sender's data bit i is [16*(i+1), 16*(i+2)); bit 7 = [128, 144): receiver
    // bits 0..=7 see 0 1 2 4 5 6 7 stop.
    let slow = Config { receiver_baud: 889, ..base() };
    assert_eq!(bit_time(&slow), 18);
    assert_eq!(heard(&slow, &sent(&[(1, &[0b0000_0000])], 400)), [(172, RxEvent::Byte(0b1000_0000))]);
    assert_eq!(heard(&slow, &sent(&[(1, &[0b0000_1000])], 400)), [(172, RxEvent::Byte(0b1000_0000))]);
    assert_eq!(heard(&slow, &sent(&[(1, &[0b1000_0001])], 400)), [(172, RxEvent::Byte(0b1100_0001))]);
    // Sent without a pause, its stop sample is in the next byte's start bit (160..=175 after the first one's
    // start).
    assert_eq!(heard(&slow, &sent(&[(1, &[0, 0xFF])], 400)), [(172, RxEvent::FramingError)]);
}

#[test]
fn forced_levels_override_sent_bytes_and_the_later_entry_wins() {
    let rx = |entries: &[ForcedLevel]| edges(&run(&base(), &forced(entries, 60)), bits::RX);
    assert_eq!(rx(&[(10, 3, false)]), [(10, false), (13, true)]);
    assert_eq!(rx(&[(10, 10, false), (12, 3, true)]), [(10, false), (12, true), (15, false), (20, true)]);
    assert_eq!(rx(&[(12, 3, true), (10, 10, false)]), [(10, false), (20, true)]);
    assert_eq!(rx(&[(10, 4, false), (14, 4, false)]), [(10, false), (18, true)]);
    assert_eq!(rx(&[(10, 4, true)]), []);
    assert_eq!(rx(&[(58, 10, false)]), [(58, false)]);
}

#[test]
fn the_line_is_high_in_cycle_0_and_a_trace_begins_there() {
    // "Reset state at cycle 0: STEP = 0, DIR = 0, EN = 1, RX = TX = 1, DE = 0."
    let idle = run(&base(), &sent(&[], 100));
    assert_eq!(idle.trace, [(0, 0b0111 << 32)]);
    let low_at_once = run(&base(), &forced(&[(1, 3, false)], 100));
    assert_eq!(low_at_once.trace, [(0, 0b0111 << 32), (1, 0b0101 << 32), (4, 0b0111 << 32)]);
    assert_eq!(run(&base(), &sent(&[], 0)).trace, []);
}
