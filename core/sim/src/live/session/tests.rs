//! Sessions that are recorded and replayed, and a host's exchange with a session over a faulty line.

use super::*;
use crate::{
    framed_host::{Conversation, GivenUp, Job, Progress},
    noise::Random,
};
use alloc::{format, string::String};
use stepscope_peripheral::{device::Faults, signal::MAX_CHANNELS, units::Cycles, wire::frame};
use stepscope_scenario::Source;

fn session(json: &str) -> Session {
    Session::new(&Scenario::from_json(json).expect("reads")).expect("no problems")
}

fn sends(session: &Session) -> Vec<(u64, usize)> {
    session.run().schedule().iter().map(|send| (send.start.0, send.bytes.len())).collect()
}

/// Slightly more than 10 cycles per bit: byte j starts at floor(10*j*1050/100).
const SLOW: &str = r#"{ "clock_hz": 1155, "line": { "baud": 100 }, "bus": { "self_test_cycles": 0 } }"#;

#[test]
fn a_byte_joins_the_last_send_if_its_time_is_in_the_future() {
    // Model's cycle, bytes received, sends afterwards. A byte takes 115.5 cycles.
    type Row = (u64, usize, &'static [(u64, usize)]);
    let rows: [Row; 6] = [
        (0, 1, &[(1, 1)]),
        (115, 1, &[(1, 2)]),
        // The third one starts at 1 + 231.
        (231, 1, &[(1, 3)]),
        (347, 2, &[(1, 3), (348, 2)]),
        (348, 3, &[(1, 3), (348, 5)]),
        (5000, 1, &[(1, 3), (348, 5), (5001, 1)]),
    ];
    let mut session = session(SLOW);
    for (now, bytes, expected) in rows {
        session.advance::<Digest>(Instant(now), &mut []);
        session.receive(&vec![0x55; bytes]);
        assert_eq!(sends(&session), expected, "{bytes} in {now}");
    }
    session.advance::<Digest>(Instant(6000), &mut []);
    session.recording().verify().expect("the same");
}

#[test]
fn a_session_ignores_sends_length_and_noise() {
    let json = r#"{ "line": { "protocol": "framed", "noise": { "lost_bytes_ppm": 1000000 }, "host": { "attempts": 3 },
        "glitches": [ { "start_cycle": 9, "length_cycles": 2, "level": 0 } ] }, "run_cycles": 70 }"#;
    let mut session = session(json);
    assert_eq!((session.now(), session.deadline(), session.received()), (Instant(0), Instant::NEVER, 0));
    session.advance::<Digest>(Instant(999), &mut []);
    let Recording { scenario, .. } = session.recording();
    let plain = Scenario::from_json(json).expect("reads");
    assert_eq!((scenario.run_cycles, scenario.source), (Some(1000), Source::Line(LineScript::default())));
    assert_eq!((scenario.line.noise, scenario.line.host), (Default::default(), Host::default()));
    assert_eq!(scenario.line.glitches, plain.line.glitches);
    let segments =
        Scenario::from_json(r#"{ "source": { "motion": { "engine": "segments" } } }"#).expect("reads");
    assert_eq!(Session::new(&segments).err().expect("no line")[0].path, "source");
}

#[test]
fn forced_levels_on_an_idle_line_have_passed_before_bytes() {
    for protocol in ["raw", "framed"] {
        let json = format!(
            r#"{{ "line": {{ "protocol": "{protocol}", "glitches": [
                {{ "start_cycle": 200000, "length_cycles": 2, "level": 1 }},
                {{ "start_cycle": 200009, "length_cycles": 2, "level": 1 }} ] }} }}"#
        );
        let mut session = session(&json);
        session.advance::<Digest>(Instant(300_000), &mut []);
        session.receive(&[0x55, 0x33]);
        session.advance::<Digest>(Instant(400_000), &mut []);
        assert!(session.received() == 2 && session.run().cycles().0 == 400_001, "{protocol}");
        session.recording().verify().expect("the same");
    }
}

