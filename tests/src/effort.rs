//! Number of random cases of a property test, and the file of its failures.

use proptest::test_runner::{Config, FileFailurePersistence};

/// This number of cases, or that of `PROPTEST_CASES`. Failures are saved next to the test's file, and run
/// first the next time.
#[must_use]
pub fn cases(cases: u32) -> Config {
    let told = Config::default();
    Config {
        cases: if std::env::var_os("PROPTEST_CASES").is_some() { told.cases } else { cases },
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("regressions"))),
        ..told
    }
}
