//! A6's reply timing, and A9: several controllers on one line.
//!
//! STATUS is 8 bytes: sent from cycle 1 its 0x00 is delivered in p = 1 + 7*160 + 152 = 1273. DE rises at p + 160 =
//! 1433; the reply's 17 bytes start at p + 176 = 1449 + 160*j, and DE falls with the last one's end, at 4169.

use super::*;
use kinds::*;

fn framed(address: u8) -> Config {
    Config { framed: true, address: Some(address), ..base() }
}

fn status_of(address: u8) -> Vec<u8> {
    frame(address, STATUS, &[])
}

fn input(sends: &[(u64, Vec<u8>)], forced: &[(u64, u64, bool)], cycles: u64) -> Input {
    Input { sends: sends.to_vec(), forced: forced.to_vec(), cycles }
}

#[test]
fn de_rises_10_bits_after_the_zero_and_the_first_start_bit_falls_one_bit_later() {
    let run = run(&framed(5), &input(&[(1, status_of(5))], &[], 10_000));
    assert_eq!(edges(&run, bits::DE), [(1_433, true), (4_169, false)]);
    // The first bytes are 5, 5, 0x84.
    let (low, high) = (false, true);
    assert_eq!(
        edges(&run, bits::TX)[..7],
        [(1_449, low), (1_465, high), (1_481, low), (1_497, high), (1_513, low), (1_593, high), (1_609, low)]
    );
    // The last is 0x00: nine bits low from 4009 on.
    let tx = edges(&run, bits::TX);
    assert_eq!(tx[tx.len() - 2..], [(4_009, low), (4_153, high)]);
}

#[test]
fn de_is_high_for_one_bit_and_ten_bits_per_byte() {
    // POSITIONS is as long as STATUS. 17 + 4*n bytes: 160*(17 + 4*n) + 16 cycles.
    for channels in 1..=16 {
        let config = Config { channels, step_period: 100, ..framed(5) };
        let run = run(&config, &input(&[(1, frame(5, POSITIONS, &[]))], &[], 20_000));
        let fall = 1_449 + 160 * (17 + 4 * channels as u64);
        assert_eq!(edges(&run, bits::DE), [(1_433, true), (fall, false)], "{channels} channels");
        assert_eq!(said(&config, &run, 20_000).len(), 17 + 4 * channels);
    }
    assert_eq!(16 + 160 * (17 + 4 * 16), 811 * 16);
}

#[test]
fn a_reply_is_sent_at_the_exact_rate_not_in_rounded_bits() {
    // Clock/rate = 11.1, B = 11; p = 1 + floor(7*10000/90) + 5 + 99 = 882.
    let uneven = Config { clock_hz: 1_000, baud: 90, receiver_baud: 90, ..framed(5) };
    // 15.5, B = 16; the host sends at 16.
    let fast = Config { receiver_baud: 1_030, ..framed(5) };
    assert_eq!((bit_time(&uneven), bit_time(&fast)), (11, 16));
    for (config, p, last, length) in [
        // floor(160000/90) and floor(10000/90); floor(160*16000/1030) and floor(160000/1030).
        (uneven, 882, 1_777, 111),
        (fast, 1_273, 2_485, 155),
    ] {
        let run = run(&config, &input(&[(1, status_of(5))], &[], 10_000));
        let start = p + 11 * bit_time(&config);
        let fall = start + last + length;
        assert_eq!(edges(&run, bits::DE), [(p + 10 * bit_time(&config), true), (fall, false)]);
        assert_eq!(edges(&run, bits::TX)[0], (start, false));
        let (last_fall, last_rise) =
            (start + last, start + last + 9 * config.clock_hz / config.receiver_baud);
        let tx = edges(&run, bits::TX);
        assert_eq!(tx[tx.len() - 2..], [(last_fall, false), (last_rise, true)]);
    }
}

