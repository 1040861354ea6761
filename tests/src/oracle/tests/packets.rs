//! A5: packets, addresses, the gap, faults; A9: the paced raw host.

use super::*;

/// Results for a packet test: STEP rises of channel 0 and the fault flags.
fn outcome(config: &Config, input: &Input) -> (Vec<u64>, u16) {
    let run = run(config, input);
    (steps(&run, 0), run.faults)
}

/// One step to the right on one channel. Committed at p, its tick starts at p + 1 and STEP rises at p + 2
/// (D = 1).
const STEP_RIGHT: u8 = 0x81;

fn addressed() -> Config {
    Config { address: Some(5), ..base() }
}

#[test]
fn a_packet_is_committed_when_its_last_byte_is_delivered() {
    // Bytes back to back from 1 are delivered at 153, 313, 473.
    assert_eq!(outcome(&base(), &sent(&[(1, &[STEP_RIGHT])], 400)), (vec![155], 0));
    let two = Config { channels: 2, ..base() };
    assert_eq!(outcome(&two, &sent(&[(1, &[STEP_RIGHT, 0])], 400)), (vec![315], 0));
    assert_eq!(outcome(&addressed(), &sent(&[(1, &[5, STEP_RIGHT])], 400)), (vec![315], 0));
    let two = Config { channels: 2, ..addressed() };
    assert_eq!(outcome(&two, &sent(&[(1, &[5, STEP_RIGHT, 0])], 600)), (vec![475], 0));
}

#[test]
fn byte_i_is_for_channel_i() {
    let run = run(&Config { channels: 3, ..base() }, &sent(&[(1, &[0x81, 0x00, 0x02])], 600));
    // Delivered at 473, c0 = 474.
    assert_eq!(steps(&run, 0), [475]);
    assert_eq!(steps(&run, 1), [0; 0]);
    assert_eq!(steps(&run, 2), [475, 485]);
    assert_eq!(run.positions[..4], [1, 0, -2, 0]);
    assert_eq!(rises(&run, bits::DIR), [474]);
    assert_eq!(rises(&run, bits::DIR + 2), [0; 0]);
}

#[test]
fn packets_for_another_address_are_consumed_by_length_and_255_is_for_all() {
    let rows: &[(&[u8], &[u64])] = &[
        (&[6, STEP_RIGHT], &[]),
        (&[6, STEP_RIGHT, 5, STEP_RIGHT], &[635]),
        // The body of a packet for another controller is not an address.
        (&[6, 5, 5, STEP_RIGHT], &[635]),
        (&[6, 5, STEP_RIGHT, STEP_RIGHT], &[]),
        (&[255, STEP_RIGHT], &[315]),
        (&[5, STEP_RIGHT, 255, STEP_RIGHT], &[315, 635]),
    ];
    for (bytes, expected) in rows {
        assert_eq!(outcome(&addressed(), &sent(&[(1, bytes)], 1_000)), (expected.to_vec(), 0), "{bytes:?}");
    }
    // Without addresses, 255 is a normal command: 127 steps.
    assert_eq!(outcome(&base(), &sent(&[(1, &[255])], 1_000)), (vec![], TOO_MANY_STEPS));
}

#[test]
fn a_byte_after_more_than_45_bits_begins_another_packet() {
    // "A delivery at d + 45*B still continues the packet": d = 153, so 873 (sent at 721) does and 874 does
    // not.
    let two = Config { channels: 2, ..base() };
    let input = |second| sent(&[(1, &[STEP_RIGHT]), (second, &[0x82])], 2_000);
    assert_eq!(outcome(&two, &input(721)), (vec![875], 0));
    // "before a byte delivered in that very cycle is looked at, a partial packet is dropped": 0x82 begins a
    // new packet, which is also too short.
    assert_eq!(outcome(&two, &input(722)), (vec![], SHORT_PACKET));
    let then_another = sent(&[(1, &[STEP_RIGHT]), (722, &[0x82, 0])], 2_000);
    // 0x82 delivered at 874, its partner at 1034.
    assert_eq!(outcome(&two, &then_another), (vec![1036, 1046], SHORT_PACKET));
}

#[test]
fn a_gap_is_detected_45_bits_and_one_cycle_after_a_byte() {
    // d = 153: SHORT_PACKET in cycle 153 + 720 + 1 = 874, so a run of 875 cycles has it and one of 874 does
    // not.
    let two = Config { channels: 2, ..base() };
    assert_eq!(outcome(&two, &sent(&[(1, &[STEP_RIGHT])], 874)).1, 0);
    assert_eq!(outcome(&two, &sent(&[(1, &[STEP_RIGHT])], 875)).1, SHORT_PACKET);
}