#[test]
fn a_reply_leaves_with_its_stop_bit_and_not_before() {
    let mut session = session(
        r#"{ "clock_hz": 1600, "line": { "baud": 100, "protocol": "framed" } , "bus": { "self_test_cycles": 0 } }"#,
    );
    session.receive(&frame::emit(0, 4, &[]));
    let (mut ends, mut rounds) = (Vec::new(), 0);
    while session.is_busy() {
        session.advance::<Digest>(session.deadline(), &mut []);
        let now = session.now();
        ends.extend(session.take_replies().map(|reply| {
            assert_eq!(reply.end, now, "in the first cycle that has all of it");
            reply.end.0
        }));
        rounds += 1;
    }
    // The frame ends with the sample of its last stop bit, 16*9 + 8 after the start; 11 bits later the reply begins.
    let last = 1 + 160 * 7 + 8 + 144;
    assert_eq!(ends.first(), Some(&(last + 11 * 16 + 160)));
    assert_eq!((ends.len(), ends[16] - ends[0], rounds), (17, 16 * 160, 18));
}

#[test]
fn bytes_of_a_reply_within_a_round_are_awaited_together() {
    let json = r#"{ "clock_hz": 1600, "line": { "baud": 100, "protocol": "framed" } , "bus": { "self_test_cycles": 0 } }"#;
    // A byte takes 160 cycles: round, rounds of a reply of 17 bytes.
    for (round, expected) in [(0, 17), (159, 17), (160, 9), (500, 5), (100_000, 1)] {
        let mut session = session(json);
        session.receive(&frame::emit(0, 4, &[]));
        let heard = session.deadline_of_round(Cycles(round));
        session.advance::<Digest>(heard, &mut []);
        let (mut bytes, mut rounds) = (Vec::new(), 0);
        while session.is_busy() {
            session.advance::<Digest>(session.deadline_of_round(Cycles(round)), &mut []);
            bytes.extend(session.take_replies());
            assert_eq!(bytes.last().map(|byte| byte.end), Some(session.now()), "{round}");
            rounds += 1;
        }
        assert_eq!((bytes.len(), rounds), (17, expected), "{round}");
    }
}

/// Random scenarios: protocols, rates, controllers.
fn random_scenario(random: &mut Random) -> String {
    let framed = random.below(2) == 0;
    let protocol = if framed { "framed" } else { "raw" };
    let baud = [100, 137, 240][random.below(3) as usize];
    let receiver = baud - 3 + random.below(6);
    let several = random.below(3) == 0;
    let controllers = if several {
        r#", "controllers": [ { "address": 9, "bus": { "channels": 1 } }, { "address": 3 } ]"#
    } else {
        ""
    };
    let address = if several { r#", "address": 1"# } else { "" };
    let glitch = random.below(9000);
    format!(
        r#"{{ "clock_hz": 4000, "bus": {{ "channels": 2, "slots": 5, "step_period_cycles": 90, "self_test_cycles": 20, "queue_depth": 3 }},
            "line": {{ "protocol": "{protocol}", "baud": {baud}, "receiver_baud": {receiver}{address},
                "glitches": [ {{ "start_cycle": {}, "length_cycles": 30, "level": 0 }} ] }}{controllers} }}"#,
        1 + glitch
    )
}

/// Bytes that may be a packet, a frame, or neither.
fn random_chunk(random: &mut Random) -> Vec<u8> {
    let bytes = |random: &mut Random, most| {
        (0..random.below(most)).map(|_| random.below(256) as u8).collect::<Vec<u8>>()
    };
    match random.below(4) {
        0 => bytes(random, 20),
        1 => vec![0x80 | random.below(6) as u8; random.below(5) as usize],
        2 => {
            frame::emit([0, 1, 3, 9, 255][random.below(5) as usize], random.below(9) as u8, &bytes(random, 3))
        }
        _ => frame::emit(
            [0, 1, 3, 9][random.below(4) as usize],
            1,
            &frame::Ticks::emit(random.below(4) as u8, 2, &[0x83, 0x02, 0x80, 0]),
        ),
    }
}