#[test]
fn rx_is_1_while_de_is_high() {
    let low = input(&[(1, status_of(5))], &[(1_300, 10_000, false)], 8_000);
    let run = run(&framed(5), &low);
    let rx = edges(&run, bits::RX);
    // Low from the end of the frame on, except during DE; then the armed receiver finds no stop bit.
    assert_eq!(rx[rx.len() - 3..], [(1_300, false), (1_433, true), (4_169, false)]);
    assert_eq!(run.faults, FRAMING);
    let until = |cycles| super::run(&framed(5), &Input { cycles, ..low.clone() }).faults;
    // The byte in progress at 1433 (from 1300) samples ones and is delivered; the error is that of the next byte, whose t is
    // 4169: 4169 + 152 = 4321.
    assert_eq!((until(4_321), until(4_322)), (0, FRAMING));
}

#[test]
fn a_byte_in_progress_when_de_rises_samples_ones() {
    // A 0x00 after the frame: bit i is sampled at its start + 24 + 16*i, the stop bit at + 152. Where bit 7 is sampled
    // before 1433 it is a 0x00, "nothing"; else it is 0x80, the start of a run that is not COBS at a later 0x00.
    for (start, faults) in [(1_281, 0), (1_296, 0), (1_297, SHORT_PACKET), (1_420, SHORT_PACKET)] {
        let sends = [(1, status_of(5)), (start, vec![0]), (6_000, vec![0])];
        assert_eq!(run(&framed(5), &input(&sends, &[], 8_000)).faults, faults, "0x00 from {start}");
    }
    // A missing stop bit is no error there: 1281 + 152 = 1433.
    let sends = [(1, status_of(5)), (1_281, vec![0])];
    assert_eq!(run(&framed(5), &input(&sends, &[(1_433, 1, false)], 8_000)).faults, 0);
    // A start bit whose middle is there is a glitch.
    let sends = [(1, status_of(5)), (1_425, vec![0]), (6_000, vec![0])];
    assert_eq!(run(&framed(5), &input(&sends, &[], 8_000)).faults, 0);
}

#[test]
fn bytes_sent_during_a_reply_are_lost_and_later_ones_received() {
    let order = |start| [(1, status_of(5)), (start, frame(5, STOP, &[]))];
    let en = |start| edges(&run(&framed(5), &input(&order(start), &[], 12_000)), bits::EN);
    assert_eq!(en(1_500), []);
    // From DE's fall on: p = 4169 + 1272.
    assert_eq!(en(4_169), [(5_442, false)]);
    // One cycle earlier, the start bit is still detected at 4169.
    assert_eq!(en(4_168), [(5_441, false)]);
}

#[test]
fn replies_of_other_controllers_change_nothing() {
    let configs = [framed(5), Config { receiver_baud: 1_010, ..framed(6) }];
    let sends = [(1, status_of(5)), (5_000, status_of(6))];
    let runs = run_line(&configs, &input(&sends, &[], 10_000));
    let host = line_levels(&configs[0], &input(&sends, &[], 10_000));
    assert_eq!(edges(&runs[0], bits::DE).len(), 2);
    assert_eq!(edges(&runs[1], bits::DE).len(), 2);
    for (own, other) in [(&runs[0], &runs[1]), (&runs[1], &runs[0])] {
        let [tx, de, rx] =
            [(other, bits::TX), (own, bits::DE), (own, bits::RX)].map(|(run, bit)| levels(run, bit, 10_000));
        for cycle in 0..10_000 {
            assert_eq!(rx[cycle], de[cycle] || host[cycle] && tx[cycle], "cycle {cycle}");
        }
        assert_eq!((own.faults, own.state), (0, State::Ready));
    }
    // A single first controller would have replied in the same way.
    assert_eq!(
        run(&configs[0], &input(&sends, &[], 10_000)).trace.len(),
        1 + {
            let own = edges(&runs[0], bits::TX).len() + edges(&runs[0], bits::DE).len();
            let sent = host.windows(2).filter(|pair| pair[0] != pair[1]).count();
            own + sent
        }
    );
}

