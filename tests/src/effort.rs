//! How many random cases a property test takes, and where what failed is remembered.

use proptest::test_runner::{Config, FileFailurePersistence};

/// So many cases, or as many as PROPTEST_CASES says; what failed is kept beside the test's file and tried
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
