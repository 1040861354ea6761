use crate::{
    capture::{Capture, Change, Channel, Format},
    channel_map::ChannelMap,
};

fn proposed(names: &[&str], changes: &[(u64, u64)]) -> String {
    let channels = names.iter().map(|name| Channel { name: (*name).into() }).collect();
    let changes = changes.iter().map(|&(tick, levels)| Change { tick, levels }).collect();
    let capture = Capture { channels, changes, ..Capture::new(Format::Vcd) };
    ChannelMap::proposed(&capture).to_text(&capture)
}

#[test]
fn signals_are_proposed_by_name() {
    for (names, expected) in [
        (&["STEP", "DIR", "EN"][..], "STEP0=STEP,DIR0=DIR,EN=EN"),
        (&["x_step", "x_dir", "y_step", "y_dir"], "STEP0=x_step,STEP1=y_step,DIR0=x_dir,DIR1=y_dir"),
        (&["stepZ", "stepX", "nEN"], "STEP0=stepX,STEP1=stepZ,EN=!nEN"),
        (&["STEP3", "DIR3", "RX", "TX", "DE"], "STEP3=STEP3,DIR3=DIR3,RX=RX,TX=TX,DE=DE"),
        (&["top.axis1.STP", "top.axis1.DIRECTION"], "STEP1=top.axis1.STP,DIR1=top.axis1.DIRECTION"),
        (&["PUL+", "CW", "ENABLE_N"], "STEP0=PUL+,DIR0=CW,EN=!ENABLE_N"),
        (&["E0_STEP", "X_STEP"], "STEP0=X_STEP,STEP1=E0_STEP"),
        (&["D0", "D1"], ""),
        (&["BUSY", "RX"], "RX=RX"),
        (&["STEP (Y axis)", "DIR (Y axis)"], "STEP0=STEP (Y axis),DIR0=DIR (Y axis)"),
        (&["STEP (Y axis)", "DIR"], "STEP0=STEP (Y axis),DIR0=DIR"),
        (
            &["RA_STEP", "RA_DIR", "DEC_STEP", "DEC_DIR"],
            "STEP0=RA_STEP,STEP1=DEC_STEP,DIR0=RA_DIR,DIR1=DEC_DIR",
        ),
        (
            &["dec_dir", "ra_dir", "ra_step", "dec_step"],
            "STEP0=dec_step,STEP1=ra_step,DIR0=dec_dir,DIR1=ra_dir",
        ),
        (&["2: STEP", "3: DIR"], "STEP0=2: STEP,DIR0=3: DIR"),
        (&["0 STEP", "1 DIR"], "STEP0=0 STEP,DIR0=1 DIR"),
        (&["D2: X_STEP", "D3: Y_STEP"], "STEP0=D2: X_STEP,STEP1=D3: Y_STEP"),
        (
            &["motor10_step", "motor2_step", "motor2_dir"],
            "STEP2=motor2_step,STEP10=motor10_step,DIR2=motor2_dir",
        ),
        (
            &["motor20_step", "motor3_step", "motor3_dir"],
            "STEP0=motor3_step,STEP1=motor20_step,DIR0=motor3_dir",
        ),
        (&["feed12_step", "feed3_step"], "STEP0=feed3_step,STEP1=feed12_step"),
        (&["step_en", "step", "dir"], "STEP0=step,DIR0=dir,EN=step_en"),
        (&["motorStep", "motorDir", "StepX", "DirX"], "STEP0=motorStep,STEP1=StepX,DIR0=motorDir,DIR1=DirX"),
        (&["X_STEP_PIN", "X_DIR_PIN", "X_ENABLE_PIN"], "STEP0=X_STEP_PIN,DIR0=X_DIR_PIN,EN=X_ENABLE_PIN"),
        (
            &["stepper_x_step", "stepper_x_dir", "stepper_z1_step"],
            "STEP0=stepper_x_step,STEP1=stepper_z1_step,DIR0=stepper_x_dir",
        ),
        (
            &["stepgen.0.step", "stepgen.0.dir", "stepgen.1.step"],
            "STEP0=stepgen.0.step,STEP1=stepgen.1.step,DIR0=stepgen.0.dir",
        ),
        (&["PUL-", "DIR-", "ENA-"], "STEP0=PUL-,DIR0=DIR-,EN=ENA-"),
        (&["PUL-", "PUL+", "DIR+"], "STEP0=PUL+,DIR0=DIR+"),
        (&["CLK", "DIR"], "STEP0=CLK,DIR0=DIR"),
        (&["CLK", "CW"], "STEP0=CLK,DIR0=CW"),
        (&["clk", "STEP", "DIR"], "STEP0=STEP,DIR0=DIR"),
        (&["Step Pulse", "Direction"], "STEP0=Step Pulse,DIR0=Direction"),
        (&["PUL/CW", "DIR/CCW"], "STEP0=PUL/CW,DIR0=DIR/CCW"),
        (&["nSTEP", "DIR"], "STEP0=!nSTEP,DIR0=DIR"),
        // A motor without a DIR shares only a DIR without an axis.
        (&["X_STEP", "Y_STEP", "Y_DIR"], "STEP0=X_STEP,STEP1=Y_STEP,DIR1=Y_DIR"),
        (&["X_STEP", "Y_DIR"], "STEP0=X_STEP,DIR1=Y_DIR"),
        (&["X_STEP", "Y_STEP", "DIR"], "STEP0=X_STEP,STEP1=Y_STEP,DIR0=DIR,DIR1=DIR"),
        (&["X_STEP", "Y_STEP", "Y_DIR", "DIR"], "STEP0=X_STEP,STEP1=Y_STEP,DIR0=DIR,DIR1=Y_DIR"),
        (&["X1_STEP", "X2_STEP", "X_DIR"], "STEP0=X1_STEP,STEP1=X2_STEP,DIR0=X_DIR,DIR1=X_DIR"),
        (&["motion.STEP", "ctrl.DIR"], "STEP0=motion.STEP,DIR0=ctrl.DIR"),
        (&["tb.STEP", "tb.DIR", "tb.dut.STEP", "tb.dut.DIR"], "STEP0=tb.STEP,DIR0=tb.DIR"),
        (&["CW", "CCW"], "CW0=CW,CCW0=CCW"),
        (&["X CW+", "X CCW+", "EN"], "CW0=X CW+,CCW0=X CCW+,EN=EN"),
        (&["PUL_CW", "PUL_CCW"], "CW0=PUL_CW,CCW0=PUL_CCW"),
        (&["UP", "DOWN"], "CW0=UP,CCW0=DOWN"),
        (&["power_up", "power_down"], ""),
        (&["ENC_A", "ENC_B", "ENC_Z"], "A0=ENC_A,B0=ENC_B"),
        (&["PHA", "PHB", "STEP"], "STEP0=STEP,A1=PHA,B1=PHB"),
        (
            &["X_STEP", "X_DIR", "SPINDLE_ENC_A", "SPINDLE_ENC_B"],
            "STEP0=X_STEP,A1=SPINDLE_ENC_A,B1=SPINDLE_ENC_B,DIR0=X_DIR",
        ),
        (&["step_count[0]", "step_count[1]", "microstep", "step_led", "next_step"], ""),
        (&["LSTEP", "LDIR", "RSTEP", "RDIR"], "STEP0=LSTEP,STEP1=RSTEP,DIR0=LDIR,DIR1=RDIR"),
        (&["STEPL", "STEPR", "DIRR", "DIRL"], "STEP0=STEPL,STEP1=STEPR,DIR0=DIRL,DIR1=DIRR"),
        (&["FLSTEP", "FRSTEP", "FLDIR", "FRDIR"], "STEP0=FLSTEP,STEP1=FRSTEP,DIR0=FLDIR,DIR1=FRDIR"),
        (&["TIMESTEP", "REDIR"], ""),
        (
            &["STEPPIN_X", "DIRPIN_X", "STEPPIN_Y", "DIRPIN_Y"],
            "STEP0=STEPPIN_X,STEP1=STEPPIN_Y,DIR0=DIRPIN_X,DIR1=DIRPIN_Y",
        ),
        (&["stepPin1", "dirPin1"], "STEP1=stepPin1,DIR1=dirPin1"),
        (
            &["X-Takt", "Y-Takt", "X-Richtung", "Y-Richtung"],
            "STEP0=X-Takt,STEP1=Y-Takt,DIR0=X-Richtung,DIR1=Y-Richtung",
        ),
        (&["DIRECTION_CHANGED", "STEPS_LEFT", "STEP", "DIR"], "STEP0=STEP,DIR0=DIR"),
        (&["STEP", "STEP2", "DIR"], "STEP0=STEP,STEP2=STEP2,DIR0=DIR,DIR2=DIR"),
        (&["X_STEP", "Y_STEP", "DIR_BOTH"], "STEP0=X_STEP,STEP1=Y_STEP,DIR0=DIR_BOTH,DIR1=DIR_BOTH"),
        (&["STEP0", "STEP1", "COMMON_DIR"], "STEP0=STEP0,STEP1=STEP1,DIR0=COMMON_DIR,DIR1=COMMON_DIR"),
        (&["STEP0", "STEP1", "DIR_ALL"], "STEP0=STEP0,STEP1=STEP1,DIR0=DIR_ALL,DIR1=DIR_ALL"),
        (&["STEP0", "STEP1", "DIR_SHARED"], "STEP0=STEP0,STEP1=STEP1,DIR0=DIR_SHARED,DIR1=DIR_SHARED"),
        (&["X_STEP", "Y_STEP", "XY_DIR"], "STEP0=X_STEP,STEP1=Y_STEP,DIR0=XY_DIR,DIR1=XY_DIR"),
        (&["X_STEP", "Y_STEP", "XYDIR"], "STEP0=X_STEP,STEP1=Y_STEP,DIR0=XYDIR,DIR1=XYDIR"),
        (
            &["X_STEP", "Y_STEP", "Z_STEP", "DIR X/Y", "Z_DIR"],
            "STEP0=X_STEP,STEP1=Y_STEP,STEP2=Z_STEP,DIR0=DIR X/Y,DIR1=DIR X/Y,DIR2=Z_DIR",
        ),
        (
            &["pin3_step", "pin4_dir", "pin5_step", "pin6_dir"],
            "STEP0=pin3_step,STEP1=pin5_step,DIR0=pin4_dir,DIR1=pin6_dir",
        ),
        (&["step2", "step3", "dir5", "dir6"], "STEP0=step2,STEP1=step3,DIR0=dir5,DIR1=dir6"),
        (&["DE/RE", "RS485_TX", "RS485_RX"], "RX=RS485_RX,TX=RS485_TX,DE=DE/RE"),
    ] {
        assert_eq!(proposed(names, &[]), expected, "{names:?}");
    }
}