#[test]
fn random_sessions_are_replayed_exactly() {
    let (mut replies, mut faults) = (0, Faults::default().bits());
    for seed in 0..400 {
        let mut random = Random::new(seed);
        let json = random_scenario(&mut random);
        let mut session = session(&json);
        for _ in 0..random.below(40) {
            let chunk = random_chunk(&mut random);
            // Some chunks are read in two parts.
            let (one, two) = chunk.split_at(random.below(chunk.len() as u64 + 1) as usize);
            session.receive(one);
            session.receive(two);
            let pause = [0, 1, 7, 300, 5000][random.below(5) as usize];
            let to = Instant(session.now().0 + random.below(pause + 1));
            session.advance::<Digest>(to, &mut []);
            replies += session.take_replies().count();
        }
        let recording = session.recording();
        assert_eq!(recording.verify(), Ok(()), "seed {seed}: {json}");
        let text = recording.scenario.to_json();
        assert_eq!(Scenario::from_json(&text).as_ref(), Ok(&recording.scenario), "seed {seed}");
        faults |= session.run().devices().fold(0, |all, device| all | device.faults().bits());
    }
    assert!(replies > 500 && faults.count_ones() >= 5, "{replies} {faults:#x}");
}

#[test]
fn a_session_continues_after_its_recording_is_full() {
    let mut session = session(r#"{ "clock_hz": 1000000, "line": { "baud": 90000 } }"#);
    let chunk = vec![0x81; 1 << 16];
    for _ in 0..64 {
        session.receive(&chunk);
    }
    let whole = session.deadline();
    session.advance::<Digest>(whole, &mut []);
    assert!(session.records_all());
    let at = session.now();
    session.receive(&[0x81]);
    assert!(!session.records_all());
    session.advance::<Digest>(whole + Cycles(1_000_000), &mut []);
    session.receive(&[0x81]);
    let kept: usize = sends(&session).iter().map(|&(_, bytes)| bytes).sum();
    assert_eq!(kept, 1, "what has been sent is forgotten");
    session.advance::<Digest>(whole + Cycles(2_000_000), &mut []);
    let recording = session.recording();
    assert_eq!(recording.scenario.run_cycles, Some(at.0 + 1));
    recording.verify().expect("the same");
    assert_eq!(session.received(), (4 << 20) + 2);
}

/// Ticks that a controller begins.
#[derive(Default)]
struct Executed(Vec<[u8; MAX_CHANNELS]>);

impl Sink for Executed {
    fn record(&mut self, _: Record) {}

    fn event(&mut self, _: Instant, event: Event) {
        if let Event::TickStart { commands } = event {
            self.0.push(commands);
        }
    }
}

/// A host and a simulated device, with a system between them that delays, divides and changes bytes, and
/// stops one of the two for a while. Returns the host's final state, the sent commands, and the executed ones.
fn over_a_bad_wire(seed: u64, stop: bool) -> (Progress, Vec<u8>, Vec<u8>, u32) {
    let mut random = Random::new(seed);
    let json = r#"{ "clock_hz": 100000, "bus": { "channels": 2, "slots": 5, "step_period_cycles": 90, "queue_depth": 6, "self_test_cycles": 20 },
        "line": { "protocol": "framed", "baud": 9000 } }"#;
    let mut device = session(json);
    let ticks = 1 + random.below(30);
    let mut orders: Vec<u8> =
        (0..2 * ticks).map(|_| (random.below(6) | random.below(2) << 7) as u8).collect();
    orders.extend([0x80, 0]);
    let job =
        Job { address: 0, channels: 2, tick: Cycles(450), queue_depth: 6, commands: orders.clone().into() };
    let settings = Host { ticks_per_frame: 1 + random.below(8) as u8, ..Host::default() };
    let mut host = Conversation::new(vec![job], &settings, Cycles(11), Instant(30)).with_slack(Cycles(5000));
    let bad = [0, 2_000, 30_000][random.below(3) as usize];
    let stop_at = stop.then(|| 30 + random.below(40_000));
    // Bytes in transit, with the time when they are read.
    let (mut to_device, mut to_host) = (VecDeque::<(u64, u8)>::new(), VecDeque::<(u64, u8)>::new());
    let mut executed = [Executed::default()];
    let wire = |random: &mut Random, now: u64, bytes: &[u8], queue: &mut VecDeque<(u64, u8)>| {
        for &byte in bytes {
            let late = [0, 0, 0, 40, 900][random.below(5) as usize];
            let at = queue.back().map_or(0, |&(at, _)| at).max(now + random.below(late + 1));
            match random.below(1_000_000) {
                lost if lost < bad => {}
                bent if bent < 2 * bad => queue.push_back((at, byte ^ 1 << random.below(8))),
                doubled if doubled < 3 * bad => queue.extend([(at, byte), (at, byte)]),
                _ => queue.push_back((at, byte)),
            }
        }
    };
    let (mut now, mut stopped) = (30_u64, false);
    while !host.is_over() {
        if stop_at.is_some_and(|at| at <= now) && !stopped {
            host.stop(Instant(now));
            stopped = true;
        }
        while to_host.front().is_some_and(|&(at, _)| at <= now) {
            to_host.pop_front().into_iter().for_each(|(_, byte)| host.receive(byte, Instant(now)));
        }
        while host.deadline() <= Instant(now) {
            if let Some(bytes) = host.poll(Instant(now)) {
                host.sent(Instant(now + 111 * bytes.len() as u64));
                wire(&mut random, now, &bytes, &mut to_device);
            }
        }
        while to_device.front().is_some_and(|&(at, _)| at <= now) {
            to_device.pop_front().into_iter().for_each(|(_, byte)| device.receive(&[byte]));
        }
        device.advance(Instant(now), &mut executed);
        let replies: Vec<u8> = device.take_replies().map(|reply| reply.byte).collect();
        wire(&mut random, now, &replies, &mut to_host);
        // Rounds of up to a millisecond; sometimes one of the two is stopped.
        now += 1 + random.below(100) + if random.below(2000) == 0 { random.below(30_000) } else { 0 };
        assert!(now < 100_000_000, "seed {seed}: the host never ends");
    }
    device.recording().verify().unwrap_or_else(|why| panic!("seed {seed}: {why}"));
    let executed: Vec<u8> = executed[0].0.iter().flat_map(|tick| tick[..2].to_vec()).collect();
    (host.progress().next().expect("one job"), orders, executed, host.acknowledged().next().expect("one job"))
}

