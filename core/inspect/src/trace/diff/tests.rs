use super::*;
use crate::export::tables::{write_edges_head, write_edges_row};
use stepscope_peripheral::trace::write_record;

fn run() -> Vec<Record> {
    [(0, 0x7_0000_0000), (5, 0x5_0000_0000), (16, 0x7_0001_0001), (17, 0x7_0001_0000), (30, 0x7_0000_0000)]
        .map(|(cycle, levels)| Record { cycle: Instant(cycle), levels: Levels(levels) })
        .to_vec()
}

fn texts(records: &[Record]) -> [String; 2] {
    let (mut table, mut trace) = (String::new(), String::new());
    write_edges_head(&mut table, 1).expect("a string takes it");
    for record in records {
        write_edges_row(&mut table, *record, 16_000_000, 1).expect("a string takes it");
        write_record(&mut trace, *record).expect("a string takes it");
    }
    [table, trace]
}

/// In pieces of one byte, of seven, and as a whole.
fn compare(run: &[Record], text: &str) -> Result<Outcome, BadLine> {
    let outcomes = [1, 7, text.len().max(1)].map(|size| {
        let mut diff = TraceDiff::new(1);
        for piece in text.as_bytes().chunks(size) {
            if diff.feed(run, piece)? {
                break;
            }
        }
        diff.finish(run)
    });
    assert_eq!(outcomes[0], outcomes[1]);
    assert_eq!(outcomes[0], outcomes[2]);
    outcomes[0].clone()
}

#[test]
fn a_file_of_a_run_or_of_its_part_agrees() {
    let run = run();
    for text in texts(&run) {
        for text in [text.clone(), text.replace('\n', "\r\n"), text.trim_end().into()] {
            let outcome = compare(&run, &text).expect("reads");
            let range = (Instant(0), Instant(30));
            assert_eq!(outcome, Outcome { same: 5, range, difference: None, run_continues: false });
        }
    }
    let mut range = run[1..4].to_vec();
    range[0].cycle = Instant(9);
    for text in texts(&range) {
        let outcome = compare(&run, &text).expect("reads");
        let range = (Instant(9), Instant(17));
        assert_eq!(outcome, Outcome { same: 3, range, difference: None, run_continues: true });
    }
}

#[test]
fn the_first_difference_is_found_with_its_cycle_and_signals() {
    let own = run();
    let changed = |change: &dyn Fn(&mut Vec<Record>)| {
        let mut file = own.clone();
        change(&mut file);
        let [table, trace] = texts(&file).map(|text| {
            let found = compare(&own, &text).expect("reads").difference.expect("they differ");
            (found.cycle.0, found.signals(), found.line)
        });
        assert_eq!(
            (table.0, table.1, table.2),
            (trace.0, trace.1, trace.2 + 1),
            "the table has one more line, its header"
        );
        trace
    };
    assert_eq!(changed(&|file| file[2].levels.0 ^= 1), (16, 1, 3));
    assert_eq!(changed(&|file| file[2].cycle.0 = 15), (15, 0x2_0001_0001, 3), "earlier in the file");
    assert_eq!(changed(&|file| file[3].cycle.0 = 18), (17, 1, 4), "earlier in the run");
    assert_eq!(changed(&|file| file[0].levels.0 = 0), (0, 0x7_0000_0000, 1));
    let without = |file: &mut Vec<Record>| {
        file.remove(2);
    };
    assert_eq!(changed(&without), (16, 0x2_0001_0001, 3), "missing in the file");
    let more = Record { cycle: Instant(40), levels: Levels(0x7_0000_0001) };
    assert_eq!(changed(&|file| file.push(more)), (40, 1, 6), "the run has ended");
}

#[test]
fn invalid_lines_are_reported_with_their_number() {
    let head = "cycle,time_s,STEP0,DIR0,EN,RX,TX,DE\n";
    let rows = [
        (String::new(), "line 0: the file has no edges"),
        (head.into(), "line 1: the file has no edges"),
        ("cycle,time_s,STEP0\n".into(), "line 1: the columns do not match this controller with 1 channels"),
        (format!("{head}0,0,0,0,1,1,1,0\nx,0,0,0,1,1,1,0\n"), "line 3: “x” is not a cycle"),
        (format!("{head}0,0,0,0,1,1,1\n"), "line 2: DE is “”, not a level"),
        (format!("{head}0,0,0,2,1,1,1,0\n"), "line 2: DIR0 is “2”"),
        (format!("{head}0,0,0,0,1,1,1,0,0\n"), "line 2: more fields"),
        ("0 700000000\n5 500000000\n5 500000000\n".into(), "line 3: cycle 5 follows cycle 5"),
        ("hello\n".into(), "line 1: not a record"),
        ("0".repeat(2000), "line 1: longer than 1000 characters"),
    ];
    for (text, expected) in rows {
        let found = compare(&run(), &text).expect_err(&text).to_string();
        assert!(found.starts_with(expected), "{text}: {found}");
    }
}