/// Levels of channels by the times of their edges; the channels in `high` start high, the others low.
fn levels(high: u64, edges: &[&[u64]]) -> Vec<(u64, u64)> {
    let mut all: Vec<(u64, u64)> = Vec::new();
    for (channel, edges) in edges.iter().enumerate() {
        all.extend(edges.iter().map(|at| (*at, 1 << channel)));
    }
    all.sort_unstable();
    let (mut now, mut rows) = (high, vec![(0, high)]);
    for (at, mask) in all {
        now ^= mask;
        match rows.last_mut() {
            Some(row) if row.0 == at => row.1 = now,
            _ => rows.push((at, now)),
        }
    }
    rows
}

fn pulses(from: u64, count: u64, interval: u64, width: u64) -> Vec<u64> {
    (0..count).flat_map(|k| [from + k * interval, from + k * interval + width]).collect()
}

#[test]
fn dir_is_detected_by_the_times_of_its_changes() {
    let step = pulses(100, 40, 100, 10);
    // DIR changes shortly after a STEP rise. LED changes in the middle between two, and its name excludes it.
    let late = [2101, 3101];
    for (names, high, edges, expected) in [
        (&["D0", "D1"][..], 0b10, &[&step[..], &late][..], "STEP0=D0,DIR0=D1"),
        (&["D0", "D1"], 0b01, &[&late, &step], "STEP0=D1,DIR0=D0"),
        (&["STEP", "D1", "LED"], 0, &[&step, &late, &[2050, 3050]], "STEP0=STEP,DIR0=D1"),
        (&["STEP", "LED"], 0, &[&step, &[2050, 3050]], "STEP0=STEP"),
        // An enable is high throughout the steps, and rises before DIR changes.
        (&["D0", "D1", "D2"], 0, &[&step, &[50, 4200], &[2050]], "STEP0=D0,DIR0=D2"),
        (&["RX", "D1"], 0, &[&step, &late], "STEP0=RX,DIR0=D1"),
        (&["D0", "DIR"], 0, &[&step, &late], "STEP0=D0,DIR0=DIR"),
        (&["D0", "D1"], 0, &[&pulses(100, 60, 20, 10), &pulses(95, 15, 80, 40)], "STEP0=D0,DIR0=D1"),
        (&["D0", "D1"], 0, &[&step, &pulses(130, 39, 100, 7)], "STEP0=D0,STEP1=D1"),
    ] {
        assert_eq!(proposed(names, &levels(high, edges)), expected, "{names:?}");
    }
}