/// Number of seeds: `STEPSCOPE_SEEDS=100000` for the long form.
fn seeds() -> u64 {
    std::env::var("STEPSCOPE_SEEDS").ok().and_then(|seeds| seeds.parse().ok()).unwrap_or(400)
}

#[test]
fn on_a_bad_line_every_wrong_tick_is_reported() {
    let mut done = 0;
    for seed in 0..seeds() {
        let (progress, commanded, executed, acknowledged) = over_a_bad_wire(seed, false);
        // In any case the executed commands are the first ones of those sent.
        assert!(commanded.starts_with(&executed), "seed {seed}: {progress}");
        assert!(executed.len() >= 2 * acknowledged as usize, "seed {seed}: {progress}");
        match progress {
            Progress::Done => assert_eq!(executed, commanded, "seed {seed}"),
            // With noise that hardly any frame passes.
            other => assert_eq!(other, Progress::GivenUp(GivenUp::NoReply), "seed {seed}"),
        }
        done += u64::from(progress == Progress::Done);
    }
    assert!((seeds() / 2..seeds()).contains(&done), "{done} of {}", seeds());
}

#[test]
fn a_stop_on_a_bad_line_leaves_the_first_ticks() {
    for seed in 0..seeds() / 4 {
        let (progress, commanded, executed, _) = over_a_bad_wire(seed, true);
        assert!(commanded.starts_with(&executed), "seed {seed}: {progress}");
        let ended =
            matches!(progress, Progress::Done | Progress::GivenUp(GivenUp::Interrupted | GivenUp::NoReply));
        assert!(ended, "seed {seed}: {progress}");
    }
}