#[test]
fn simultaneous_replies_are_received_as_their_and() {
    // Two controllers with one address: both reply, one READY and one BUSY, at slightly different rates.
    let busy = Config { boot: 100_000, receiver_baud: 1_030, ..framed(5) };
    let configs = [framed(5), busy, framed(6)];
    let runs = run_line(&configs, &input(&[(1, status_of(5))], &[], 4_300));
    let of = |k: usize, bit| levels(&runs[k], bit, 4_300);
    let (first, second, third) = (of(0, bits::TX), of(1, bits::TX), of(2, bits::RX));
    for cycle in 1_433..4_300 {
        assert_eq!(third[cycle], first[cycle] && second[cycle], "cycle {cycle}");
    }
    assert!(third[1_433..] != first[1_433..] && third[1_433..] != second[1_433..]);
    // The second's DE falls at 4089, and then it receives the first's last byte, low from 4009 to 4152.
    let rx = edges(&runs[1], bits::RX);
    assert_eq!(rx[rx.len() - 2..], [(4_089, false), (4_153, true)]);
    assert!(of(0, bits::RX)[1_433..4_300].iter().all(|high| *high));
    // The third receives no valid frame.
    assert_ne!(runs[2].faults, 0);
}

#[test]
fn a_forced_level_overrides_a_reply() {
    let configs = [framed(5), framed(6)];
    // A low in a high bit of the first byte (bit 0, from 1465), a high in its start bit.
    for (cycle, level) in [(1_470, false), (1_450, true)] {
        let runs = run_line(&configs, &input(&[(1, status_of(5))], &[(cycle, 1, level)], 5_000));
        let rx = levels(&runs[1], bits::RX, 5_000);
        let [before, at, after] = [cycle - 1, cycle, cycle + 1].map(|cycle| rx[cycle as usize]);
        assert_eq!([before, at, after], [!level, level, !level], "cycle {cycle}");
        // The sender itself receives 1 and continues.
        assert_eq!(levels(&runs[0], bits::TX, 5_000)[cycle as usize], !level);
        assert!(levels(&runs[0], bits::RX, 5_000)[cycle as usize]);
    }
}

#[test]
fn every_controller_has_its_own_receiver_bus_and_queue() {
    // B = 160, TICKS for all, one channel: p = 1 + 10*1600 + 80 + 9*160 = 17521; at B = 162 19 cycles later.
    let framed = |address| Config { clock_hz: 160_000, ..framed(address) };
    let slow = Config { receiver_baud: 988, ..framed(6) };
    assert_eq!((bit_time(&framed(5)), bit_time(&slow)), (160, 162));
    let two = Config { channels: 2, ..framed(7) };
    let raw = Config { framed: false, address: None, channels: 11, ..framed(8) };
    let sends = [(1, frame(255, TICKS, &[0, 1, 0x81]))];
    let runs = run_line(&[framed(5), slow, two, raw], &input(&sends, &[], 50_000));
    let starts: Vec<_> = runs[..3].iter().map(|run| edges(run, bits::DIR)).collect();
    assert_eq!(starts, [vec![(17_522, true)], vec![(17_541, true)], vec![]]);
    assert_eq!([0, 1, 2].map(|k| runs[k].positions[0]), [1, 1, 0]);
    // Two channels would need two commands: BAD_BODY, which sets nothing.
    assert_eq!([0, 1, 2].map(|k| runs[k].faults), [UNDERRUN, UNDERRUN, 0]);
    assert_eq!([0, 1, 2].map(|k| runs[k].expected_seq), [1, 1, 0]);
    // A raw controller on the same line receives the same eleven bytes, among them counts above 4.
    assert_eq!((runs[3].faults, runs[3].positions), (TOO_MANY_STEPS, [0; 16]));
}
