//! The golden cases of `tests/golden/` in a browser: the very files of the native test.
#![cfg(target_arch = "wasm32")]

mod js;

use js::{get, list, number, text};
use stepscope_tests::{
    golden::{CASES, Case},
    plant_digests::plant_cases,
};
use stepscope_wasm::ValidatedScenario;
use wasm_bindgen_test::{wasm_bindgen_test, wasm_bindgen_test_configure};

wasm_bindgen_test_configure!(run_in_dedicated_worker);

/// Fails with the messages of all cases that `check` refuses.
fn every_case(check: impl Fn(&Case) -> Result<(), String>) {
    let failures: Vec<String> = CASES.iter().filter_map(|case| check(case).err()).collect();
    assert!(failures.is_empty(), "{} failed\n{}", failures.len(), failures.join("\n"));
}

#[wasm_bindgen_test]
fn every_golden_case_has_its_trace_at_both_speeds() {
    every_case(Case::check);
}

#[wasm_bindgen_test]
fn plant_digests_match_the_contract() {
    let failures: Vec<String> = plant_cases().iter().filter_map(|case| case.check(true).err()).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// As the page's worker runs it, and with slices so small that many of them end amid a tick.
#[wasm_bindgen_test]
fn every_golden_case_has_its_digest_in_slices() {
    every_case(|case| {
        let mut simulation =
            ValidatedScenario::new(case.json()?).run().map_err(|_| format!("{}: refused", case.name))?;
        let controllers = case.experiment()?.controllers();
        let mut records = 0.0;
        for slice in [1, 2, 3, 100].into_iter().chain(std::iter::repeat(10_000)) {
            let Ok(progress) = simulation.advance(slice) else {
                return Err(format!("{}: stopped", case.name));
            };
            let before = std::mem::replace(&mut records, number(&progress, "records"));
            if get(&progress, "done").is_truthy() {
                break;
            }
            // "A few more may come": those of the tick that runs; and other controllers make theirs.
            let made = records - before;
            let most = (f64::from(slice) + 600.0) * controllers as f64;
            if made < f64::from(slice) || made > most {
                return Err(format!("{}: a slice of {slice} made {made} records", case.name));
            }
        }
        let Ok(summary) = simulation.summary() else { return Err(format!("{}: no summary", case.name)) };
        let digests: Vec<String> =
            list(&summary, "controllers").iter().map(|controller| text(controller, "digest")).collect();
        let (found, expected) = (digests.join("\n"), case.file("digest").unwrap_or_default().trim());
        if found == expected { Ok(()) } else { Err(format!("{}: {found} is not {expected}", case.name)) }
    });
}