/// A host and a simulated device whose connection is cut after a number of bytes in either direction. Returns the host's state,
/// the ticks that it has confirmed, and the sent and executed commands.
fn cut_after(to_device: usize, to_host: usize) -> (Progress, u32, Vec<u8>, Vec<u8>, bool) {
    let json = r#"{ "clock_hz": 100000, "bus": { "channels": 2, "slots": 5, "step_period_cycles": 90, "queue_depth": 6, "self_test_cycles": 20 },
        "line": { "protocol": "framed", "baud": 9000 } }"#;
    let mut device = session(json);
    let orders: Vec<u8> = vec![0x81, 2, 0x83, 4, 0x82, 1, 0x80, 0];
    let job =
        Job { address: 0, channels: 2, tick: Cycles(450), queue_depth: 6, commands: orders.clone().into() };
    let settings = Host { ticks_per_frame: 2, ..Host::default() };
    let mut host = Conversation::new(vec![job], &settings, Cycles(11), Instant(30));
    let mut executed = [Executed::default()];
    let (mut there, mut back, mut now, mut cut) = (to_device, to_host, Instant(30), false);
    while !host.is_over() && !cut {
        if let Some(bytes) = host.poll(now) {
            let passed = there.min(bytes.len());
            device.receive(&bytes[..passed]);
            host.sent(now + Cycles(111 * bytes.len() as u64));
            cut = passed < bytes.len();
            there -= passed;
        }
        now = host.deadline().min(device.deadline().max(now.next())).min(now + Cycles(1000));
        device.advance(now, &mut executed);
        let replies: Vec<u8> = device.take_replies().map(|reply| reply.byte).collect();
        let passed = back.min(replies.len());
        replies[..passed].iter().for_each(|&byte| host.receive(byte, now));
        cut |= passed < replies.len();
        back -= passed;
    }
    // Queued ticks are executed.
    device.advance(now + Cycles(10_000), &mut executed);
    let progress = host.progress().next().expect("one job");
    let done = host.known().next().and_then(|(_, known)| known.ticks_done()).unwrap_or(0);
    let executed = executed[0].0.iter().flat_map(|tick| tick[..2].to_vec()).collect();
    (progress, done, orders, executed, cut)
}

#[test]
fn a_connection_cut_at_any_byte_leaves_the_first_ticks() {
    let mut cuts = 0;
    for bytes in 0..200 {
        for (to_device, to_host) in [(bytes, usize::MAX), (usize::MAX, bytes)] {
            let (progress, done, commanded, executed, cut) = cut_after(to_device, to_host);
            assert!(commanded.starts_with(&executed), "{to_device} {to_host}");
            assert!(2 * done as usize <= executed.len(), "{to_device} {to_host}");
            assert_eq!(progress == Progress::Done, !cut, "{to_device} {to_host}: {progress}");
            assert!(cut || executed == commanded, "{to_device} {to_host}");
            cuts += u32::from(cut);
        }
    }
    // 2 * 8 + 2 * 8 + 2 * 13 bytes to the device, 4 * 17 + 2 * 25 back.
    assert!(cuts > 150, "{cuts}");
}

/// A host and a simulated device that is reset in each of these cycles. Returns the host's final state, and whether each STEP
/// output had the commanded number of pulses.
fn with_resets(resets: &[u64], opening_tick: bool, restarts_with: u64) -> (Progress, bool, u64) {
    let json = r#"{ "clock_hz": 100000, "bus": { "channels": 2, "slots": 5, "step_period_cycles": 90, "queue_depth": 6, "self_test_cycles": 20 },
        "line": { "protocol": "framed", "baud": 9000 } }"#;
    let blank = session(json);
    let mut device = blank.clone();
    let orders: Vec<u8> = vec![0x81, 2, 0x83, 4, 0x82, 1, 0x80, 0];
    let job = Job { address: 0, channels: 2, tick: Cycles(450), queue_depth: 6, commands: orders.into() };
    let settings = Host { ticks_per_frame: 2, ..Host::default() };
    let mut host = Conversation::new(vec![job], &settings, Cycles(11), Instant(30));
    if opening_tick {
        host = host.with_opening_tick();
    }
    let mut pulses = [Pulses::default()];
    // The device's cycle 0, and the bytes in transit to it.
    let (mut powered, mut now, mut coming) = (0, 30_u64, VecDeque::<(u64, u8)>::new());
    let mut resets = resets.iter().copied().peekable();
    while !host.is_over() {
        if let Some(bytes) = host.poll(Instant(now)) {
            let places = (0..).map(|byte| now + 1 + 111 * byte);
            coming.extend(places.zip(bytes.iter().copied()));
            host.sent(Instant(now + 111 * bytes.len() as u64));
        }
        while coming.front().is_some_and(|&(at, _)| at <= now) {
            coming.pop_front().into_iter().for_each(|(_, byte)| device.receive(&[byte]));
        }
        if resets.next_if(|&at| at <= now).is_some() {
            (device, powered) = (blank.clone(), now + restarts_with);
            pulses[0].high = 0;
        }
        device.advance(Instant(now.saturating_sub(powered)), &mut pulses);
        device.take_replies().for_each(|reply| host.receive(reply.byte, Instant(now)));
        let next = host.deadline().min(Instant(now + 37)).0.max(now + 1);
        now = coming.front().map_or(next, |&(at, _)| next.min(at.max(now + 1)));
        assert!(now < 100_000_000, "the host never ends");
    }
    // 1 + 3 + 2 and 2 + 4 + 1.
    (host.progress().next().expect("one job"), pulses[0].counts[..2] == [6, 7], now)
}

