use proptest::{
    prelude::*,
    strategy::ValueTree,
    test_runner::{Config, TestRunner},
};
use stepscope_core::{
    run::Experiment,
    scenario::{Protocol, Source},
    wire::framed_host::Progress,
};
use stepscope_tests::scenarios::shared;
#[test]
fn stats() {
    let mut r = TestRunner::deterministic();
    let (mut ok, mut bad, mut done, mut gave, mut framed, mut multi, mut long) = (0, 0, 0, 0, 0, 0, 0);
    let mut reasons = std::collections::BTreeMap::new();
    for _ in 0..2000 {
        let s = shared().new_tree(&mut r).unwrap().current();
        match Experiment::new(&s) {
            Err(p) => {
                bad += 1;
                for p in p {
                    let path: String = p.path.chars().filter(|c| !c.is_ascii_digit()).collect();
                    *reasons.entry(path).or_insert(0) += 1;
                }
            }
            Ok(e) => {
                ok += 1;
                let mut v: Vec<stepscope_core::trace::Digest> = vec![];
                let run = e.run_each(&mut v);
                if e.controllers() > 1 {
                    multi += 1
                }
                if run.cycles().0 >= 400000 {
                    long += 1
                }
                if let Some(h) = run.host() {
                    framed += 1;
                    for p in h.progress() {
                        match p {
                            Progress::Done => done += 1,
                            Progress::GivenUp(_) => {
                                gave += 1;
                                *reasons.entry(format!("{p:?}")).or_insert(0) += 1;
                            }
                            _ => {}
                        }
                    }
                }
            }
        }
    }
    println!(
        "ok {ok} bad {bad} framed {framed} done {done} gave {gave} multi {multi} long {long} {reasons:#?}"
    );
}