#[test]
fn dir_belongs_to_the_motor_whose_pulses_it_changes_next_to() {
    let (x, y, z) = (pulses(100, 60, 100, 10), pulses(137, 50, 117, 10), pulses(151, 40, 131, 12));
    let (dx, dy, dz) = ([2095, 4095], [137 + 117 * 20 - 5], [151 + 131 * 11 - 5, 151 + 131 * 31 - 5]);
    let found = proposed(&["D0", "D1", "D2", "D3", "D4", "D5"], &levels(0, &[&x, &dx, &y, &dy, &z, &dz]));
    assert_eq!(found, "STEP0=D0,STEP1=D2,STEP2=D4,DIR0=D1,DIR1=D3,DIR2=D5");
    let found = proposed(&["D0", "D1", "D2", "D3", "D4", "D5"], &levels(0, &[&x, &y, &z, &dz, &dx, &dy]));
    assert_eq!(found, "STEP0=D0,STEP1=D1,STEP2=D2,DIR0=D4,DIR1=D5,DIR2=D3");
    // A change in the middle of an interval belongs to no motor.
    let (x, y) = (pulses(1000, 18, 500, 5), pulses(1137, 16, 571, 5));
    let found = proposed(&["D0", "D1", "D2", "D3"], &levels(0, &[&x, &[6750], &y, &[4849]]));
    assert_eq!(found, "STEP0=D0,STEP1=D2,DIR0=D1,DIR1=D3");
    let found = proposed(&["D0", "D1", "D2", "D3"], &levels(0, &[&[6750], &x, &[4849], &y]));
    assert_eq!(found, "STEP0=D1,STEP1=D3,DIR0=D0,DIR1=D2");
    let names = ["X-Foo", "Y-Foo", "Y-Bar", "X-Bar"];
    let (near_x, near_y) = ([2095], [137 + 117 * 20 - 5]);
    let (x, y) = (pulses(100, 60, 100, 10), pulses(137, 50, 117, 10));
    let found = proposed(&names, &levels(0, &[&x, &y, &near_x, &near_y]));
    assert_eq!(found, "STEP0=X-Foo,STEP1=Y-Foo,DIR0=X-Bar,DIR1=Y-Bar");
    let (x, y) = (pulses(100, 40, 100, 10), pulses(140, 40, 100, 10));
    let found = proposed(&["X_STEP", "Y_STEP", "D2"], &levels(0, &[&x, &y, &[2130, 3120]]));
    assert_eq!(found, "STEP0=X_STEP,STEP1=Y_STEP,DIR0=D2,DIR1=D2");
    let found = proposed(&["X_STEP", "Y_STEP", "D2"], &levels(0, &[&x, &y, &[2137, 3138]]));
    assert_eq!(found, "STEP0=X_STEP,STEP1=Y_STEP,DIR1=D2");
}