/// Counts the pulses on each STEP output.
#[derive(Default)]
struct Pulses {
    high: u16,
    counts: [u32; MAX_CHANNELS],
}

impl Sink for Pulses {
    fn record(&mut self, record: Record) {
        let rising = record.levels.step() & !self.high;
        for (channel, count) in self.counts.iter_mut().enumerate() {
            *count += u32::from(rising >> channel & 1);
        }
        self.high = record.levels.step();
    }

    fn event(&mut self, _: Instant, _: Event) {}
}

#[test]
fn a_reset_device_is_done_only_after_all_steps() {
    let (progress, right, end) = with_resets(&[], true, 0);
    assert_eq!((progress, right), (Progress::Done, true));
    let (mut done, mut wrong_without) = (0, 0);
    // Single resets during the whole job, and pairs.
    let singles = (30..end).step_by(61).map(|at| vec![at]);
    let pairs = (30..end).step_by(487).flat_map(|at| [90, 1700, 9000].map(|later| vec![at, at + later]));
    for (index, resets) in singles.chain(pairs).enumerate() {
        // Some devices restart immediately, others after a while.
        let restarts_with = [0, 4000][index % 2];
        let (progress, right, _) = with_resets(&resets, true, restarts_with);
        assert!(progress != Progress::Done || right, "{resets:?}: {progress}");
        assert_ne!(progress, Progress::Counted, "{resets:?}");
        done += u32::from(progress == Progress::Done);
        let (progress, right, _) = with_resets(&resets, false, restarts_with);
        wrong_without += u32::from(progress == Progress::Done && !right);
    }
    // Before the first step, the job restarts with a device that was reset.
    assert!(done > 50, "{done}");
    assert!(wrong_without > 5, "without the opening tick {wrong_without} are wrong");
}

#[test]
fn buffered_bytes_have_the_same_cycles_as_bytes_received_immediately() {
    for seed in 0..100 {
        let mut random = Random::new(seed);
        let json = random_scenario(&mut random);
        let (mut at_once, mut waiting) = (session(&json), session(&json));
        let mut input = Input::default();
        for _ in 0..random.below(20) {
            let chunk = random_chunk(&mut random);
            at_once.receive(&chunk);
            assert_eq!(input.push(&chunk), chunk.len());
            let to = Instant(at_once.now().0 + random.below(3000));
            at_once.advance::<Digest>(to, &mut []);
            while waiting.now() < to {
                let to = Instant(waiting.now().0 + 1 + random.below(700)).min(to);
                input.feed(&mut waiting, to + Cycles(random.below(500)));
                waiting.advance::<Digest>(to, &mut []);
            }
        }
        input.feed(&mut waiting, Instant(1 << 40));
        assert!(input.is_empty());
        assert_eq!(sends(&waiting), sends(&at_once), "seed {seed}: {json}");
        assert_eq!(waiting.recording(), at_once.recording(), "seed {seed}: {json}");
    }
}