#[test]
fn a_gap_without_a_partial_packet_is_no_fault() {
    assert_eq!(
        outcome(&base(), &sent(&[(1, &[STEP_RIGHT]), (2_000, &[STEP_RIGHT])], 4_000)),
        (vec![155, 2_154], 0)
    );
}

#[test]
fn a_short_packet_is_a_fault_for_any_address() {
    for address in [5, 6, 255] {
        let input = sent(&[(1, &[address]), (722, &[5, STEP_RIGHT])], 2_000);
        // 5 is delivered at 874, the command at 1034.
        assert_eq!(outcome(&addressed(), &input), (vec![1_036], SHORT_PACKET), "address {address}");
    }
}

#[test]
fn a_byte_in_progress_or_a_low_line_does_not_delay_the_gap() {
    let two = Config { channels: 2, ..base() };
    // The second byte starts 1 cycle before the gap ends (874) and is delivered at 1025.
    let input = sent(&[(1, &[STEP_RIGHT]), (873, &[0x82, 0])], 2_000);
    assert_eq!(outcome(&two, &input), (vec![1_025 + 160 + 2, 1_025 + 160 + 12], SHORT_PACKET));
    // A break that starts at 760: its framing error comes at 912, after the gap.
    let input = Input { forced: vec![(760, 1_000, false)], ..sent(&[(1, &[STEP_RIGHT])], 900) };
    assert_eq!(outcome(&two, &input), (vec![], SHORT_PACKET));
}

#[test]
fn after_a_framing_error_bytes_are_ignored_until_a_gap() {
    let two = Config { channels: 2, ..base() };
    // Bytes at 1 and 161; the second's stop bit (sampled at 313) is broken. Ignoring ends at 313 + 721 =
    // 1034.
    let input = |third: u64, last: u64| Input {
        forced: vec![(313, 1, false)],
        ..sent(&[(1, &[STEP_RIGHT, 0]), (third, &[0x82]), (last, &[0x81, 0])], 4_000)
    };
    // "ignores bytes until a gap has passed" and "bytes that are being ignored count too": the byte
    // delivered at 482 + 152 = 634 is ignored and begins the gap anew, which ends at 634 + 721 = 1355: a
    // byte sent at 1203 is received.
    assert_eq!(outcome(&two, &input(482, 1_203)), (vec![1_355 + 160 + 2], FRAMING));
    // Sent one cycle earlier, its first byte is ignored, and so is the next.
    assert_eq!(outcome(&two, &input(482, 1_202)), (vec![], FRAMING));
    // Immediately after the error: a byte delivered at 1033 is ignored, at 1034 it is not ("before a byte
    // delivered in that very cycle is looked at … ignoring ends"), and with the next one it is a packet:
    // 0x82, 0x81.
    assert_eq!(outcome(&two, &input(881, 2_000)), (vec![2_312 + 2], FRAMING));
    let run = run(&two, &input(882, 1_042));
    assert_eq!(steps(&run, 0), [1_034 + 160 + 2, 1_034 + 160 + 12]);
    assert_eq!(steps(&run, 1), [1_034 + 160 + 2]);
    // The remaining zero is too short.
    assert_eq!(run.faults, FRAMING | SHORT_PACKET);
}

#[test]
fn a_framing_error_in_the_cycle_of_the_gap_ends_a_short_packet() {
    // d = 153; the gap ends in 874; a byte sent at 722 has its stop sample there. One cycle earlier it is
    // in the packet.
    let two = Config { channels: 2, ..base() };
    for (start, expected) in [(721, FRAMING), (722, FRAMING | SHORT_PACKET)] {
        let input = Input {
            forced: vec![(start + 144, 16, false)],
            ..sent(&[(1, &[STEP_RIGHT]), (start, &[0])], 2_000)
        };
        assert_eq!(outcome(&two, &input), (vec![], expected), "broken byte at {start}");
    }
}