#[test]
fn step_that_idles_high_is_inverted_unless_its_name_is_plain() {
    let step = pulses(100, 40, 100, 10);
    for (name, expected) in
        [("D0", "STEP0=!D0"), ("PUL-", "STEP0=!PUL-"), ("STEP", "STEP0=STEP"), ("STEP_N", "STEP0=!STEP_N")]
    {
        assert_eq!(proposed(&[name], &levels(1, &[&step])), expected);
    }
    let both = levels(3, &[&step, &pulses(9000, 20, 100, 10)]);
    assert_eq!(proposed(&["CW-", "CCW-"], &both), "CW0=!CW-,CCW0=!CCW-");
}

#[test]
fn alternating_edges_are_an_encoder() {
    let a: Vec<u64> = (0..40).map(|k| 100 + 40 * k + k % 3).collect();
    let b: Vec<u64> = (0..40).map(|k| 120 + 40 * k + k % 5).collect();
    assert_eq!(proposed(&["D0", "D1"], &levels(0, &[&a, &b])), "A0=D0,B0=D1");
    // At constant speed a bit rate fits each channel.
    let (mut a, mut b, mut at) = (Vec::new(), Vec::new(), 1000);
    for edges in [41, 33, 27, 60, 39] {
        for _ in 0..edges {
            let is_a = a.len() == b.len();
            if is_a {
                a.push(at)
            } else {
                b.push(at)
            }
            at += 100;
        }
    }
    assert_eq!(proposed(&["D0", "D1"], &levels(0, &[&a, &b])), "A0=D0,B0=D1");
    // Overlapping pulses are not spaced like the edges of an encoder, and STEP and DIR do not alternate.
    let overlapping = [&pulses(100, 40, 400, 10)[..], &pulses(105, 40, 400, 10)];
    assert_eq!(proposed(&["D0", "D1"], &levels(0, &overlapping)), "STEP0=D0,STEP1=D1");
}