#[test]
fn a_flood_is_read_at_the_rate_of_the_line() {
    for protocol in ["raw", "framed"] {
        let json =
            format!(r#"{{ "clock_hz": 1000000, "line": {{ "baud": 50000, "protocol": "{protocol}" }} }}"#);
        let mut session = session(&json);
        let (mut input, mut read, flood) = (Input::default(), 0, vec![0; 4096]);
        // 200 cycles per byte: 50 s take 250 000 bytes.
        let round = Cycles(50_000);
        for _ in 0..1000 {
            while input.room() > 0 {
                read += input.push(&flood) as u64;
            }
            let to = session.now() + round;
            input.feed(&mut session, to);
            session.advance::<Digest>(to, &mut []);
            session.take_replies().for_each(drop);
            assert!(session.received() <= session.now().0 / 200 + 1, "{protocol}");
        }
        assert_eq!(session.received() + input.len() as u64, read);
        assert!(session.received() >= 249_999, "{protocol}: {}", session.received());
        assert!(session.records_all());
        // When the recording is full, nothing of an endless send is stored.
        session.end_recording();
        for _ in 0..3 {
            while input.room() > 0 {
                input.push(&flood);
            }
            let to = session.now() + round;
            input.feed(&mut session, to);
            session.advance::<Digest>(to, &mut []);
            let kept: usize = session.run().schedule().iter().map(|send| send.bytes.len()).sum();
            assert!(kept <= 1000, "{protocol}: {kept}");
        }
        session.recording().verify().expect("the same");
    }
}

#[test]
fn the_first_frame_of_a_host_is_separate_from_the_last_host() {
    let status = frame::emit(0, 4, &[]);
    let json = |protocol| {
        format!(
            r#"{{ "clock_hz": 1600, "line": {{ "baud": 100, "protocol": "{protocol}" }}, "bus": {{ "self_test_cycles": 0 }} }}"#
        )
    };
    // Up to an incomplete frame, and one that is too long.
    let flood = vec![1; 700];
    for unfinished in (0..status.len()).map(|sent| &status[..sent]).chain([&flood[..]]) {
        let mut session = session(&json("framed"));
        session.receive(unfinished);
        session.hang_up();
        session.hang_up();
        let is_ended = unfinished.last().is_none_or(|byte| *byte == 0);
        let sent = unfinished.len() as u64 + if is_ended { 0 } else { 2 };
        assert_eq!(session.received(), sent);
        session.receive(&status);
        session.advance::<Digest>(Instant(160 * (sent + 100)), &mut []);
        assert_eq!(session.take_replies().count(), 17, "{unfinished:?}");
        session.recording().verify().expect("the same");
    }
    // A raw packet has no delimiter: its gap ends it.
    let mut session = session(&json("raw"));
    session.receive(&[1]);
    session.hang_up();
    assert_eq!(session.received(), 1);
}

#[test]
fn a_host_never_gets_replies_of_the_last_host() {
    let json = r#"{ "clock_hz": 1600, "line": { "baud": 100, "protocol": "framed" }, "bus": { "self_test_cycles": 0 } }"#;
    let status = frame::emit(0, 4, &[]);
    // 8 bytes of 160 cycles, then a reply of 17.
    for hangs_up in (0..5000).step_by(97) {
        let mut session = session(json);
        session.receive(&status);
        session.advance::<Digest>(Instant(hangs_up), &mut []);
        session.take_replies().for_each(drop);
        session.hang_up();
        // The frame of the first host ends, and the next one begins.
        let begins = session.deadline().min(Instant(5000)).max(Instant(hangs_up + 1));
        session.advance::<Digest>(begins, &mut []);
        assert_eq!(session.take_replies().count(), 0, "{hangs_up}");
        session.receive(&status);
        session.advance::<Digest>(Instant(20_000), &mut []);
        let replies: Vec<ReplyByte> = session.take_replies().collect();
        // A frame that arrives while the controller still replies to the first host is lost, as on any such line.
        assert!([0, 17].contains(&replies.len()), "{hangs_up}: {}", replies.len());
        let earliest = begins + Cycles(160 * status.len() as u64);
        assert!(replies.iter().all(|reply| reply.end > earliest), "{hangs_up}");
    }
}

#[test]
fn a_session_replays_the_same_bytes() {
    use crate::session::Session;
    use stepscope_peripheral::{signal::Record, units::Instant, wire::frame};
    use stepscope_scenario::Scenario;

    let scenario = Scenario::from_json(r#"{ "line": { "protocol": "framed" } }"#).expect("reads");
    let mut session = Session::new(&scenario).expect("it has no problems");
    let nobody: &mut [Vec<Record>] = &mut [];
    session.advance(Instant(5000), nobody);
    session.receive(&frame::emit(0, 4, &[])); // STATUS, read while the model is behind cycle 5000
    session.advance(Instant(50_000), nobody);
    let reply: Vec<u8> = session.take_replies().map(|reply| reply.byte).collect();
    assert_eq!(reply.len(), 17);
    session.recording().verify().expect("run again it has the same digest");
}