#[test]
fn too_many_steps_drops_the_packet_and_sets_no_other_fault() {
    let two = Config { channels: 2, ..base() };
    assert_eq!(outcome(&two, &sent(&[(1, &[0x84, 0x04])], 1_000)).1, 0);
    assert_eq!(outcome(&two, &sent(&[(1, &[0x84, 0x05])], 1_000)), (vec![], TOO_MANY_STEPS));
    assert_eq!(outcome(&two, &sent(&[(1, &[0x85, 0x00])], 1_000)), (vec![], TOO_MANY_STEPS));
    // A packet for another controller sets no fault.
    assert_eq!(outcome(&addressed(), &sent(&[(1, &[6, 0x7F])], 1_000)), (vec![], 0));
    assert_eq!(outcome(&addressed(), &sent(&[(1, &[255, 0x7F])], 1_000)), (vec![], TOO_MANY_STEPS));
    // Also when the queue is full: ticks of 4*500 cycles, one place.
    let slow = Config { step_period: 500, queue_depth: 1, ..base() };
    assert_eq!(outcome(&slow, &sent(&[(1, &[1, 1, 5])], 1_000)).1, TOO_MANY_STEPS);
    assert_eq!(outcome(&slow, &sent(&[(1, &[1, 1, 4])], 1_000)).1, QUEUE_OVERFLOW);
}

#[test]
fn a_packet_for_a_full_queue_is_dropped_completely() {
    // Ticks of 4*200 = 800 cycles. Committed at 153: c0 = 154, e = 954. At 313 the place is taken, at 473
    // there is none.
    let config = Config { step_period: 200, queue_depth: 1, ..base() };
    let first_slot = |c0: u64| c0 + 1;
    let (steps, faults) = outcome(&config, &sent(&[(1, &[1, 1, 1])], 4_000));
    assert_eq!((steps, faults), (vec![first_slot(154), first_slot(954)], QUEUE_OVERFLOW));
    let deeper = Config { queue_depth: 2, ..config };
    let (steps, faults) = outcome(&deeper, &sent(&[(1, &[1, 1, 1])], 4_000));
    assert_eq!((steps, faults), (vec![first_slot(154), first_slot(954), first_slot(1_754)], 0));
    assert_eq!(outcome(&deeper, &sent(&[(1, &[1, 1, 1, 1])], 4_000)).1, QUEUE_OVERFLOW);
}

#[test]
fn a_place_freed_at_c0_equal_p_is_free_at_p() {
    // As above, the second tick leaves the queue at 954. A byte sent at 802 is delivered in that cycle.
    let config = Config { step_period: 200, queue_depth: 1, ..base() };
    let input = |third| sent(&[(1, &[1, 1]), (third, &[1])], 4_000);
    assert_eq!(outcome(&config, &input(801)), (vec![155, 955], QUEUE_OVERFLOW));
    assert_eq!(outcome(&config, &input(802)), (vec![155, 955, 1_755], 0));
}

#[test]
fn a_packet_during_boot_is_dropped_without_a_fault() {
    // p = 153; "the cycles 0..=boot-1 are self-test".
    let boot = |boot| Config { boot, ..base() };
    assert_eq!(outcome(&boot(153), &sent(&[(1, &[STEP_RIGHT])], 400)), (vec![155], 0));
    assert_eq!(outcome(&boot(154), &sent(&[(1, &[STEP_RIGHT])], 400)), (vec![], 0));
    // Reading: boot is checked first, so too many steps are no fault, either.
    assert_eq!(outcome(&boot(154), &sent(&[(1, &[0x7F])], 400)), (vec![], 0));
    // Bytes are received during boot: the packet's first byte may arrive then, and faults may occur.
    let two = Config { channels: 2, boot: 313, ..base() };
    assert_eq!(outcome(&two, &sent(&[(1, &[STEP_RIGHT, 0])], 400)), (vec![315], 0));
    let two = Config { channels: 2, boot: 2_000, ..base() };
    assert_eq!(outcome(&two, &sent(&[(1, &[STEP_RIGHT])], 1_000)), (vec![], SHORT_PACKET));
}

#[test]
fn ticks_of_the_paced_host_follow_each_other() {
    // "packet j starts at boot + 1 + j*M*Ts (then tick follows tick without a pause)": M*Ts = 4*50.
    let config = Config { boot: 100, step_period: 50, ..base() };
    let packets = vec![vec![1], vec![2], vec![3]];
    let sends = packets_schedule(&config, &packets);
    assert_eq!(sends, [(101, vec![1]), (301, vec![2]), (501, vec![3])]);
    let run = run(&config, &Input { sends, forced: Vec::new(), cycles: 1_000 });
    // Committed at 253, 453, 653; c0 = 254, 454, 654.
    assert_eq!(steps(&run, 0), [255, 455, 505, 655, 705, 755]);
    assert_eq!((run.ticks_done, run.positions[0], run.faults), (3, -6, 0));
}