#[test]
fn signals_are_proposed_by_behavior_if_names_are_unknown() {
    // D0 is DIR, D1 is STEP, and D2 is a serial line with 104 ticks per bit.
    let mut edges = vec![(0, 0b100)];
    for step in 0..40_u64 {
        let dir = u64::from(step >= 20);
        edges.push((1000 * step + 500, 0b110 | dir));
        edges.push((1000 * step + 520, 0b100 | dir));
        if step == 19 {
            edges.push((1000 * step + 700, 0b101));
        }
    }
    let mut at = 50_000;
    for byte in [0x55_u64, 0x0f, 0xa3, 0x00, 0x81, 0x55] {
        let bits = byte << 1 | 1 << 9;
        for bit in 0..10 {
            let levels = 0b001 | (bits >> bit & 1) << 2;
            if edges.last().is_some_and(|(_, before)| *before != levels) {
                edges.push((at, levels));
            }
            at += 104;
        }
    }
    edges.push((at, 0b101));
    edges.dedup_by_key(|(_, levels)| *levels);
    assert_eq!(proposed(&["D0", "D1", "D2", "D3"], &edges), "STEP0=D1,DIR0=D0,RX=D2");
    assert_eq!(proposed(&["A", "B", "TX", "C"], &edges), "STEP0=B,DIR0=A,TX=TX");
    assert_eq!(proposed(&["STEP", "B"], &[(0, 0), (5, 2), (6, 0)]), "STEP0=STEP");
    let pulses = |count: u64| (0..2 * count).map(|at| (10 * at, at % 2)).collect::<Vec<_>>();
    assert_eq!(proposed(&["A", "B"], &pulses(3)), "");
    assert_eq!(proposed(&["A", "B"], &pulses(5)), "STEP0=A");
    assert_eq!(proposed(&["RX", "BUSY"], &[(0, 1), (5, 3), (6, 1)]), "RX=RX");
}
